//! Parts of the tests side by side, each in a process of its own, whose output is shown whole when it ends.

use super::tally::Tally;
use crate::test::Part;
use crate::tools;
use anyhow::{Context as _, Result, anyhow};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How many parts run at a time. Most use one core for most of the time, and those of C and Python all cores for some of it.
const LANES: usize = 2;

/// How a part ended.
struct Ended {
    status: ExitStatus,
    took: Duration,
    output: String,
}

/// Runs these parts in this order, and adds their counts. Their output goes to files in `folder`.
pub(super) fn run(parts: &[Part], folder: &Path, tally: &mut Tally) -> Result<()> {
    tools::create_folder(folder)?;
    let program = std::env::current_exe().context("the path of this program")?;
    let slots: Vec<_> = parts.iter().map(|_| Mutex::new(None)).collect();
    let queue = Mutex::new(parts.iter().zip(&slots));
    let start = Instant::now();
    let lane = || {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((part, slot)) = next else { break };
            let name = part.name();
            println!("== {name} begins; alone: cargo xtask test --only {name}");
            let ended = run_one(&program, &name, &folder.join(&name).with_extension("txt"));
            if let Ok(ended) = &ended {
                show(&name, ended);
            }
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(ended);
        }
    };
    std::thread::scope(|scope| {
        let lanes: Vec<_> = (0..LANES).map(|_| scope.spawn(lane)).collect();
        for lane in lanes {
            // The part at which a lane panics has no outcome, which is a failure; the other lane goes on.
            let _ = lane.join();
        }
    });
    println!("== all parts: {:.1} s", start.elapsed().as_secs_f64());
    for (part, slot) in parts.iter().zip(slots) {
        let ended = slot.into_inner().unwrap_or_else(PoisonError::into_inner);
        count(*part, ended.unwrap_or_else(|| Err(anyhow!("its lane panicked"))), tally);
    }
    Ok(())
}

/// Does some work while a part runs, and shows that part at the end. Nothing waits for what it makes: what needs it
/// makes it again if it failed.
pub(crate) fn beside(part: Part, work: impl FnOnce()) {
    let name = part.name();
    println!("== {name} begins, beside what follows; alone: cargo xtask test --only {name}");
    let file = tools::target().join("test-env").join(&name).with_extension("txt");
    std::thread::scope(|scope| {
        let running = scope.spawn(|| {
            tools::create_folder(file.parent().unwrap_or(&file))?;
            run_one(&std::env::current_exe()?, &name, &file)
        });
        work();
        match running.join().unwrap_or_else(|_| Err(anyhow!("its thread panicked"))) {
            Ok(ended) => show(&name, &ended),
            Err(why) => println!("== {name}: {why:#}"),
        }
    });
}

/// Runs one part; its output and errors go to a file in the order in which it writes them.
fn run_one(program: &Path, name: &str, file: &PathBuf) -> Result<Ended> {
    let cannot = || format!("{}: cannot write", file.display());
    let log = File::create(file).with_context(cannot)?;
    let errors = log.try_clone().with_context(cannot)?;
    let start = Instant::now();
    let mut command = Command::new(program);
    command.args(["test", "--prepared", "--only", name]);
    // The threads of numpy's BLAS yield their core in a loop while they wait for each other: beside another part every small
    // product loses a time slice, and Blender's tests take several times as long.
    command.env("OPENBLAS_NUM_THREADS", "1");
    let status = command.stdin(Stdio::null()).stdout(log).stderr(errors).status();
    let (status, took) = (status.context("did not start")?, start.elapsed());
    let output = std::fs::read(file).with_context(|| format!("{}: cannot read", file.display()))?;
    Ok(Ended { status, took, output: String::from_utf8_lossy(&output).into_owned() })
}

/// Prints the output of a part in one piece.
fn show(name: &str, ended: &Ended) {
    let mut out = std::io::stdout().lock();
    // As with `println!`, an output that nobody reads is no error.
    let _ = writeln!(out, "== {name}, {:.1} s", ended.took.as_secs_f64());
    let _ = write!(out, "{}", ended.output);
    let _ = writeln!(out, "== end of {name}");
}

/// Adds the counts of a part, and repeats its seconds and failures below all output.
fn count(part: Part, ended: Result<Ended>, tally: &mut Tally) {
    let name = part.name();
    let Ended { status, took, output } = match ended {
        Ok(ended) => ended,
        Err(why) => return tally.case(&name, Err(why)),
    };
    let counts = output.lines().rev().find_map(Tally::read);
    let counted = counts.as_ref().map_or_else(String::new, |counts| format!(": {counts}"));
    println!("{name}, {:.1} s{counted}", took.as_secs_f64());
    let failed = |line: &str| line.starts_with("FAILED ") || line.ends_with(" ... FAILED");
    for line in output.lines().filter(|line| failed(line)) {
        println!("  {line}");
    }
    // Cargo counts the Rust tests, crate by crate.
    let ended = status.success() && (counts.is_some() || part == Part::Rust);
    let reported = counts.as_ref().is_some_and(|counts| counts.failed > 0);
    if let Some(counts) = counts {
        tally.add(&counts);
    }
    if !ended && !reported {
        let last = output.lines().next_back().unwrap_or("no output");
        tally.case(&name, Err(anyhow!("broke off: {status}: {last}")));
    }
}

#[cfg(test)]
mod tests {
    use super::{Ended, Part, Tally, count};
    use anyhow::anyhow;
    use std::process::Command;
    use std::time::Duration;

    #[test]
    fn parts_without_counts_or_success_are_failed_cases() {
        let counted = |part, program: &str, output: &str| {
            let status = Command::new(program).status().unwrap();
            let (mut tally, took) = (Tally::default(), Duration::ZERO);
            count(part, Ok(Ended { status, took, output: output.to_owned() }), &mut tally);
            (tally.passed, tally.failed, tally.skipped)
        };
        assert_eq!(counted(Part::C, "true", "ok a\n5 passed, 0 failed, 1 skipped\n"), (5, 0, 1));
        assert_eq!(
            counted(Part::C, "false", "FAILED a\n5 passed, 2 failed, 1 skipped\nxtask: 2 failed\n"),
            (5, 2, 1)
        );
        assert_eq!(counted(Part::C, "false", "5 passed, 0 failed, 1 skipped\n"), (5, 1, 1));
        assert_eq!(counted(Part::C, "false", "ok a\nthread 'main' panicked\n"), (0, 1, 0));
        assert_eq!(counted(Part::C, "true", ""), (0, 1, 0));
        assert_eq!(counted(Part::Rust, "true", "test result: ok. 5 passed; 0 failed\n"), (0, 0, 0));
        assert_eq!(
            counted(Part::Rust, "false", "test a ... FAILED\nxtask: `cargo test` failed\n"),
            (0, 1, 0)
        );
        let mut tally = Tally::default();
        count(Part::C, Err(anyhow!("did not start")), &mut tally);
        assert_eq!((tally.passed, tally.failed), (0, 1));
    }
}
