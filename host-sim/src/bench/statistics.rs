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

/// 95 % percentile interval of the mean over worlds, each given as its sum and number of runs, by resampling worlds
/// (Efron 1979): seeds within a world are alike, so worlds, not runs, are what was drawn.
pub fn bootstrap(worlds: &[(f64, usize)]) -> [f64; 2] {
    let mut rng = stream(0, worlds.len() as u32, Purpose::Bootstrap);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut sum = (0.0, 0);
            for _ in worlds {
                let (value, runs) = worlds[rng.random_range(0..worlds.len())];
                sum = (sum.0 + value, sum.1 + runs);
            }
            sum.0 / sum.1.max(1) as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let at = |share: f64| means[((RESAMPLES - 1) as f64 * share).round() as usize];
    [at(0.025), at(0.975)]
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
