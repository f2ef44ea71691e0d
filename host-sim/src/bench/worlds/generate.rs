//! Worlds that are made: `generated:KIND`, a world for every number. The same number is the same world everywhere.
//! `generated:routes` are a few of known shape instead, see `routes`.

mod automaton;
mod corridor;
mod open;
mod rooms;
mod routes;
mod traps;

use super::error::WorldError;
use super::numbers::Numbers;
use super::planner;
use crate::bench::arena::{Arena, Circle};
use crate::bench::seeds::{Purpose, stream};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// A kind of world.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What it is asked for by.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    make: fn(&mut Pcg64Mcg, &Options) -> Arena,
}

/// All kinds.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "barn",
        about: "a cellular automaton's 30 × 30 cells of 0.15 m, as in the benchmark",
        make: automaton::make,
    },
    Kind {
        name: "corridor",
        about: "a corridor with right-angled bends",
        make: corridor::make,
    },
    Kind {
        name: "rooms",
        about: "four rooms in a row, joined by doors",
        make: rooms::make,
    },
    Kind {
        name: "slalom",
        about: "gates to the left and right in turn",
        make: open::slalom,
    },
    Kind {
        name: "forest",
        about: "trunks of 0.05 to 0.25 m",
        make: open::forest,
    },
    Kind {
        name: "moving",
        about: "a light forest with discs that cross at constant speed",
        make: open::moving,
    },
    Kind {
        name: "u-trap",
        about: "a U that opens towards the start, across the straight line",
        make: traps::u_trap,
    },
    Kind {
        name: "sealed",
        about: "a room without a door; the robot ought to say so",
        make: traps::sealed,
    },
    Kind {
        name: "closed",
        about: "a narrow corridor that is closed at both ends, with the robot inside; it ought to say so",
        make: traps::closed,
    },
];

/// What may be chosen; every kind takes what concerns it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Radius of the disc for which there is a way, m. The benchmark's worlds have 0.359 m.
    pub radius: f64,
    /// Share of the automaton's cells that are filled at first; drawn from 0.15 to 0.3 for every world if left out.
    pub fill: Option<f64>,
    /// Rounds of smoothing; drawn from 2 to 4 if left out.
    pub smooth: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            radius: 0.36,
            fill: None,
            smooth: None,
        }
    }
}

/// Number of worlds if none was said.
const USUAL: u32 = 100;

/// Makes the worlds of `KIND` or `KIND,radius=0.4,…`.
pub fn make(text: &str, numbers: &Numbers) -> Result<Vec<Arena>, WorldError> {
    let mut parts = text.split(',');
    let name = parts.next().unwrap_or_default();
    if name == routes::NAME {
        return routes::make(parts.next(), numbers);
    }
    let kind = KINDS.iter().find(|k| k.name == name).ok_or_else(|| {
        let mut known: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
        known.push(routes::NAME);
        WorldError::wrong("generated", format!("the kind `{name}`"), known.join(", "))
    })?;
    let mut options = Options::default();
    for part in parts {
        set(&mut options, part)?;
    }
    let numbers = numbers.below(USUAL);
    numbers
        .into_par_iter()
        .map(|number| {
            let mut arena = (kind.make)(&mut stream(0, number, Purpose::World), &options);
            arena.number = number;
            Ok(arena)
        })
        .collect()
}

fn set(options: &mut Options, part: &str) -> Result<(), WorldError> {
    let wrong = || {
        WorldError::wrong(
            "generated",
            format!("`{part}`"),
            "radius=0.2 to 1 (m), fill=0 to 0.5, smooth=0 to 10",
        )
    };
    let (key, value) = part.split_once('=').ok_or_else(wrong)?;
    let within = |least: f64, most: f64| {
        value
            .parse::<f64>()
            .ok()
            .filter(|x| (least..=most).contains(x))
            .ok_or_else(wrong)
    };
    match key {
        "radius" => options.radius = within(0.2, 1.0)?,
        "fill" => options.fill = Some(within(0.0, 0.5)?),
        "smooth" => {
            let rounds = value.parse::<usize>().ok().filter(|n| *n <= 10);
            options.smooth = Some(rounds.ok_or_else(wrong)?);
        }
        _ => return Err(wrong()),
    }
    Ok(())
}

/// A world from its parts, the robot looking along y, with a planned route. Who calls this has left a way for
/// `radius`; a grid's rounding may take a little of it.
fn arena(circles: Vec<Circle>, start: [f64; 2], goal: [f64; 2], radius: f64) -> Arena {
    let route = [radius, 0.95 * radius, 0.85 * radius]
        .iter()
        .find_map(|r| planner::route(&circles, *r, start, goal, 0.0))
        .unwrap_or_else(|| vec![start, goal]);
    Arena {
        number: 0,
        circles,
        unmapped: 0,
        movers: Vec::new(),
        start: [start[0], start[1], FRAC_PI_2],
        goal,
        goal_radius: 0.5,
        sealed: false,
        route,
        course: None,
    }
}

/// A number between two.
fn between(rng: &mut Pcg64Mcg, least: f64, most: f64) -> f64 {
    least + (most - least) * rng.random::<f64>()
}
