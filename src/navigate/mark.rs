//! Places where the robot was, in 32 bits each.

use super::steps::{Steps, Vector};
use crate::geometry::Point;

/// A place of the world in steps, modulo 16 m: enough for a place that is known to be near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mark {
    x: i16,
    y: i16,
}

impl Mark {
    pub const ORIGIN: Self = Self { x: 0, y: 0 };

    /// The step's place next below.
    pub const fn of(place: Point) -> Self {
        /// Fractional bits that [`Metres`](crate::units::Metres) have more than [`Steps`].
        const FINER: u32 = 4;
        Self {
            x: (place.x.bits() >> FINER) as i16,
            y: (place.y.bits() >> FINER) as i16,
        }
    }

    /// From here to the place, along the world's axes; what is more than 8 m away seems nearer.
    pub fn to(self, place: Self) -> Vector {
        let between = |from: i16, to: i16| Steps::from_bits(to.wrapping_sub(from).into());
        Vector::new(between(self.x, place.x), between(self.y, place.y))
    }
}

#[cfg(test)]
mod tests {
    use super::Mark;
    use crate::geometry::Point;
    use crate::navigate::steps::{Steps, Vector};
    use crate::units::Metres;

    #[test]
    fn what_is_near_lies_where_it_lies_wherever_in_the_world() {
        let off = Point::new(Metres::lit("-0.75"), Metres::lit("1.5"));
        for x in (-30_000_000..30_000_000).step_by(777_777) {
            let from = Point::new(Metres::from_bits(x), Metres::from_bits(-x / 3));
            let seen = Mark::of(from).to(Mark::of(from + off)) - Vector::of(off);
            let step = Steps::from_bits(1);
            assert!(seen.x.abs() <= step && seen.y.abs() <= step, "{from:?}");
        }
    }
}
