//! One turn of the range ring: validity, segments, circles.

use super::circle::fit_circle;
use crate::geometry::{Point, Rotation, square, times};
use crate::integer::{divide, saturate};
use crate::params::{MAX_BEAMS, RingGeometry};
use crate::ports::{Fault, Range, RangeReading};
use crate::signals::{MAX_OBSTACLES, Obstacle, Sensed};
use crate::units::{Angle, Metres, MetresPerSecond, Seconds};
use fixed::types::I2F30;
use heapless::Vec;

/// What of a ring's geometry every scan needs, worked out once.
#[derive(Clone, Debug)]
pub struct Beams<const N: usize> {
    /// Where each sensor looks.
    directions: [Rotation; N],
    /// Width of the first cone, and the sine of its half. All cones are alike as a rule.
    cone: (Angle, I2F30),
    /// Sine of half the angle between two sensors.
    space: I2F30,
}

impl<const N: usize> Default for Beams<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Beams<N> {
    /// Of no ring yet: see [`Beams::place`].
    pub const fn new() -> Self {
        Self {
            directions: [Rotation::NONE; N],
            cone: (Angle::ZERO, I2F30::ZERO),
            space: I2F30::ZERO,
        }
    }

    /// Takes over a ring's geometry. In place: a microcontroller's stack has no room for another ring.
    pub fn place(&mut self, ring: &RingGeometry<N>) {
        for (direction, mount) in self.directions.iter_mut().zip(&ring.mounts) {
            *direction = mount.pose.heading.rotation();
        }
        let width = ring.mounts.first().map_or(Angle::ZERO, |m| m.width);
        self.cone = (width, half_sine(width));
        self.space = half_sine(pitch(ring));
    }
}

/// Judges every reading, places the echoes in the body frame and makes circles of them; what `sensed` held is gone.
///
/// An echo that is `age` old is drawn nearer by `speed · age`, the worst that the robot's own motion can have done.
/// Neighbouring echoes closer than `ring.gap` belong together; a silent or invalid sensor in between separates. In a
/// closed ring the last sensor's neighbour is the first. Sensors past [`MAX_BEAMS`] are not looked at.
#[inline(never)]
pub fn sense_ranges<const N: usize>(
    ring: &RingGeometry<N>,
    beams: &Beams<N>,
    readings: &[RangeReading],
    speed: MetresPerSecond,
    sensed: &mut Sensed,
) {
    sensed.echoes.clear();
    sensed.spreads.clear();
    sensed.obstacles.clear();
    sensed.valid = 0;
    sensed.nearest = Metres::MAX;
    let mut finds = Finds {
        ring,
        space: beams.space,
        nearest: Vec::new(),
    };
    let gap = square(ring.gap);
    let near = |a: Point, b: Point| (a - b).norm_squared() <= gap;
    // The run at hand, and the one that began at the first sensor: in a closed ring the last may go on in it.
    let (mut open, mut first) = (None::<Run>, None::<Run>);
    for (index, reading) in readings.iter().enumerate().take(MAX_BEAMS) {
        let range = judge(ring, reading, speed);
        if !matches!(range, Range::Invalid(_)) {
            sensed.valid = sensed.valid.wrapping_add(1);
        }
        let Range::Echo(distance) = range else {
            if let Some(run) = &open {
                finds.close(run, &mut first, sensed);
                open = None;
            }
            continue;
        };
        let (mount, direction) = (ring.mounts.get(index), beams.directions.get(index));
        let (Some(mount), Some(direction)) = (mount, direction) else {
            break;
        };
        let point = mount.pose.at + direction.ahead(distance);
        // What sits at the centre needs no root.
        let from_centre = if mount.pose.at == Point::default() {
            distance
        } else {
            point.norm()
        };
        sensed.nearest = sensed.nearest.min(from_centre);
        let half_sine = match mount.width == beams.cone.0 {
            true => beams.cone.1,
            false => half_sine(mount.width),
        };
        let spread = times(distance, half_sine);
        let start = sensed.echoes.len();
        // Both have room for every beam that is looked at.
        let _ = sensed.echoes.push(point);
        let _ = sensed.spreads.push(spread);
        match &mut open {
            Some(run) if near(point, run.last) => {
                run.count = run.count.wrapping_add(1);
                run.last = point;
                run.nearest = run.nearest.min(from_centre);
                run.spread = run.spread.max(spread);
            }
            _ => {
                if let Some(run) = &open {
                    finds.close(run, &mut first, sensed);
                }
                open = Some(Run {
                    start,
                    count: 1,
                    at_begin: index == 0,
                    first: point,
                    last: point,
                    direction: *direction,
                    nearest: from_centre,
                    spread,
                });
            }
        }
    }
    match (&mut open, &first) {
        // The last run goes on in the first: one obstacle.
        (Some(last), Some(first)) if near(last.last, first.first) => {
            turn_round(&mut sensed.echoes, last.start);
            turn_round(&mut sensed.spreads, last.start);
            last.start = 0;
            last.count = last.count.wrapping_add(first.count);
            last.last = first.last;
            last.nearest = last.nearest.min(first.nearest);
            last.spread = last.spread.max(first.spread);
            finds.insert(last, sensed);
        }
        _ => {
            for run in [&open, &first].into_iter().flatten() {
                finds.insert(run, sensed);
            }
        }
    }
}

