//! The general fuzzy engine on emulated microcontrollers: the same bits as here, the same count for every input.

use crate::machine::{Images, MACHINES, Machine, Time};
use crate::page::{Page, compiler, grouped};
use anyhow::ensure;
use fuzzypilot::fuzzy::system::Controller;
use replica::systems::{CROWD, CURVED, MAMDANI, NUMBERS, TABLE, digest, inputs};

/// What an evaluation costs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Which system.
    pub system: &'static str,
    /// Instructions.
    pub least: u32,
    /// Instructions.
    pub most: u32,
}

/// The table's place.
const PAGE: Page = Page {
    file: "docs/engine.md",
    begin: "<!-- systems: written by `cargo systems --write` -->\n",
    end: "<!-- systems end -->\n",
    renew: "cargo systems --write",
};

/// Counts, prints, and compares with the page; or writes it.
///
/// # Errors
///
/// Bits that differ, a count that depends on the inputs, a table that is another one.
pub fn run(write: bool) -> anyhow::Result<()> {
    let images = Images::build()?;
    let mut measured = Vec::new();
    for machine in &MACHINES {
        let costs = count(machine, &images)?;
        for Cost {
            system,
            least,
            most,
        } in &costs
        {
            ensure!(
                least == most,
                "{}, {system}: {least} to {most} instructions, by the input",
                machine.name
            );
        }
        measured.push((machine.name, costs));
    }
    let table = table(&measured, &compiler()?);
    println!("{table}");
    PAGE.hold(&table, write)
}

/// The table for people: a row a system, a column a core. All cores have the same systems.
fn table(measured: &[(&str, Vec<Cost>)], compiler: &str) -> String {
    let mut table = "| one evaluation of a general system, instructions |".to_owned();
    let mut rule = "|---|".to_owned();
    for (core, _) in measured {
        table += &format!(" {core} |");
        rule += "--:|";
    }
    table += &format!("\n{rule}\n");
    let systems = measured.first().map_or(&[][..], |(_, costs)| costs);
    for (row, cost) in systems.iter().enumerate() {
        table += &format!("| {} |", cost.system);
        for (_, costs) in measured {
            table += &format!(" {} |", grouped(costs[row].most));
        }
        table += "\n";
    }
    table + &format!("\nCounted in QEMU, the same for every input tried; {compiler}.\n")
}

/// Evaluates every system on one machine, and compares.
///
/// # Errors
///
/// Bits that differ from this machine's. Counts that differ are left to the caller.
pub fn count(machine: &Machine, images: &Images) -> anyhow::Result<Vec<Cost>> {
    let image = images.of(machine, "fuzzy-systems");
    let folder = tempfile::tempdir()?;
    let words = machine
        .run(&image, folder.path(), &[], Time::Counted)?
        .words()?;
    let instructions = |ticks: u32| machine.instructions(ticks).round() as u32;
    let [empty, thousand, words @ ..] = &words[..] else {
        anyhow::bail!("{}: nothing was counted", machine.name);
    };
    let empty = instructions(*empty);
    ensure!(
        instructions(*thousand).abs_diff(1000 + empty) <= 32,
        "{}: the clock counts {} for 1,000 instructions",
        machine.name,
        instructions(*thousand)
    );
    let mut words = words.iter().copied();
    let mut costs = Vec::new();
    let mut one = |system, expected: Vec<Vec<u32>>| {
        let mut cost = Cost {
            system,
            least: u32::MAX,
            most: 0,
        };
        for (number, expected) in expected.iter().enumerate() {
            let count = words.next().map_or(0, instructions).saturating_sub(empty);
            cost.least = cost.least.min(count);
            cost.most = cost.most.max(count);
            let found: Vec<u32> = words.by_ref().take(expected.len()).collect();
            ensure!(
                found == *expected,
                "{}: {system}: evaluation {number} differs: {found:x?} for {expected:x?}",
                machine.name
            );
        }
        costs.push(cost);
        Ok(())
    };
    one("2 inputs, 9 rules, height", here(&TABLE))?;
    one(
        "3 inputs, curves, 6 rules, Takagi–Sugeno, 2 outputs",
        here(&CURVED),
    )?;
    one(
        "2 inputs, 4 rules, 2 centroids of 50 samples",
        here(&MAMDANI),
    )?;
    one(
        "1 input, 320 rules, centre of sums of 20 samples",
        here(&CROWD),
    )?;
    ensure!(words.next().is_none(), "the image wrote too much");
    Ok(costs)
}

/// What comes out on this machine, a list of words an evaluation.
fn here<const I: usize, const T: usize, const R: usize, const O: usize>(
    controller: &Controller<'static, I, T, R, O>,
) -> Vec<Vec<u32>> {
    (0..NUMBERS)
        .map(|number| {
            let evaluation = controller.evaluate(inputs(controller.system(), number));
            let outputs = evaluation.outputs.iter().map(|value| *value as u32);
            outputs.chain([digest(&evaluation.rules)]).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_a_system_and_a_column_a_core() {
        let costs = |most| {
            vec![Cost {
                system: "small",
                least: most,
                most,
            }]
        };
        let measured = [("Cortex-M4F", costs(2305)), ("Cortex-M0", costs(998))];
        assert_eq!(
            table(&measured, "rustc 1"),
            "| one evaluation of a general system, instructions | Cortex-M4F | Cortex-M0 |\n\
             |---|--:|--:|\n\
             | small | 2,305 | 998 |\n\
             \nCounted in QEMU, the same for every input tried; rustc 1.\n"
        );
    }
}
