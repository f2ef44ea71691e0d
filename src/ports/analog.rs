//! Analog distance sensors: voltage to distance by a table, in integers.

use super::{Fault, Range};
use crate::integer::ratio;
use crate::units::Metres;

/// An analog input: embedded-hal 1.0 has no trait for it.
pub trait AnalogIn {
    /// The voltage now in millivolts, or why there is none. One conversion, some microseconds; a mean of a few is
    /// welcome, these sensors are noisy.
    fn millivolts(&mut self) -> Result<u16, Fault>;
}

/// Voltage against distance: points of (mV, mm), nearest first, between which a straight line is drawn.
///
/// Outside the table nothing is guessed. A voltage past the farthest point is [`Range::Clear`], one past the nearest
/// point [`Fault::OutOfRange`].
///
/// Distances rise and voltages all fall or all rise from point to point: any other table does not compile.
///
/// ```
/// use fuzzypilot::ports::{Range, analog::DistanceTable};
/// use fuzzypilot::units::Metres;
///
/// static MINE: DistanceTable<3> = DistanceTable::new([(2400, 100), (1200, 200), (400, 800)]);
/// assert_eq!(MINE.range(1800), Range::Echo(Metres::lit("0.15")));
/// assert_eq!(MINE.range(300), Range::Clear);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistanceTable<const N: usize> {
    points: [(u16, u16); N],
}

impl<const N: usize> DistanceTable<N> {
    /// Checks the points; evaluate it in a `const` or `static`, so that a wrong table does not compile.
    pub const fn new(points: [(u16, u16); N]) -> Self {
        assert!(N >= 2, "a distance table has at least two points");
        let falls = points[0].0 > points[N - 1].0;
        let mut i = 1;
        while i < N {
            let (near, far) = (points[i - 1], points[i]);
            assert!(
                near.1 < far.1,
                "the distances of a table rise from point to point"
            );
            assert!(
                near.0 != far.0 && (near.0 > far.0) == falls,
                "the voltages of a table all fall or all rise from point to point"
            );
            i += 1;
        }
        Self { points }
    }

    /// What a voltage means.
    pub fn range(&self, millivolts: u16) -> Range {
        let (Some(&nearest), Some(&farthest)) = (self.points.first(), self.points.last()) else {
            return Range::Invalid(Fault::OutOfRange);
        };
        // Turned so that voltages fall with distance.
        let falls = nearest.0 > farthest.0;
        let turned = |v: u16| if falls { v } else { !v };
        let seen = turned(millivolts);
        if seen > turned(nearest.0) {
            return Range::Invalid(Fault::OutOfRange);
        }
        for pair in self.points.windows(2) {
            if let &[(v_near, near), (v_far, far)] = pair
                && seen >= turned(v_far)
            {
                let below = i32::from(turned(v_near)).wrapping_sub(seen.into());
                let step = bits(far).wrapping_sub(bits(near));
                let on = ratio(step, below, v_near.abs_diff(v_far).into());
                return Range::Echo(Metres::from_bits(bits(near).wrapping_add(on)));
            }
        }
        Range::Clear
    }
}

/// Millimetres in steps of [`Metres`], rounded: at most 65.535 m.
const fn bits(millimetres: u16) -> i32 {
    ((millimetres as i32).wrapping_mul(8192).wrapping_add(62)) / 125
}

/// A sensor on an analog input.
#[derive(Clone, Debug)]
pub struct AnalogRange<A, const N: usize> {
    input: A,
    table: &'static DistanceTable<N>,
    connected: u16,
}

impl<A: AnalogIn, const N: usize> AnalogRange<A, N> {
    /// With its table. Voltages below `connected` mV are read as a broken wire, [`Fault::Bus`]: find out what your sensor
    /// gives with nothing in view and pass half of it. With 0 a broken wire that hangs low reads as clear.
    pub fn new(input: A, table: &'static DistanceTable<N>, connected: u16) -> Self {
        Self {
            input,
            table,
            connected,
        }
    }

    /// One reading.
    pub fn read(&mut self) -> Range {
        match self.input.millivolts() {
            Err(fault) => Range::Invalid(fault),
            Ok(millivolts) if millivolts < self.connected => Range::Invalid(Fault::Bus),
            Ok(millivolts) => self.table.range(millivolts),
        }
    }
}

/// Sharp GP2Y0A21YK0F, 100 to 800 mm, at 5 V.
///
/// Ends from the datasheet's table (OP13008EN: 0.4 V at 800 mm, 1.9 V more at 100 mm, typical), the points between read
/// off its voltage curve for white paper, good to some 50 mV. Single sensors differ more: 0.25 to 0.55 V at 800 mm.
/// Measure yours for a better table.
///
/// **Nearer than about 80 mm the voltage falls again** and reads as farther away: mount the sensor at least 80 mm inside
/// the robot's rim. It measures every 38 ms (± 10), and needs 10 µF or more across its supply.
pub static GP2Y0A21: DistanceTable<11> = DistanceTable::new([
    (2300, 100),
    (1650, 150),
    (1300, 200),
    (1080, 250),
    (920, 300),
    (820, 350),
    (740, 400),
    (600, 500),
    (510, 600),
    (450, 700),
    (400, 800),
]);
