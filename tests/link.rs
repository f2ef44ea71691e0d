//! The link protocol: bytes that are the same everywhere, and a document that says what they are.

use fuzzypilot::fuzzy::{ActiveRules, FiredRule, Grade};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::link::frame::{self, Counters, Decoder, FrameError, MAX_FRAME, MAX_MESSAGE};
use fuzzypilot::link::message::{MAX_READINGS, PART_BYTES, Readings, ToTarget};
use fuzzypilot::link::record::{self, RECORD_BYTES};
use fuzzypilot::link::settings::{self, Format, SetError};
use fuzzypilot::params::{
    Avoider, Body, Follower, Guard, Limits, Mount, Params, RingGeometry, Supervisor,
};
use fuzzypilot::ports::{Fault, Range, RangeReading};
use fuzzypilot::presets;
use fuzzypilot::signals::{
    Controller, Decision, Guidance, Obstacle, RuleTrace, StopReason, TickRecord, Turn, Twist,
    WheelCommand,
};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond, Seconds};
use proptest::prelude::*;
use std::collections::BTreeSet;

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

/// Any of the four rules around an input.
fn rules() -> impl Strategy<Value = ActiveRules> {
    let degree = prop_oneof![Just(0), 0..=1u16 << 15];
    (
        0..u8::MAX,
        0..u8::MAX,
        [degree.clone(), degree.clone(), degree.clone(), degree],
    )
        .prop_map(|(row, col, degrees)| {
            let rule = |down, right, degree| FiredRule {
                row: row + down,
                col: col + right,
                degree: Grade::from_bits(degree),
            };
            let [a, b, c, d] = degrees;
            let mut fired = vec![rule(0, 0, a), rule(0, 1, b), rule(1, 0, c), rule(1, 1, d)];
            fired.retain(|rule| rule.degree > Grade::ZERO);
            ActiveRules::of_fired(&fired).unwrap()
        })
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

/// What a field of the page's table holds, from the record itself.
fn field(record: &TickRecord, name: &str) -> i64 {
    let guidance = &record.guidance;
    let trace = &record.trace;
    let held = match record.decision {
        Decision::Avoid { obstacle, .. } => obstacle,
        _ => Obstacle::default(),
    };
    let rule = |rules: &[FiredRule]| {
        let digit = name.find(|c: char| c.is_ascii_digit()).unwrap();
        let place: usize = name[digit..=digit].parse().unwrap();
        let rule = rules.get(place - 1).copied().unwrap_or_default();
        match &name[digit + 1..] {
            ".row" => i64::from(rule.row),
            ".col" => i64::from(rule.col),
            ".degree" => i64::from(rule.degree.bits()),
            _ => panic!("unknown field {name}"),
        }
    };
    i64::from(match name {
        "tick" => return i64::from(record.tick),
        "decision" => match record.decision {
            Decision::Follow => 0,
            Decision::Avoid { .. } => 1,
            Decision::Stop(_) => 2,
        },
        "detail" => match record.decision {
            Decision::Avoid {
                side: Turn::Right, ..
            } => 1,
            Decision::Stop(StopReason::NoOdometry) => 1,
            Decision::Stop(StopReason::PathEnd) => 2,
            Decision::Stop(StopReason::PathMissed) => 3,
            _ => 0,
        },
        "flags" => {
            i32::from(guidance.at_end)
                + 2 * i32::from(guidance.missed_end)
                + 4 * i32::from(record.guarded)
                + 8 * i32::from(record.drive_fault)
        }
        "controller" => match trace.controller {
            Controller::None => 0,
            Controller::Fine => 1,
            Controller::Coarse => 2,
        },
        "held.x" => held.centre.x.bits(),
        "held.y" => held.centre.y.bits(),
        "held.radius" => held.radius.bits(),
        "held.residual" => held.residual.bits(),
        "pose.x" => record.pose.at.x.bits(),
        "pose.y" => record.pose.at.y.bits(),
        "pose.heading" => record.pose.heading.bits(),
        "foot.x" => guidance.foot.x.bits(),
        "foot.y" => guidance.foot.y.bits(),
        "cross_track" => guidance.cross_track.bits(),
        "distance" => guidance.distance.bits(),
        "tangent" => guidance.tangent.bits(),
        "curvature" => guidance.curvature.bits(),
        "heading_error" => guidance.heading_error.bits(),
        "progress" => guidance.progress.bits(),
        "remaining" => guidance.remaining.bits(),
        "speed_limit" => guidance.speed_limit.bits(),
        "laps" => guidance.laps.into(),
        "obstacles" => record.obstacles.into(),
        "valid_ranges" => record.valid_ranges.into(),
        "nearest" => record.nearest.bits(),
        "held.echoes" => held.echoes.into(),
        "rules" => trace.rules.fired().len() as i32,
        "speed_rules" => trace.speed_rules.fired().len() as i32,
        "reserved" => 0,
        "distance_input" => trace.distance_input,
        "angle_input" => trace.angle_input,
        "speed_output" => trace.speed_output.into(),
        "deflection_output" => trace.deflection_output.into(),
        "desired.linear" => record.desired.linear.bits(),
        "desired.angular" => record.desired.angular.bits(),
        "twist.linear" => record.twist.linear.bits(),
        "twist.angular" => record.twist.angular.bits(),
        "wheels.left" => record.wheels.left.bits(),
        "wheels.right" => record.wheels.right.bits(),
        name if name.starts_with("rule") => return rule(&trace.rules.fired()),
        _ => return rule(&trace.speed_rules.fired()),
    })
}

/// The page's table: offset, length, whether signed, field.
fn record_table() -> Vec<(usize, usize, bool, String)> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/link.md");
    let page = std::fs::read_to_string(page).unwrap();
    let table = page.split("\n## Records\n").nth(1).unwrap();
    let table = table.split("\n## ").next().unwrap();
    let mut rows = Vec::new();
    for line in table.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, offset, of, name, ..] = cells[..] else {
            continue;
        };
        let Ok(offset) = offset.parse() else { continue };
        let of = of.trim_matches('`');
        let bits: usize = of[1..].parse().unwrap();
        rows.push((offset, bits / 8, of.starts_with('i'), name.to_owned()));
    }
    rows
}

