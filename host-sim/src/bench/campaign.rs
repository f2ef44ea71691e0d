//! Every world with every seed, on all cores.

use super::arena::Arena;
use super::attempt::{Outcome, Setting, drive};
use super::controllers::Controller;
use super::discs::Discs;
use super::navigator::{Mission, Navigator};
use super::tracking::{Tracked, Tracking};
use rayon::prelude::*;

/// Worlds, seeds and all that is the same for their runs.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The worlds, in the order of the results.
    pub arenas: Vec<Arena>,
    /// The seeds, in the order of the results.
    pub seeds: Vec<u64>,
    /// The rest.
    pub setting: Setting,
}

/// One run and what came out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// World's number.
    pub world: u32,
    /// Seed.
    pub seed: u64,
    /// The sensor that was dead in it, if one was.
    pub dead: Option<usize>,
    /// Result.
    pub outcome: Outcome,
    /// The route's name, and how far from it the run was, where its shape is known.
    pub course: Option<(String, Vec<Tracked>)>,
}

impl Campaign {
    /// Runs a controller through all of it: worlds in order, the seeds of each in order, whatever the number of
    /// threads. `done` is called after every run, from any thread.
    pub fn run(&self, controller: &Controller, done: &(dyn Fn() + Sync)) -> Vec<Run> {
        self.run_with(&controller.build, done)
    }

    /// The same with a navigator that `build` makes for each run.
    pub fn run_with(
        &self,
        build: &(dyn Fn(&Mission) -> Box<dyn Navigator> + Sync),
        done: &(dyn Fn() + Sync),
    ) -> Vec<Run> {
        let discs: Vec<Discs> = self
            .arenas
            .iter()
            .map(|arena| Discs::new(&arena.circles))
            .collect();
        let seeds = self.seeds.len();
        (0..self.arenas.len() * seeds)
            .into_par_iter()
            .map(|job| {
                let (world, seed) = (job / seeds, self.seeds[job % seeds]);
                let arena = &self.arenas[world];
                let mut navigator = build(&self.setting.mission(arena));
                let mut tracking = arena.course.as_ref().map(Tracking::new);
                let outcome = drive(
                    arena,
                    &discs[world],
                    &self.setting,
                    seed,
                    navigator.as_mut(),
                    &mut |step| {
                        if let Some(tracking) = &mut tracking {
                            tracking.see(step);
                        }
                    },
                );
                done();
                let tracked = tracking.map(Tracking::finish).unwrap_or_default();
                let name = arena.course.as_ref().map(|course| course.name.clone());
                Run {
                    world: arena.number,
                    seed,
                    dead: self.setting.dead.sensor(seed, self.setting.sensors.len()),
                    outcome,
                    course: name.map(|name| (name, tracked)),
                }
            })
            .collect()
    }
}
