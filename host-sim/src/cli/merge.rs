//! `host-sim merge`

use super::bench::table;
use super::{BadInput, not_what_is_read, print, put, ready_file};
use clap::Args;
use host_sim::bench::results::Results;
use host_sim::bench::shard::merge;
use host_sim::bench::worlds::error::of_json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct MergeArguments {
    /// What `host-sim bench --shard i/n --json FILE` wrote, all parts.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Also write the whole to this file: what the bench would have written in one go.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn execute(arguments: &MergeArguments) -> anyhow::Result<()> {
    let files = arguments
        .files
        .iter()
        .map(|file| Ok((file.display().to_string(), read(file)?)))
        .collect::<Result<Vec<_>, BadInput>>()?;
    let whole = merge(&files).map_err(BadInput)?;
    if let Some(file) = &arguments.json {
        let parts: Vec<_> = arguments
            .files
            .iter()
            .map(|part| ("a part", part.as_path()))
            .collect();
        not_what_is_read("--json", file, &parts)?;
        ready_file("--json", file)?;
    }
    let printed = print(table::all(&whole));
    let stored = arguments.json.as_ref().map_or(Ok(()), |file| {
        put(file, super::bench::json(&whole)?.as_bytes())
    });
    printed.and(stored)
}

fn read(file: &Path) -> Result<Vec<Results>, BadInput> {
    let name = file.display();
    let text = std::fs::read_to_string(file).map_err(|e| {
        BadInput(match e.kind() {
            ErrorKind::InvalidData => format!(
                "{name}: found bytes that are no text (UTF-8); allowed: what `host-sim bench --json` writes"
            ),
            _ => format!("{name}: cannot be read ({e})"),
        })
    })?;
    serde_json::from_str(&text).map_err(|e| {
        BadInput(format!(
            "{name}:{}: found {}; allowed: what `host-sim bench --json` writes, whole",
            e.line(),
            of_json(&e)
        ))
    })
}
