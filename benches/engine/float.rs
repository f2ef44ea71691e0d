//! The same controller in `f32`: the cell is looked up and four rules are weighed, as here.

use fuzzypilot::params::{Follower, Limits};
use fuzzypilot::tables::fine::{FineTables, SPEED_AXIS};
use std::f32::consts::PI;

/// Factors between axes and physical units, folded as ours are.
#[derive(Clone, Copy)]
pub struct Scales {
    /// Units of d's axis a metre.
    pub distance: f32,
    /// m/s a unit of the speed axis.
    pub speed: f32,
    /// rad/s a degree of deflection.
    pub yaw_rate: f32,
}

impl Scales {
    pub fn new(follower: &Follower, limits: &Limits) -> Self {
        Self {
            distance: follower.distance_scale.to_num(),
            speed: limits.speed.get().to_num::<f32>() / SPEED_AXIS.to_num::<f32>(),
            yaw_rate: follower.deflection_rate.to_num::<f32>() * PI / 180.0,
        }
    }
}

/// Both outputs' peaks, rule by rule, and the scales.
pub struct Float {
    speeds: [[f32; 5]; 5],
    deflections: [[f32; 5]; 5],
    scales: Scales,
}

impl Float {
    pub fn new(tables: &FineTables, scales: Scales) -> Self {
        let all = |peak: &dyn Fn(usize, usize) -> f32| {
            std::array::from_fn(|row| std::array::from_fn(|col| peak(row, col)))
        };
        Self {
            speeds: all(&|row, col| tables.speed.peak(row, col).to_num()),
            deflections: all(&|row, col| tables.deflection.peak(row, col).to_num()),
            scales,
        }
    }

    /// Speed and yaw rate at `d` metres and a heading error in radians.
    pub fn evaluate(&self, d: f32, error: f32) -> [f32; 2] {
        let x = (d * self.scales.distance).clamp(0.0, 4.0);
        let y = (error.abs() * (4.0 / PI)).clamp(0.0, 4.0);
        let (col, row) = ((x as usize).min(3), (y as usize).min(3));
        let (g, f) = (x - col as f32, y - row as f32);
        let weights = [
            (1.0 - f).min(1.0 - g),
            (1.0 - f).min(g),
            f.min(1.0 - g),
            f.min(g),
        ];
        let whole = 1.0 / weights.iter().sum::<f32>();
        let mean = |peaks: &[[f32; 5]; 5]| {
            let [above_left, above_right, below_left, below_right] = weights;
            let sum = above_left * peaks[row][col]
                + above_right * peaks[row][col + 1]
                + below_left * peaks[row + 1][col]
                + below_right * peaks[row + 1][col + 1];
            sum * whole
        };
        [
            mean(&self.speeds) * self.scales.speed,
            (mean(&self.deflections) * self.scales.yaw_rate).copysign(error),
        ]
    }
}
