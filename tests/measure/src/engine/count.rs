//! The image `fine`: every way to evaluate, over the whole grid.

use crate::machine::{Images, Machine, Time};
use anyhow::{bail, ensure};

/// The ways in the image's order.
const WAYS: [&str; 3] = ["plain Rust", "compiled in", "by reference"];

/// What an evaluation needs.
#[derive(Clone, Copy, Debug)]
pub struct Counted {
    /// By [`WAYS`].
    pub instructions: [u32; 3],
    /// Bytes, of the way that needs most.
    pub stack: u32,
}

/// Counts on one machine.
///
/// # Errors
///
/// Counts that differ from input to input; outputs whose checksum is not `expected`; tables of other shapes that give
/// other results than here.
pub fn count(machine: &Machine, images: &Images, expected: u32) -> anyhow::Result<Counted> {
    let folder = tempfile::tempdir()?;
    let words = machine
        .run(
            &images.of(machine, "fine"),
            folder.path(),
            &[],
            Time::Counted,
        )?
        .words()?;
    let [shapes, empty, thousand, call, _, _, bottom, ways @ ..] = words.as_slice() else {
        bail!("{}: nothing was counted", machine.name);
    };
    ensure!(
        *shapes == replica::shapes::checksum(),
        "{}: the results of tables of other shapes are not this machine's",
        machine.name
    );
    let instructions = |ticks: u32| machine.instructions(ticks).round() as u32;
    ensure!(
        instructions(thousand.wrapping_sub(*empty)).abs_diff(1000) <= 32,
        "{}: the clock is no instruction counter",
        machine.name
    );
    let (ways, rest) = ways.as_chunks::<4>();
    ensure!(rest.is_empty() && ways.len() == WAYS.len(), "half a way");
    let mut counted = Counted {
        instructions: [0; 3],
        stack: 0,
    };
    for ((name, count), [least, most, sum, depth]) in
        WAYS.iter().zip(&mut counted.instructions).zip(ways)
    {
        let name = format!("{}, {name}", machine.name);
        // What is called instead, to know what calling costs, is one instruction itself.
        let [least, most] =
            [least, most].map(|ticks| instructions(ticks.saturating_sub(*call)) + 1);
        ensure!(
            least == most,
            "{name}: {least} to {most} instructions, by the input"
        );
        ensure!(
            *sum == expected,
            "{name}: the results are not this machine's"
        );
        *count = most;
        counted.stack = counted.stack.max(depth.saturating_sub(*bottom));
    }
    Ok(counted)
}