#[test]
fn the_page_has_every_byte_of_a_record_once() {
    let mut next = 0;
    for (offset, length, _, name) in record_table() {
        assert_eq!(offset, next, "{name}");
        assert_eq!(offset % length, 0, "{name} is not aligned");
        next += length;
    }
    assert_eq!(next, RECORD_BYTES);
    assert_eq!(RECORD_BYTES, 3 * PART_BYTES);
}

proptest! {
    #![proptest_config(config(500))]

    #[test]
    fn records_are_laid_out_as_the_page_says(record in tick_record()) {
        let bytes = record::encode(&record);
        for (offset, length, signed, name) in record_table() {
            let mut wide = [0; 8];
            wide[..length].copy_from_slice(&bytes[offset..offset + length]);
            let mut value = i64::from_le_bytes(wide);
            let top = 1 << (8 * length - 1);
            if signed && value >= top {
                value -= 2 * top;
            }
            prop_assert_eq!(value, field(&record, &name), "{}", name);
        }
    }
}

// ---- frames ----

/// A frame around a message, as sent.
fn wire(sequence: u8, message: &impl serde::Serialize) -> Vec<u8> {
    let mut wire = [0xaa; MAX_FRAME];
    frame::encode(sequence, message, &mut wire)
        .unwrap()
        .to_vec()
}

/// What a decoder makes of a stream: the messages' bytes with their sequence numbers, and the errors.
type Received = Result<(u8, Vec<u8>), FrameError>;

fn receive(decoder: &mut Decoder, stream: &[u8]) -> Vec<Received> {
    let mut received = Vec::new();
    for &byte in stream {
        if let Some(result) = decoder.push(byte) {
            received.push(result.map(|frame| (frame.sequence, frame.message.to_vec())));
        }
    }
    received
}

/// Raw bytes as COBS with a terminator, written from the algorithm's description: each block is its length plus one
/// and the bytes up to the next zero.
fn cobs(raw: &[u8]) -> Vec<u8> {
    let mut wire: Vec<u8> = raw
        .split(|byte| *byte == 0)
        .flat_map(|block| [&[block.len() as u8 + 1], block].concat())
        .collect();
    wire.push(0);
    wire
}

