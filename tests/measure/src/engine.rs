//! `cargo engine`: what one evaluation of the fine controller costs on each core, and what it is linked with.

mod alone;
mod bars;
mod count;
mod oracle;

use crate::machine::{Images, MACHINES};
use anyhow::{Context, bail};
use bars::Bars;
use fuzzypilot::behaviour::fine::FineMotion;
use replica::fine::{CONTROLLER, grid, mix};

/// What is measured on each core, in the order of the table: key in `engine.toml`, and words for people.
const ROWS: [(&str, &str); 6] = [
    ("plain", "plain Rust, settings by reference, instructions"),
    ("by-reference", "settings by reference, instructions"),
    ("compiled-in", "settings compiled in, instructions"),
    ("flash", "flash: code, scales, tables, bytes"),
    ("memory", "mutable memory, bytes"),
    ("stack", "stack, bytes"),
];

/// One core's.
#[derive(Clone, Copy, Debug)]
struct Measured {
    /// Its key and its name.
    core: (&'static str, &'static str),
    /// By [`ROWS`].
    needs: [u32; ROWS.len()],
}

/// Counts, prints, and compares with the bars, with the page and with this machine's results; or writes bars and page.
pub fn run(write: bool) -> anyhow::Result<()> {
    let images = Images::build()?;
    let expected = grid().fold(0, |sum, (d, error)| {
        let FineMotion {
            speed, yaw_rate, ..
        } = CONTROLLER.evaluate(d, error);
        mix(sum, (speed.bits(), yaw_rate.bits()))
    });
    for agreement in oracle::agreements()? {
        println!("{agreement}");
        agreement.held()?;
    }
    let mut measured = Vec::new();
    for machine in &MACHINES {
        let counted = count::count(machine, &images, expected)?;
        let [plain, compiled_in, by_reference] = counted.instructions;
        let alone = alone::look(machine, &images)?;
        alone::refused(machine, &images)?;
        println!(
            "{}: one count for every input, this machine's results, no float or division routine; one unwrap more does not link",
            machine.name
        );
        measured.push(Measured {
            core: (machine.key, machine.name),
            needs: [
                plain,
                by_reference,
                compiled_in,
                alone.flash,
                alone.memory,
                counted.stack,
            ],
        });
    }
    let mut bars = Bars::read()?;
    let misfits = bars.check(&measured, write);
    for misfit in &misfits {
        println!("{misfit}");
    }
    let table = bars.table(&measured)?;
    println!("\n{table}");
    if write {
        bars.write()?;
        return bars::PAGE.hold(&table, true);
    }
    if !misfits.is_empty() {
        bail!(
            "{} budgets do not fit; if that is meant: cargo engine --write",
            misfits.len()
        );
    }
    bars::PAGE.hold(&table, false).context("budgets fit, but")
}
