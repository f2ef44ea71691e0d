//! Writes a bench's report folder.

use crate::cli::put;
use anyhow::Context;
use host_sim::bench::attempt::Ending;
use host_sim::bench::campaign::Campaign;
use host_sim::bench::controllers::{CONTROLLERS, Controller};
use host_sim::bench::recorded::record;
use host_sim::bench::report::{About, Failure, explain, page, per_world, picture};
use host_sim::bench::results::Results;
use host_sim::replay;
use std::path::Path;

/// What [`write`] makes beside `runs`.
pub const FILES: [&str; 3] = ["table.txt", "per-world.csv", "index.html"];

/// Whether a report in `folder` is, or writes or removes, a file.
pub fn writes(folder: &Path, file: &Path) -> bool {
    let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (folder, file) = (whole(folder), whole(file));
    folder == file
        || file.starts_with(folder.join("runs"))
        || FILES.iter().any(|name| folder.join(name) == file)
}

/// Writes `table.txt`, `per-world.csv`, `runs/*.html` and last of all `index.html`.
pub fn write(
    folder: &Path,
    campaign: &Campaign,
    chosen: &[Controller],
    results: &[Results],
    most: usize,
    json: Option<&Path>,
) -> anyhow::Result<()> {
    let runs = folder.join("runs");
    std::fs::create_dir_all(&runs)
        .with_context(|| format!("{}: cannot be created", runs.display()))?;
    remove_earlier(&runs)?;
    let table = super::table::all(results);
    put(&folder.join("table.txt"), table.as_bytes())?;
    put(&folder.join("per-world.csv"), per_world(results).as_bytes())?;

    let mut failures = Vec::new();
    let mut left_out = 0;
    for (controller, result) in chosen.iter().zip(results) {
        let failed = result.per_world.iter().zip(&campaign.arenas);
        let failed = failed.flat_map(|(world, arena)| {
            let attempts = world.attempts.iter();
            attempts
                .filter(|a| a.outcome.ending != Ending::Reached)
                .map(move |a| (arena, a))
        });
        for (count, (arena, attempt)) in failed.enumerate() {
            if count >= most {
                left_out += 1;
                continue;
            }
            let (outcome, mut recording) =
                record(controller, arena, &campaign.setting, attempt.seed);
            explain(&mut recording, &result.conditions);
            let name = format!(
                "runs/{}-{}-{}.html",
                controller.name, arena.number, attempt.seed
            );
            put(&folder.join(&name), replay::html(&recording)?.as_bytes())?;
            failures.push(Failure {
                controller: controller.name.to_owned(),
                world: arena.number,
                seed: attempt.seed,
                dead: attempt.dead_sensor,
                ending: outcome.ending,
                time: outcome.time_s,
                unmapped: !recording.unmapped.is_empty(),
                moving: !recording.movers.is_empty(),
                picture: picture(arena, &campaign.setting.body, &recording, outcome.ending)?,
                replay: name,
            });
        }
    }
    put(
        &folder.join("index.html"),
        page(results, &failures, left_out, &about(folder, json)).as_bytes(),
    )
}

/// Removes the replays of an earlier report: its index is about to be replaced, and nothing would lead to them. Whatever
/// has another name than a replay's stays.
fn remove_earlier(runs: &Path) -> anyhow::Result<()> {
    let entries = std::fs::read_dir(runs);
    let entries = entries.with_context(|| format!("{}: cannot be read", runs.display()))?;
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        if name.is_some_and(is_replay) && path.is_file() {
            std::fs::remove_file(&path)
                .with_context(|| format!("{}: cannot be removed", path.display()))?;
        }
    }
    Ok(())
}

/// Whether a file's name is CONTROLLER-WORLD-SEED.html.
fn is_replay(name: &str) -> bool {
    let number = |text: &str| {
        text.parse::<u64>()
            .is_ok_and(|number| number.to_string() == text)
    };
    let Some(stem) = name.strip_suffix(".html") else {
        return false;
    };
    let mut parts = stem.rsplitn(3, '-');
    let (seed, world, controller) = (parts.next(), parts.next(), parts.next());
    seed.is_some_and(number)
        && world.is_some_and(number)
        && controller.is_some_and(|name| CONTROLLERS.iter().any(|c| c.name == name))
}

fn about(folder: &Path, json: Option<&Path>) -> About {
    let mut words = std::env::args();
    words.next();
    let command = std::iter::once("host-sim".to_owned()).chain(words.map(|word| quoted(&word)));
    let mut files = vec!["table.txt".to_owned(), "per-world.csv".to_owned()];
    files.extend(json.and_then(|json| seen_from(folder, json)));
    About {
        command: command.collect::<Vec<_>>().join(" "),
        files,
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// The way from a folder to a file, both of which are there; none on another drive.
fn seen_from(folder: &Path, file: &Path) -> Option<String> {
    let (folder, file) = (folder.canonicalize().ok()?, file.canonicalize().ok()?);
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), file.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return None;
    }
    let up = std::iter::repeat_n("..".to_owned(), from.len() - shared);
    let down = to[shared..]
        .iter()
        .map(|part| part.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}
