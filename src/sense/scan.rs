//! One turn of the range ring: validity, segments, circles.

use super::circle::fit_circle;
use crate::geometry::{Point, root, square};
use crate::params::{MAX_BEAMS, RingGeometry};
use crate::ports::{Fault, Range, RangeReading};
use crate::signals::{MAX_OBSTACLES, Obstacle, Sensed};
use crate::units::{Angle, Metres, MetresPerSecond, Seconds, saturate};
use heapless::Vec;

/// Judges every reading, places the echoes in the body frame and makes circles of them.
///
/// An echo that is `age` old is drawn nearer by `speed · age`, the worst that the robot's own motion can have done.
/// Neighbouring echoes closer than `ring.gap` belong together; a silent or invalid sensor in between separates.
pub fn sense_ranges<const N: usize>(
    ring: &RingGeometry<N>,
    readings: &[RangeReading; N],
    speed: MetresPerSecond,
) -> Sensed {
    let mut sensed = Sensed {
        nearest: Metres::MAX,
        ..Sensed::default()
    };
    let mut segments: Vec<Segment, MAX_BEAMS> = Vec::new();
    let mut open: Option<Segment> = None;
    let (gap, mut nearest) = (square(ring.gap), u64::MAX);
    for (mount, reading) in ring.mounts.iter().zip(readings) {
        let range = judge(ring, reading, speed);
        if !matches!(range, Range::Invalid(_)) {
            sensed.valid = sensed.valid.saturating_add(1);
        }
        let Range::Echo(distance) = range else {
            segments.extend(open.take());
            continue;
        };
        let point = mount.pose.to_world(Point::new(distance, Metres::ZERO));
        nearest = nearest.min(point.norm_squared());
        let index = sensed.echoes.len();
        let joins = sensed
            .echoes
            .last()
            .is_some_and(|last| (point - *last).norm_squared() <= gap);
        if sensed.echoes.push(point).is_err()
            || sensed.spreads.push(spread(distance, mount.width)).is_err()
        {
            break;
        }
        open = match open.take() {
            Some(segment) if joins => Some(Segment {
                count: segment.count.saturating_add(1),
                ..segment
            }),
            finished => {
                segments.extend(finished);
                Some(Segment {
                    start: index,
                    count: 1,
                })
            }
        };
    }
    segments.extend(open);
    if nearest < u64::MAX {
        sensed.nearest = root(nearest);
    }
    if ring.closed {
        join_ends(ring, readings, &mut sensed, &mut segments);
    }
    for segment in &segments {
        let end = segment.start.saturating_add(segment.count);
        let pieces = (
            sensed.echoes.get(segment.start..end),
            sensed.spreads.get(segment.start..end),
        );
        if let (Some(points), Some(spreads)) = pieces {
            insert(&mut sensed.obstacles, circle_of(ring, points, spreads));
        }
    }
    sensed
}

/// Consecutive echoes of one obstacle.
#[derive(Clone, Copy)]
struct Segment {
    start: usize,
    count: usize,
}

fn judge<const N: usize>(
    ring: &RingGeometry<N>,
    reading: &RangeReading,
    speed: MetresPerSecond,
) -> Range {
    match reading.range {
        Range::Invalid(fault) => Range::Invalid(fault),
        _ if reading.age > ring.max_age => Range::Invalid(Fault::Stale),
        Range::Echo(distance) if distance < Metres::ZERO => Range::Invalid(Fault::OutOfRange),
        Range::Echo(distance) if distance > ring.max_range => Range::Clear,
        Range::Echo(distance) => Range::Echo(
            (distance - speed.abs().over(reading.age.max(Seconds::ZERO))).max(Metres::ZERO),
        ),
        Range::Clear => Range::Clear,
    }
}

/// In a closed ring the last segment may go on in the first: rotate the echoes so that it is one piece.
fn join_ends<const N: usize>(
    ring: &RingGeometry<N>,
    readings: &[RangeReading; N],
    sensed: &mut Sensed,
    segments: &mut Vec<Segment, MAX_BEAMS>,
) {
    let echo = |reading: Option<&RangeReading>| {
        reading.is_some_and(|r| matches!(judge(ring, r, MetresPerSecond::ZERO), Range::Echo(_)))
    };
    let (Some(first), Some(last)) = (sensed.echoes.first(), sensed.echoes.last()) else {
        return;
    };
    let meet = echo(readings.first())
        && echo(readings.last())
        && segments.len() >= 2
        && (*last - *first).norm_squared() <= square(ring.gap);
    if !meet {
        return;
    }
    let Some(tail) = segments.pop() else { return };
    sensed.echoes.rotate_right(tail.count);
    sensed.spreads.rotate_right(tail.count);
    for segment in segments.iter_mut() {
        segment.start = segment.start.saturating_add(tail.count);
    }
    if let Some(head) = segments.first_mut() {
        head.start = 0;
        head.count = head.count.saturating_add(tail.count);
    }
}

