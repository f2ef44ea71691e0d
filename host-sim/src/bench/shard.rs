//! A part of a campaign, and putting the parts together again.

use super::attempt::{Ending, Outcome};
use super::results::{Conditions, Figures, Results, WorldResult};
use super::worlds::error::short;

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

/// Longest run that a bench allows, and a little, s.
const LONGEST: f64 = 3601.0;

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
    /// Each with its part.
    worlds: Vec<(u32, WorldResult)>,
    /// The worlds with a sound robot.
    sound: Vec<WorldResult>,
}

/// Puts the parts of campaigns together: one result a controller, as if it had been run whole. `files` are names, for
/// messages, and what each holds.
pub fn merge(files: &[(String, Vec<Results>)]) -> Result<Vec<Results>, String> {
    let mut merged: Vec<Results> = Vec::new();
    let mut parts: Vec<Parts> = Vec::new();
    for (name, results) in files {
        if results.is_empty() {
            return Err(format!(
                "{name}: found no results; allowed: what `host-sim bench --json` writes, one or more"
            ));
        }
        for result in results {
            let [index, count] = check(result).map_err(|why| {
                format!("{name}: {}: {}", result.conditions.controller, short(&why))
            })?;
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
            if merged[at].conditions != result.conditions
                || merged[at].sound.is_some() != result.sound.is_some()
                || part.count != count
            {
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
            let worlds = result.per_world.iter().cloned();
            part.worlds.extend(worlds.map(|world| (index, world)));
            let sound = result.sound.iter().flat_map(|s| &s.per_world);
            part.sound.extend(sound.cloned());
        }
    }
    merged
        .into_iter()
        .zip(parts)
        .map(|(result, part)| {
            let controller = &result.conditions.controller;
            let has_sound = result.sound.is_some();
            let (worlds, sound) = part.whole().map_err(|why| format!("{controller}: {why}"))?;
            let sound = has_sound.then_some(sound);
            Ok(Results::of(result.conditions, None, worlds, sound))
        })
        .collect()
}

impl Parts {
    /// All worlds, by number; those with a sound robot, too.
    fn whole(mut self) -> Result<(Vec<WorldResult>, Vec<WorldResult>), String> {
        let count = self.count;
        if let Some(missing) = (0..count).find(|k| !self.seen.contains(k)) {
            return Err(format!(
                "part {missing}/{count} is missing; allowed: all parts"
            ));
        }
        self.worlds.sort_by_key(|(_, w)| w.world);
        self.sound.sort_by_key(|w| w.world);
        if self.worlds.is_empty() {
            return Err("found no run in any part; allowed: parts of a campaign".to_owned());
        }
        for pair in self.worlds.windows(2) {
            let [(one, a), (other, b)] = pair else {
                continue;
            };
            if a.world == b.world {
                return Err(format!(
                    "found world {} in the parts {one}/{count} and {other}/{count}; allowed: every world once",
                    a.world
                ));
            }
        }
        // Parts are every n-th world.
        for ((part, world), own) in self.worlds.iter().zip((0..count).cycle()) {
            if *part != own {
                return Err(format!(
                    "found world {} in part {part}/{count}, where part {own}/{count} ought to have it; allowed: parts of one campaign",
                    world.world
                ));
            }
        }
        let worlds = self.worlds.into_iter().map(|(_, world)| world);
        Ok((worlds.collect(), self.sound))
    }
}

/// Which part it is, if it is one as it was written.
fn check(part: &Results) -> Result<[u32; 2], String> {
    let Some([index, count]) = part.shard else {
        return Err("a whole campaign; allowed: parts written with --shard i/n".to_owned());
    };
    if index >= count || count > MOST {
        return Err(format!(
            "found part {index}/{count}; allowed: 0 to n-1 of n, {MOST} at most"
        ));
    }
    let conditions = &part.conditions;
    runs(&part.per_world, conditions)?;
    figures("all runs", &part.figures, &part.per_world)?;
    if let Some(sound) = &part.sound {
        runs(&sound.per_world, conditions)?;
        figures(
            "all runs of the sound robot",
            &sound.figures,
            &sound.per_world,
        )?;
        let numbers = |worlds: &[WorldResult]| worlds.iter().map(|w| w.world).collect::<Vec<_>>();
        if numbers(&sound.per_world) != numbers(&part.per_world) {
            return Err("found other worlds with the sound robot; allowed: the same".to_owned());
        }
    }
    Ok([index, count])
}

/// Whether worlds come in order, each with every seed, and their runs are such as can be.
fn runs(worlds: &[WorldResult], conditions: &Conditions) -> Result<(), String> {
    if let Some(pair) = worlds.windows(2).find(|w| w[0].world >= w[1].world) {
        return Err(format!(
            "found world {} behind {}; allowed: worlds in order, each once",
            pair[1].world, pair[0].world
        ));
    }
    for world in worlds {
        let number = world.world;
        let (first, count) = (conditions.first_seed, conditions.seeds);
        let seeds = world.attempts.iter().map(|a| a.seed);
        // As many as the list has are looked at, whatever the file says.
        let due = (first..first.saturating_add(count)).take(world.attempts.len());
        if world.attempts.len() as u64 != count || !seeds.clone().eq(due) {
            let seeds: Vec<String> = seeds.take(10).map(|s| s.to_string()).collect();
            return Err(format!(
                "world {number}: found {} runs, with the seeds {}…; allowed: {count}, with the seeds from {first} in order",
                world.attempts.len(),
                seeds.join(", ")
            ));
        }
        for attempt in &world.attempts {
            let o = &attempt.outcome;
            let most = if o.ending == Ending::Reached {
                0.5
            } else {
                0.0
            };
            let limits = [
                ("score", o.score, most),
                ("time_s", o.time_s, LONGEST),
                ("longest_stall_s", o.longest_stall_s, LONGEST),
                ("cross_track_rms_m", o.cross_track_rms_m, f64::MAX),
                ("cross_track_max_m", o.cross_track_max_m, f64::MAX),
                ("omega_rate_rms", o.omega_rate_rms, f64::MAX),
            ];
            let wrong = limits
                .into_iter()
                .find(|(_, x, most)| !(0.0..=*most).contains(x));
            if let Some((name, x, most)) = wrong {
                let to = if most < f64::MAX {
                    format!("0 to {most}")
                } else {
                    "0 or more".to_owned()
                };
                return Err(format!(
                    "world {number}, seed {}: found the {name} {x}; allowed: {to}",
                    attempt.seed
                ));
            }
        }
        figures(
            &format!("world {number}"),
            &world.figures,
            std::slice::from_ref(world),
        )?;
    }
    Ok(())
}

/// Whether the figures are those of the runs.
fn figures(of: &str, said: &Figures, worlds: &[WorldResult]) -> Result<(), String> {
    let attempts = worlds.iter().flat_map(|w| &w.attempts);
    let outcomes: Vec<Outcome> = attempts.map(|a| a.outcome).collect();
    let are = Figures::of(&outcomes);
    let pairs = [
        ("runs", said.runs as f64, are.runs as f64),
        ("success", said.success, are.success),
        ("collision", said.collision, are.collision),
        ("timeout", said.timeout, are.timeout),
        ("blocked", said.blocked, are.blocked),
        ("score", said.score, are.score),
        // None where nobody arrived.
        (
            "mean_time_s",
            said.mean_time_s.unwrap_or(f64::NAN),
            are.mean_time_s.unwrap_or(f64::NAN),
        ),
    ];
    let same = |said: f64, is: f64| (said - is).abs() <= 1e-9 || (said.is_nan() && is.is_nan());
    match pairs.into_iter().find(|(_, said, is)| !same(*said, *is)) {
        None => Ok(()),
        Some((name, said, is)) => Err(format!(
            "{of}: found the {name} {said} where the runs have {is}; allowed: what `host-sim bench --json` wrote, unchanged"
        )),
    }
}
