//! Range sensors of the navigator: 3 to 32 cones or beams wherever they are mounted, or a lidar's scan that is reduced on
//! the fly to the nearest echo of each of up to 32 sectors.

use super::steps::{Bearing, Steps, Vector};
use crate::integer::proper_fraction;
use crate::params::{Mount, ParamError};
use crate::ports::{Range, RangeReading};
use crate::units::{Angle, Metres, MetresPerSecond, Seconds};
use fixed::types::I16F16;
use heapless::Vec;

/// The fewest and the most sensors or sectors.
pub const SENSORS: core::ops::RangeInclusive<usize> = 3..=32;

/// The sensors' settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RangeSet<const N: usize> {
    /// Where each sits and looks, and its full opening angle: at most 90°, 0 for a beam. A lidar's sectors stand here as
    /// cones from the lidar's place: see [`RangeSet::sectors`].
    pub mounts: Vec<Mount, N>,
    /// Echoes from here on are not believed.
    pub max_range: Metres,
    /// Readings older than this are not used.
    pub max_age: Seconds,
}

impl<const N: usize> RangeSet<N> {
    /// `N` cones or sectors side by side at `at`, over `field` about straight ahead, each as wide as its share of it.
    pub fn sectors(
        at: crate::geometry::Point,
        field: Angle,
        max_range: Metres,
        max_age: Seconds,
    ) -> Self {
        // A full turn is the angle 0 here.
        let whole = match field.bits() {
            0 => 1u64 << 32,
            bits => u64::from(bits.cast_unsigned()),
        };
        let count = N.max(1) as u64;
        let width = whole / count;
        let mut mounts = Vec::new();
        for i in 0..count {
            let middle = width
                .wrapping_mul(i)
                .wrapping_add(width / 2)
                .wrapping_sub(whole / 2);
            let heading = Angle::from_bits(middle as i32);
            let width = Angle::from_bits(width.min(1 << 30) as i32);
            // There is room for all.
            let _ = mounts.push(Mount {
                pose: crate::geometry::Pose::new(at, heading),
                width,
            });
        }
        Self {
            mounts,
            max_range,
            max_age,
        }
    }

    /// Whether the navigator can use them.
    ///
    /// # Errors
    ///
    /// The first field that it cannot, and what is allowed.
    pub fn check(&self) -> Result<(), ParamError> {
        let near = |m: &Mount| {
            let at = m.pose.at;
            at.x.abs() <= const { Metres::lit("2") } && at.y.abs() <= const { Metres::lit("2") }
        };
        let narrow = |m: &Mount| (0..=Angle::QUARTER.bits()).contains(&m.width.bits());
        let checks = [
            (
                SENSORS.contains(&self.mounts.len()),
                "sensors.mounts",
                "3 to 32 sensors",
            ),
            (
                self.mounts.iter().all(near),
                "sensors.mounts.pose",
                "within 2 m of the axle's middle",
            ),
            (
                self.mounts.iter().all(narrow),
                "sensors.mounts.width",
                "0 to 90 degrees",
            ),
            (
                (const { Metres::lit("0.2") }..=const { Metres::lit("7.9") })
                    .contains(&self.max_range),
                "sensors.max_range",
                "0.2 to 7.9 m",
            ),
            (
                self.max_age >= Seconds::ZERO,
                "sensors.max_age",
                "0 or more",
            ),
        ];
        match checks.into_iter().find(|(ok, ..)| !ok) {
            Some((_, field, allowed)) => Err(ParamError { field, allowed }),
            None => Ok(()),
        }
    }
}

/// What a sensor or sector says this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Nothing that could be used: no echo, too old, a fault.
    Silent,
    /// An echo at this range, from anywhere across the cone.
    Across(Steps),
    /// An echo at this range and this angle from the sensor's axis.
    At(Steps, Angle),
}

impl Echo {
    /// The range, if there is an echo.
    pub fn range(self) -> Option<Steps> {
        match self {
            Self::Silent => None,
            Self::Across(range) | Self::At(range, _) => Some(range),
        }
    }
}

/// A sensor made ready for a tick's many questions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    pub at: Vector,
    pub axis: Bearing,
    pub heading: Angle,
    pub width: Angle,
    /// The part of the arc that an echo fills: an end of it and half the way there, from the axis to the left, and all
    /// of it, radians with 14 fractional bits.
    pub flank: Bearing,
    pub inner: Bearing,
    pub filled: i32,
    /// Direction of the place across its cone that is nearest to straight ahead, from the body's axis to its side; none if
    /// the sensor looks more than [`Eye::ASIDE`] aside.
    pub ahead: Option<Bearing>,
    /// Tangents of half the width and of 0.9 of that, 14 fractional bits.
    edge: i32,
    sure: i32,
}

