//! Counting of cases, those of scripts included.

use anyhow::{Result, anyhow};
use std::fmt::{self, Display};
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The output of a script, and how long it took.
type Done = (std::io::Result<Output>, Duration);

/// Cases so far.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) passed: u32,
    pub(crate) failed: u32,
    pub(crate) skipped: u32,
}

/// The line that a part ends with.
impl Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

impl Tally {
    /// The counts of a line as [`Display`] writes it.
    pub(crate) fn read(line: &str) -> Option<Self> {
        let mut words = line.split(", ");
        let mut number = |unit| words.next()?.strip_suffix(unit)?.parse().ok();
        let tally =
            Self { passed: number(" passed")?, failed: number(" failed")?, skipped: number(" skipped")? };
        words.next().is_none().then_some(tally)
    }

    /// Adds the counts of a part.
    pub(crate) fn add(&mut self, other: &Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }

    /// Prints and counts one case.
    pub(crate) fn case(&mut self, name: &str, result: Result<()>) {
        match result {
            Ok(()) => self.line(&format!("ok {name}")),
            Err(why) => self.line(&format!("FAILED {name}: {why:#}")),
        }
    }

    /// Prints and counts a case that this machine cannot run.
    pub(crate) fn skip(&mut self, name: &str, why: impl Display) {
        self.line(&format!("skipped {name}: {why}"));
    }

    /// Prints a line and counts it if it is a case.
    fn line(&mut self, line: &str) {
        println!("{line}");
        match line.split(' ').next() {
            Some("ok") => self.passed += 1,
            Some("FAILED") => self.failed += 1,
            Some("skipped") => self.skipped += 1,
            _ => {}
        }
    }

    /// Runs independent scripts in parallel on all cores, then counts them in order as [`script`](Self::script) does.
    pub(crate) fn scripts(&mut self, scripts: Vec<(String, Command)>) {
        let (names, commands): (Vec<_>, Vec<_>) = scripts.into_iter().unzip();
        let slots: Vec<Mutex<Option<Done>>> = names.iter().map(|_| Mutex::new(None)).collect();
        let queue = Mutex::new(commands.into_iter().zip(&slots));
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            for _ in 0..threads.min(slots.len()) {
                scope.spawn(|| {
                    loop {
                        let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
                        let Some((mut command, slot)) = next else { break };
                        let start = Instant::now();
                        let output = command.stdout(Stdio::piped()).output();
                        *slot.lock().unwrap_or_else(PoisonError::into_inner) =
                            Some((output, start.elapsed()));
                    }
                });
            }
        });
        for (name, slot) in names.iter().zip(slots) {
            let Some((output, took)) = slot.into_inner().unwrap_or_else(PoisonError::into_inner) else {
                continue;
            };
            println!("-- {name}, {:.1} s", took.as_secs_f64());
            let before = self.counts();
            let status = output.map(|output| {
                eprint!("{}", String::from_utf8_lossy(&output.stderr));
                for line in String::from_utf8_lossy(&output.stdout).lines() {
                    self.line(line.trim_end());
                }
                output.status
            });
            self.ended(name, before, status);
        }
    }

    /// Runs a script and counts the cases that it prints; a script that exits early is a failed case of its own.
    pub(crate) fn script(&mut self, name: &str, command: &mut Command) {
        println!("-- {name}");
        let before = self.counts();
        let status = command.stdout(Stdio::piped()).spawn().and_then(|mut child| {
            if let Some(output) = child.stdout.take() {
                for line in BufReader::new(output).split(b'\n') {
                    self.line(String::from_utf8_lossy(&line?).trim_end());
                }
            }
            child.wait()
        });
        self.ended(name, before, status);
    }

    fn counts(&self) -> (u32, u32) {
        (self.passed + self.failed + self.skipped, self.failed)
    }

    /// Adds a failed case for a script that exited early or ran nothing. `before`: the counts before its lines.
    fn ended(&mut self, name: &str, before: (u32, u32), status: std::io::Result<ExitStatus>) {
        let (before, failed_before) = before;
        match status {
            Err(e) => self.case(name, Err(anyhow!("did not start: {e}"))),
            Ok(status) if !status.success() && self.failed == failed_before => {
                self.case(name, Err(anyhow!("broke off: {status}")));
            }
            Ok(_) if self.counts().0 == before => {
                self.case(name, Err(anyhow!("ran no case")));
            }
            Ok(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Tally;

    #[test]
    fn counts_are_read_back() {
        let tally = Tally { passed: 12, failed: 0, skipped: 3 };
        let read = Tally::read(&tally.to_string()).unwrap();
        assert_eq!((read.passed, read.failed, read.skipped), (12, 0, 3));
        for line in ["98 passed in 2.92s", "1 passed, 0 failed", "1 passed, 0 failed, 2 skipped, 3 slow", ""]
        {
            assert!(Tally::read(line).is_none(), "{line}");
        }
    }
}