/// A raw frame with its CRC, by the polynomial's definition.
fn enveloped(content: &[u8]) -> Vec<u8> {
    let mut crc = !0u32;
    for byte in content {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    [content, &(!crc).to_le_bytes()].concat()
}

#[test]
fn a_frame_is_what_the_document_says() {
    let stop = wire(7, &ToTarget::Stop);
    assert_eq!(stop, cobs(&enveloped(&[1, 7, 11])));
    let zeros = wire(
        0,
        &ToTarget::PathPoint {
            index: 0,
            x: 0,
            y: 0,
            heading: 0,
        },
    );
    assert_eq!(zeros, cobs(&enveloped(&[1, 0, 6, 0, 0, 0, 0])));
}

#[test]
fn every_fault_of_a_frame_has_its_name_and_count() {
    let good = wire(1, &ToTarget::Status);
    let mut changed = good.clone();
    changed[3] ^= 0x10;
    let cases = [
        (vec![0x55; 64], FrameError::Overlong),
        (vec![0x55; 700], FrameError::Overlong),
        (good[..good.len() - 2].to_vec(), FrameError::Truncated),
        (vec![3], FrameError::Truncated),
        (cobs(&[1, 2, 3, 4])[..5].to_vec(), FrameError::Truncated),
        (changed[..changed.len() - 1].to_vec(), FrameError::Corrupt),
        (
            cobs(&enveloped(&[2, 9, 1]))[..8].to_vec(),
            FrameError::Version {
                found: 2,
                sequence: 9,
            },
        ),
    ];
    let mut decoder = Decoder::new();
    let mut counters = Counters::new();
    for (mut stream, error) in cases {
        stream.push(0);
        for byte in stream {
            if let Some(result) = decoder.push(byte) {
                counters.note(&result);
                assert_eq!(result, Err(error));
            }
        }
        // The next one is whole again.
        for &byte in &good {
            if let Some(result) = decoder.push(byte) {
                counters.note(&result);
                assert_eq!(
                    result.map(|frame| frame.parse()),
                    Ok(Some(ToTarget::Status))
                );
            }
        }
    }
    let expected = Counters {
        good: 7,
        overlong: 2,
        truncated: 3,
        corrupt: 1,
        version: 1,
    };
    assert_eq!(counters, expected);
    // Silence between frames is neither.
    assert_eq!(receive(&mut decoder, &[0, 0, 0]), []);
}

#[test]
fn a_message_fills_its_bytes_exactly() {
    let parse = |message: &[u8]| {
        let frame = frame::Frame {
            sequence: 0,
            check: 0,
            message,
        };
        frame.parse::<ToTarget<'_>>().is_some()
    };
    assert!(parse(&[3, 5, 1]));
    assert!(!parse(&[3, 5, 1, 0]), "a byte too many");
    assert!(!parse(&[3, 5]), "a byte missing");
    assert!(!parse(&[15]), "no such message");
    assert!(!parse(&[]), "nothing");
}

proptest! {
    #![proptest_config(config(2_000))]

    /// Whatever the bytes, they come back, as the independent encoder above has them on the wire.
    #[test]
    fn any_message_survives_its_frame(
        sequence in any::<u8>(),
        message in prop::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..MAX_MESSAGE),
    ) {
        let frame = wire(sequence, &message.as_slice());
        prop_assert!(frame.len() <= MAX_FRAME);
        let content = [&[1, sequence, message.len() as u8], message.as_slice()].concat();
        prop_assert_eq!(&frame, &cobs(&enveloped(&content)));
        let received = receive(&mut Decoder::new(), &frame);
        prop_assert_eq!(received, [Ok((sequence, content[2..].to_vec()))]);
    }

    /// Noise is never a message, and at most one good frame after it is lost.
    #[test]
    fn noise_is_survived(noise in prop::collection::vec(any::<u8>(), 0..200)) {
        let good = wire(1, &ToTarget::Status);
        let mut decoder = Decoder::new();
        let received = receive(&mut decoder, &noise);
        prop_assert!(received.iter().all(Result::is_err));
        receive(&mut decoder, &good);
        prop_assert_eq!(receive(&mut decoder, &good), [Ok((1, vec![1]))]);
    }

    /// Any change of a single byte is noticed.
    #[test]
    fn a_changed_byte_is_noticed(at in 0usize..20, by in 1u8..) {
        let message = ToTarget::PathLine {
            index: 3, x: 70_000, y: -1, heading: i32::MIN, length: 1,
        };
        let mut frame = wire(9, &message);
        let at = at % (frame.len() - 1);
        frame[at] ^= by;
        prop_assert!(receive(&mut Decoder::new(), &frame).iter().all(Result::is_err));
    }
}

