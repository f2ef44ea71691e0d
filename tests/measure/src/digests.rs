//! The digests in `tests/digests.toml`.

use crate::repository;
use crate::suite;
use crate::tape::Tape;
use anyhow::{Context, ensure};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};

const FILE: &str = "tests/digests.toml";

const HEAD: &str = "\
# What runs compute: number of ticks, and SHA-256 over the canonical bytes of their records in a row
# (fuzzypilot::link::record). Every built-in scenario with seed 1, and `invented`: tapes of random integers, in a row.
# `cargo test` and `cargo bit-exact` check it. If a change of behaviour is meant, `cargo bit-exact --write` renews it.
";

/// What some runs compute.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// All of them.
    pub ticks: usize,
    /// Over their records in a row.
    pub sha256: String,
}

type Entries = BTreeMap<String, Entry>;

/// The digest of tapes in a row.
pub fn entry<'t, const BYTES: usize>(tapes: impl IntoIterator<Item = &'t Tape<BYTES>>) -> Entry {
    let (mut ticks, mut digest) = (0, Sha256::new());
    for tape in tapes {
        ticks += tape.ticks();
        digest.update(&tape.records);
    }
    let digest = digest.finalize();
    Entry {
        ticks,
        sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect(),
    }
}

/// The digests of this machine.
fn computed() -> anyhow::Result<Entries> {
    let mut entries = Entries::new();
    for tape in suite::plain(1)? {
        let scenario = tape.name.split(',').next().unwrap_or(&tape.name);
        entries.insert(scenario.to_owned(), entry([&tape]));
    }
    entries.insert("invented".to_owned(), entry(&suite::invented()?));
    Ok(entries)
}

/// Compares what this machine computes with the file.
pub fn check() -> anyhow::Result<()> {
    let text = std::fs::read_to_string(repository(FILE))
        .with_context(|| format!("{FILE}: cannot be read"))?;
    let known: Entries = toml::from_str(&text).with_context(|| FILE.to_owned())?;
    let computed = computed()?;
    let names: BTreeSet<&String> = known.keys().chain(computed.keys()).collect();
    let wrong: Vec<&str> = names
        .into_iter()
        .filter(|name| known.get(*name) != computed.get(*name))
        .map(String::as_str)
        .collect();
    ensure!(
        wrong.is_empty(),
        "{FILE}: other records than these: {}; if that is meant: cargo bit-exact --write",
        wrong.join(", ")
    );
    Ok(())
}

/// Writes the file anew.
pub fn write() -> anyhow::Result<()> {
    let mut text = HEAD.to_owned();
    for (name, Entry { ticks, sha256 }) in computed()? {
        text += &format!("\n[{name}]\nticks = {ticks}\nsha256 = \"{sha256}\"\n");
    }
    std::fs::write(repository(FILE), text).with_context(|| format!("{FILE}: cannot be written"))
}
