//! One turn of the range ring: validity, segments, circles.

use super::circle::fit_circle;
use crate::geometry::{Point, root, square};
use crate::integer::saturate;
use crate::params::{MAX_BEAMS, RingGeometry};
use crate::ports::{Fault, Range, RangeReading};
use crate::signals::{MAX_OBSTACLES, Obstacle, Sensed};
use crate::units::{Angle, Metres, MetresPerSecond, Seconds};
use heapless::Vec;

/// Judges every reading, places the echoes in the body frame and makes circles of them; what `sensed` held is gone.
///
/// An echo that is `age` old is drawn nearer by `speed · age`, the worst that the robot's own motion can have done.
/// Neighbouring echoes closer than `ring.gap` belong together; a silent or invalid sensor in between separates. In a
/// closed ring the last sensor's neighbour is the first. Sensors past [`MAX_BEAMS`] are not looked at.
pub fn sense_ranges<const N: usize>(
    ring: &RingGeometry<N>,
    readings: &[RangeReading],
    speed: MetresPerSecond,
    sensed: &mut Sensed,
) {
    sensed.echoes.clear();
    sensed.spreads.clear();
    sensed.obstacles.clear();
    sensed.valid = 0;
    let gap = square(ring.gap);
    let near = |a: Point, b: Point| (a - b).norm_squared() <= gap;
    // Bit i: echo i goes on where the one before it ended.
    let mut joined = 0u64;
    let (mut nearest, mut before) = (u64::MAX, None);
    // Whether the first and the last sensor see an echo.
    let (mut start, mut ends) = (true, (false, false));
    for (mount, reading) in ring.mounts.iter().zip(readings).take(MAX_BEAMS) {
        let first = core::mem::take(&mut start);
        let range = judge(ring, reading, speed);
        if !matches!(range, Range::Invalid(_)) {
            sensed.valid = sensed.valid.saturating_add(1);
        }
        ends.1 = false;
        let Range::Echo(distance) = range else {
            before = None;
            continue;
        };
        let point = mount.pose.at + Point::polar(distance, mount.pose.heading);
        nearest = nearest.min(point.norm_squared());
        if before.is_some_and(|last| near(point, last)) {
            joined |= bit(sensed.echoes.len());
        }
        before = Some(point);
        ends = (ends.0 || first, true);
        // Both have room for every beam that is looked at.
        let _ = sensed.echoes.push(point);
        let _ = sensed.spreads.push(spread(distance, mount.width));
    }
    sensed.nearest = match nearest {
        u64::MAX => Metres::MAX,
        nearest => root(nearest),
    };
    let count = sensed.echoes.len();
    if let (true, (true, true), [first, .., last]) = (ring.closed, ends, sensed.echoes.as_slice())
        && near(*first, *last)
    {
        joined |= 1;
    }
    // A segment may go round the end of the list: begin where one begins.
    let start = joined.trailing_ones() as usize;
    let start = if start >= count { 0 } else { start };
    let mut keys = Vec::new();
    let mut from = start;
    for step in 1..=count {
        let to = start.saturating_add(step);
        let index = if to >= count {
            to.saturating_sub(count)
        } else {
            to
        };
        if step < count && joined & bit(index) != 0 {
            continue;
        }
        let obstacle = circle_of(ring, &Run::of(sensed, from, to));
        insert(&mut sensed.obstacles, &mut keys, obstacle);
        from = to;
    }
}

/// One bit for each echo.
const fn bit(index: usize) -> u64 {
    1u64.wrapping_shl(index as u32)
}

