//! The numbers that move.

use crate::si;
use fixed::traits::ToFixed;
use fuzzypilot::navigate::NavigatorParams;
use fuzzypilot::tables::clutter::Peaks;

/// The most sensors, or sectors of a lidar.
const SENSORS: usize = 32;

/// Settings whose rule tables can move, too.
#[derive(Clone, Debug)]
pub struct Tuned {
    params: NavigatorParams<SENSORS>,
    /// Peaks of the deflection, degrees.
    pub deflections: [f64; 5],
    /// Peaks of the speed, shares.
    pub speeds: [f64; 5],
}

impl Tuned {
    /// From a preset and the peaks of its tables.
    pub fn from_preset((params, peaks): (NavigatorParams<SENSORS>, Peaks)) -> Self {
        Self {
            params,
            deflections: peaks.deflection.map(f64::from),
            speeds: peaks.speed.map(f64::from),
        }
    }

    /// As the library takes them. Each call leaks some hundred bytes, for the library's tables live for ever.
    pub fn params(&self) -> NavigatorParams<SENSORS> {
        let peaks = Peaks {
            deflection: self.deflections.map(ToFixed::to_fixed),
            speed: self.speeds.map(ToFixed::to_fixed),
        };
        let mut params = self.params.clone();
        params.steer.tables = Box::leak(Box::new(peaks.tables()));
        params
    }
}

/// A number that moves.
#[derive(Debug)]
pub struct Knob {
    /// The field's name, below the settings.
    pub name: &'static str,
    /// Its least value…
    pub from: f64,
    /// …and its greatest.
    pub to: f64,
    /// Digits after the point; what is written is rounded to them.
    pub digits: usize,
    kind: Kind,
    get: fn(&Tuned) -> f64,
    set: fn(&mut Tuned, f64),
}

/// How a number is written in Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A length.
    Metres,
    /// A plain number.
    Number,
    /// Seconds.
    Seconds,
    /// A count.
    Count,
    /// A peak of a table.
    Peak,
}

impl Knob {
    /// Its value, in its own unit.
    pub fn get(&self, tuned: &Tuned) -> f64 {
        self.rounded((self.get)(tuned))
    }

    /// Sets it, rounded.
    pub fn set(&self, tuned: &mut Tuned, value: f64) {
        (self.set)(tuned, self.rounded(value));
    }

    fn rounded(&self, value: f64) -> f64 {
        let steps = 10f64.powi(self.digits as i32);
        (value * steps).round() / steps
    }

    pub(super) fn kind(&self) -> Kind {
        self.kind
    }
}

macro_rules! knob {
    (metres $a:ident . $b:ident, $from:literal to $to:literal) => {
        knob!(Metres, 4, si::from_metres, si::metres, $a.$b, $from, $to)
    };
    (number $a:ident . $b:ident, $from:literal to $to:literal) => {
        knob!(Number, 4, si::from_number, si::number, $a.$b, $from, $to)
    };
    (seconds $a:ident . $b:ident, $from:literal to $to:literal) => {
        knob!(Seconds, 4, si::from_seconds, si::seconds, $a.$b, $from, $to)
    };
    (count $a:ident . $b:ident, $from:literal to $to:literal) => {
        knob!(Count, 0, f64::from, |x| x as _, $a.$b, $from, $to)
    };
    ($kind:ident, $digits:literal, $get:expr, $set:expr, $a:ident . $b:ident, $from:literal, $to:literal) => {
        Knob {
            name: concat!(stringify!($a), ".", stringify!($b)),
            from: $from,
            to: $to,
            digits: $digits,
            kind: Kind::$kind,
            get: |tuned| ($get)(tuned.params.$a.$b),
            set: |tuned, x| tuned.params.$a.$b = ($set)(x),
        }
    };
    (peak $name:literal, $table:ident [$index:literal], $from:literal to $to:literal) => {
        Knob {
            name: $name,
            from: $from,
            to: $to,
            digits: if $to > 1.0 { 1 } else { 3 },
            kind: Kind::Peak,
            get: |tuned| tuned.$table[$index],
            set: |tuned, x| tuned.$table[$index] = x,
        }
    };
}

