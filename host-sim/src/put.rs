//! Files written whole or not at all: a run that fails leaves what was there before.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

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
        // What a link or a device leads to is written as it is: a rename would put a file in its place.
        let special = file.symlink_metadata().is_ok_and(|m| !m.is_file());
        let place = if special {
            file.to_owned()
        } else {
            let mut partial = file.as_os_str().to_owned();
            partial.push(format!(".{}.tmp", std::process::id()));
            let partial = PathBuf::from(partial);
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
