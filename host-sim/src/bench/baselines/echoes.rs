//! Echoes as points, and those of the last moments.

use crate::bench::navigator::Inputs;
use crate::recording::BeamView;
use crate::si;
use fuzzypilot::ports::Range;

/// An echo on its sensor's axis.
#[derive(Clone, Copy, Debug)]
pub struct Echo {
    /// Which sensor.
    pub sensor: usize,
    /// Range, m.
    pub range: f64,
    /// Where it is in the body's frame, m.
    pub at: [f64; 2],
}

/// The echoes of a tick.
pub fn echoes<'a>(
    sensors: &'a [BeamView],
    inputs: &Inputs<'a>,
) -> impl Iterator<Item = Echo> + use<'a> {
    let ranges = inputs.ranges;
    sensors
        .iter()
        .zip(ranges)
        .enumerate()
        .filter_map(|(sensor, (view, reading))| match reading.range {
            Range::Echo(range) => {
                let range = si::from_metres(range);
                let (sin, cos) = libm::sincos(view.heading);
                Some(Echo {
                    sensor,
                    range,
                    at: [view.x + range * cos, view.y + range * sin],
                })
            }
            _ => None,
        })
}

/// A point that was seen a while ago.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Where, in odometry's frame, m.
    pub at: [f64; 2],
    /// Half the width of the cone there, m.
    pub radius: f64,
    /// When, s.
    pub time: f64,
}

/// The echoes of the last moments, by odometry. One point stands for all echoes within [`Memory::merge`] of it.
#[derive(Clone, Debug)]
pub struct Memory {
    /// The points.
    pub points: Vec<Seen>,
    /// How long a point is kept, s.
    pub keep: f64,
    /// Echoes that are further away than this are not taken in, m.
    pub reach: f64,
    /// How near two echoes are one, m.
    pub merge: f64,
}

impl Memory {
    /// Empty.
    pub const fn new(keep: f64, reach: f64, merge: f64) -> Self {
        Self {
            points: Vec::new(),
            keep,
            reach,
            merge,
        }
    }

    /// Forgets what is old and takes in what is seen.
    pub fn observe(&mut self, sensors: &[BeamView], inputs: &Inputs<'_>) {
        let keep = self.keep;
        self.points.retain(|p| inputs.time - p.time <= keep);
        let [x, y, heading] = inputs.pose;
        let (sin, cos) = libm::sincos(heading);
        for echo in echoes(sensors, inputs) {
            if echo.range > self.reach {
                continue;
            }
            let [u, v] = echo.at;
            let at = [x + u * cos - v * sin, y + u * sin + v * cos];
            let new = Seen {
                at,
                radius: echo.range * libm::tan(sensors[echo.sensor].width / 2.0),
                time: inputs.time,
            };
            let merge2 = self.merge * self.merge;
            let same = self.points.iter_mut().find(|p| {
                let (dx, dy) = (p.at[0] - at[0], p.at[1] - at[1]);
                dx * dx + dy * dy < merge2
            });
            match same {
                Some(point) => *point = new,
                None => self.points.push(new),
            }
        }
    }
}
