//! What needs no emulator: the digests, that a tape holds all that a tick depends on, and that watching changes nothing.

use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::ports::Ports;
use fuzzypilot::presets;
use fuzzypilot::tick::{Probe, Robot, Stage};
use fuzzypilot::units::Metres;
use measure::tape::play;
use measure::{digests, suite, synthetic};
use replica::tape::{Inputs, NoWheels};

#[test]
fn every_run_computes_what_its_digest_says() {
    digests::check().unwrap();
}

#[test]
fn a_tape_played_in_open_loop_gives_the_closed_loops_records() {
    for tape in suite::plain(1)
        .unwrap()
        .into_iter()
        .chain(suite::varied(3).unwrap())
    {
        let played = play(&tape.bytes).unwrap();
        assert_eq!(played.len(), tape.records.len(), "{}", tape.name);
        assert!(played == tape.records, "{}", tape.name);
    }
}

#[test]
fn hostile_tapes_reach_every_decision() {
    let mut seen = [false; 3];
    for seed in 1..=30 {
        let tape = synthetic::hostile(seed).unwrap();
        for tick in 0..tape.ticks() {
            // Byte 4 of a record is its decision.
            seen[usize::from(tape.record(tick).unwrap()[4])] = true;
        }
    }
    assert_eq!(seen, [true; 3], "follow, avoid, stop");
}

#[test]
fn a_watched_tick_shows_every_stage_once_and_changes_nothing() {
    struct Marks(Vec<Stage>);
    impl Probe for Marks {
        fn mark(&mut self, stage: Stage) {
            self.0.push(stage);
        }
    }
    let path = [Segment::line(Pose::default(), Metres::lit("2"))];
    let path = Path::segments(&path, false).unwrap();
    let robot = || Robot::<8>::new(presets::small_robot(), Pose::default());
    let (mut watched, mut plain) = (robot(), robot());
    let inputs = Inputs::new();
    let ports = || Ports {
        drive: NoWheels,
        encoders: &inputs,
        ranges: &inputs,
    };
    for _ in 0..20 {
        let mut marks = Marks(Vec::new());
        let record = watched.tick_observed(&path, &mut ports(), &mut marks);
        assert_eq!(record, plain.tick(&path, &mut ports()));
        let order: Vec<usize> = marks.0.iter().map(|stage| *stage as usize).collect();
        assert_eq!(order, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }
}
