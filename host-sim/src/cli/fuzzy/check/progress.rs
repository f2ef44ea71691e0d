//! How far a check has got, for one that takes long.

use host_sim::fuzzy::check::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// What takes less is not shown.
const LONG: Duration = Duration::from_secs(1);
const TICK: Duration = Duration::from_millis(100);

/// A line on a terminal.
pub struct Progress {
    bar: ProgressBar,
    waits: AtomicBool,
}

impl Progress {
    /// Nothing to be seen yet.
    pub fn new() -> Self {
        Self {
            bar: ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()),
            waits: AtomicBool::new(std::io::stderr().is_terminal()),
        }
    }

    /// Nothing to be seen any more.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch for Progress {
    fn begin(&self, what: &'static str, steps: Option<usize>) {
        let template = match steps {
            Some(_) => "{spinner} {msg} {bar:30} {pos} of {len}, {eta} left",
            None => "{spinner} {msg} {elapsed}",
        };
        let style = ProgressStyle::with_template(template)
            .unwrap_or_else(|_| ProgressStyle::default_spinner());
        self.bar.set_style(style);
        self.bar.reset();
        self.bar.set_message(what);
        match steps {
            Some(steps) => self.bar.set_length(steps as u64),
            None => self.bar.unset_length(),
        }
        if self.waits.swap(false, Ordering::Relaxed) {
            let bar = self.bar.clone();
            thread::spawn(move || {
                thread::sleep(LONG);
                if !bar.is_finished() {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(TICK);
                }
            });
        }
    }

    fn done(&self, steps: usize) {
        self.bar.inc(steps as u64);
    }
}
