//! The library's ports, implemented for the simulated robot: encoders with scale error, ray-cast ranges with noise.
//!
//! Every random number comes from one named generator, `Pcg64Mcg` seeded by the run's seed, in a fixed order, and what
//! moves the robot is computed with `libm`'s sines, not the system's, which differ in the last bit: the same seed gives
//! the same run on every machine.

use crate::recording::BeamView;
use crate::si;
use crate::world::World;
use fuzzypilot::ports::{
    Fault, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::units::MetresPerSecond;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// How wrong the sensors are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of a range, m.
    pub range: f64,
    /// Share of range readings lost (reported as time-outs).
    pub dropout: f64,
    /// Standard deviation of each wheel's scale error, drawn once a run.
    pub wheel_scale: f64,
    /// Standard deviation of each wheel's slip, a share of its travel in every tick.
    pub wheel_slip: f64,
}

/// The wheel drive: keeps the command for the plant to fetch.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimDrive {
    /// Last command left, right, m/s.
    pub command: [f64; 2],
    /// When the motors last stopped by themselves while they were driven, s, and how long after their last command.
    pub timed_out: Option<(f64, f64)>,
}

impl WheelDrive for SimDrive {
    type Error = core::convert::Infallible;

    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), Self::Error> {
        let index = match wheel {
            Side::Left => 0,
            Side::Right => 1,
        };
        self.command[index] = si::from_speed(speed);
        Ok(())
    }
}

/// The encoders: true travel, distorted, in counts.
#[derive(Clone, Debug)]
pub struct SimEncoders {
    metres_per_count: f64,
    scale: [f64; 2],
    slip: f64,
    seen: [f64; 2],
    measured: [f64; 2],
    rng: Pcg64Mcg,
}

impl SimEncoders {
    /// Draws the run's scale errors.
    pub fn new(metres_per_count: f64, noise: &Noise, seed: u64) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed ^ 0x656e_636f_6465_7273);
        let scale = std::array::from_fn(|_| 1.0 + noise.wheel_scale * normal(&mut rng));
        Self {
            metres_per_count,
            scale,
            slip: noise.wheel_slip,
            seen: [0.0; 2],
            measured: [0.0; 2],
            rng,
        }
    }

    /// Tells the true rim travel left, right, m.
    pub fn observe(&mut self, travel: [f64; 2]) {
        for (i, now) in travel.into_iter().enumerate() {
            let moved = now - self.seen[i];
            let slip = if self.slip > 0.0 {
                1.0 + self.slip * normal(&mut self.rng)
            } else {
                1.0
            };
            self.measured[i] += moved * self.scale[i] * slip;
            self.seen[i] = now;
        }
    }
}

impl WheelEncoders for SimEncoders {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        let counts = |metres: f64| (metres / self.metres_per_count).round() as i64 as i32;
        Ok(WheelCounts {
            left: counts(self.measured[0]),
            right: counts(self.measured[1]),
        })
    }
}

/// The ring of ranges.
#[derive(Clone, Debug)]
pub struct SimRanges<const N: usize> {
    /// As the robot reads them.
    pub readings: [RangeReading; N],
    /// Metres, for the recording; none where nothing was seen.
    pub seen: [Option<f64>; N],
    mounted: usize,
    noise: Noise,
    rng: Pcg64Mcg,
}

impl<const N: usize> SimRanges<N> {
    /// With the run's noise.
    pub fn new(noise: &Noise, seed: u64) -> Self {
        Self {
            readings: [RangeReading::fresh(Range::Invalid(Fault::NeverSeen)); N],
            seen: [None; N],
            mounted: 0,
            noise: *noise,
            rng: Pcg64Mcg::seed_from_u64(seed ^ 0x0072_616e_6765_7300),
        }
    }

    /// Number of sensors that have measured.
    pub fn mounted(&self) -> usize {
        self.mounted
    }

    /// Measures from the true pose.
    pub fn observe(&mut self, world: &World, beams: &[BeamView], [x, y, heading]: [f64; 3]) {
        let (sin, cos) = libm::sincos(heading);
        self.mounted = beams.len().min(N);
        for (i, beam) in beams.iter().enumerate().take(N) {
            let at = [
                x + beam.x * cos - beam.y * sin,
                y + beam.x * sin + beam.y * cos,
            ];
            let echo = world.cast_cone(at, heading + beam.heading, beam.width, beam.max_range);
            let lost = self.noise.dropout > 0.0 && self.rng.random::<f64>() < self.noise.dropout;
            let noisy = echo.map(|range| {
                let error = if self.noise.range > 0.0 {
                    self.noise.range * normal(&mut self.rng)
                } else {
                    0.0
                };
                (range + error).max(0.0)
            });
            let range = match noisy {
                _ if lost => Range::Invalid(Fault::Timeout),
                Some(range) => Range::Echo(si::metres(range)),
                None => Range::Clear,
            };
            self.readings[i] = RangeReading::fresh(range);
            self.seen[i] = noisy.filter(|_| !lost);
        }
    }
}

impl<const N: usize> RangeSensors for SimRanges<N> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        for (reading, seen) in readings.iter_mut().zip(&self.readings) {
            *reading = *seen;
        }
    }
}

fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}
