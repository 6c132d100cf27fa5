//! Mutated inputs: whatever bytes come, what reads them returns in time, without a panic of ours, and with bounded memory.
//!
//! Each test changes small valid inputs, which each seed changes in one way. The ordinary run tries some hundred seeds. With
//! `ANTHRONET_FUZZ_SECONDS` each test goes on for that long, from the seed `ANTHRONET_FUZZ_SEED` on.

mod mutate;

use std::cell::RefCell;
use std::env;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use self::mutate::Mutation;
use super::memory::most_held;
use crate::format::panic_becomes_error;

/// A file of a format: its parts, and the file that they make. What is inside a container is changed, and the container made
/// anew around it, as otherwise its lengths and checksums would refuse everything.
pub(crate) struct Input {
    pub(crate) path: &'static str,
    pub(crate) parts: Vec<Vec<u8>>,
    pub(crate) whole: fn(&[Vec<u8>]) -> Vec<u8>,
}

impl Input {
    /// A file that is not taken apart.
    pub(crate) fn plain(path: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        Self { path, parts: vec![bytes.into()], whole: |parts| parts.concat() }
    }
}

/// How many seeds of each test the ordinary run tries.
const SEEDS: u64 = 150;
/// One input takes at most this long, even on a busy machine.
const TIME: Duration = Duration::from_secs(60);
/// And so much memory, bytes: about what the longest motion that is allowed takes in double precision, of 2²⁴ rotations.
const MEMORY: usize = 1 << 30;

thread_local! {
    /// Where this thread panicked, and whether that becomes an error about a damaged file.
    static PANIC: RefCell<Option<(String, bool)>> = const { RefCell::new(None) };
}

/// Notes panics of the threads that read, which would otherwise fill the terminal; all others are reported as before.
fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(READER) {
                return before(info);
            }
            PANIC.set(Some((info.to_string(), panic_becomes_error())));
        }));
    });
}

/// The name of the threads that read.
const READER: &str = "reader of mutated files";

/// Whether a panic is a fault: one that nothing catches, or one of ours that is taken for one of a parser.
fn is_fault((place, caught): &(String, bool)) -> bool {
    !caught || place.contains("core/src")
}

fn number(variable: &str) -> Option<u64> {
    env::var(variable).ok().map(|value| value.parse().unwrap())
}

/// Mutates inputs and has `read` read them, which returns whether they could be read.
pub(crate) fn fuzz(inputs: Vec<Input>, read: impl Fn(&[u8], &str) -> bool + Send + 'static) {
    note_panics();
    let seconds = number("ANTHRONET_FUZZ_SECONDS");
    let first = number("ANTHRONET_FUZZ_SEED").unwrap_or(0);
    let (sender, receiver) = channel();
    let work = move || read_all(&inputs, &read, first, seconds.map(Duration::from_secs), &sender);
    let reader = std::thread::Builder::new().name(READER.into()).spawn(work).unwrap();
    let mut last = first;
    loop {
        match receiver.recv_timeout(TIME) {
            Ok(seed) => last = seed,
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => panic!("seed {last} takes over {TIME:?}"),
            Err(_) => break,
        }
    }
    match reader.join() {
        Ok(faults) => assert!(faults.is_empty(), "{}", faults.join("\n")),
        Err(_) => panic!("seed {last}: the reader's thread ended"),
    }
}

/// Reads the mutated inputs of one seed after the other, and returns what went wrong with the first few.
fn read_all(
    inputs: &[Input],
    read: &impl Fn(&[u8], &str) -> bool,
    first: u64,
    time: Option<Duration>,
    sender: &Sender<u64>,
) -> Vec<String> {
    for input in inputs {
        assert!(read(&(input.whole)(&input.parts), input.path), "{} is no valid input", input.path);
    }
    let (start, mut faults) = (Instant::now(), Vec::new());
    let (mut understood, mut memory, mut longest) = (0, (0, 0), (Duration::ZERO, 0));
    let mut seed = first;
    let goes_on = |seed| time.map_or(seed < first + SEEDS, |time| start.elapsed() < time);
    while goes_on(seed) && faults.len() < 8 {
        sender.send(seed).unwrap();
        let (bytes, path) = mutated(inputs, seed);
        let began = Instant::now();
        let mut outcome = Ok(false);
        let held = most_held(|| outcome = panic::catch_unwind(AssertUnwindSafe(|| read(&bytes, path))));
        let panicked = PANIC.take().filter(is_fault).map(|(place, _)| place);
        if let Some(why) =
            panicked.or_else(|| (held > MEMORY).then(|| format!("{held} bytes of memory at once")))
        {
            faults.push(format!("seed {seed} ({path}, {} bytes): {why}", bytes.len()));
        }
        understood += u64::from(outcome.unwrap_or(false));
        memory = memory.max((held, seed));
        longest = longest.max((began.elapsed(), seed));
        seed += 1;
    }
    let count = seed - first;
    println!(
        "{count} inputs, {understood} of them valid; at most {} bytes (seed {}), {:?} (seed {})",
        memory.0, memory.1, longest.0, longest.1
    );
    faults
}

/// What a seed makes of one of the inputs.
fn mutated(inputs: &[Input], seed: u64) -> (Vec<u8>, &'static str) {
    let mut mutation = Mutation::new(seed);
    let input = &inputs[mutation.below(inputs.len())];
    let mut parts = input.parts.clone();
    let part = mutation.below(parts.len() + 1);
    match parts.get_mut(part) {
        Some(part) => {
            mutation.change(part);
            ((input.whole)(&parts), input.path)
        }
        None => {
            let mut bytes = (input.whole)(&parts);
            mutation.change(&mut bytes);
            (bytes, input.path)
        }
    }
}
