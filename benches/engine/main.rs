//! The fine controller on a desktop, side by side with its peers, one core: `cargo bench --bench engine`.
//!
//! | contender | what it is |
//! |---|---|
//! | this library | [`FineController`]: fixed point, four rules |
//! | [f32](float) | the same four rules in floats, as one would write them down |
//! | [oxictl](peer) | the quickest fuzzy controller in Rust that we know: `f32`, Sugeno, every rule |
//!
//! All have the same rule base, Tables 7.1 and 7.2 of `tables::fine`, take metres and a heading error, give m/s and rad/s,
//! and are held to the same results before anything is measured. A table is printed first: the best of many batches, so
//! that what else the machine does is not counted. There our own has a bar. Then criterion has its say.
//!
//! *Independent* evaluations overlap in the processor; *in a row* each waits for the one before, as in a control loop.

mod count;
mod float;
mod peer;
mod time;

use criterion::{Criterion, Throughput};
use float::{Float, Scales};
use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::params::{Follower, Params};
use fuzzypilot::presets;
use fuzzypilot::tables::fine::FineSet;
use fuzzypilot::units::{Angle, Metres};
use peer::Peer;
use std::f32::consts::PI;
use std::process::ExitCode;

/// Ours may take this long, nanoseconds, evaluations being independent. In a row it takes longer, and has no bar.
const BAR: f64 = 10.0;

/// Inputs a batch.
pub const INPUTS: usize = 1024;

/// Settings: the small robot's, with the printed tables, whose rules differ in all directions.
static SMALL: Params<1> = presets::small_robot();
static FOLLOWER: Follower = Follower {
    tables: FineSet::Printed,
    ..SMALL.follower
};
static CONTROLLER: FineController = FineController::new(&FOLLOWER, &SMALL.limits);

/// Ours: raw speed and yaw rate of an input.
fn ours((d, heading_error): (Metres, Angle)) -> [u32; 2] {
    let motion = CONTROLLER.evaluate(d, heading_error);
    [motion.speed.bits() as u32, motion.yaw_rate.bits() as u32]
}

/// Everything that is measured.
pub struct Contest {
    fixed: Vec<(Metres, Angle)>,
    /// The same in metres and radians.
    floats: Vec<(f32, f32)>,
    float: Float,
    peer: Peer,
}

/// What is done with a contender: its name, its inputs, and how it evaluates one of them.
pub trait Measure {
    /// Once for each contender.
    fn measure<I: Copy>(
        &mut self,
        name: &'static str,
        inputs: &[I],
        evaluate: impl Fn(I) -> [u32; 2],
    );
}

impl Contest {
    fn new() -> Self {
        let fixed: Vec<_> = inputs().collect();
        let floats = fixed.iter().map(|(d, error)| {
            let turns = error.bits() as f32 / (1u32 << 31) as f32;
            (d.bits() as f32 / 65536.0, turns * PI)
        });
        let tables = FineSet::Printed.tables();
        let scales = Scales::new(&FOLLOWER, &SMALL.limits);
        Self {
            floats: floats.collect(),
            fixed,
            float: Float::new(tables, scales),
            peer: Peer::new(tables, scales),
        }
    }

    /// Each contender in turn.
    pub fn each(&self, measure: &mut impl Measure) {
        let bits = |outputs: [f32; 2]| outputs.map(f32::to_bits);
        measure.measure("this library, fixed point", &self.fixed, ours);
        measure.measure("f32, the same four rules", &self.floats, |(d, error)| {
            bits(self.float.evaluate(d, error))
        });
        measure.measure("oxictl 0.1.1, f32, Sugeno", &self.floats, |(d, error)| {
            bits(self.peer.evaluate(d, error))
        });
    }

    /// Whether all come to the same results, within 0.0005 units of the speed axis and 0.01°.
    fn agree(&self) {
        let scales = Scales::new(&FOLLOWER, &SMALL.limits);
        let allowed = [0.0005 * scales.speed, 0.01 * scales.yaw_rate];
        for (fixed, &(d, error)) in self.fixed.iter().zip(&self.floats) {
            let ours = ours(*fixed).map(|bits| bits as i32 as f32 / 65536.0);
            let float = self.float.evaluate(d, error);
            let peer = self.peer.evaluate(d, error);
            for (name, theirs) in [("f32", float), ("oxictl", peer)] {
                for (i, what) in ["m/s", "rad/s"].into_iter().enumerate() {
                    assert!(
                        (ours[i] - theirs[i]).abs() <= allowed[i],
                        "{name} at {d} m, {error} rad: {} {what}, ours {}",
                        theirs[i],
                        ours[i]
                    );
                }
            }
        }
    }
}

/// Spread over all of both axes and beyond the distance's, in no order.
fn inputs() -> impl Iterator<Item = (Metres, Angle)> {
    (0..INPUTS as u32).map(|i| {
        let d = i.wrapping_mul(0x9E37_79B9) >> 17;
        let error = i.wrapping_mul(0x85EB_CA6B);
        (
            // −0.04 m to 0.46 m; the axis is 0.4 m.
            Metres::from_bits(d as i32 - 2621),
            Angle::from_bits(error as i32),
        )
    })
}

/// Criterion's measurements, both kinds.
struct Statistics(Criterion);

impl Measure for Statistics {
    fn measure<I: Copy>(
        &mut self,
        name: &'static str,
        inputs: &[I],
        evaluate: impl Fn(I) -> [u32; 2],
    ) {
        let mut group = self.0.benchmark_group(name);
        group.throughput(Throughput::Elements(INPUTS as u64));
        group.bench_function("independent", |b| {
            b.iter(|| time::independent(inputs, &evaluate));
        });
        group.bench_function("in a row", |b| {
            b.iter(|| time::in_a_row(inputs, &evaluate));
        });
        group.finish();
    }
}

fn main() -> ExitCode {
    let contest = Contest::new();
    if let Some(batches) = count::asked() {
        count::evaluate(&contest, batches);
        return ExitCode::SUCCESS;
    }
    contest.agree();
    // Not where it is only tried whether a bench runs.
    let asked = |for_it: &str| std::env::args().any(|argument| argument == for_it);
    if asked("--bench") && !asked("--test") && !asked("--list") {
        let rows = time::rows(&contest);
        let counts = count::instructions(rows.len());
        println!(
            "{:28} {:>12} {:>10} {:>14} {:>13}",
            "one evaluation", "independent", "in a row", "a second", "instructions"
        );
        for (i, row) in rows.iter().enumerate() {
            let count = match &counts {
                Ok(counts) => counts[i].to_string(),
                Err(_) => "–".to_owned(),
            };
            println!(
                "{:28} {:>9.1} ns {:>7.1} ns {:>12.1} M {count:>13}",
                row.name,
                row.independent,
                row.in_a_row,
                1000.0 / row.independent,
            );
        }
        if let Err(why) = counts {
            println!("instructions were not counted: {why}");
        }
        let ours = rows[0].independent;
        if ours > BAR {
            eprintln!("error: {ours:.1} ns an evaluation; allowed are {BAR} ns");
            return ExitCode::FAILURE;
        }
    }
    let mut statistics = Statistics(Criterion::default().configure_from_args());
    contest.each(&mut statistics);
    statistics.0.final_summary();
    ExitCode::SUCCESS
}