/// The circle behind a segment.
///
/// A fit is believed with at least [`ENOUGH`] echoes, a radius and residual within the ring's bounds, and a sagitta of
/// the arc seen that is not lost in that residual (a flatter arc says nothing about its radius). Otherwise the
/// disc that can have made the echoes stands in: as wide as they are, and to either side half a beam's spacing or half a
/// cone's width, whichever is more; its surface through the nearest.
fn circle_of<const N: usize>(
    ring: &RingGeometry<N>,
    points: &[Point],
    spreads: &[Metres],
) -> Obstacle {
    let [least, most] = ring.radius;
    let echoes = u8::try_from(points.len()).unwrap_or(u8::MAX);
    let first = points.first().copied().unwrap_or_default();
    let last = points.last().copied().unwrap_or_default();
    let width = (last - first).norm();
    let nearest = root(points.iter().map(|p| p.norm_squared()).min().unwrap_or(0));
    // Between echoes lie count − 1 spaces; half of one to either side covers what the outermost beams just missed. A
    // single echo shows no space: there it is the ring's.
    let missed = match i32::from(echoes).checked_sub(1).filter(|n| *n > 0) {
        Some(spaces) => Metres::from_bits(width.bits().checked_div(spaces).unwrap_or(0) >> 1),
        None => spread(nearest, pitch(ring)),
    };
    let cone = spreads.iter().copied().max().unwrap_or(Metres::ZERO);
    let half_width = Metres::from_bits(width.bits() >> 1) + missed.max(cone);
    if points.len() >= ENOUGH
        && let Some(fit) = fit_circle(points)
        && fit.radius >= least
        && fit.radius <= most
        && sagitta(half_width, fit.radius) >= ring.residual
        && fit.residual <= ring.residual
        && points
            .iter()
            .any(|p| p.norm_squared() < fit.centre.norm_squared())
    {
        return Obstacle {
            centre: fit.centre,
            radius: fit.radius,
            residual: fit.residual,
            echoes,
        };
    }
    let radius = half_width.max(least).min(most);
    Obstacle {
        centre: Point::polar(nearest + radius, (first + last).direction()),
        radius,
        residual: ring.residual,
        echoes,
    }
}

/// Half the width that an angle spans at `distance`.
fn spread(distance: Metres, angle: Angle) -> Metres {
    if angle == Angle::ZERO {
        return Metres::ZERO;
    }
    let half = Angle::from_bits(angle.bits() >> 1).limit(Angle::QUARTER);
    Point::polar(distance, half).y.abs()
}

/// Angle between two neighbouring sensors, from the first two; none in a ring of one.
fn pitch<const N: usize>(ring: &RingGeometry<N>) -> Angle {
    match ring.mounts.as_slice() {
        [first, second, ..] => (second.pose.heading - first.pose.heading).abs(),
        _ => Angle::ZERO,
    }
}

/// Height of an arc of `radius` over its chord, h²/2r: exact enough to tell an arc from a line.
fn sagitta(half_chord: Metres, radius: Metres) -> Metres {
    let square = i64::from(half_chord.bits()).pow(2);
    let twice = i64::from(radius.bits()).saturating_mul(2);
    Metres::from_bits(square.checked_div(twice).map_or(0, saturate))
}

/// Echoes from which a fit is believed: with fewer, a centimetre of noise doubles the radius.
const ENOUGH: usize = 5;

/// Keeps the list sorted by free distance and, when full, drops the farthest.
fn insert(obstacles: &mut Vec<Obstacle, MAX_OBSTACLES>, new: Obstacle) {
    let key = |o: &Obstacle| o.centre.norm() - o.radius;
    let place = obstacles.iter().position(|o| key(o) > key(&new));
    if obstacles.is_full() {
        if place.is_none() {
            return;
        }
        obstacles.pop();
    }
    let place = place.unwrap_or(obstacles.len()).min(obstacles.len());
    if obstacles.insert(place, new).is_err() {
        // Unreachable: there is room and the place is inside.
    }
}
