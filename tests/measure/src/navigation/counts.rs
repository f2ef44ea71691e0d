//! What the navigator's tick costs.

use super::runs::Tape;
use super::{IMAGE, SIZES};
use crate::counts::{by_tick, calibrated, ticks};
use crate::machine::{Images, Machine, Time};
use crate::tape::file;
use anyhow::ensure;
use comfy_table::{Table, presets::NOTHING};
use replica::tape::Mode;

/// What is counted: key in the file, and words for people. The stages in the order of `fuzzypilot::navigate::Stage`.
pub const COUNTED: [(&str, &str); 10] = [
    ("whole-tick", "**whole tick**"),
    ("remember", "echoes into the memory"),
    ("near", "points near the predicted body"),
    ("map", "room to turn in place"),
    ("course", "the path, or the way of the guide field"),
    ("heading", "polar map and choice of the heading"),
    ("supervise", "supervisor"),
    ("behave", "the manoeuvre's twist"),
    ("guard", "barrier and brake gate"),
    ("field", "a slice of the guide field"),
];

/// Counts of one thing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// Over all ticks of all runs.
    pub median: u32,
    /// All but one in a hundred are at or below.
    pub most: u32,
    /// The worst of them.
    pub worst: u32,
    /// In invented runs.
    pub contrived: u32,
    /// Where the worst was.
    pub at: String,
}

/// What one machine needs.
#[derive(Clone, Debug)]
pub struct Needs {
    /// The machine's key and name.
    pub core: (&'static str, &'static str),
    /// By [`COUNTED`].
    pub instructions: [Spread; 10],
    /// Bytes of the navigator, of its settings, and of the deepest stack of a tick.
    pub bytes: [u32; 3],
    /// Where the stack was deepest.
    pub stack_at: String,
}

/// Counts on one machine.
pub fn count(
    machine: &Machine,
    images: &Images,
    tapes: &[Tape],
    contrived: &[Tape],
) -> anyhow::Result<Needs> {
    let image = images.of(machine, IMAGE);
    let folder = tempfile::tempdir()?;
    let play = |mode, time, tapes: &[Tape]| -> anyhow::Result<Vec<u32>> {
        let outcome = machine.run(&image, folder.path(), &file(mode, tapes), time)?;
        outcome.words()
    };
    let samples = |tapes: &[Tape]| -> anyhow::Result<[Vec<(u32, usize)>; 10]> {
        let whole = calibrated(machine, &play(Mode::Ticks, Time::Counted, tapes)?)?;
        let stages = calibrated(machine, &play(Mode::Stages, Time::Counted, tapes)?)?;
        let whole = by_tick(tapes, &whole, 1)?;
        let stages = by_tick(tapes, &stages, COUNTED.len() - 1)?;
        let mut samples: [Vec<(u32, usize)>; 10] = Default::default();
        for (tick, (whole, stages)) in whole.iter().zip(&stages).enumerate() {
            let counts = whole.iter().chain(stages.iter());
            for (samples, count) in samples.iter_mut().zip(counts) {
                samples.push((*count, tick));
            }
        }
        Ok(samples)
    };
    let place = |tapes: &[Tape], tick: usize| {
        let found = ticks(tapes).nth(tick);
        found.map_or_else(String::new, |(tape, tick)| {
            format!("{}, tick {tick}", tape.name)
        })
    };
    let mut ordinary = samples(tapes)?;
    let invented = samples(contrived)?;
    let mut instructions: [Spread; 10] = Default::default();
    for ((spread, ordinary), invented) in instructions.iter_mut().zip(&mut ordinary).zip(&invented)
    {
        ordinary.sort_unstable();
        let at = |share: f64| ordinary[(share * (ordinary.len() - 1) as f64) as usize];
        ensure!(!ordinary.is_empty() && !invented.is_empty(), "no ticks");
        *spread = Spread {
            median: at(0.5).0,
            most: at(0.99).0,
            worst: at(1.0).0,
            contrived: invented.iter().map(|(count, _)| *count).max().unwrap_or(0),
            at: place(tapes, at(1.0).1),
        };
    }
    let (mut stack, mut stack_at) = (0, String::new());
    for tapes in [tapes, contrived] {
        let depths = play(Mode::Stack, Time::Free, tapes)?;
        ensure!(depths.len() == ticks(tapes).count(), "too few depths");
        for (tick, depth) in depths.iter().enumerate() {
            if *depth > stack {
                (stack, stack_at) = (*depth, place(tapes, tick));
            }
        }
    }
    let sizes = machine
        .run(
            &image,
            folder.path(),
            &file(Mode::Records, [] as [&Tape; 0]),
            Time::Free,
        )?
        .words()?;
    ensure!(sizes.len() * 4 == SIZES, "no sizes");
    Ok(Needs {
        core: (machine.key, machine.name),
        instructions,
        bytes: [sizes[1], sizes[0], stack],
        stack_at,
    })
}

/// What was measured, and where the worst was.
pub fn report(needs: &[Needs]) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(["core", "what", "median", "99 %", "worst", "in", "contrived"]);
    for Needs {
        core: (_, core),
        instructions,
        bytes,
        stack_at,
    } in needs
    {
        for ((_, what), spread) in COUNTED.iter().zip(instructions) {
            table.add_row([
                core,
                what.trim_matches('*'),
                &spread.median.to_string(),
                &spread.most.to_string(),
                &spread.worst.to_string(),
                &spread.at,
                &spread.contrived.to_string(),
            ]);
        }
        let places = ["", "", stack_at.as_str()];
        for ((what, bytes), at) in ["navigator", "settings", "stack"]
            .iter()
            .zip(bytes)
            .zip(places)
        {
            let what = format!("{what}, bytes");
            table.add_row([core, what.as_str(), "", "", &bytes.to_string(), at, ""]);
        }
    }
    table
}
