//! The link protocol: bytes that are the same everywhere, and a document that says what they are.

use fuzzypilot::fuzzy::{FiredRule, Grade};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::link::record::{self, RECORD_BYTES};
use fuzzypilot::signals::{
    Controller, Decision, Guidance, Obstacle, RuleTrace, StopReason, TickRecord, Turn, Twist,
    WheelCommand,
};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond};
use proptest::prelude::*;

/// A failure prints its smallest input; nothing is written beside the tests.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

// ---- records ----

fn metres() -> impl Strategy<Value = Metres> {
    any::<i32>().prop_map(Metres::from_bits)
}

fn speed() -> impl Strategy<Value = MetresPerSecond> {
    any::<i32>().prop_map(MetresPerSecond::from_bits)
}

fn angle() -> impl Strategy<Value = Angle> {
    any::<i32>().prop_map(Angle::from_bits)
}

fn point() -> impl Strategy<Value = Point> {
    (metres(), metres()).prop_map(|(x, y)| Point::new(x, y))
}

fn twist() -> impl Strategy<Value = Twist> {
    (speed(), any::<i32>()).prop_map(|(linear, angular)| Twist {
        linear,
        angular: RadiansPerSecond::from_bits(angular),
    })
}

fn decision() -> impl Strategy<Value = Decision> {
    let side = prop_oneof![Just(Turn::Left), Just(Turn::Right)];
    let obstacle = (point(), metres(), metres(), any::<u8>()).prop_map(
        |(centre, radius, residual, echoes)| Obstacle {
            centre,
            radius,
            residual,
            echoes,
        },
    );
    let reason = prop_oneof![
        Just(StopReason::NoRanges),
        Just(StopReason::NoOdometry),
        Just(StopReason::PathEnd),
        Just(StopReason::PathMissed),
    ];
    prop_oneof![
        Just(Decision::Follow),
        (side, obstacle).prop_map(|(side, obstacle)| Decision::Avoid { side, obstacle }),
        reason.prop_map(Decision::Stop),
    ]
}

fn rules() -> impl Strategy<Value = heapless::Vec<FiredRule, 4>> {
    let rule =
        (any::<u8>(), any::<u8>(), 0..=1u16 << 15).prop_map(|(row, col, degree)| FiredRule {
            row,
            col,
            degree: Grade::from_bits(degree),
        });
    prop::collection::vec(rule, 0..=4).prop_map(|rules| rules.into_iter().collect())
}

fn trace() -> impl Strategy<Value = RuleTrace> {
    let controller = prop_oneof![
        Just(Controller::None),
        Just(Controller::Fine),
        Just(Controller::Coarse),
    ];
    let numbers = any::<(i32, i32, i16, i16)>();
    (controller, numbers, rules(), rules()).prop_map(|(controller, numbers, rules, speed_rules)| {
        RuleTrace {
            controller,
            distance_input: numbers.0,
            angle_input: numbers.1,
            speed_output: numbers.2,
            deflection_output: numbers.3,
            rules,
            speed_rules,
        }
    })
}

fn guidance() -> impl Strategy<Value = Guidance> {
    let places = (point(), metres(), metres(), angle(), angle());
    let lengths = (metres(), metres(), speed(), any::<i32>());
    (places, lengths, any::<(u16, bool, bool)>()).prop_map(|(places, lengths, rest)| Guidance {
        foot: places.0,
        cross_track: places.1,
        distance: places.2,
        tangent: places.3,
        heading_error: places.4,
        progress: lengths.0,
        remaining: lengths.1,
        speed_limit: lengths.2,
        curvature: PerMetre::from_bits(lengths.3),
        laps: rest.0,
        at_end: rest.1,
        missed_end: rest.2,
    })
}

fn tick_record() -> impl Strategy<Value = TickRecord> {
    let places = (point(), angle(), metres(), guidance());
    let motion = (twist(), twist(), speed(), speed());
    let rest = any::<(u32, u8, u8, bool, bool)>();
    (decision(), places, trace(), motion, rest).prop_map(
        |(decision, places, trace, motion, rest)| TickRecord {
            tick: rest.0,
            decision,
            pose: Pose::new(places.0, places.1),
            guidance: places.3,
            obstacles: rest.1,
            valid_ranges: rest.2,
            nearest: places.2,
            trace,
            desired: motion.0,
            twist: motion.1,
            wheels: WheelCommand {
                left: motion.2,
                right: motion.3,
            },
            guarded: rest.3,
            drive_fault: rest.4,
        },
    )
}

/// Bytes near a real record's: mostly zero, tags and counts small.
fn record_bytes() -> impl Strategy<Value = [u8; RECORD_BYTES]> {
    (
        tick_record(),
        prop::collection::vec((0..RECORD_BYTES, 0..=5u8), 0..3),
    )
        .prop_map(|(record, changes)| {
            let mut bytes = record::encode(&record);
            for (at, byte) in changes {
                bytes[at] = byte;
            }
            bytes
        })
}

proptest! {
    #![proptest_config(config(2_000))]

    #[test]
    fn a_record_survives_its_bytes(record in tick_record()) {
        prop_assert_eq!(record::decode(&record::encode(&record)), Some(record));
    }

    /// Bytes that decode are the only ones of their record: equal records, equal digests.
    #[test]
    fn a_record_has_one_string_of_bytes(bytes in record_bytes()) {
        if let Some(record) = record::decode(&bytes) {
            prop_assert_eq!(record::encode(&record), bytes);
        }
    }

    #[test]
    fn arbitrary_bytes_do_no_harm(bytes in any::<[[u8; 12]; 13]>()) {
        let bytes: [u8; RECORD_BYTES] = bytes.concat().try_into().unwrap();
        if let Some(record) = record::decode(&bytes) {
            prop_assert_eq!(record::encode(&record), bytes);
        }
    }
}
