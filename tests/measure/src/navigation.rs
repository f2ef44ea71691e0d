//! The navigator on emulated microcontrollers: the same bits as here over some two hundred runs, and what a tick costs.

mod book;
mod counts;
mod runs;

use crate::exact::compare_records;
use crate::machine::{Images, MACHINES};
use anyhow::ensure;
use book::Book;
use std::time::Instant;

/// The image.
const IMAGE: &str = "navigator";

/// Bytes that it writes before the records: the sizes of settings and navigator.
const SIZES: usize = 8;

/// Drives, compares, counts, and holds or writes `tests/navigation.toml` and the table in `docs/bench.md`.
///
/// # Errors
///
/// Bytes that differ, digests or budgets that do not fit, a table that is another one.
pub fn run(write: bool) -> anyhow::Result<()> {
    let begin = Instant::now();
    let groups = runs::groups()?;
    let tapes: Vec<runs::Tape> = groups.iter().flat_map(|g| g.tapes.clone()).collect();
    println!(
        "{} runs recorded ({} s)",
        tapes.len(),
        begin.elapsed().as_secs()
    );
    let images = Images::build_one(IMAGE)?;
    let comparisons = compare_records(&images, IMAGE, &tapes, SIZES, runs::parting)?;
    let (mut ticks, mut differing, mut equal) = (0, 0, true);
    for (machine, comparison) in MACHINES.iter().zip(&comparisons) {
        println!("{}: {comparison}", machine.name);
        ticks += comparison.ticks;
        differing += comparison.differing;
        equal &= comparison.is_equal();
    }
    println!(
        "{} runs, {ticks} ticks in all, {differing} bytes differ from the desktop's ({} s)",
        tapes.len(),
        begin.elapsed().as_secs()
    );
    ensure!(equal, "the records are not the same everywhere");
    let contrived = runs::contrived()?;
    let counted = std::thread::scope(|scope| {
        let count = |machine| {
            let (images, tapes, contrived) = (&images, &tapes, &contrived);
            scope.spawn(move || counts::count(machine, images, tapes, contrived))
        };
        let budgeted = MACHINES.iter().filter(|machine| machine.budgeted);
        let running: Vec<_> = budgeted.map(count).collect();
        running
            .into_iter()
            .map(|run| {
                run.join()
                    .map_err(|_| anyhow::anyhow!("a count panicked"))?
            })
            .collect::<anyhow::Result<Vec<_>>>()
    })?;
    println!("{}", counts::report(&counted));
    println!("{} s in all", begin.elapsed().as_secs());
    let digests = groups.iter().map(|g| (g.name, g.tapes.as_slice()));
    Book::read()?.hold(digests, &counted, write)
}
