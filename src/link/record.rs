//! A [`TickRecord`] as bytes. Logs, frames and the bit-exactness digests of all architectures hold these, so two records
//! are equal if and only if their bytes are.
//!
//! Little endian, every field at a fixed, aligned place (the table in `docs/link.md`), raw integers of the types in
//! [`units`](crate::units). What a record does not have – an obstacle held while following, the fourth of two rules –
//! is zero, and [`decode`] refuses anything else there.

use crate::fuzzy::{ActiveRules, FiredRule, Grade};
use crate::geometry::{Point, Pose};
use crate::signals::{
    Controller, Decision, Guidance, Obstacle, RuleTrace, StopReason, TickRecord, Turn, Twist,
    WheelCommand,
};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond};
use heapless::Vec;

/// Length of an encoded record.
pub const RECORD_BYTES: usize = 156;

const AT_END: u8 = 1;
const MISSED_END: u8 = 2;
const GUARDED: u8 = 4;
const DRIVE_FAULT: u8 = 8;

/// The record's bytes.
pub fn encode(record: &TickRecord) -> [u8; RECORD_BYTES] {
    let mut bytes = [0; RECORD_BYTES];
    encode_into(record, &mut bytes);
    bytes
}

/// Writes the record's bytes where they are to stay.
pub fn encode_into(record: &TickRecord, bytes: &mut [u8; RECORD_BYTES]) {
    let mut to = Writer(bytes);
    let (decision, detail, held) = match record.decision {
        Decision::Follow => (0, 0, Obstacle::default()),
        Decision::Avoid { side, obstacle } => (1, side_tag(side), obstacle),
        Decision::Stop(reason) => (2, reason_tag(reason), Obstacle::default()),
    };
    let guidance = &record.guidance;
    let trace = &record.trace;
    let (rules, speed_rules) = (trace.rules.fired(), trace.speed_rules.fired());
    let flag = |set: bool, bit: u8| if set { bit } else { 0 };

    to.put(record.tick.to_le_bytes());
    to.put([
        decision,
        detail,
        flag(guidance.at_end, AT_END)
            | flag(guidance.missed_end, MISSED_END)
            | flag(record.guarded, GUARDED)
            | flag(record.drive_fault, DRIVE_FAULT),
        controller_tag(trace.controller),
    ]);
    to.point(held.centre);
    to.word(held.radius.bits());
    to.word(held.residual.bits());
    to.point(record.pose.at);
    to.word(record.pose.heading.bits());
    to.point(guidance.foot);
    to.word(guidance.cross_track.bits());
    to.word(guidance.distance.bits());
    to.word(guidance.tangent.bits());
    to.word(guidance.curvature.bits());
    to.word(guidance.heading_error.bits());
    to.word(guidance.progress.bits());
    to.word(guidance.remaining.bits());
    to.word(guidance.speed_limit.bits());
    to.put(guidance.laps.to_le_bytes());
    to.put([record.obstacles, record.valid_ranges]);
    to.word(record.nearest.bits());
    to.put([held.echoes, rules.len() as u8, speed_rules.len() as u8, 0]);
    to.word(trace.distance_input);
    to.word(trace.angle_input);
    to.put(trace.speed_output.to_le_bytes());
    to.put(trace.deflection_output.to_le_bytes());
    to.rules(&rules);
    to.rules(&speed_rules);
    to.twist(record.desired);
    to.twist(record.twist);
    to.word(record.wheels.left.bits());
    to.word(record.wheels.right.bits());
}

/// The record behind the bytes; `None` if no record encodes to them.
pub fn decode(bytes: &[u8; RECORD_BYTES]) -> Option<TickRecord> {
    let mut from = Reader(bytes);
    let tick = u32::from_le_bytes(from.take()?);
    let [decision, detail, flags, controller] = from.take()?;
    let mut held = Obstacle {
        centre: from.point()?,
        radius: from.metres()?,
        residual: from.metres()?,
        echoes: 0,
    };
    let pose = Pose::new(from.point()?, from.angle()?);
    let foot = from.point()?;
    let cross_track = from.metres()?;
    let distance = from.metres()?;
    let tangent = from.angle()?;
    let curvature = PerMetre::from_bits(from.word()?);
    let heading_error = from.angle()?;
    let progress = from.metres()?;
    let remaining = from.metres()?;
    let speed_limit = from.speed()?;
    let laps = u16::from_le_bytes(from.take()?);
    let [obstacles, valid_ranges] = from.take()?;
    let nearest = from.metres()?;
    let [echoes, rules, speed_rules, reserved] = from.take()?;
    held.echoes = echoes;
    let trace = RuleTrace {
        controller: controller_of(controller)?,
        distance_input: from.word()?,
        angle_input: from.word()?,
        speed_output: i16::from_le_bytes(from.take()?),
        deflection_output: i16::from_le_bytes(from.take()?),
        rules: from.rules(rules)?,
        speed_rules: from.rules(speed_rules)?,
    };
    let nothing_held = held == Obstacle::default();
    let decision = match decision {
        0 if detail == 0 && nothing_held => Decision::Follow,
        1 => Decision::Avoid {
            side: side_of(detail)?,
            obstacle: held,
        },
        2 if nothing_held => Decision::Stop(reason_of(detail)?),
        _ => return None,
    };
    if reserved != 0 || flags & !(AT_END | MISSED_END | GUARDED | DRIVE_FAULT) != 0 {
        return None;
    }
    Some(TickRecord {
        tick,
        decision,
        pose,
        guidance: Guidance {
            foot,
            cross_track,
            distance,
            tangent,
            curvature,
            heading_error,
            progress,
            remaining,
            laps,
            speed_limit,
            at_end: flags & AT_END != 0,
            missed_end: flags & MISSED_END != 0,
        },
        obstacles,
        valid_ranges,
        nearest,
        trace,
        desired: from.twist()?,
        twist: from.twist()?,
        wheels: WheelCommand {
            left: from.speed()?,
            right: from.speed()?,
        },
        guarded: flags & GUARDED != 0,
        drive_fault: flags & DRIVE_FAULT != 0,
    })
}

