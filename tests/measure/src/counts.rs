//! What a tick costs, in instructions and in bytes of stack.

use crate::machine::{Images, Machine, Outcome, Time};
use crate::suite::Counted;
use crate::tape::{Tape, file};
use anyhow::{Context, ensure};
use fuzzypilot::link::record::decode;
use fuzzypilot::signals::Decision;
use fuzzypilot::tick::Stage;
use replica::tape::Mode;

/// What is counted, in the order of the table: key in `budgets.toml`, and words for people.
pub const COUNTED: [(&str, &str); 5] = [
    ("fine-inference", "one fine inference"),
    ("coarse-avoidance", "one coarse avoidance"),
    ("path-cursor", "path cursor, guidance, speed limit"),
    ("sensing", "sensing"),
    ("whole-tick", "**whole tick**"),
];

/// Stages of a tick.
const STAGES: usize = 9;

/// Counts of one thing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// Over all ticks of all scenarios.
    pub median: u32,
    /// Over all ticks of all scenarios.
    pub worst: u32,
    /// In the contrived runs.
    pub contrived: u32,
    /// Where the worst was, and where the contrived.
    pub at: [String; 2],
}

/// What one machine needs.
#[derive(Clone, Debug)]
pub struct Needs {
    /// By [`COUNTED`].
    pub instructions: [Spread; 5],
    /// The deepest stack of a tick, bytes, in any run.
    pub stack: u32,
    /// Where it was.
    pub stack_at: String,
}

/// A count, and whose.
type Sample<'a> = (u32, &'a Tape, usize);

/// Runs everything on one machine.
pub fn count(machine: &Machine, images: &Images, runs: &Counted) -> anyhow::Result<Needs> {
    let image = images.of(machine, "replica");
    let folder = tempfile::tempdir()?;
    let play = |mode, time, tapes: &[Tape]| -> anyhow::Result<Vec<u32>> {
        let outcome: Outcome = machine.run(&image, folder.path(), &file(mode, tapes), time)?;
        outcome.words()
    };
    let samples = |tapes| -> anyhow::Result<[Vec<Sample<'_>>; 5]> {
        let whole = calibrated(machine, &play(Mode::Ticks, Time::Counted, tapes)?)?;
        let stages = calibrated(machine, &play(Mode::Stages, Time::Counted, tapes)?)?;
        let whole = by_tick(tapes, &whole, 2)?;
        let stages = by_tick(tapes, &stages, STAGES)?;
        let mut samples: [Vec<Sample<'_>>; 5] = Default::default();
        for ((whole, stages), (tape, tick)) in whole.iter().zip(&stages).zip(ticks(tapes)) {
            let record = tape.record(tick).and_then(decode).context("no record")?;
            let stage = |stage: Stage| stages[stage as usize];
            let avoiding = matches!(record.decision, Decision::Avoid { .. });
            let counts = [
                Some(whole[1]).filter(|count| *count > 0),
                Some(stage(Stage::Behave)).filter(|_| avoiding),
                Some(stage(Stage::Guide).saturating_add(stage(Stage::Pace))),
                Some(stage(Stage::Sense)),
                Some(whole[0]),
            ];
            for (samples, count) in samples.iter_mut().zip(counts) {
                samples.extend(count.map(|count| (count, tape, tick)));
            }
        }
        Ok(samples)
    };
    let mut instructions: [Spread; 5] = Default::default();
    let mut ordinary = samples(&runs.scenarios)?;
    let mut contrived = samples(&runs.contrived)?;
    for (i, spread) in instructions.iter_mut().enumerate() {
        ordinary[i].sort_by_key(|sample| sample.0);
        contrived[i].sort_by_key(|sample| sample.0);
        let (Some(worst), Some(most)) = (ordinary[i].last(), contrived[i].last()) else {
            anyhow::bail!("{}: never happened", COUNTED[i].1);
        };
        *spread = Spread {
            median: ordinary[i][ordinary[i].len() / 2].0,
            worst: worst.0,
            contrived: most.0,
            at: [worst, most].map(|(_, tape, tick)| format!("{}, tick {tick}", tape.name)),
        };
    }
    let mut deepest = (0, String::new());
    for tapes in [&runs.scenarios, &runs.contrived] {
        let depths = play(Mode::Stack, Time::Free, tapes)?;
        let depths = by_tick(tapes, &depths, 1)?;
        for (depth, (tape, tick)) in depths.iter().zip(ticks(tapes)) {
            if depth[0] > deepest.0 {
                deepest = (depth[0], format!("{}, tick {tick}", tape.name));
            }
        }
    }
    Ok(Needs {
        instructions,
        stack: deepest.0,
        stack_at: deepest.1,
    })
}

/// Instructions, the cost of counting taken off.
pub(crate) fn calibrated(machine: &Machine, words: &[u32]) -> anyhow::Result<Vec<u32>> {
    let [empty, thousand, counts @ ..] = words else {
        anyhow::bail!("{}: nothing was counted", machine.name);
    };
    let instructions = |ticks: u32| machine.instructions(ticks).round() as u32;
    let empty = instructions(*empty);
    ensure!(
        instructions(*thousand).abs_diff(1000 + empty) <= 32,
        "{}: the clock counts {} for 1,000 instructions and {empty} for none",
        machine.name,
        instructions(*thousand)
    );
    let net = |ticks: &u32| instructions(*ticks).saturating_sub(empty);
    Ok(counts.iter().map(net).collect())
}

pub(crate) fn ticks<const BYTES: usize>(
    tapes: &[Tape<BYTES>],
) -> impl Iterator<Item = (&Tape<BYTES>, usize)> {
    tapes
        .iter()
        .flat_map(|tape| (0..tape.ticks()).map(move |tick| (tape, tick)))
}

/// The counts of every tick, `each` a tick.
pub(crate) fn by_tick<'w, const BYTES: usize>(
    tapes: &[Tape<BYTES>],
    words: &'w [u32],
    each: usize,
) -> anyhow::Result<Vec<&'w [u32]>> {
    let expected: usize = tapes.iter().map(Tape::ticks).sum();
    ensure!(
        words.len() == expected * each,
        "{} counts for {expected} ticks",
        words.len()
    );
    Ok(words.chunks_exact(each).collect())
}