// ---- readings ----

fn reading() -> impl Strategy<Value = RangeReading> {
    let fault = prop_oneof![
        Just(Fault::NeverSeen),
        Just(Fault::Timeout),
        Just(Fault::Bus),
        Just(Fault::OutOfRange),
        Just(Fault::Stale),
    ];
    let range = prop_oneof![
        metres().prop_map(Range::Echo),
        Just(Range::Clear),
        fault.prop_map(Range::Invalid),
    ];
    let age = prop_oneof![Just(0), any::<i32>()].prop_map(Seconds::from_bits);
    (range, age).prop_map(|(range, age)| RangeReading { range, age })
}

proptest! {
    #![proptest_config(config(1_000))]

    #[test]
    fn a_ring_survives_its_frames(ring in prop::collection::vec(reading(), 1..=64)) {
        let (mut rest, mut back) = (ring.as_slice(), Vec::new());
        while !rest.is_empty() {
            let mut room = [0; MAX_READINGS];
            let (readings, count) = Readings::pack(rest, &mut room);
            prop_assert!(count >= rest.len().min(4));
            let ranges = ToTarget::Ranges { scan: 255, first: back.len() as u8, readings };
            let frame = wire(0, &ranges);
            let mut decoder = Decoder::new();
            let sent = frame.iter().find_map(|byte| match decoder.push(*byte) {
                Some(Ok(_)) => Some(()),
                _ => None,
            });
            prop_assert!(sent.is_some());
            back.extend(readings.iter().map(Option::unwrap));
            rest = &rest[count..];
        }
        prop_assert_eq!(back, ring);
    }
}

/// Readings that are none stop the list, once.
#[test]
fn what_is_no_reading_ends_the_readings() {
    let message = [12, 1, 0, 4, 1, 0, 9, 1];
    let frame = frame::Frame {
        sequence: 0,
        check: 0,
        message: &message,
    };
    let Some(ToTarget::Ranges { readings, .. }) = frame.parse() else {
        panic!("not understood");
    };
    let clear = RangeReading::fresh(Range::Clear);
    assert_eq!(readings.iter().collect::<Vec<_>>(), [Some(clear), None]);
}

// ---- settings ----

/// A setting outside the table would be one that no desktop can see. Adding a field breaks this pattern: give it an id,
/// and the table its row.
#[test]
fn every_setting_has_an_id() {
    let params = presets::small_robot::<2>();
    #[rustfmt::skip]
    let Params {
        body: Body { radius: _, track: _, metres_per_count: _ },
        limits: Limits { speed: _, yaw_rate: _, acceleration: _, yaw_acceleration: _, wheel_speed: _ },
        period: _, latency: _, integrator: _,
        ring: RingGeometry { mounts, closed: _, max_range: _, max_age: _, gap: _, radius: [_, _], residual: _ },
        follower: Follower {
            law: _, tables: _, speed_axis: _, distance_scale: _, deflection_rate: _, approach_gain: _,
            approach_angle: _, feed_forward_band: _, lateral_acceleration: _, corner_speed: _, reach: _,
            arrival: _, end_radius: _,
        },
        avoider: Avoider { tables: _, speed_input: _, range: _, margin: _, deflection_rate: _, overshoot: _ },
        supervisor: Supervisor { enter: _, exit: _, dwell: _, clear: _, tie: _, same: _, patience: _ },
        guard: Guard { margin: _, braking: _ },
    } = params;
    let [Mount { pose: _, width: _ }, _] = mounts.into_array().unwrap();
    assert_eq!(settings::SETTINGS.len(), 3 + 5 + 3 + 7 + 13 + 6 + 7 + 2);
}

