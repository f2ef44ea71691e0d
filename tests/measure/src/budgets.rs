//! What the tick may cost, `tests/budgets.toml`, and the table of what it costs in `README.md`.

use crate::counts::{COUNTED, Needs};
use crate::footprint::Footprint;
use crate::page::{Page, compiler, grouped};
use crate::repository;
use crate::slack::{self, Misfit, roomy};
use anyhow::Context;
use serde::Deserialize;
use std::collections::BTreeMap;

const FILE: &str = "tests/budgets.toml";
const README: Page = Page {
    file: "README.md",
    begin: "<!-- budgets: written by `cargo budgets --write` -->\n",
    end: "<!-- budgets end -->\n",
    renew: "cargo budgets --write",
};

const HEAD: &str = "\
# What a tick with eight ranges may cost on each core: bytes, and instructions as QEMU executes them. `median` and `worst`
# are over all ticks of all built-in scenarios, `contrived` over runs invented to be expensive. `cargo budgets` measures,
# and fails where more is needed, or where a budget is slack by more than a fifth of itself. `cargo budgets --write` sets
# such a budget anew, 5 % above what was measured; say in the commit why. A `goal` is what we want; it is only shown.
";

/// Budget of bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bytes {
    budget: u32,
    goal: Option<u32>,
}

/// Budget of instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Instructions {
    median: u32,
    worst: u32,
    contrived: u32,
    goal: Option<u32>,
}

/// One core's.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
struct Core {
    flash: Bytes,
    ram: Bytes,
    stack: Bytes,
    #[serde(flatten)]
    instructions: BTreeMap<String, Instructions>,
}

/// All budgets, by core.
#[derive(Clone, Debug, PartialEq)]
pub struct Budgets(BTreeMap<String, Core>);

/// What was measured on one core.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Its key and its name.
    pub core: (&'static str, &'static str),
    /// Flash and static memory.
    pub footprint: Footprint,
    /// Instructions and stack.
    pub needs: Needs,
}

