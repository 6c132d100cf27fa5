//! Counting of cases, those of scripts included.

use crate::tools::Outcome;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// Cases so far.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) passed: u32,
    pub(crate) failed: u32,
    pub(crate) skipped: u32,
}

impl Tally {
    /// Prints and counts one case.
    pub(crate) fn case(&mut self, name: &str, result: Outcome) {
        match result {
            Ok(()) => self.line(&format!("ok {name}")),
            Err(why) => self.line(&format!("FAILED {name}: {why}")),
        }
    }

    pub(crate) fn skip(&mut self, name: &str, why: &str) {
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

    /// Runs a script and counts the cases that it prints; a script that breaks off is a failed case of its own.
    pub(crate) fn script(&mut self, name: &str, command: &mut Command) {
        println!("-- {name}");
        let before = self.passed + self.failed + self.skipped;
        let failed_before = self.failed;
        let status = command.stdout(Stdio::piped()).spawn().and_then(|mut child| {
            if let Some(output) = child.stdout.take() {
                for line in BufReader::new(output).split(b'\n') {
                    self.line(String::from_utf8_lossy(&line?).trim_end());
                }
            }
            child.wait()
        });
        match status {
            Err(e) => self.case(name, Err(format!("did not start: {e}"))),
            Ok(status) if !status.success() && self.failed == failed_before => {
                self.case(name, Err(format!("broke off: {status}")));
            }
            Ok(_) if self.passed + self.failed + self.skipped == before => {
                self.case(name, Err("ran no case".to_owned()));
            }
            Ok(_) => {}
        }
    }
}
