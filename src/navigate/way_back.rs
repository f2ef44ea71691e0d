//! The way that the body came: where it has driven nothing stands, unless it moves, so it is the surest way out.

use super::footprint::Outline;
use super::mark::Mark;
use super::near::Near;
use super::steps::{Bearing, Steps};
use super::trajectory::Trajectory;
use crate::geometry::Pose;
use crate::integer::{quotient, saturate};
use crate::units::{MetresPerSecond, PerMetre};

/// The most places: 2.4 m, or a little more, as they are noted once a tick.
const PLACES: usize = 16;

/// Places of the middle of the body on its way, the newest last; the oldest are forgotten.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayBack {
    places: [Mark; PLACES],
    /// Index of the newest.
    newest: u8,
    known: u8,
}

/// An arc back to a place of the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Retreat {
    pub curvature: PerMetre,
    /// Distance of the place, a little less than the arc.
    pub distance: Steps,
}

impl Retreat {
    /// How far it is free, and how often a point was looked at.
    pub fn free(&self, near: &Near, outline: &Outline) -> (Steps, u32) {
        /// The body has been there: what seems to stand nearer is doubtful.
        const MARGIN: Steps = Steps::lit("0.01");
        let mut way = Trajectory::new();
        let step = way.bend(self.curvature, true, self.distance);
        let free = way.free(near, outline, MARGIN, step);
        (free, way.looked)
    }
}

impl WayBack {
    /// Nowhere yet.
    pub const fn new() -> Self {
        Self {
            places: [Mark::ORIGIN; PLACES],
            newest: 0,
            known: 0,
        }
    }

    /// Notes a tick's place while the robot drives forward or turns; while it drives backward it forgets those that it has
    /// come back to.
    pub fn follow(&mut self, pose: Pose, driven: MetresPerSecond) {
        const SPACING: Steps = Steps::lit("0.15");
        /// A place that is hardly behind the middle any more is reached.
        const REACHED: Steps = Steps::lit("-0.03");
        if driven < MetresPerSecond::ZERO {
            let (at, forward) = (Mark::of(pose.at), Bearing::of(pose.heading));
            while let Some(last) = self.place(0)
                && at.to(last).in_frame(forward).x >= REACHED
            {
                self.newest = self.index(1);
                self.known = self.known.wrapping_sub(1);
            }
            return;
        }
        let at = Mark::of(pose.at);
        let noted = self
            .place(0)
            .is_some_and(|last| at.to(last).norm_squared() <= const { SPACING.squared() });
        if noted {
            return;
        }
        // The next one is the oldest of all.
        self.newest = self.index(PLACES as u8 - 1);
        if let Some(next) = self.places.get_mut(usize::from(self.newest)) {
            *next = at;
        }
        self.known = self.known.saturating_add(1).min(PLACES as u8);
    }

    /// The arc to the first place of the way that is 0.22 m away or more: less is driven before the next choice takes effect.
    /// None if there is none, if it is farther away than 0.5 m, not behind the robot, or so far aside that the arc would be
    /// tighter than 1/3 m.
    pub fn retreat(&self, pose: Pose) -> Option<Retreat> {
        const FAR_ENOUGH: Steps = Steps::lit("0.22");
        const TOO_FAR: Steps = Steps::lit("0.5");
        const BEHIND: Steps = Steps::lit("-0.05");
        const TIGHTEST: PerMetre = PerMetre::lit("3");
        let (at, forward) = (Mark::of(pose.at), Bearing::of(pose.heading));
        let mut places = (0..self.known)
            .filter_map(|back| self.place(back))
            .map(|place| at.to(place).in_frame(forward));
        let place = places.find(|place| place.norm_squared() >= const { FAR_ENOUGH.squared() })?;
        let squared = place.norm_squared();
        if squared > const { TOO_FAR.squared() } || place.x > BEHIND {
            return None;
        }
        // κ = 2y/(x² + y²): 12 and 24 fractional bits give 16.
        let doubled = i64::from(place.y.bits()) << 29;
        let curvature = quotient(doubled, squared as i32)
            .map_or(PerMetre::MAX, |wide| PerMetre::from_bits(saturate(wide)));
        (curvature.abs() <= TIGHTEST).then(|| Retreat {
            curvature,
            distance: place.norm(),
        })
    }

    /// The place so many before the newest.
    fn place(&self, back: u8) -> Option<Mark> {
        let index = (back < self.known).then(|| self.index(back))?;
        self.places.get(usize::from(index)).copied()
    }

    fn index(&self, back: u8) -> u8 {
        self.newest.wrapping_sub(back) % PLACES as u8
    }
}

#[cfg(test)]
mod tests {
    use super::{PLACES, WayBack};
    use crate::geometry::{Point, Pose};
    use crate::navigate::steps::Steps;
    use crate::units::{Angle, Metres, MetresPerSecond, PerMetre};

    const SPEED: MetresPerSecond = MetresPerSecond::lit("0.5");

    fn at(x: i32, y: i32, heading: Angle) -> Pose {
        // Millimetres.
        let [x, y] = [x, y].map(|mm| Metres::from_bits(mm * 8192 / 125));
        Pose::new(Point::new(x, y), heading)
    }

    /// Straight on along x, a place a centimetre.
    fn straight(centimetres: i32) -> WayBack {
        let mut way = WayBack::new();
        for x in 0..=centimetres {
            way.follow(at(10 * x, 0, Angle::ZERO), SPEED);
        }
        way
    }

    #[test]
    fn the_way_back_is_the_arc_that_was_driven() {
        let mut way = WayBack::new();
        let radius = Metres::lit("1");
        let mut last = Pose::default();
        for step in 0..60 {
            // Around (0, 1) to the left.
            let heading = Angle::from_bits(step << 23);
            let centre = Point::new(Metres::ZERO, radius);
            last = Pose::new(
                centre + Point::polar(radius, heading - Angle::deg("90")),
                heading,
            );
            way.follow(last, SPEED);
        }
        let back = way.retreat(last).unwrap();
        let off = back.curvature - PerMetre::lit("1");
        assert!(off.abs() < PerMetre::lit("0.02"), "{back:?}");
        assert!(back.distance >= Steps::lit("0.22") && back.distance < Steps::lit("0.38"));
    }

    #[test]
    fn what_it_has_come_back_to_is_forgotten() {
        let mut way = straight(40);
        for x in (0..=40).rev() {
            let here = at(10 * x, 0, Angle::ZERO);
            way.follow(here, -SPEED);
            match way.retreat(here) {
                Some(back) => assert!(x >= 22 && back.curvature == PerMetre::ZERO, "{x}: {back:?}"),
                None => assert!(x <= 26, "{x}"),
            }
        }
    }

    #[test]
    fn a_long_way_is_known_as_far_as_there_is_room() {
        let way = straight(300);
        assert_eq!(usize::from(way.known), PLACES);
        let back = way.retreat(at(3000, 0, Angle::ZERO)).unwrap();
        assert_eq!(back.curvature, PerMetre::ZERO);
    }

    #[test]
    fn who_has_turned_or_was_carried_away_knows_no_way_back() {
        let way = straight(40);
        assert!(way.retreat(at(400, 0, Angle::ZERO)).is_some());
        for pose in [
            at(400, 0, Angle::deg("90")),
            at(400, 0, Angle::deg("180")),
            at(400, 2000, Angle::ZERO),
            at(1400, 0, Angle::ZERO),
        ] {
            assert_eq!(way.retreat(pose), None, "{pose:?}");
        }
        assert_eq!(WayBack::new().retreat(Pose::default()), None);
    }
}