impl Budgets {
    /// Reads the file.
    pub fn read() -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(repository(FILE))
            .with_context(|| format!("{FILE}: cannot be read"))?;
        Self::parse(&text).with_context(|| FILE.to_owned())
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        Ok(Self(toml::from_str(text)?))
    }

    /// Goes through every budget; `renew` sets those anew that do not fit.
    pub fn check(&mut self, measured: &[Measured], renew: bool) -> Vec<Misfit> {
        let mut misfits = Vec::new();
        for core in measured {
            let budgets = self.0.entry(core.core.0.to_owned()).or_default();
            let mut see = |what: &str, measured: u32, budget: &mut u32| {
                misfits.extend(slack::see(
                    &format!("{}: {what}", core.core.1),
                    measured,
                    *budget,
                ));
                if renew && !slack::fits(measured, *budget) {
                    *budget = roomy(measured);
                }
            };
            see("flash", core.footprint.flash, &mut budgets.flash.budget);
            see("static memory", core.footprint.ram, &mut budgets.ram.budget);
            see("stack", core.needs.stack, &mut budgets.stack.budget);
            for ((key, name), spread) in COUNTED.iter().zip(&core.needs.instructions) {
                let budget = budgets.instructions.entry((*key).to_owned()).or_default();
                see(
                    &format!("{name}, median"),
                    spread.median,
                    &mut budget.median,
                );
                see(&format!("{name}, worst"), spread.worst, &mut budget.worst);
                let contrived = &mut budget.contrived;
                see(&format!("{name}, contrived"), spread.contrived, contrived);
            }
        }
        misfits
    }

    /// The file's text.
    fn text(&self) -> String {
        let mut text = HEAD.to_owned();
        let goal = |goal: Option<u32>| goal.map_or_else(String::new, |n| format!(", goal = {n}"));
        for (core, budgets) in &self.0 {
            text += &format!("\n[{core}]\n");
            let bytes = [
                ("flash", budgets.flash),
                ("ram", budgets.ram),
                ("stack", budgets.stack),
            ];
            for (key, bytes) in bytes {
                text += &format!(
                    "{key} = {{ budget = {}{} }}\n",
                    bytes.budget,
                    goal(bytes.goal)
                );
            }
            for (key, _) in COUNTED {
                let budget = budgets.instructions.get(key).copied().unwrap_or_default();
                let Instructions {
                    median,
                    worst,
                    contrived,
                    ..
                } = budget;
                let goal = goal(budget.goal);
                text += &format!(
                    "{key} = {{ median = {median}, worst = {worst}, contrived = {contrived}{goal} }}\n"
                );
            }
        }
        text
    }

    /// Writes the file anew.
    pub fn write(&self) -> anyhow::Result<()> {
        std::fs::write(repository(FILE), self.text())
            .with_context(|| format!("{FILE}: cannot be written"))
    }

    /// The table for people.
    pub fn table(&self, measured: &[Measured]) -> anyhow::Result<String> {
        let mut table = "| eight ranges |".to_owned();
        let mut rule = "|---|".to_owned();
        for core in measured {
            table += &format!(" {}: median | worst | contrived | goal |", core.core.1);
            rule += "--:|--:|--:|--:|";
        }
        table += &format!("\n{rule}\n");
        let known = |core: &Measured| self.0.get(core.core.0).cloned().unwrap_or_default();
        let goal =
            |goal: Option<u32>| goal.map_or_else(String::new, |n| format!("≤ {}", grouped(n)));
        for (i, (key, name)) in COUNTED.iter().enumerate() {
            let unit = if i == 0 { ", instructions" } else { "" };
            table += &format!("| {name}{unit} |");
            for core in measured {
                let spread = &core.needs.instructions[i];
                let aim = known(core).instructions.get(*key).and_then(|i| i.goal);
                table += &format!(
                    " {} | {} | {} | {} |",
                    grouped(spread.median),
                    grouped(spread.worst),
                    grouped(spread.contrived),
                    goal(aim)
                );
            }
            table += "\n";
        }
        type Row = (&'static str, fn(&Measured) -> u32, fn(&Core) -> Option<u32>);
        let rows: [Row; 3] = [
            (
                "stack of a tick, bytes",
                |m| m.needs.stack,
                |c| c.stack.goal,
            ),
            (
                "flash: library, tables, settings, bytes",
                |m| m.footprint.flash,
                |c| c.flash.goal,
            ),
            (
                "static memory: the robot, bytes",
                |m| m.footprint.ram,
                |c| c.ram.goal,
            ),
        ];
        for (name, of, aim) in rows {
            table += &format!("| {name} |");
            for core in measured {
                let aim = goal(aim(&known(core)));
                table += &format!(" | {} | | {aim} |", grouped(of(core)));
            }
            table += "\n";
        }
        table += &format!(
            "\nCounted in QEMU; compiled as the firmware is, by {}.\n",
            compiler()?
        );
        Ok(table)
    }
}

/// Compares the table in the README, or puts it there.
pub fn readme(table: &str, write: bool) -> anyhow::Result<()> {
    README.hold(table, write)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counts::Spread;

    fn measured(whole: u32) -> [Measured; 1] {
        let spread = Spread {
            median: whole,
            worst: whole,
            contrived: whole,
            ..Spread::default()
        };
        [Measured {
            core: ("m0", "Cortex-M0"),
            footprint: Footprint {
                flash: 1000,
                ram: 1000,
            },
            needs: Needs {
                instructions: std::array::from_fn(|_| spread.clone()),
                stack: 1000,
                stack_at: String::new(),
            },
        }]
    }

    #[test]
    fn a_budget_holds_from_its_own_value_down_to_a_fifth_less() {
        let mut budgets = Budgets(BTreeMap::new());
        assert_eq!(budgets.check(&measured(1000), true).len(), 18);
        assert!(budgets.check(&measured(1000), false).is_empty());
        assert!(budgets.check(&measured(1050), false).is_empty());
        assert!(budgets.check(&measured(840), false).is_empty());
        for (count, why) in [
            (1051, "over its budget of 1050"),
            (839, "slack by more than a fifth"),
        ] {
            let misfits = budgets.check(&measured(count), false);
            assert_eq!(misfits.len(), 15);
            let text = misfits[0].to_string();
            assert!(
                text.contains("one fine inference, median") && text.contains(why),
                "{text}"
            );
        }
    }

    #[test]
    fn the_file_is_what_is_written() {
        let text = std::fs::read_to_string(repository(FILE)).unwrap();
        assert_eq!(Budgets::parse(&text).unwrap().text(), text);
    }
}
