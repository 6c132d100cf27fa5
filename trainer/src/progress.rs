//! The progress bar of a training.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::generator::Metrics;

/// A bar on standard error, hidden when it is no terminal.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    pub(crate) fn new(name: &'static str, epochs: usize, done: usize, quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(epochs as u64), target).with_position(done as u64);
        bar.reset_eta();
        let template = "{prefix} {bar:30} {pos}/{len} epochs, {elapsed} gone, {eta} to go  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_prefix(name);
        bar.tick();
        Self(bar)
    }

    /// Shows the state of the network. Off a terminal the same goes to standard error as a line.
    pub(crate) fn message(&self, metrics: &Metrics) {
        let p2p = match metrics.p2p_mm {
            Some(p2p) => format!("p2p {p2p:.3} mm"),
            None => format!("rms {:.3} mm", metrics.rms_mm),
        };
        let [loss, divergence, _] = metrics.training;
        self.0.set_message(format!(
            "{p2p}, z = 0 {:.2}, loss {loss:.4}, kl {divergence:.1}",
            metrics.rms_z0_mm
        ));
    }

    pub(crate) fn advance(&self) {
        self.0.inc(1);
    }

    pub(crate) fn finish(&self) {
        self.0.finish();
    }
}