/// All that can move. The peaks' ranges do not meet, so that their order stays.
pub static KNOBS: [Knob; 43] = [
    knob!(metres memory.insert, 0.6 to 2.6),
    knob!(number memory.arc, 0.2 to 1.0),
    // Nearer than two deviations of its noise an echo disproves what is true.
    knob!(metres memory.disproof, 0.02 to 0.15),
    knob!(metres memory.support, 0.03 to 0.1),
    knob!(metres memory.nearer, 0.005 to 0.06),
    knob!(metres map.look, 1.0 to 1.8),
    knob!(metres map.hard, 0.0 to 0.05),
    knob!(metres map.soft, 0.03 to 0.2),
    knob!(metres map.turning, 0.002 to 0.05),
    knob!(metres field.wall_distance, 0.1 to 0.21),
    knob!(number field.wall, 8.0 to 60.0),
    knob!(metres field.halo_distance, 0.02 to 0.08),
    knob!(metres field.ahead, 0.35 to 1.0),
    knob!(count field.shun, 0.0 to 40.0),
    knob!(metres heading.least, 0.02 to 0.4),
    knob!(number heading.toward, 0.3 to 3.0),
    knob!(number heading.ahead, 0.0 to 1.5),
    knob!(number heading.commitment, 0.0 to 1.0),
    knob!(number heading.soft, 0.0 to 2.5),
    knob!(number heading.hard, 0.0 to 2.5),
    knob!(number heading.neighbours, 0.0 to 1.0),
    knob!(metres steer.near, 0.05 to 0.5),
    knob!(metres steer.far, 0.55 to 1.6),
    knob!(metres steer.soft_bonus, 0.0 to 0.4),
    knob!(number steer.rate, 1.0 to 6.0),
    knob!(number steer.yaw_acceleration, 3.0 to 8.0),
    knob!(metres steer.flank, 0.0 to 0.1),
    knob!(metres supervisor.enter, 0.2 to 1.2),
    knob!(seconds supervisor.enter_time, 0.1 to 0.9),
    knob!(metres supervisor.path_margin, 0.0 to 0.2),
    knob!(metres supervisor.leave, 0.0 to 0.12),
    knob!(metres supervisor.escape, 0.1 to 0.7),
    knob!(count supervisor.stuck, 1.0 to 10.0),
    knob!(count supervisor.still, 3.0 to 20.0),
    knob!(metres barrier.margin, 0.015 to 0.05),
    knob!(number barrier.braking, 0.6 to 2.2),
    knob!(number barrier.share, 0.6 to 1.0),
    knob!(peak "deflection.S", deflections[1], 15.0 to 37.0),
    knob!(peak "deflection.N", deflections[2], 38.0 to 55.0),
    knob!(peak "speed.VS", speeds[0], 0.02 to 0.15),
    knob!(peak "speed.S", speeds[1], 0.16 to 0.45),
    knob!(peak "speed.N", speeds[2], 0.46 to 0.72),
    knob!(peak "speed.B", speeds[3], 0.73 to 0.95),
];

#[cfg(test)]
mod tests {
    use super::*;
    use fuzzypilot::navigate::presets;
    use fuzzypilot::tables::clutter::PEAKS;

    #[test]
    fn every_knob_turns_its_own_number_and_the_library_takes_both_ends() {
        let start = Tuned::from_preset((presets::jackal(), PEAKS));
        for knob in &KNOBS {
            for value in [knob.from, knob.to] {
                let mut tuned = start.clone();
                knob.set(&mut tuned, value);
                assert!((knob.get(&tuned) - value).abs() < 1e-9, "{}", knob.name);
                let refused = tuned.params().check().err();
                assert!(refused.is_none(), "{} = {value}: {refused:?}", knob.name);
                for other in KNOBS.iter().filter(|other| other.name != knob.name) {
                    assert_eq!(other.get(&tuned), other.get(&start), "{}", knob.name);
                }
            }
        }
    }
}
