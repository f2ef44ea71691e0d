//! What the navigator's runs compute and may cost: `tests/navigation.toml`, and the table in `docs/bench.md`.

use super::counts::{COUNTED, Needs};
use super::runs::Tape;
use crate::digests::{self, Entry};
use crate::page::{Page, compiler, grouped};
use crate::repository;
use crate::slack::{self, roomy};
use anyhow::{Context, bail};
use serde::Deserialize;
use std::collections::BTreeMap;

const FILE: &str = "tests/navigation.toml";

const PAGE: Page = Page {
    file: "docs/bench.md",
    begin: "<!-- navigation: written by `cargo navigation --write` -->\n",
    end: "<!-- navigation end -->\n",
    renew: "cargo navigation --write",
};

const HEAD: &str = "\
# The navigator's tick with 16 cones in generated worlds (host-sim's `generated:barn`, 1-70, seed 1).
#
# [digests]: number of ticks, and SHA-256 over the canonical bytes of their records in a row (tests/replica/src/navigation.rs),
# the navigator's own digest among them. If a change of behaviour is meant, `cargo navigation --write` renews them.
#
# A core's table: what a tick may cost, instructions as QEMU executes them and bytes. `median` and `worst` are over all
# ticks of all runs, `contrived` over runs invented to be expensive. `cargo navigation` fails where more is needed, or
# where a budget is slack by more than a fifth of itself; `--write` sets such a budget anew, 5 % above what was measured:
# say in the commit why. A `goal` is what we want, median and worst; it is only shown. The M4F's whole tick has its goals as
# budgets, by hand: `--write` must not raise them.
";

/// Budget of instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Instructions {
    median: u32,
    worst: u32,
    contrived: u32,
    goal: Option<[u32; 2]>,
}

/// One core's.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
struct Core {
    navigator: u32,
    settings: u32,
    stack: u32,
    #[serde(flatten)]
    instructions: BTreeMap<String, Instructions>,
}

/// The file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Book {
    #[serde(default)]
    digests: BTreeMap<String, Entry>,
    #[serde(default, flatten)]
    cores: BTreeMap<String, Core>,
}

/// What the bytes are, in [`Needs::bytes`].
const BYTES: [(&str, &str); 3] = [
    ("navigator", "static memory: the navigator, bytes"),
    ("settings", "its settings, bytes"),
    ("stack", "stack of a tick, bytes"),
];

impl Book {
    /// Reads the file; an empty one if there is none.
    pub fn read() -> anyhow::Result<Self> {
        match std::fs::read_to_string(repository(FILE)) {
            Ok(text) => toml::from_str(&text).context(FILE),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(e) => Err(e).context(FILE),
        }
    }

    /// Compares with what was found, or takes it over.
    pub fn hold<'t>(
        mut self,
        groups: impl Iterator<Item = (&'t str, &'t [Tape])>,
        needs: &[Needs],
        write: bool,
    ) -> anyhow::Result<()> {
        let mut wrong = Vec::new();
        let found: BTreeMap<String, Entry> = groups
            .map(|(name, tapes)| (name.to_owned(), digests::entry(tapes)))
            .collect();
        for (name, entry) in &found {
            if self.digests.get(name) != Some(entry) {
                wrong.push(format!("{name}: other records than the digest's"));
            }
        }
        self.digests = found;
        for needs in needs {
            let core = self.cores.entry(needs.core.0.to_owned()).or_default();
            wrong.extend(core.check(needs, write));
        }
        for what in &wrong {
            println!("{what}");
        }
        let table = self.table(needs)?;
        if write {
            std::fs::write(repository(FILE), self.text())
                .with_context(|| format!("{FILE}: cannot be written"))?;
            return PAGE.hold(&table, true);
        }
        if !wrong.is_empty() {
            bail!("{FILE} does not fit; if that is meant: cargo navigation --write");
        }
        PAGE.hold(&table, false)
    }

    /// The file's text.
    fn text(&self) -> String {
        let mut text = HEAD.to_owned();
        for (name, Entry { ticks, sha256 }) in &self.digests {
            text += &format!("\n[digests.{name}]\nticks = {ticks}\nsha256 = \"{sha256}\"\n");
        }
        for (key, core) in &self.cores {
            let Core {
                navigator,
                settings,
                stack,
                instructions,
            } = core;
            text += &format!(
                "\n[{key}]\nnavigator = {navigator}\nsettings = {settings}\nstack = {stack}\n"
            );
            for (key, _) in COUNTED {
                let Instructions {
                    median,
                    worst,
                    contrived,
                    goal,
                } = instructions.get(key).copied().unwrap_or_default();
                let goal = goal.map_or_else(String::new, |[median, worst]| {
                    format!(", goal = [{median}, {worst}]")
                });
                text += &format!(
                    "{key} = {{ median = {median}, worst = {worst}, contrived = {contrived}{goal} }}\n"
                );
            }
        }
        text
    }

    /// The table for people.
    fn table(&self, needs: &[Needs]) -> anyhow::Result<String> {
        let mut table = "| 16 cones |".to_owned();
        let mut rule = "|---|".to_owned();
        for needs in needs {
            table += &format!(" {}: median | 99 % | worst | contrived |", needs.core.1);
            rule += "--:|--:|--:|--:|";
        }
        table += &format!("\n{rule}\n");
        for (i, (_, name)) in COUNTED.iter().enumerate() {
            let unit = if i == 0 { ", instructions" } else { "" };
            table += &format!("| {name}{unit} |");
            for needs in needs {
                let spread = &needs.instructions[i];
                for count in [spread.median, spread.most, spread.worst, spread.contrived] {
                    table += &format!(" {} |", grouped(count));
                }
            }
            table += "\n";
        }
        for (i, (_, name)) in BYTES.iter().enumerate() {
            table += &format!("| {name} |");
            for needs in needs {
                table += &format!(" | | {} | |", grouped(needs.bytes[i]));
            }
            table += "\n";
        }
        let runs: usize = self.digests.values().map(|entry| entry.ticks).sum();
        Ok(format!(
            "{table}\nOver {} ticks; counted in QEMU; compiled as the firmware is, by {}.\n",
            grouped(u32::try_from(runs)?),
            compiler()?
        ))
    }
}

impl Core {
    /// Goes through every budget; `renew` sets those anew that do not fit.
    fn check(&mut self, needs: &Needs, renew: bool) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut see = |what: &str, measured: u32, budget: &mut u32| {
            if let Some(misfit) =
                slack::see(&format!("{}: {what}", needs.core.1), measured, *budget)
            {
                wrong.push(misfit.to_string());
                if renew {
                    *budget = roomy(measured);
                }
            }
        };
        let budgets = [&mut self.navigator, &mut self.settings, &mut self.stack];
        for (((what, _), measured), budget) in BYTES.iter().zip(needs.bytes).zip(budgets) {
            see(what, measured, budget);
        }
        for ((key, name), spread) in COUNTED.iter().zip(&needs.instructions) {
            let budget = self.instructions.entry((*key).to_owned()).or_default();
            for (what, measured, budget) in [
                ("median", spread.median, &mut budget.median),
                ("worst", spread.worst, &mut budget.worst),
                ("contrived", spread.contrived, &mut budget.contrived),
            ] {
                see(&format!("{name}, {what}"), measured, budget);
            }
        }
        wrong
    }
}
