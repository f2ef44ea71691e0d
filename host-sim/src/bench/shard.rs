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

/// What was read of a controller's campaign.
#[derive(Default)]
struct Parts {
    seen: Vec<u32>,
    count: u32,
    worlds: Vec<WorldResult>,
    /// The worlds of each part with a sound robot.
    sound: Vec<Vec<WorldResult>>,
}

fn in_order(mut worlds: Vec<WorldResult>) -> Vec<WorldResult> {
    worlds.sort_by_key(|w| w.world);
    worlds
}

/// Puts the parts of campaigns together: one result a controller, as if it had been run whole. `files` are names, for
/// messages, and what each holds.
pub fn merge(files: &[(String, Vec<Results>)]) -> Result<Vec<Results>, String> {
    let mut merged: Vec<Results> = Vec::new();
    let mut parts: Vec<Parts> = Vec::new();
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
                parts.push(Parts {
                    count,
                    ..Parts::default()
                });
                merged.len() - 1
            });
            let part = &mut parts[at];
            let controller = &result.conditions.controller;
            if merged[at].conditions != result.conditions || part.count != count {
                return Err(format!(
                    "{name}: {controller}: part {index}/{count} of another campaign than {}; allowed: parts of one",
                    files[0].0
                ));
            }
            if part.seen.contains(&index) {
                return Err(format!(
                    "{name}: {controller}: part {index}/{count} a second time; allowed: every part once"
                ));
            }
            part.seen.push(index);
            part.worlds.extend(result.per_world.iter().cloned());
            part.sound
                .extend(result.sound.as_ref().map(|s| s.per_world.clone()));
        }
    }
    merged
        .into_iter()
        .zip(parts)
        .map(|(result, part)| {
            if let Some(missing) = (0..part.count).find(|k| !part.seen.contains(k)) {
                return Err(format!(
                    "{}: part {missing}/{} is missing; allowed: all parts",
                    result.conditions.controller, part.count
                ));
            }
            // Parts of one campaign have it all or none.
            let sound = (part.sound.len() == part.seen.len())
                .then(|| in_order(part.sound.into_iter().flatten().collect()));
            let worlds = in_order(part.worlds);
            Ok(Results::of(result.conditions, None, worlds, sound))
        })
        .collect()
}
