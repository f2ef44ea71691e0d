//! What the whole firmware takes on its reference board: flash, static memory, and the deepest that its stack can be.

use crate::footprint::{self, Footprint};
use crate::machine::{Missing, build_folder};
use crate::repository;
use anyhow::{Context, ensure};
use std::path::Path;
use std::process::Command;

/// A whole image's needs, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Whole {
    /// Flash and static memory.
    pub footprint: Footprint,
    /// The deepest that the stack can be: added up from the image, not seen.
    pub stack: u32,
}

/// The image that `cargo fw` builds.
pub fn whole() -> anyhow::Result<Whole> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let folder = build_folder()?;
    let status = Command::new(cargo)
        .current_dir(repository("."))
        // Those of `.cargo/config.toml` only.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .args(["fw", "--quiet", "--target-dir"])
        .arg(&folder)
        .status()
        .context("cargo cannot be started")?;
    ensure!(status.success(), "the firmware cannot be built");
    let image = folder.join("thumbv7em-none-eabihf/firmware/fuzzypilot");
    Ok(Whole {
        footprint: footprint::of(&image)?,
        stack: stack(&image)?,
    })
}

fn stack(image: &Path) -> anyhow::Result<u32> {
    const SCRIPT: &str = "tests/firmware/stack.py";
    let output = Command::new("python3")
        .arg(repository(SCRIPT))
        .arg(image)
        .output()
        .map_err(|error| {
            Missing(format!(
                "python3 cannot be started ({error}); to get it: apt-get install python3"
            ))
        })?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let last = said.lines().last().unwrap_or_default();
    let bytes = last.split_whitespace().next().map(str::parse);
    // Deeper than the bar is an error of the script's, too; here the budget tells.
    bytes.and_then(Result::ok).with_context(|| {
        format!(
            "{SCRIPT}: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        )
    })
}
