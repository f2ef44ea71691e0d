//! What needs no emulator: the digests, and that a tape holds all that a tick depends on.

use measure::tape::play;
use measure::{digests, suite, synthetic};

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
