//! What commands that search have in common: progress, the state file, Ctrl-C.

use super::{BadInput, put};
use anyhow::Context;
use host_sim::search::state::{Question, State};
use host_sim::search::{Progress, SearchError};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where the state is, in the folder of the results.
pub const STATE: &str = "state.json";

/// Whether Ctrl-C was pressed, once [`listen`] was called.
pub static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C ends the search, not the program.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("signals: cannot be handled")
}

/// What the user can mend is bad input.
pub fn bad(error: SearchError) -> anyhow::Error {
    match error {
        SearchError::Observer(error) => error,
        other => BadInput(other.to_string()).into(),
    }
}

/// Progress on a terminal, nothing elsewhere.
pub fn bar(evaluations: u64) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("{bar:30} {pos} of at most {len}, {msg}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(evaluations), target).with_style(style)
}

/// A generation's figures beside it.
pub fn show(bar: &ProgressBar, progress: &Progress<'_>) {
    bar.set_position(progress.evaluations as u64);
    bar.set_message(format!(
        "best cost {:.4e}, step {:.1e}",
        progress.best, progress.sigma
    ));
}

/// Writes the state, whole or not at all.
pub fn remember(file: &Path, question: &Question, progress: &Progress<'_>) -> anyhow::Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: cannot be created", folder.display()))?;
    }
    let state = State::new(question.clone(), progress.judged);
    put(file, state.text()?.as_bytes())
}