/// How a place lies in a sensor's view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// Outside its cone.
    Outside,
    /// At its edge: noise in the heading decides.
    Edge,
    /// Inside.
    Sure,
}

/// The most sensors that are asked for a place on the way to one that sees it: a tick's turn is no more than a cone or two.
const ASKED: usize = 3;

impl Eye {
    /// A beam still sees this far to either side: what its own width and the robot's heading leave open.
    const BEAM: Angle = Angle::deg("1");

    /// Sensors that look farther aside than this do not tell what stands ahead.
    const ASIDE: Angle = Angle::deg("60");

    fn new(mount: &Mount, arc: I16F16) -> Self {
        let aside = mount.pose.heading.abs();
        let nearest = (aside - Angle::from_bits(mount.width.bits() >> 1))
            .bits()
            .max(0);
        let half = half_width(mount.width);
        let sure = Angle::from_bits((i64::from(half.bits()).wrapping_mul(9) / 10) as i32);
        let flank = Angle::from_bits(mount.width.bits() >> 1).scale(arc);
        Self {
            at: Vector::of(mount.pose.at),
            axis: Bearing::of(mount.pose.heading),
            flank: Bearing::of(flank),
            inner: Bearing::of(Angle::from_bits(flank.bits() >> 1)),
            filled: (flank.radians().to_bits() >> 1).clamp(0, 1 << 15),
            heading: mount.pose.heading,
            width: mount.width,
            ahead: (aside.bits() <= Self::ASIDE.bits())
                .then(|| Bearing::of(Angle::from_bits(nearest))),
            edge: tangent(half),
            sure: tangent(sure),
        }
    }

    /// How the place, seen from the sensor (body's directions), lies in its cone, and whether to the left of its axis.
    #[inline(always)]
    pub fn view(&self, from_here: Vector) -> (View, bool) {
        let place = from_here.in_frame(self.axis);
        let beside = place.y.abs();
        // A tangent is at most one: the product fits.
        let view = if place.x <= Steps::ZERO || beside > place.x.share(self.edge) {
            View::Outside
        } else if beside > place.x.share(self.sure) {
            View::Edge
        } else {
            View::Sure
        };
        (view, place.y > Steps::ZERO)
    }
}

/// Half of a sensor's width: what it sees to either side of its axis.
fn half_width(width: Angle) -> Angle {
    let half = Angle::from_bits(width.bits() >> 1).limit(const { Angle::deg("45") });
    if half.bits() < Eye::BEAM.bits() {
        Eye::BEAM
    } else {
        half
    }
}

/// Tangent of an angle up to 45°, 14 fractional bits.
fn tangent(angle: Angle) -> i32 {
    let (cos, sin) = angle.cos_sin();
    let [cos, sin] = [cos, sin].map(|c| c.to_bits().unsigned_abs());
    (proper_fraction(sin, cos) >> 10) as i32
}

/// The sensors made ready.
#[derive(Clone, Debug)]
pub struct Eyes<const N: usize> {
    eyes: Vec<Eye, N>,
    /// They all sit in one place, in the order of their directions: a place's direction tells whose cones it may be in.
    shared: bool,
    /// And their cones do not overlap.
    disjoint: bool,
    /// The sensor whose axis is nearest to the middle of each 64th of a turn.
    nearest: [u8; 64],
    max_range: Steps,
    max_age: Seconds,
}

impl<const N: usize> Eyes<N> {
    pub(super) fn new(set: &RangeSet<N>, arc: I16F16) -> Self {
        let mut eyes: Vec<Eye, N> = Vec::new();
        for mount in &set.mounts {
            // There is room: as many as mounts.
            let _ = eyes.push(Eye::new(mount, arc));
        }
        let first = eyes.first().map_or(Vector::default(), |eye| eye.at);
        let in_order = eyes
            .iter()
            .zip(eyes.iter().skip(1))
            .all(|(right, left)| (left.heading - right.heading).is_left());
        let shared = in_order && eyes.iter().all(|eye| eye.at == first);
        // A thousandth of a turn is noise.
        let apart = |a: &Eye, b: &Eye| {
            let half = |eye: &Eye| eye.width.bits() >> 1;
            let between = (a.heading - b.heading).abs().bits();
            between >= half(a).saturating_add(half(b)).saturating_sub(1 << 22)
        };
        let pairs = eyes.iter().enumerate();
        let disjoint = shared
            && pairs.clone().all(|(i, a)| {
                let others = eyes.iter().skip(i.wrapping_add(1));
                others.into_iter().all(|b| apart(a, b))
            });
        let mut nearest = [0; 64];
        for (sector, entry) in (0..64i32).zip(&mut nearest) {
            let middle = Angle::from_bits((sector << 26).wrapping_add(1 << 25));
            let off = |eye: &Eye| (eye.heading - middle).abs().bits();
            let best = (0..32u8).zip(&eyes).min_by_key(|(_, eye)| off(eye));
            *entry = best.map_or(0, |(index, _)| index);
        }
        Self {
            eyes,
            shared,
            disjoint,
            nearest,
            max_range: Steps::of(set.max_range),
            max_age: set.max_age,
        }
    }