/// Consecutive echoes of one obstacle: up to the end of the list, and on from its beginning.
struct Run<'a> {
    points: [&'a [Point]; 2],
    spreads: [&'a [Metres]; 2],
}

impl<'a> Run<'a> {
    /// The echoes `from..to`, counted on past the end of the list.
    fn of(sensed: &'a Sensed, from: usize, to: usize) -> Self {
        let count = sensed.echoes.len();
        let (head, tail) = (from..to.min(count), ..to.saturating_sub(count));
        Self {
            points: [
                sensed.echoes.get(head.clone()).unwrap_or_default(),
                sensed.echoes.get(tail).unwrap_or_default(),
            ],
            spreads: [
                sensed.spreads.get(head).unwrap_or_default(),
                sensed.spreads.get(tail).unwrap_or_default(),
            ],
        }
    }

    fn points(&self) -> impl Iterator<Item = Point> + Clone {
        let [head, tail] = self.points;
        head.iter().chain(tail).copied()
    }

    fn spreads(&self) -> impl Iterator<Item = Metres> {
        let [head, tail] = self.spreads;
        head.iter().chain(tail).copied()
    }

    fn count(&self) -> usize {
        let [head, tail] = self.points;
        head.len().saturating_add(tail.len())
    }

    fn ends(&self) -> (Point, Point) {
        let [head, tail] = self.points;
        let first = head.first().or(tail.first());
        let last = tail.last().or(head.last());
        (
            first.copied().unwrap_or_default(),
            last.copied().unwrap_or_default(),
        )
    }
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

/// The circle behind a segment.
///
/// A fit is believed with at least [`ENOUGH`] echoes, a radius and residual within the ring's bounds, and a sagitta of
/// the arc seen that is not lost in that residual (a flatter arc says nothing about its radius). Otherwise the
/// disc that can have made the echoes stands in: as wide as they are, and to either side half a beam's spacing or half a
/// cone's width, whichever is more; its surface through the nearest.
fn circle_of<const N: usize>(ring: &RingGeometry<N>, run: &Run<'_>) -> Obstacle {
    let [least, most] = ring.radius;
    let echoes = u8::try_from(run.count()).unwrap_or(u8::MAX);
    let (first, last) = run.ends();
    let width = (last - first).norm();
    let nearest = root(run.points().map(Point::norm_squared).min().unwrap_or(0));
    // Between echoes lie count − 1 spaces; half of one to either side covers what the outermost beams just missed. A
    // single echo shows no space: there it is the ring's.
    let missed = match i32::from(echoes).checked_sub(1).filter(|n| *n > 0) {
        Some(spaces) => Metres::from_bits(width.bits().checked_div(spaces).unwrap_or(0) >> 1),
        None => spread(nearest, pitch(ring)),
    };
    let cone = run.spreads().max().unwrap_or(Metres::ZERO);
    let half_width = Metres::from_bits(width.bits() >> 1) + missed.max(cone);
    if run.count() >= ENOUGH
        && let Some(fit) = fit_circle(run.points())
        && fit.radius >= least
        && fit.radius <= most
        && sagitta(half_width, fit.radius) >= ring.residual
        && fit.residual <= ring.residual
        && run
            .points()
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

/// Keeps the list sorted by the distance of the surface, which `keys` holds, and drops the farthest when full.
fn insert(
    obstacles: &mut Vec<Obstacle, MAX_OBSTACLES>,
    keys: &mut Vec<Metres, MAX_OBSTACLES>,
    new: Obstacle,
) {
    let key = new.centre.norm() - new.radius;
    if obstacles.push(new).is_err() || keys.push(key).is_err() {
        let last = (obstacles.last_mut(), keys.last_mut());
        let (Some(obstacle), Some(farthest)) = last else {
            return;
        };
        if *farthest <= key {
            return;
        }
        (*obstacle, *farthest) = (new, key);
    }
    // Down to its place: neighbours swap while they are the wrong way round.
    let mut at = keys.len();
    while at >= 2 {
        at = at.saturating_sub(1);
        let pair = keys.get_mut(at.saturating_sub(1)..=at);
        let Some([left, right]) = pair else { return };
        if *left <= *right {
            return;
        }
        core::mem::swap(left, right);
        if let Some([left, right]) = obstacles.get_mut(at.saturating_sub(1)..=at) {
            core::mem::swap(left, right);
        }
    }
}
