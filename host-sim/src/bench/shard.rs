//! A part of a campaign, and putting the parts together again.

use super::results::{Results, WorldResult};

/// Part `index` of `count`: every `count`-th world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0, as Kubernetes' `JOB_COMPLETION_INDEX` and Slurm's `SLURM_ARRAY_TASK_ID` with `--array=0-…` count.
    pub index: u32,
    /// How many there are.
    pub count: u32,
}

/// Most parts.
const MOST: u32 = 100_000;

impl Shard {
    /// Reads `i/n`.
    pub fn parse(text: &str) -> Result<Self, String> {
        text.split_once('/')
            .and_then(|(index, count)| {
                Some(Self {
                    index: index.parse().ok()?,
                    count: count.parse().ok()?,
                })
            })
            .filter(|s| s.index < s.count && s.count <= MOST)
            .ok_or_else(|| {
                "allowed is i/n with i from 0 to n-1, such as 0/4, 1/4, 2/4, 3/4".to_owned()
            })
    }

    /// The part of a list that is its own.
    pub fn of<T>(self, all: Vec<T>) -> Vec<T> {
        all.into_iter()
            .enumerate()
            .filter(|(k, _)| k % self.count as usize == self.index as usize)
            .map(|(_, item)| item)
            .collect()
    }
}

/// Puts the parts of campaigns together: one result a controller, as if it had been run whole. `files` are names, for
/// messages, and what each holds.
pub fn merge(files: &[(String, Vec<Results>)]) -> Result<Vec<Results>, String> {
    let mut merged: Vec<Results> = Vec::new();
    let mut parts: Vec<(Vec<u32>, u32, Vec<WorldResult>)> = Vec::new();
    for (name, results) in files {
        for result in results {
            let Some([index, count]) = result.shard else {
                return Err(format!(
                    "{name}: a whole campaign; allowed: parts written with --shard i/n"
                ));
            };
            let known = merged
                .iter()
                .position(|m| m.conditions.controller == result.conditions.controller);
            let at = known.unwrap_or_else(|| {
                merged.push(result.clone());
                parts.push((Vec::new(), count, Vec::new()));
                merged.len() - 1
            });
            let (seen, of, worlds) = &mut parts[at];
            let controller = &result.conditions.controller;
            if merged[at].conditions != result.conditions || *of != count {
                return Err(format!(
                    "{name}: {controller}: part {index}/{count} of another campaign than {}; allowed: parts of one",
                    files[0].0
                ));
            }
            if seen.contains(&index) {
                return Err(format!(
                    "{name}: {controller}: part {index}/{count} a second time; allowed: every part once"
                ));
            }
            seen.push(index);
            worlds.extend(result.per_world.iter().cloned());
        }
    }
    merged
        .into_iter()
        .zip(parts)
        .map(|(result, (seen, count, mut worlds))| {
            if let Some(missing) = (0..count).find(|k| !seen.contains(k)) {
                return Err(format!(
                    "{}: part {missing}/{count} is missing; allowed: all parts",
                    result.conditions.controller
                ));
            }
            worlds.sort_by_key(|w| w.world);
            Ok(Results::of_worlds(result.conditions, None, worlds))
        })
        .collect()
}
