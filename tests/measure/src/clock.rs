//! Is the clock an instruction counter? The emulator's log of single instructions says.

use crate::machine::{Images, Machine, Time};
use crate::suite;
use crate::tape::file;
use anyhow::{Context, ensure};
use replica::tape::Mode;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Counts a short tape by the clock and by the log, and compares every count. Answers with their number.
pub fn check(machine: &Machine, images: &Images) -> anyhow::Result<usize> {
    let tape = suite::short()?;
    let tapes = file(Mode::Ticks, [&tape]);
    let image = images.of(machine, "replica");
    let folder = tempfile::tempdir()?;
    let counted = machine
        .run(&image, folder.path(), &tapes, Time::Counted)?
        .words()?;
    let logged = machine.run(&image, folder.path(), &tapes, Time::Logged)?;
    ensure!(logged.failure.is_none(), "{:?}", logged.failure);
    let reads = readings(&folder.path().join("log"))?;
    let spans: Vec<usize> = reads
        .as_chunks()
        .0
        .iter()
        .map(|[begin, end]| end - begin)
        .collect();
    // A tick without inference has no second span.
    let counts: Vec<usize> = counted
        .iter()
        .filter(|ticks| **ticks > 0)
        .map(|ticks| machine.instructions(*ticks).round() as usize)
        .collect();
    ensure!(
        counts == spans && counts.len() > 2,
        "{}: the clock counts {counts:?} instructions, the log has {spans:?}",
        machine.name
    );
    Ok(counts.len())
}

/// The number of the instruction with which each reading of the clock begins.
fn readings(log: &Path) -> anyhow::Result<Vec<usize>> {
    let log = File::open(log).context("the emulator wrote no log")?;
    let (mut found, mut inside, mut number) = (Vec::new(), false, 0);
    for line in BufReader::new(log).lines() {
        let line = line?;
        if !line.starts_with("Trace ") {
            continue;
        }
        let now = line.ends_with(" clock_now");
        if now && !inside {
            found.push(number);
        }
        inside = now;
        number += 1;
    }
    Ok(found)
}
