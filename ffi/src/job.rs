//! Jobs: many bodies made on a thread of the library, with progress and cancellation.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use anthronet::condition::Request;

use crate::body::anthronet_body;
use crate::model::anthronet_model;
use crate::options::{Descriptor, DescriptorOut};
use crate::pointer::{Out, beyond, free, list, read};
use crate::request::anthronet_request;
use crate::status::{
    ANTHRONET_ERROR_BUSY, ANTHRONET_ERROR_CANCELLED, ANTHRONET_ERROR_OTHER, ANTHRONET_ERROR_TAKEN, Fault,
    Outcome, anthronet_error, anthronet_status, caught, guard,
};

/// Bodies are still being made.
pub const ANTHRONET_JOB_RUNNING: u32 = 0;
/// Every request has its body or its error.
pub const ANTHRONET_JOB_DONE: u32 = 1;
/// Cancelled, and nothing is running any more; what was made before can be taken.
pub const ANTHRONET_JOB_CANCELLED: u32 = 2;

/// Requests that are being made into bodies by a thread of the library. May be polled and cancelled from any thread.
pub struct anthronet_job {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    /// The process that started it: a child made by `fork` has the job's memory, but not its thread.
    process: u32,
    cancelled: AtomicBool,
    finished: AtomicBool,
    done: AtomicU32,
    results: Vec<Mutex<Slot>>,
}

enum Slot {
    Open,
    Made(Outcome<Box<anthronet_body>>),
    Taken,
}

/// Progress of a job.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_job_progress {
    /// Set by the caller: `sizeof(anthronet_job_progress)`.
    pub struct_size: u32,
    /// `ANTHRONET_JOB_…`.
    pub state: u32,
    /// Requests that have their body or error.
    pub done: u32,
    /// Requests altogether.
    pub total: u32,
}

// SAFETY: numbers alone, the size first.
unsafe impl Descriptor for anthronet_job_progress {}

impl Drop for anthronet_job {
    fn drop(&mut self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
        let Some(thread) = self.thread.take() else { return };
        if self.shared.is_here() {
            // Its panics are caught inside.
            let _ = thread.join();
        } else {
            // There is no such thread here, and its own memory may be another's by now.
            std::mem::forget(thread);
        }
    }
}

impl Shared {
    fn run(&self, model: &anthronet_model, requests: &[Request]) {
        for (slot, request) in self.results.iter().zip(requests) {
            if self.cancelled.load(Ordering::Relaxed) {
                break;
            }
            let make = || {
                #[cfg(feature = "test-hooks")]
                crate::test_hooks::before_a_body();
                Ok(Box::new(anthronet_body::new(model.0.generate(request)?)))
            };
            let made = caught(make);
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Slot::Made(made);
            self.done.fetch_add(1, Ordering::Release);
        }
        self.finished.store(true, Ordering::Release);
    }

    /// False in a child of the process that started the job: what was not made by then never will be there.
    fn is_here(&self) -> bool {
        self.process == std::process::id()
    }

    fn state(&self) -> u32 {
        if !self.is_here() {
            return ANTHRONET_JOB_CANCELLED;
        }
        if !self.finished.load(Ordering::Acquire) {
            return ANTHRONET_JOB_RUNNING;
        }
        let all = self.done.load(Ordering::Acquire) as usize == self.results.len();
        if all { ANTHRONET_JOB_DONE } else { ANTHRONET_JOB_CANCELLED }
    }
}

/// Starts to make the bodies of `count` requests, in order. The requests are copied and the model is kept: both may be
/// freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_job_start(
    model: *const anthronet_model,
    requests: *const *const anthronet_request,
    count: u32,
    out_job: *mut *mut anthronet_job,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_job, "out_job")?;
        let model = anthronet_model(read(model, "model")?.0.clone());
        let requests = list(requests, count, "requests")?
            .iter()
            .map(|request| Ok(read(*request, "request")?.0.clone()))
            .collect::<Outcome<Vec<Request>>>()?;
        let shared = Arc::new(Shared {
            process: std::process::id(),
            cancelled: AtomicBool::new(false),
            finished: AtomicBool::new(false),
            done: AtomicU32::new(0),
            results: requests.iter().map(|_| Mutex::new(Slot::Open)).collect(),
        });
        let theirs = shared.clone();
        let thread = std::thread::Builder::new()
            .name("anthronet job".into())
            .spawn(move || theirs.run(&model, &requests))
            .map_err(|e| Fault::new(ANTHRONET_ERROR_OTHER, format!("cannot start a thread: {e}")))?;
        out.give(anthronet_job { shared, thread: Some(thread) });
        Ok(())
    })
}

/// The progress of the job. Returns at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_job_poll(
    job: *const anthronet_job,
    out_progress: *mut anthronet_job_progress,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = DescriptorOut::new(out_progress, "out_progress")?;
        let shared = &read(job, "job")?.shared;
        // The state first: done and total of a finished job do not change any more.
        let state = shared.state();
        let done = shared.done.load(Ordering::Acquire);
        out.write(&anthronet_job_progress {
            struct_size: 0,
            state,
            done,
            total: shared.results.len() as u32,
        });
        Ok(())
    })
}

/// Asks the job to stop after the current body, which takes some hundredths of a second at most. Returns at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_job_cancel(
    job: *const anthronet_job,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        read(job, "job")?.shared.cancelled.store(true, Ordering::Relaxed);
        Ok(())
    })
}

/// Takes the body of a request, once, as soon as it is there; while the job goes on, too. Fails with the error of that
/// request, with `ANTHRONET_ERROR_BUSY` before there is one, with `ANTHRONET_ERROR_CANCELLED` when there will be none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_job_take(
    job: *const anthronet_job,
    index: u32,
    out_body: *mut *mut anthronet_body,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_body, "out_body")?;
        let shared = &read(job, "job")?.shared;
        let finished = shared.finished.load(Ordering::Acquire);
        let count = shared.results.len();
        if !shared.is_here() && (index as usize) < count {
            // The lock of a slot may be held for ever by the thread that is not here.
            let message =
                format!("body {index} was made in the process that started the job, this is another");
            return Err(Fault::new(ANTHRONET_ERROR_CANCELLED, message));
        }
        let slot = shared.results.get(index as usize).ok_or_else(|| beyond("index", index, count))?;
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        match std::mem::replace(&mut *slot, Slot::Taken) {
            Slot::Made(Ok(body)) => {
                out.give(*body);
                Ok(())
            }
            Slot::Made(Err(fault)) => {
                let again = Fault::new(fault.code, fault.message.clone());
                *slot = Slot::Made(Err(fault));
                Err(again)
            }
            Slot::Taken => Err(Fault::new(ANTHRONET_ERROR_TAKEN, format!("body {index} was taken before"))),
            Slot::Open => {
                *slot = Slot::Open;
                let (code, why) = match finished {
                    true => (ANTHRONET_ERROR_CANCELLED, "was never made: the job was cancelled"),
                    false => (ANTHRONET_ERROR_BUSY, "is not made yet"),
                };
                Err(Fault::new(code, format!("body {index} {why}")))
            }
        }
    })
}

/// Cancels the job, waits until it has stopped and frees it; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_job_free(job: *mut anthronet_job) {
    free(job);
}