/// Each id moves one value, its own, and takes every value that its format has.
#[test]
fn settings_are_read_and_written_by_id() {
    let fresh = presets::small_robot::<3>();
    let mut params = fresh.clone();
    let ids: Vec<_> = settings::list(3).map(|setting| setting.id).collect();
    assert_eq!(ids.len(), settings::SETTINGS.len() + 1 + 12);
    assert!(ids.is_sorted_by(|a, b| a < b));
    let all = |params: &Params<3>| -> Vec<i32> {
        ids.iter()
            .map(|id| settings::get(params, *id).unwrap())
            .collect()
    };
    let before = all(&params);
    for (place, setting) in settings::list(3).enumerate() {
        if setting.id == settings::MOUNTS {
            continue;
        }
        let old = before[place];
        let (values, bad) = match setting.format {
            Format::Choice(names) => ((0..names.len() as i32).collect(), [-1, names.len() as i32]),
            Format::Whole(most) => (vec![0, i32::from(most)], [-1, i32::from(most) + 1]),
            _ => (vec![i32::MIN, -1, 0, 1, i32::MAX], [0; 2]),
        };
        for raw in values {
            assert_eq!(
                settings::set(&mut params, setting.id, raw),
                Ok(()),
                "{}",
                setting.name
            );
            let mut expected = before.clone();
            expected[place] = raw;
            assert_eq!(all(&params), expected, "{}", setting.name);
        }
        for raw in bad.into_iter().filter(|raw| *raw != 0) {
            let refused = settings::set(&mut params, setting.id, raw);
            assert_eq!(refused, Err(SetError::NotAllowed), "{}", setting.name);
        }
        settings::set(&mut params, setting.id, old).unwrap();
        assert_eq!(params, fresh, "{}", setting.name);
    }
    for id in [0, 4, 255, settings::MOUNTS + 13, u16::MAX] {
        assert_eq!(settings::get(&params, id), None);
        assert_eq!(settings::set(&mut params, id, 0), Err(SetError::UnknownId));
    }
}

#[test]
fn sensors_are_mounted_by_number() {
    let mut params = presets::small_robot::<3>();
    assert_eq!(settings::get(&params, settings::MOUNTS), Some(3));
    settings::set(&mut params, settings::MOUNTS, 1).unwrap();
    assert_eq!(params.ring.mounts.len(), 1);
    assert_eq!(settings::get(&params, settings::MOUNTS + 5), None);
    settings::set(&mut params, settings::MOUNTS, 2).unwrap();
    assert_eq!(params.ring.mounts.get(1), Some(&Mount::default()));
    settings::set(&mut params, settings::MOUNTS + 5 + 2, 99).unwrap();
    assert_eq!(params.ring.mounts[1].pose.heading, Angle::from_bits(99));
    for raw in [-1, 4] {
        let refused = settings::set(&mut params, settings::MOUNTS, raw);
        assert_eq!(refused, Err(SetError::NotAllowed));
    }
}

/// Whatever [`Params::check`] objects to has an id: a desktop can say which setting it was.
#[test]
fn a_refused_setting_has_an_id() {
    let mut named = BTreeSet::new();
    for setting in settings::list(2) {
        for raw in [i32::MIN, -1, 0, i32::MAX] {
            let mut params = presets::small_robot::<2>();
            if settings::set(&mut params, setting.id, raw).is_err() {
                continue;
            }
            if let Err(error) = params.check() {
                let id = settings::id_of(error.field);
                named.insert(error.field);
                assert!(id.is_some(), "{} has no id", error.field);
            }
        }
    }
    assert!(named.len() > 30, "{named:?}");
    assert_eq!(settings::id_of("ring.radius"), Some(34));
    assert_eq!(
        settings::id_of("supervisor.enter, supervisor.exit"),
        Some(70)
    );
    assert_eq!(settings::id_of("body"), None);
}
