//! Encoders: narrow counters become 32 bits, whatever wraps; implausible reads are faults; edges are decoded.

use super::config;
use fuzzypilot::ports::quadrature::{
    JUMP_READS, QuadratureCounter, QuadratureDecoder, QuadratureEncoders, RawCount,
};
use fuzzypilot::ports::{Fault, WheelEncoders};
use proptest::prelude::*;
use std::cell::Cell;
use std::rc::Rc;

/// A counter at a place that the test sets; narrower counters show its lower bits.
struct Counter<T>(Rc<Cell<Result<i64, Fault>>>, fn(i64) -> T);

impl<T: RawCount> QuadratureCounter for Counter<T> {
    type Raw = T;
    fn raw(&mut self) -> Result<T, Fault> {
        self.0.get().map(self.1)
    }
}

type Place = Rc<Cell<Result<i64, Fault>>>;

fn pair() -> (Place, Place, QuadratureEncoders<Counter<u16>, Counter<u32>>) {
    let (left, right): (Place, Place) = (Rc::new(Cell::new(Ok(0))), Rc::new(Cell::new(Ok(0))));
    let encoders = QuadratureEncoders::new(
        Counter(left.clone(), |at| at as u16),
        Counter(right.clone(), |at| at as u32),
    );
    (left, right, encoders)
}

proptest! {
    #![proptest_config(config(256))]

    /// Any walk in steps that the counter can tell, from any place, far past every wrap-around.
    #[test]
    fn counts_are_the_travel(
        start in any::<[i32; 2]>(),
        walk in prop::collection::vec((-32_768..=32_767_i64, any::<i32>()), 1..64),
        reverse in any::<[bool; 2]>(),
    ) {
        let (left, right, encoders) = pair();
        let mut encoders = encoders.reverse(reverse[0], reverse[1]);
        let mut at = start.map(i64::from);
        left.set(Ok(at[0]));
        right.set(Ok(at[1]));
        prop_assert_eq!(encoders.counts().map(|c| [c.left, c.right]), Ok([0, 0]));
        let mut travel = [0_i64; 2];
        for (l, r) in walk {
            for (i, step) in [l, r.into()].into_iter().enumerate() {
                at[i] += step;
                travel[i] += if reverse[i] { -step } else { step };
            }
            left.set(Ok(at[0]));
            right.set(Ok(at[1]));
            let counts = encoders.counts().unwrap();
            prop_assert_eq!([counts.left, counts.right], travel.map(|t| t as i32));
        }
    }

    /// Legal and lost edges, in any order: the count is right up to the lost ones, and those are counted.
    #[test]
    fn edges_are_decoded(moves in prop::collection::vec(-1..=2_i64, 1..200)) {
        let levels = |at: i64| [(false, false), (true, false), (true, true), (false, true)]
            [at.rem_euclid(4) as usize];
        let mut decoder = QuadratureDecoder::new().tolerate(u32::MAX);
        let (mut at, mut expected, mut lost) = (0, 0, 0);
        let (a, b) = levels(0);
        decoder.on_edge(a, b);
        for step in moves {
            at += step;
            if step == 2 { lost += 1 } else { expected += step }
            let (a, b) = levels(at);
            decoder.on_edge(a, b);
            prop_assert_eq!(i64::from(decoder.count()), expected);
            prop_assert_eq!(decoder.illegal(), lost);
        }
        prop_assert_eq!(decoder.raw(), Ok(expected as u32));
    }
}

#[test]
fn a_failed_read_loses_nothing() {
    let (left, right, mut encoders) = pair();
    encoders.counts().unwrap();
    left.set(Ok(100));
    right.set(Err(Fault::Bus));
    assert_eq!(encoders.counts(), Err(Fault::Bus));
    left.set(Ok(250));
    right.set(Ok(-40));
    let counts = encoders.counts().unwrap();
    assert_eq!([counts.left, counts.right], [250, -40]);
}

#[test]
fn an_implausible_read_is_a_fault_and_the_next_good_one_holds_the_travel() {
    let (left, _, encoders) = pair();
    let mut encoders = encoders.at_most(500);
    encoders.counts().unwrap();
    left.set(Ok(500));
    assert_eq!(encoders.counts().map(|c| c.left), Ok(500));
    left.set(Ok(9_000));
    assert_eq!(encoders.counts(), Err(Fault::OutOfRange));
    // 900 in two reads is possible, where in one it is not.
    left.set(Ok(1_400));
    assert_eq!(encoders.counts().map(|c| c.left), Ok(1_400));
    left.set(Ok(1_400 + 501));
    assert_eq!(encoders.counts(), Err(Fault::OutOfRange));
}

#[test]
fn a_counter_that_jumped_is_believed_again_without_the_jump() {
    let (left, _, encoders) = pair();
    let mut encoders = encoders.at_most(500);
    encoders.counts().unwrap();
    for read in 1..JUMP_READS {
        left.set(Ok(20_000 + i64::from(read) * 10));
        assert_eq!(encoders.counts(), Err(Fault::OutOfRange), "read {read}");
    }
    left.set(Ok(20_030));
    assert_eq!(encoders.counts().map(|c| c.left), Ok(0));
    left.set(Ok(20_100));
    assert_eq!(encoders.counts().map(|c| c.left), Ok(70));
    // Noise never agrees with itself.
    for at in [3_000, -9_000, 15_000, 100, -20_000, 7_000] {
        left.set(Ok(20_100 + at));
        let counts = encoders.counts();
        assert!(counts.is_err() || at == 100, "{at}: {counts:?}");
    }
}

#[test]
fn lost_edges_are_a_fault_once() {
    let mut decoder = QuadratureDecoder::new().tolerate(1);
    decoder.on_edge(false, false);
    decoder.on_edge(true, true);
    assert_eq!(decoder.raw(), Ok(0), "one is tolerated");
    decoder.on_edge(false, false);
    decoder.on_edge(true, true);
    assert_eq!(decoder.raw(), Err(Fault::OutOfRange));
    decoder.on_edge(false, true);
    assert_eq!(decoder.raw(), Ok(1));
}

#[test]
fn the_decoder_is_a_counter_and_a_leading_b_counts_up() {
    let mut left = QuadratureDecoder::new();
    left.on_edge(false, false);
    left.on_edge(true, false);
    left.on_edge(true, true);
    assert_eq!(left.count(), 2);
    left.on_edge(true, false);
    left.on_edge(false, false);
    left.on_edge(false, true);
    assert_eq!(left.count(), -1);
    let mut encoders = QuadratureEncoders::new(left, QuadratureDecoder::new());
    assert_eq!(encoders.counts().map(|c| [c.left, c.right]), Ok([0, 0]));
}
