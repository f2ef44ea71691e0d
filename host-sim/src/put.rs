//! Files written whole or not at all: a run that fails leaves what was there before.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Finds out whether [`put`] could write a file, and makes the folders above it.
///
/// # Errors
/// When it could not.
pub fn try_out(file: &Path) -> std::io::Result<()> {
    if file.is_dir() {
        return Err(std::io::ErrorKind::IsADirectory.into());
    }
    if special(file) {
        // Whoever reads a pipe would take the try for all there is.
        return Ok(());
    }
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let partial = partial(file);
    std::fs::write(&partial, [])?;
    std::fs::remove_file(partial)
}

/// Writes a file whole or not at all.
///
/// # Errors
/// When it cannot be written.
pub fn put(file: &Path, bytes: &[u8]) -> Result<()> {
    put_all(&[(file, bytes)])
}

/// Writes files that belong together: none takes its place before all of them are written.
///
/// # Errors
/// When one of them cannot be written.
pub fn put_all(files: &[(&Path, &[u8])]) -> Result<()> {
    let mut moves = Vec::new();
    let mut done = Ok(());
    for &(file, bytes) in files {
        let place = if special(file) {
            file.to_owned()
        } else {
            let partial = partial(file);
            moves.push((partial.clone(), file));
            partial
        };
        done = std::fs::write(place, bytes)
            .with_context(|| format!("{}: cannot be written", file.display()));
        if done.is_err() {
            break;
        }
    }
    for (partial, file) in &moves {
        if done.is_ok() {
            done = std::fs::rename(partial, file)
                .with_context(|| format!("{}: cannot be written", file.display()));
        }
        if done.is_err() {
            // Best effort: the error that matters is the one above.
            let _ = std::fs::remove_file(partial);
        }
    }
    done
}

/// Whether it is a link or a device. What that leads to is written as it is: a rename would put a file in its place.
fn special(file: &Path) -> bool {
    file.symlink_metadata().is_ok_and(|m| !m.is_file())
}

/// Where a file is until it is whole.
fn partial(file: &Path) -> PathBuf {
    let mut partial = file.as_os_str().to_owned();
    partial.push(format!(".{}.tmp", std::process::id()));
    PathBuf::from(partial)
}