fn side_tag(side: Turn) -> u8 {
    match side {
        Turn::Left => 0,
        Turn::Right => 1,
    }
}

fn side_of(tag: u8) -> Option<Turn> {
    match tag {
        0 => Some(Turn::Left),
        1 => Some(Turn::Right),
        _ => None,
    }
}

fn reason_tag(reason: StopReason) -> u8 {
    match reason {
        StopReason::NoRanges => 0,
        StopReason::NoOdometry => 1,
        StopReason::PathEnd => 2,
        StopReason::PathMissed => 3,
    }
}

fn reason_of(tag: u8) -> Option<StopReason> {
    match tag {
        0 => Some(StopReason::NoRanges),
        1 => Some(StopReason::NoOdometry),
        2 => Some(StopReason::PathEnd),
        3 => Some(StopReason::PathMissed),
        _ => None,
    }
}

fn controller_tag(controller: Controller) -> u8 {
    match controller {
        Controller::None => 0,
        Controller::Fine => 1,
        Controller::Coarse => 2,
    }
}

fn controller_of(tag: u8) -> Option<Controller> {
    match tag {
        0 => Some(Controller::None),
        1 => Some(Controller::Fine),
        2 => Some(Controller::Coarse),
        _ => None,
    }
}

/// The room that is left. The tests write every field, and writing past the end would be seen there as a lost field.
struct Writer<'a>(&'a mut [u8]);

impl Writer<'_> {
    fn put<const K: usize>(&mut self, bytes: [u8; K]) {
        if let Some((place, rest)) = core::mem::take(&mut self.0).split_first_chunk_mut() {
            *place = bytes;
            self.0 = rest;
        }
    }

    fn word(&mut self, bits: i32) {
        self.put(bits.to_le_bytes());
    }

    fn point(&mut self, point: Point) {
        self.word(point.x.bits());
        self.word(point.y.bits());
    }

    fn twist(&mut self, twist: Twist) {
        self.word(twist.linear.bits());
        self.word(twist.angular.bits());
    }

    fn rules(&mut self, rules: &[FiredRule]) {
        for i in 0..4 {
            let rule = rules.get(i).copied().unwrap_or_default();
            self.put([rule.row, rule.col]);
            self.put(rule.degree.bits().to_le_bytes());
        }
    }
}

/// The bytes still to be read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const K: usize>(&mut self) -> Option<[u8; K]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    fn word(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    fn metres(&mut self) -> Option<Metres> {
        self.word().map(Metres::from_bits)
    }

    fn speed(&mut self) -> Option<MetresPerSecond> {
        self.word().map(MetresPerSecond::from_bits)
    }

    fn angle(&mut self) -> Option<Angle> {
        self.word().map(Angle::from_bits)
    }

    fn point(&mut self) -> Option<Point> {
        Some(Point::new(self.metres()?, self.metres()?))
    }

    fn twist(&mut self) -> Option<Twist> {
        Some(Twist {
            linear: self.speed()?,
            angular: RadiansPerSecond::from_bits(self.word()?),
        })
    }

    /// `count` rules at the front of four places, the others zero.
    fn rules(&mut self, count: u8) -> Option<ActiveRules> {
        let mut rules: Vec<FiredRule, 4> = Vec::new();
        for i in 0..4 {
            let [row, col] = self.take()?;
            let degree = u16::from_le_bytes(self.take()?);
            let rule = FiredRule {
                row,
                col,
                degree: Grade::from_bits(degree),
            };
            if rule.degree.bits() != degree {
                return None;
            }
            if i < count {
                rules.push(rule).ok()?;
            } else if rule != FiredRule::default() {
                return None;
            }
        }
        if usize::from(count) != rules.len() {
            return None;
        }
        ActiveRules::of_fired(&rules)
    }
}
