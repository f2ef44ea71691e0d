//! What the tick may cost, `tests/budgets.toml`, and the table of what it costs in `README.md`.

use crate::counts::{COUNTED, Needs};
use crate::firmware::Whole;
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
# such a budget anew, 5 % above what was measured; say in the commit why. A `goal` is a bar that is met: what misses it fails,
# and no budget is above it; of instructions it is the worst that counts. The 24 KiB of flash are asked of the library on
# the M4F alone: the M0 needs half as much again, and has a budget but no goal. [f411] is the whole firmware's image on its
# board (`cargo fw`), its stack the deepest that tests/firmware/stack.py adds up.
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

/// The firmware's whole image, beside the cores: its key and its name.
const IMAGE: (&str, &str) = ("f411", "F411 image");

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
    pub fn check(&mut self, measured: &[Measured], whole: Whole, renew: bool) -> Vec<Misfit> {
        let mut misfits = Vec::new();
        let mut see = |what: &str, measured: u32, budget: &mut u32, goal: Option<u32>| {
            misfits.extend(slack::see(what, measured, *budget));
            misfits.extend(slack::aim(what, measured, goal));
            let most = goal.filter(|goal| measured <= *goal).unwrap_or(u32::MAX);
            if renew && (!slack::fits(measured, *budget) || *budget > most) {
                *budget = roomy(measured).min(most);
            }
        };
        let mut bytes = |name: &str, budgets: &mut Core, [flash, ram, stack]: [u32; 3]| {
            for (what, measured, of) in [
                ("flash", flash, &mut budgets.flash),
                ("static memory", ram, &mut budgets.ram),
                ("stack", stack, &mut budgets.stack),
            ] {
                see(
                    &format!("{name}: {what}"),
                    measured,
                    &mut of.budget,
                    of.goal,
                );
            }
        };
        let Footprint { flash, ram } = whole.footprint;
        let image = self.0.entry(IMAGE.0.to_owned()).or_default();
        bytes(IMAGE.1, image, [flash, ram, whole.stack]);
        for core in measured {
            let budgets = self.0.entry(core.core.0.to_owned()).or_default();
            let Footprint { flash, ram } = core.footprint;
            bytes(core.core.1, budgets, [flash, ram, core.needs.stack]);
        }
        for core in measured {
            let budgets = self.0.entry(core.core.0.to_owned()).or_default();
            for ((key, name), spread) in COUNTED.iter().zip(&core.needs.instructions) {
                let budget = budgets.instructions.entry((*key).to_owned()).or_default();
                let name = format!("{}: {name}", core.core.1);
                let Instructions {
                    median,
                    worst,
                    contrived,
                    goal,
                } = budget;
                see(&format!("{name}, median"), spread.median, median, None);
                see(&format!("{name}, worst"), spread.worst, worst, *goal);
                let what = format!("{name}, contrived");
                see(&what, spread.contrived, contrived, None);
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
                if core == IMAGE.0 {
                    // Its ticks are the M4F's.
                    break;
                }
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
    pub fn table(&self, measured: &[Measured], whole: Whole) -> anyhow::Result<String> {
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
        let aims = self.0.get(IMAGE.0).cloned().unwrap_or_default();
        for (name, bytes, aim) in [
            (
                "the whole F411 image: flash",
                whole.footprint.flash,
                aims.flash,
            ),
            ("its static memory", whole.footprint.ram, aims.ram),
            (
                "its stack at the deepest that can be",
                whole.stack,
                aims.stack,
            ),
        ] {
            let aim = goal(aim.goal);
            table += &format!("| {name}, bytes | | {} | | {aim} |", grouped(bytes));
            // The board has one core.
            table += &" | | | |".repeat(measured.len().saturating_sub(1));
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
        assert_eq!(budgets.check(&measured(1000), whole(1000), true).len(), 21);
        assert!(
            budgets
                .check(&measured(1000), whole(1000), false)
                .is_empty()
        );
        assert!(
            budgets
                .check(&measured(1050), whole(1000), false)
                .is_empty()
        );
        assert!(budgets.check(&measured(840), whole(1000), false).is_empty());
        for (count, why) in [
            (1051, "over its budget of 1050"),
            (839, "slack by more than a fifth"),
        ] {
            let misfits = budgets.check(&measured(count), whole(1000), false);
            assert_eq!(misfits.len(), 15);
            let text = misfits[0].to_string();
            assert!(
                text.contains("one fine inference, median") && text.contains(why),
                "{text}"
            );
        }
    }

    fn whole(bytes: u32) -> Whole {
        Whole {
            footprint: Footprint {
                flash: bytes,
                ram: bytes,
            },
            stack: bytes,
        }
    }

    #[test]
    fn a_goal_that_is_missed_fails_and_no_budget_is_above_one() {
        let text = "[f411]\nflash = { budget = 1050, goal = 1040 }\nram = { budget = 1050 }\nstack = { budget = 1050 }\n";
        let mut budgets = Budgets::parse(text).unwrap();
        // Within the goal; the budget is cut down to it.
        assert!(budgets.check(&[], whole(1040), true).is_empty());
        assert_eq!(budgets.0["f411"].flash.budget, 1040);
        let misfits = budgets.check(&[], whole(1045), false);
        let said: Vec<String> = misfits.iter().map(Misfit::to_string).collect();
        assert_eq!(
            said,
            [
                "F411 image: flash: 1045 is over its budget of 1040",
                "F411 image: flash: 1045 misses its goal of 1040"
            ]
        );
        // Writing budgets anew does not help.
        budgets.check(&[], whole(1045), true);
        let misfits = budgets.check(&[], whole(1045), false);
        assert_eq!(misfits.len(), 1, "{misfits:?}");
        // The bars of what is there are in the file.
        let file = std::fs::read_to_string(repository(FILE)).unwrap();
        let Budgets(file) = Budgets::parse(&file).unwrap();
        let image = &file["f411"];
        let goals = [image.flash.goal, image.ram.goal, image.stack.goal];
        assert_eq!(goals, [Some(65_536), Some(8_192), Some(1_536)]);
        assert_eq!(file["m4f"].flash.goal, Some(24_576));
        for (core, most) in [("m4f", 4_000), ("m0", 25_000)] {
            assert_eq!(file[core].stack.goal, Some(1_536));
            assert_eq!(file[core].instructions["whole-tick"].goal, Some(most));
            let budget = &file[core].instructions["whole-tick"];
            assert!(budget.worst <= most, "{core}");
        }
    }

    #[test]
    fn the_file_is_what_is_written() {
        let text = std::fs::read_to_string(repository(FILE)).unwrap();
        assert_eq!(Budgets::parse(&text).unwrap().text(), text);
    }
}