/// Brings what begins at `start` to the front, the order kept all round: by three reversals.
fn turn_round<T>(ring: &mut [T], start: usize) {
    if let Some((head, tail)) = ring.split_at_mut_checked(start) {
        head.reverse();
        tail.reverse();
        ring.reverse();
    }
}

/// Consecutive echoes of one obstacle.
#[derive(Clone, Copy)]
struct Run {
    /// Place of the first among the echoes.
    start: usize,
    count: usize,
    /// It begins at the first sensor.
    at_begin: bool,
    first: Point,
    last: Point,
    /// Where the first one's sensor looks.
    direction: Rotation,
    /// Least distance from the body's centre.
    nearest: Metres,
    /// Largest spread.
    spread: Metres,
}

/// The obstacles found so far, the one with the nearest echo first.
struct Finds<'a, const N: usize> {
    ring: &'a RingGeometry<N>,
    /// Sine of half the angle between two sensors.
    space: I2F30,
    /// Distance of the obstacles' nearest echoes from the body's centre.
    nearest: Vec<Metres, MAX_OBSTACLES>,
}

impl<const N: usize> Finds<'_, N> {
    /// A run ends. The one from a closed ring's first sensor waits for the last.
    fn close(&mut self, run: &Run, first: &mut Option<Run>, sensed: &mut Sensed) {
        if run.at_begin && self.ring.closed {
            *first = Some(*run);
        } else {
            self.insert(run, sensed);
        }
    }

    /// Puts the run's circle in its place; when the list is full, the farthest goes.
    fn insert(&mut self, run: &Run, sensed: &mut Sensed) {
        let (obstacles, nearest) = (&mut sensed.obstacles, &mut self.nearest);
        if obstacles.is_full() {
            if nearest.last().is_some_and(|last| *last <= run.nearest) {
                return;
            }
            obstacles.pop();
            nearest.pop();
        }
        let obstacle = circle_of(self.ring, self.space, run, &sensed.echoes);
        // There is room now. What lies farther moves up, and the new one is written once more only if something did.
        let _ = (obstacles.push(obstacle), nearest.push(run.nearest));
        let last = nearest.len().saturating_sub(1);
        let mut at = last;
        while let Some(before) = at.checked_sub(1)
            && let Some([left, right]) = nearest.get_mut(before..=at)
            && let Some([moved, place]) = obstacles.get_mut(before..=at)
            && *left > run.nearest
        {
            (*right, *place) = (*left, *moved);
            at = before;
        }
        if at < last
            && let (Some(place), Some(distance)) = (obstacles.get_mut(at), nearest.get_mut(at))
        {
            (*place, *distance) = (obstacle, run.nearest);
        }
    }
}

