//! Ground that the robot has driven over or looked at. Backward it sees nothing: where it never looked it must not back.

use super::footprint::Outline;
use super::mark::Mark;
use super::sensors::Eyes;
use super::steps::{Bearing, Steps, Vector};
use crate::geometry::Pose;
use crate::units::Angle;

/// The most poses: 1.6 m of way, or 240° of turning; a pose near a known one is not noted again.
const POSES: usize = 8;

/// A pose from which it looked around.
#[derive(Clone, Copy, Debug)]
struct Stand {
    at: Mark,
    heading: Angle,
}

/// The last poses, some way or turn apart, in the order in which they were first stood at.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownGround {
    stands: [Stand; POSES],
    /// Index of the newest.
    newest: u8,
    count: u8,
}

impl KnownGround {
    /// None: it has not looked yet.
    pub const fn new() -> Self {
        Self {
            stands: [const {
                Stand {
                    at: Mark::ORIGIN,
                    heading: Angle::ZERO,
                }
            }; POSES],
            newest: 0,
            count: 0,
        }
    }

    /// Notes a tick's pose.
    pub fn follow(&mut self, pose: Pose) {
        const APART: Steps = Steps::lit("0.2");
        const TURNED: Angle = Angle::deg("30");
        let at = Mark::of(pose.at);
        let stood = self.newest_first().any(|stand| {
            at.to(stand.at).norm_squared() <= const { APART.squared() }
                && (pose.heading - stand.heading).abs().bits() <= TURNED.bits()
        });
        if stood {
            return;
        }
        self.newest = self.newest.wrapping_add(1) % POSES as u8;
        if let Some(next) = self.stands.get_mut(usize::from(self.newest)) {
            *next = Stand {
                at,
                heading: pose.heading,
            };
        }
        self.count = self.count.saturating_add(1).min(POSES as u8);
    }

    /// Whether the rear edge of a robot at this pose, both ends and the middle, is known: each of the three was under the body
    /// or in the view of a sensor that is not `dead` from one of the poses. Whether something hid it there is not asked: it stood
    /// nearer, and a point of it is remembered.
    pub fn has_rear<const N: usize>(
        &self,
        eyes: &Eyes<N>,
        dead: u32,
        outline: &Outline,
        pose: Pose,
    ) -> bool {
        let at = Mark::of(pose.at);
        let forward = Bearing::of(pose.heading);
        let across = outline.half_width;
        let rear =
            [across, Steps::ZERO, -across].map(|y| Vector::new(-outline.rear, y).turned(forward));
        let mut unknown = 0b111u32;
        for stand in self.newest_first() {
            let heading = Bearing::of(stand.heading);
            let away = stand.at.to(at);
            for (bit, place) in (0..3u32).zip(&rear) {
                let place = (away + *place).in_frame(heading);
                if unknown >> bit & 1 == 1
                    && (outline.clearance_at_least(place) <= Steps::ZERO || eyes.see(dead, place))
                {
                    unknown &= !(1 << bit);
                }
            }
            if unknown == 0 {
                return true;
            }
        }
        false
    }

    fn newest_first(&self) -> impl Iterator<Item = &Stand> {
        (0..self.count).filter_map(|back| {
            let index = self.newest.wrapping_sub(back) % POSES as u8;
            self.stands.get(usize::from(index))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{KnownGround, POSES};
    use crate::geometry::{Point, Pose};
    use crate::navigate::footprint::{Footprint, Outline};
    use crate::navigate::sensors::{Eyes, RangeSet};
    use crate::units::{Angle, Metres, Seconds};
    use fixed::types::I16F16;

    /// Half a metre long, 0.4 m wide; twelve cones over 270°.
    fn robot() -> (Outline, Eyes<12>) {
        let footprint = Footprint::Rectangle {
            front: Metres::lit("0.25"),
            rear: Metres::lit("0.25"),
            half_width: Metres::lit("0.2"),
        };
        let set = RangeSet::sectors(
            Point::default(),
            Angle::deg("-90"),
            Metres::lit("4"),
            Seconds::lit("0.2"),
        );
        (footprint.outline(), Eyes::new(&set, I16F16::ONE))
    }

    fn at(x: i32, heading: Angle) -> Pose {
        // Centimetres.
        Pose::new(
            Point::new(Metres::from_bits(x * 16384 / 25), Metres::ZERO),
            heading,
        )
    }

    /// How far behind the place x, cm, the ground is known to one that looks along x there.
    fn known_behind(ground: &KnownGround, x: i32) -> i32 {
        let (outline, eyes) = robot();
        (1..200)
            .find(|back| !ground.has_rear(&eyes, 0, &outline, at(x - back, Angle::ZERO)))
            .map_or(200, |back| back - 1)
    }

    #[test]
    fn nothing_is_known_behind_one_that_has_not_moved() {
        let mut ground = KnownGround::new();
        assert_eq!(known_behind(&ground, 0), 0);
        ground.follow(at(0, Angle::ZERO));
        assert_eq!(known_behind(&ground, 0), 0);
    }

    #[test]
    fn who_drove_knows_the_way_back_to_where_he_began() {
        let mut ground = KnownGround::new();
        for x in 0..=100 {
            ground.follow(at(x, Angle::ZERO));
            let known = known_behind(&ground, x);
            assert!((x - 1..=x).contains(&known), "{x}: {known}");
        }
    }

    #[test]
    fn who_goes_to_and_fro_does_not_forget_where_he_began() {
        let mut ground = KnownGround::new();
        for x in (0..=100).chain((0..10).flat_map(|_| (50..100).rev().chain(50..100))) {
            ground.follow(at(x, Angle::ZERO));
        }
        let known = known_behind(&ground, 99);
        assert!((98..=99).contains(&known), "{known}");
    }

    #[test]
    fn who_turned_around_knows_what_lies_behind() {
        let mut ground = KnownGround::new();
        for thirty_second in 0..=16 {
            ground.follow(at(0, Angle::from_bits(thirty_second << 27)));
        }
        assert_eq!(known_behind(&ground, 0), 200);
    }

    #[test]
    fn what_lies_long_behind_is_forgotten() {
        let mut ground = KnownGround::new();
        for x in 0..=1000 {
            ground.follow(at(x, Angle::ZERO));
        }
        let known = known_behind(&ground, 1000);
        assert!((140..=20 * POSES as i32).contains(&known), "{known}");
    }
}
