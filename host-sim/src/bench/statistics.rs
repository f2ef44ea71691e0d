//! Confidence intervals.

use super::seeds::{Purpose, stream};
use rand::RngExt;

/// Two-sided 95 % quantile of the standard normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// Wilson's 95 % interval of a share from `hits` of `total` independent runs (Wilson 1927); 0 to 1 if there are none.
pub fn wilson(hits: usize, total: usize) -> [f64; 2] {
    if total == 0 {
        return [0.0, 1.0];
    }
    let n = total as f64;
    let p = hits as f64 / n;
    let z2 = Z * Z;
    let middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = Z / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    // Exact at both ends, where rounding would leave a trace.
    let low = if hits == 0 { 0.0 } else { middle - half };
    let high = if hits == total { 1.0 } else { middle + half };
    [low.max(0.0), high.min(1.0)]
}

/// Worlds resampled for 95 % percentile intervals (Efron 1979): seeds within a world are alike, so worlds, not runs, are what
/// was drawn.
pub struct Resampling {
    worlds: usize,
    /// How often each world was drawn, resample after resample.
    drawn: Vec<u32>,
}

impl Resampling {
    /// Of so many worlds; always the same ones for the same number.
    pub fn new(worlds: usize) -> Self {
        let mut rng = stream(0, worlds as u32, Purpose::Bootstrap);
        let mut drawn = vec![0; RESAMPLES * worlds];
        for resample in drawn.chunks_mut(worlds.max(1)) {
            for _ in 0..worlds {
                resample[rng.random_range(0..worlds)] += 1;
            }
        }
        Self { worlds, drawn }
    }

    /// Of a mean over runs; each world is given as its sum and number of runs. 0 where no run was drawn.
    pub fn mean(&self, worlds: &[(f64, usize)]) -> [f64; 2] {
        self.interval(|drawn| {
            let mut sum = (0.0, 0);
            for (times, (value, runs)) in drawn.iter().zip(worlds) {
                sum = (
                    sum.0 + f64::from(*times) * value,
                    sum.1 + *times as usize * runs,
                );
            }
            sum.0 / sum.1.max(1) as f64
        })
    }

    /// Of the median over runs; each value comes with the place of its world.
    pub fn median(&self, mut values: Vec<(f64, usize)>) -> [f64; 2] {
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.interval(|drawn| {
            let times = |world: usize| drawn.get(world).map_or(0, |n| *n as usize);
            let total: usize = values.iter().map(|(_, world)| times(*world)).sum();
            let nth = |n: usize| {
                let mut passed = 0;
                let found = values.iter().find(|(_, world)| {
                    passed += times(*world);
                    passed > n
                });
                found.map_or(0.0, |(value, _)| *value)
            };
            let (low, high) = (total.saturating_sub(1) / 2, total / 2);
            if low == high {
                nth(low)
            } else {
                (nth(low) + nth(high)) / 2.0
            }
        })
    }

    fn interval(&self, statistic: impl Fn(&[u32]) -> f64) -> [f64; 2] {
        let resamples = self.drawn.chunks(self.worlds.max(1));
        let mut all: Vec<f64> = resamples.map(statistic).collect();
        if all.is_empty() {
            return [0.0; 2];
        }
        all.sort_by(f64::total_cmp);
        let at = |share: f64| all[((all.len() - 1) as f64 * share).round() as usize];
        [at(0.025), at(0.975)]
    }
}

/// Middle value; the mean of the two middle ones of an even number; zero of none.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        _ => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}