/// The circle behind a run of echoes.
///
/// A fit is believed with at least [`ENOUGH`] echoes, a radius and residual within the ring's bounds, and a sagitta
/// of the arc seen that is not lost in that residual (a flatter arc says nothing about its radius). Otherwise the
/// disc that can have made the echoes stands in: as wide as they are, and to either side half a beam's spacing or
/// half a cone's width, whichever is more; its surface through the nearest. A single echo's disc stands behind it
/// on its beam.
///
/// `space` is the sine of half the angle between two sensors.
fn circle_of<const N: usize>(
    ring: &RingGeometry<N>,
    space: I2F30,
    run: &Run,
    echoes: &[Point],
) -> Obstacle {
    let [least, most] = ring.radius;
    let disc = |centre, radius| Obstacle {
        centre,
        radius,
        residual: ring.residual,
        echoes: u8::try_from(run.count).unwrap_or(u8::MAX),
    };
    if run.count <= 1 {
        // One echo shows no space to its neighbours: there it is the ring's.
        let half_width = times(run.nearest, space).max(run.spread);
        let radius = half_width.max(least).min(most);
        let centre = run.first + run.direction.ahead(radius);
        return disc(centre, radius);
    }
    let width = (run.last - run.first).norm();
    // Between echoes lie count − 1 spaces; half of one to either side covers what the outermost beams just missed.
    let spaces = (run.count as i32).saturating_sub(1);
    let missed = Metres::from_bits(width.bits().checked_div(spaces).unwrap_or(0) >> 1);
    let half_width = Metres::from_bits(width.bits() >> 1) + missed.max(run.spread);
    let end = run.start.saturating_add(run.count);
    if run.count >= ENOUGH
        && let Some(fit) = echoes.get(run.start..end).and_then(fit_circle)
        && fit.radius >= least
        && fit.radius <= most
        && sagitta(half_width, fit.radius) >= ring.residual
        && fit.residual <= ring.residual
        && fit.centre.norm_squared() > square(run.nearest)
    {
        return Obstacle {
            residual: fit.residual,
            ..disc(fit.centre, fit.radius)
        };
    }
    let radius = half_width.max(least).min(most);
    let middle = run.first + run.last;
    let centre = stretched(middle, middle.norm(), run.nearest + radius);
    disc(centre, radius)
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
        Range::Echo(distance) if reading.age <= Seconds::ZERO => Range::Echo(distance),
        Range::Echo(distance) => {
            Range::Echo((distance - speed.abs().over(reading.age)).max(Metres::ZERO))
        }
        Range::Clear => Range::Clear,
    }
}

/// The point in the direction of `point`, which is `from` away, at the distance `to`; straight ahead for a point at the
/// centre.
fn stretched(point: Point, from: Metres, to: Metres) -> Point {
    let factor = divide(
        u64::from(to.bits().unsigned_abs()) << 16,
        from.bits().unsigned_abs(),
    );
    let Some(factor) = factor else {
        return Point::new(to, Metres::ZERO);
    };
    let times = |x: Metres| {
        let wide = i64::from(x.bits()).wrapping_mul(factor as i64);
        Metres::from_bits(saturate(wide.wrapping_add(1 << 15) >> 16))
    };
    Point::new(times(point.x), times(point.y))
}

/// Half the width, as a share of the distance, that an angle spans: the sine of its half.
fn half_sine(angle: Angle) -> I2F30 {
    let half = Angle::from_bits(angle.bits() >> 1)
        .limit(Angle::QUARTER)
        .abs();
    if half == Angle::ZERO {
        return I2F30::ZERO;
    }
    let (_, sine) = half.cos_sin();
    sine
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
    let halved = square(half_chord) >> 1;
    let height = divide(halved, radius.bits().unsigned_abs()).unwrap_or(0);
    Metres::from_bits(i32::try_from(height).unwrap_or(i32::MAX))
}

/// Echoes from which a fit is believed: with fewer, a centimetre of noise doubles the radius.
const ENOUGH: usize = 5;
