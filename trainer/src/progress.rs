//! Progress of long work on standard error: a bar on a terminal, lines elsewhere.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::generator::Metrics;

/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

/// Progress towards a total that may become known later.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    /// When the last line was written; `None` on a terminal.
    line: Option<Mutex<Instant>>,
}

impl Bar {
    pub(crate) fn new(what: &str, length: u64) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar =
            styled(length, terminal, "{msg} {wide_bar} {pos}/{len} {eta}").with_message(what.to_owned());
        Self { bar, line: (!terminal).then(|| Mutex::new(Instant::now())) }
    }

    pub(crate) fn inc(&self) {
        self.bar.inc(1);
        self.tell(LINE_EVERY);
    }

    /// Sets the activity and the progress, `done` of `of`; `of` is 0 while the total is unknown.
    pub(crate) fn set(&self, what: &str, done: u64, of: u64) {
        self.bar.set_message(what.to_owned());
        self.bar.set_length(of.max(1));
        self.bar.set_position(done);
        self.tell(LINE_EVERY);
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Writes a line when there is no terminal and the last one is so long ago; whether it did.
    fn tell(&self, every: Duration) -> bool {
        let Some(line) = &self.line else { return false };
        let mut last = line.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() < every {
            return false;
        }
        *last = Instant::now();
        eprintln!("{}: {} of {}", self.bar.message(), self.bar.position(), self.bar.length().unwrap_or(0));
        true
    }
}

/// The progress of a training, optionally silent.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    name: &'static str,
    lines: bool,
}

impl Progress {
    pub(crate) fn new(name: &'static str, epochs: usize, done: usize, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let template = "{prefix} {bar:30} {pos}/{len} epochs, {elapsed} gone, {eta} to go  {msg}";
        let bar = styled(epochs as u64, terminal && !quiet, template).with_position(done as u64);
        bar.reset_eta();
        bar.set_prefix(name);
        bar.tick();
        Self { bar, name, lines: !terminal && !quiet }
    }

    /// Shows the network's metrics; without a terminal, as a line on standard error.
    pub(crate) fn message(&self, metrics: &Metrics) {
        let message = state(metrics);
        if self.lines {
            let epochs = self.bar.length().unwrap_or(0);
            eprintln!("{}: epoch {} of {epochs}, {message}", self.name, metrics.epoch);
        }
        self.bar.set_message(message);
    }

    pub(crate) fn advance(&self) {
        self.bar.inc(1);
    }

    pub(crate) fn finish(&self) {
        self.bar.finish();
    }
}

fn styled(length: u64, shown: bool, template: &str) -> ProgressBar {
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

fn state(metrics: &Metrics) -> String {
    let p2p = match metrics.p2p_mm {
        Some(p2p) => format!("p2p {p2p:.3} mm"),
        None => format!("rms {:.3} mm", metrics.rms_mm),
    };
    let [loss, divergence, _] = metrics.training;
    format!("{p2p}, z = 0 {:.2}, loss {loss:.4}, kl {divergence:.1}", metrics.rms_z0_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_off_a_terminal_and_not_too_often() {
        let off = |line| Bar { bar: ProgressBar::hidden(), line };
        let bar = off(Some(Mutex::new(Instant::now())));
        bar.set("bodies", 3, 9);
        assert_eq!((bar.bar.position(), bar.bar.length()), (3, Some(9)));
        assert!(!bar.tell(LINE_EVERY));
        assert!(bar.tell(Duration::ZERO));
        assert!(!off(None).tell(Duration::ZERO));
    }
}
