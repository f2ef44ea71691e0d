//! The digest of every built-in scenario's records, seed 1, in `tests/digests.toml`.

use crate::repository;
use crate::tape::Tape;
use anyhow::{Context, ensure};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

const FILE: &str = "tests/digests.toml";

const HEAD: &str = "\
# What every built-in scenario's run with seed 1 computes: number of ticks, and SHA-256 over the canonical bytes of its
# records in a row (fuzzypilot::link::record). `cargo test` and `cargo bit-exact` check it. If a change of behaviour is
# meant, `cargo bit-exact --write` renews it.
";

#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    ticks: usize,
    sha256: String,
}

fn entry(tape: &Tape) -> Entry {
    let digest = Sha256::digest(&tape.records);
    Entry {
        ticks: tape.ticks(),
        sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect(),
    }
}

/// The scenario of a plain run.
fn scenario(tape: &Tape) -> &str {
    tape.name.split(',').next().unwrap_or(&tape.name)
}

/// Compares plain runs with the file.
pub fn check(tapes: &[Tape]) -> anyhow::Result<()> {
    let text = std::fs::read_to_string(repository(FILE))
        .with_context(|| format!("{FILE}: cannot be read"))?;
    let mut known: BTreeMap<String, Entry> =
        toml::from_str(&text).with_context(|| FILE.to_owned())?;
    let mut wrong = Vec::new();
    for tape in tapes {
        if known.remove(scenario(tape)) != Some(entry(tape)) {
            wrong.push(scenario(tape));
        }
    }
    wrong.extend(known.keys().map(String::as_str));
    ensure!(
        wrong.is_empty(),
        "{FILE}: other records than these: {}; if that is meant: cargo bit-exact --write",
        wrong.join(", ")
    );
    Ok(())
}

/// Writes the file anew.
pub fn write(tapes: &[Tape]) -> anyhow::Result<()> {
    let mut text = HEAD.to_owned();
    for tape in tapes {
        let Entry { ticks, sha256 } = entry(tape);
        text += &format!(
            "\n[{}]\nticks = {ticks}\nsha256 = \"{sha256}\"\n",
            scenario(tape)
        );
    }
    std::fs::write(repository(FILE), text).with_context(|| format!("{FILE}: cannot be written"))
}