    pub(super) fn as_slice(&self) -> &[Eye] {
        &self.eyes
    }

    /// Whether a place, body frame, is in a sensor's view; those with a bit in `dead` see nothing. Where all share a place the
    /// one whose axis is nearest to the place's direction is asked, and its neighbours.
    pub(super) fn see(&self, dead: u32, place: Vector) -> bool {
        let (first, last) = match self.eyes.first().filter(|_| self.shared) {
            Some(eye) => {
                let sector = ((place - eye.at).direction().bits().cast_unsigned() >> 26) as usize;
                let nearest = usize::from(self.nearest.get(sector).copied().unwrap_or(0));
                (nearest.saturating_sub(1), nearest.wrapping_add(2))
            }
            None => (0, N),
        };
        (first..last).any(|index| {
            self.eyes.get(index).is_some_and(|eye| {
                dead.wrapping_shr(index as u32) & 1 == 0
                    && eye.view(place - eye.at).0 != View::Outside
            })
        })
    }

    /// Tells which sensors see a place, body frame: calls `see` with the index of each, where the place lies as seen from it,
    /// and how, until it answers `false`; answers what was answered last, else `true`. Where all share a place the search
    /// begins at `hint`, the one that saw it last time, goes to the neighbour on the place's side, [`ASKED`] sensors in all, and
    /// leaves in `hint` where it came to; where no cones overlap, one is called at most, else both neighbours, too.
    #[inline(always)]
    pub(super) fn seeing(
        &self,
        place: Vector,
        hint: &mut u8,
        mut see: impl FnMut(usize, &Eye, Vector, View) -> bool,
    ) -> bool {
        let mut ask = |index: usize, eye: &Eye, from_eye: Vector| -> (bool, Option<bool>) {
            let (view, left) = eye.view(from_eye);
            match view {
                View::Outside => (left, None),
                _ => (left, Some(see(index, eye, from_eye, view))),
            }
        };
        let Some(eye) = self.eyes.first().filter(|_| self.shared) else {
            return (0..).zip(&self.eyes).all(|(index, eye)| {
                let (_, seen) = ask(index, eye, place - eye.at);
                seen.unwrap_or(true)
            });
        };
        let from_eye = place - eye.at;
        let count = self.eyes.len();
        let beside = |index: usize, left: bool| match (left, index.wrapping_add(1) < count) {
            (true, true) => index.wrapping_add(1),
            (true, false) => 0,
            (false, _) => index.checked_sub(1).unwrap_or(count.wrapping_sub(1)),
        };
        let mut index = usize::from(*hint);
        let mut before = usize::MAX;
        for _ in 0..ASKED {
            let Some(eye) = self.eyes.get(index) else {
                break;
            };
            let (left, seen) = ask(index, eye, from_eye);
            if let Some(seen) = seen {
                *hint = index as u8;
                if self.disjoint || !seen {
                    return seen;
                }
                return [true, false].into_iter().all(|left| {
                    let index = beside(index, left);
                    let seen = self
                        .eyes
                        .get(index)
                        .and_then(|eye| ask(index, eye, from_eye).1);
                    seen.unwrap_or(true)
                });
            }
            let next = beside(index, left);
            if next == before {
                // Between the two.
                return true;
            }
            (before, index) = (index, next);
        }
        *hint = index as u8;
        true
    }
}

/// The echoes of one tick.
#[derive(Clone, Debug)]
pub struct Echoes<const N: usize> {
    echoes: [Echo; N],
}

impl<const N: usize> Default for Echoes<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Echoes<N> {
    /// All sensors silent.
    pub const fn new() -> Self {
        Self {
            echoes: [Echo::Silent; N],
        }
    }

    pub(super) fn as_slice(&self) -> &[Echo] {
        &self.echoes
    }

    /// Those of the sensors that there are: there may be fewer than `N`.
    pub(super) fn of(&self, eyes: &Eyes<N>) -> &[Echo] {
        self.echoes.get(..eyes.eyes.len()).unwrap_or(&self.echoes)
    }

