//! What an evaluation may cost, `tests/engine.toml`, and the table of what it costs in `docs/engine.md`.

use super::{Measured, ROWS};
use crate::page::{Page, compiler, grouped};
use crate::repository;
use crate::slack::{self, Misfit, roomy};
use anyhow::{Context, ensure};
use serde::Deserialize;
use std::collections::BTreeMap;

const FILE: &str = "tests/engine.toml";

/// The table's place.
pub const PAGE: Page = Page {
    file: "docs/engine.md",
    begin: "<!-- engine: written by `cargo engine --write` -->\n",
    end: "<!-- engine end -->\n",
    renew: "cargo engine --write",
};

const HEAD: &str = "\
# What one evaluation of the fine controller may cost on each core: instructions as QEMU executes them, and bytes. `cargo
# engine` measures, and fails where more is needed, or where a budget is slack by more than a fifth of itself. `cargo engine
# --write` sets such a budget anew, 5 % above what was measured, but never above a `goal` that is met; say in the commit
# why. A `goal` that is not met is only shown.
";

/// Of one thing on one core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bar {
    budget: u32,
    goal: Option<u32>,
}

/// All of them, by core and by [`ROWS`]' keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars(BTreeMap<String, BTreeMap<String, Bar>>);

impl Bars {
    /// Reads the file.
    pub fn read() -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(repository(FILE))
            .with_context(|| format!("{FILE}: cannot be read"))?;
        Self::parse(&text).with_context(|| FILE.to_owned())
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let bars: BTreeMap<String, BTreeMap<String, Bar>> = toml::from_str(text)?;
        for (core, bars) in &bars {
            for key in bars.keys() {
                ensure!(
                    ROWS.iter().any(|row| row.0 == key),
                    "{core}: {key} is not measured; measured are {}",
                    ROWS.map(|row| row.0).join(", ")
                );
            }
        }
        Ok(Self(bars))
    }

    /// Goes through every budget; `renew` sets those anew that do not fit.
    pub fn check(&mut self, measured: &[Measured], renew: bool) -> Vec<Misfit> {
        let mut misfits = Vec::new();
        for Measured {
            core: (key, core),
            needs,
        } in measured
        {
            let bars = self.0.entry((*key).to_owned()).or_default();
            for ((key, name), &need) in ROWS.iter().zip(needs) {
                let bar = bars.entry((*key).to_owned()).or_default();
                misfits.extend(slack::see(&format!("{core}: {name}"), need, bar.budget));
                if renew && !slack::fits(need, bar.budget) {
                    let met = bar.goal.filter(|goal| need <= *goal);
                    bar.budget = roomy(need).min(met.unwrap_or(u32::MAX));
                }
            }
        }
        misfits
    }

    fn bar(&self, core: &str, key: &str) -> Bar {
        let bar = self.0.get(core).and_then(|bars| bars.get(key));
        bar.copied().unwrap_or_default()
    }

    /// The file's text.
    fn text(&self) -> String {
        let mut text = HEAD.to_owned();
        for core in self.0.keys() {
            text += &format!("\n[{core}]\n");
            for (key, _) in ROWS {
                let Bar { budget, goal } = self.bar(core, key);
                let goal = goal.map_or_else(String::new, |n| format!(", goal = {n}"));
                text += &format!("{key} = {{ budget = {budget}{goal} }}\n");
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
        let mut table = "| one evaluation of the fine controller |".to_owned();
        let mut rule = "|---|".to_owned();
        for core in measured {
            table += &format!(" {} | goal |", core.core.1);
            rule += "--:|--:|";
        }
        table += &format!("\n{rule}\n");
        for (i, (key, name)) in ROWS.iter().enumerate() {
            table += &format!("| {name} |");
            for core in measured {
                let goal = self.bar(core.core.0, key).goal;
                let goal = goal.map_or_else(String::new, |n| format!("≤ {}", grouped(n)));
                table += &format!(" {} | {goal} |", grouped(core.needs[i]));
            }
            table += "\n";
        }
        table += &format!(
            "\nCounted in QEMU, the same for every input; compiled as the firmware is, by {}.\n",
            compiler()?
        );
        Ok(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(need: u32) -> [Measured; 1] {
        [Measured {
            core: ("m0", "Cortex-M0"),
            needs: [need; ROWS.len()],
        }]
    }

    #[test]
    fn a_budget_stays_below_a_goal_that_is_met() {
        let mut bars = Bars::parse("[m0]\nplain = { budget = 0, goal = 101 }\n").unwrap();
        assert_eq!(bars.check(&measured(100), true).len(), ROWS.len());
        assert_eq!(bars.bar("m0", "plain").budget, 101);
        assert_eq!(bars.bar("m0", "stack").budget, 105);
        assert!(bars.check(&measured(101), false).is_empty());
        let misfits = bars.check(&measured(102), false);
        assert_eq!(misfits.len(), 1);
        let text = misfits[0].to_string();
        assert!(
            text.contains("plain Rust") && text.contains("over its budget of 101"),
            "{text}"
        );
    }

    #[test]
    fn what_is_not_measured_has_no_budget() {
        let error = Bars::parse("[m0]\nheap = { budget = 0 }\n").unwrap_err();
        assert!(error.to_string().starts_with("m0: heap is not measured"));
    }

    #[test]
    fn the_file_is_what_is_written() {
        let text = std::fs::read_to_string(repository(FILE)).unwrap();
        assert_eq!(Bars::parse(&text).unwrap().text(), text);
    }

    /// The dearer of the two ways on each core, and the largest image.
    #[test]
    fn the_engines_front_page_states_what_is_held() {
        let text = std::fs::read_to_string(repository(FILE)).unwrap();
        let bars = Bars::parse(&text).unwrap();
        let budget = |core, key| bars.bar(core, key).budget;
        let [m4f, m0, rv32] = ["m4f", "m0", "rv32"]
            .map(|core| budget(core, "by-reference").max(budget(core, "compiled-in")));
        let flash = ["m4f", "m0", "rv32"].map(|core| budget(core, "flash"));
        let flash = flash.into_iter().max().unwrap();
        let page = std::fs::read_to_string(repository("src/fuzzy.rs")).unwrap();
        let page = page.replace("\n//! ", " ");
        for stated in [
            format!(
                "at most {m4f} instructions on a Cortex-M4F, {m0} on a Cortex-M0 and {rv32} on a RISC-V"
            ),
            format!("at most {flash} bytes of flash"),
        ] {
            assert!(page.contains(&stated), "not in src/fuzzy.rs: {stated}");
        }
    }
}
