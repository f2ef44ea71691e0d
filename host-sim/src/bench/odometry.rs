//! What the robot believes of its own motion: the truth, or the truth with a scale error drawn once a run.

use super::seeds::normal;
use super::vehicle::along;
use rand_pcg::Pcg64Mcg;

/// How wrong odometry is: standard deviations of its scale errors. Zero is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// Of distance; 0.02 is two centimetres a metre.
    pub distance: f64,
    /// Of turned angle.
    pub yaw: f64,
}

/// State of the odometry.
#[derive(Clone, Debug)]
pub struct Odometry {
    scale: Option<[f64; 2]>,
    /// x, y (m), heading (rad), as believed.
    pub pose: [f64; 3],
    /// Speed (m/s), yaw rate (rad/s), as believed.
    pub twist: [f64; 2],
}

impl Odometry {
    /// Knows its start exactly, and draws the run's errors.
    pub fn new(drift: Drift, start: [f64; 3], rng: &mut Pcg64Mcg) -> Self {
        let drawn = [
            1.0 + drift.distance * normal(rng),
            1.0 + drift.yaw * normal(rng),
        ];
        Self {
            scale: (drift != Drift::default()).then_some(drawn),
            pose: start,
            twist: [0.0; 2],
        }
    }

    /// Sees that the vehicle came to `pose` with `twist` now, having had the mean twist `mean` for `dt` seconds.
    pub fn observe(&mut self, pose: [f64; 3], twist: [f64; 2], mean: [f64; 2], dt: f64) {
        match self.scale {
            // Exact to the last bit, not only up to rounding.
            None => (self.pose, self.twist) = (pose, twist),
            Some([distance, yaw]) => {
                self.pose = along(self.pose, [mean[0] * distance, mean[1] * yaw], dt);
                self.twist = [twist[0] * distance, twist[1] * yaw];
            }
        }
    }
}