    /// Takes over the readings of single sensors, in the order of their mounts; what is missing is silent. A reading
    /// that is `age` old is taken nearer by `speed · age`, the worst that the robot's own motion can have done.
    pub fn take(&mut self, eyes: &Eyes<N>, readings: &[RangeReading], speed: MetresPerSecond) {
        self.echoes = [Echo::Silent; N];
        let speed = speed.abs();
        for (echo, (reading, eye)) in self.echoes.iter_mut().zip(readings.iter().zip(&eyes.eyes)) {
            let Range::Echo(distance) = reading.range else {
                continue;
            };
            if reading.age > eyes.max_age || distance < Metres::ZERO {
                continue;
            }
            let range = if reading.age > Seconds::ZERO {
                (distance - speed.over(reading.age)).max(Metres::ZERO)
            } else {
                distance
            };
            let range = Steps::of(range);
            if range < eyes.max_range {
                *echo = match eye.width {
                    Angle::ZERO => Echo::At(range, Angle::ZERO),
                    _ => Echo::Across(range),
                };
            }
        }
    }

    /// Takes over a lidar's scan, beam after beam: its direction from the first mount's place, body frame, and its range.
    /// Of each sector the nearest stays; beams outside all sectors and ranges of 0 or less (no return) are left out.
    pub fn reduce(&mut self, eyes: &Eyes<N>, beams: impl IntoIterator<Item = (Angle, Metres)>) {
        self.echoes = [Echo::Silent; N];
        for (direction, distance) in beams {
            let range = Steps::of(distance);
            if range <= Steps::ZERO || range >= eyes.max_range {
                continue;
            }
            let sector = (direction.bits().cast_unsigned() >> 26) as usize;
            let nearest = usize::from(eyes.nearest.get(sector).copied().unwrap_or(0));
            for index in nearest.saturating_sub(1)..nearest.saturating_add(2) {
                let (Some(eye), Some(echo)) = (eyes.eyes.get(index), self.echoes.get_mut(index))
                else {
                    continue;
                };
                let aside = direction - eye.heading;
                let within = aside.abs().bits() <= eye.width.bits() >> 1;
                if within && echo.range().is_none_or(|known| range < known) {
                    *echo = Echo::At(range, aside);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Eyes, RangeSet, View};
    use crate::geometry::{Point, Pose};
    use crate::navigate::steps::{Steps, Vector};
    use crate::units::{Angle, Metres, Seconds};
    use fixed::types::I16F16;

    fn set(field: &str, width: Option<&str>) -> RangeSet<12> {
        let field = Angle::deg(field);
        let (far, age) = (Metres::lit("4"), Seconds::lit("0.2"));
        let at = Point::new(Metres::lit("0.1"), Metres::lit("-0.05"));
        let mut set = RangeSet::sectors(at, field, far, age);
        for mount in &mut set.mounts {
            mount.width = width.map_or(mount.width, Angle::deg);
        }
        set
    }

    /// Whoever is asked of all sensors says the same as who goes from neighbour to neighbour.
    #[test]
    fn the_sensors_that_see_a_place_are_found_by_their_neighbours() {
        let mut apart = set("-90", None);
        if let Some(mount) = apart.mounts.first_mut() {
            mount.pose = Pose::new(Point::default(), mount.pose.heading);
        }
        let mut reversed = set("-90", None);
        reversed.mounts.reverse();
        // 270° side by side, with gaps, overlapping, all around, in another order, from two places.
        let sets = [
            (set("-90", None), true),
            (set("-90", Some("12")), true),
            (set("-90", Some("40")), false),
            (set("0", None), true),
            (reversed, true),
            (apart, false),
        ];
        for (number, (set, disjoint)) in sets.iter().enumerate() {
            set.check().unwrap();
            let eyes = Eyes::new(set, I16F16::ONE);
            for x in (-6000..=6000).step_by(233) {
                for y in (-6000..=6000).step_by(271) {
                    let place = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
                    let views = (0..12).filter(|i: &usize| {
                        let eye = &eyes.as_slice()[*i];
                        eye.view(place - eye.at).0 != View::Outside
                    });
                    let seen: heapless::Vec<usize, 12> = views.collect();
                    let mut asked = heapless::Vec::<usize, 12>::new();
                    let mut hint = 0;
                    // From the first one it takes a few ticks to come to the last.
                    for _ in 0..12 / 3 {
                        asked.clear();
                        eyes.seeing(place, &mut hint, |index, _, _, _| {
                            asked.push(index).unwrap();
                            true
                        });
                    }
                    assert_eq!(eyes.see(0, place), !seen.is_empty(), "{number}: {x}, {y}");
                    let all = seen.iter().fold(0, |bits, index| bits | 1 << index);
                    assert!(!eyes.see(all, place), "{number}: {x}, {y}");
                    asked.sort_unstable();
                    if *disjoint {
                        // At an edge two may see it: one is asked.
                        assert_eq!(asked.is_empty(), seen.is_empty(), "{number}: {x}, {y}");
                    } else {
                        // Four overlap at most; the three nearest are asked.
                        assert_eq!(asked.len(), seen.len().min(3), "{number}: {x}, {y}");
                    }
                    assert!(asked.iter().all(|index| seen.contains(index)));
                }
            }
        }
    }
}
