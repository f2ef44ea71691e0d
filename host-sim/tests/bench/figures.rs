//! Score and intervals against numbers worked out elsewhere.

use host_sim::bench::score::barn;
use host_sim::bench::statistics::{Resampling, median, wilson};

#[test]
fn the_score_is_the_benchmarks() {
    // Ten metres: optimal time 5 s, so 10 s and less are full marks, 40 s and more the least.
    for (time, score) in [
        (4.0, 0.5),
        (10.0, 0.5),
        (20.0, 0.25),
        (40.0, 0.125),
        (90.0, 0.125),
    ] {
        assert_eq!(barn(true, time, 10.0), score, "{time} s");
    }
    assert_eq!(barn(false, 10.0, 10.0), 0.0);
}

#[test]
fn wilson_agrees_with_the_tables() {
    // Newcombe 1998, Statistics in Medicine 17, table I: method 3.
    for (hits, total, low, high) in [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ] {
        let [l, h] = wilson(hits, total);
        assert!(
            (l - low).abs() < 1e-4 && (h - high).abs() < 1e-4,
            "{hits}/{total}: {l} {h}"
        );
    }
    assert_eq!(wilson(0, 0), [0.0, 1.0]);
    assert_eq!(wilson(20, 20)[1], 1.0);
}

#[test]
fn the_bootstrap_holds_the_mean_and_is_as_wide_as_it_should_be() {
    // Half of 100 worlds at 1: standard error 0.05.
    let worlds: Vec<(f64, usize)> = (0..100).map(|k| (f64::from(k % 2), 1)).collect();
    let [low, high] = Resampling::new(100).mean(&worlds);
    assert!(
        (low - 0.402).abs() < 0.02 && (high - 0.598).abs() < 0.02,
        "{low} {high}"
    );
    // All alike: no width.
    assert_eq!(Resampling::new(2).mean(&[(2.0, 2), (3.0, 3)]), [1.0, 1.0]);
    // A world without a run counts for nothing.
    let [low, high] = Resampling::new(3).mean(&[(8.0, 2), (8.0, 2), (0.0, 0)]);
    assert!((low == 0.0 || low == 4.0) && high == 4.0, "{low} {high}");
}

#[test]
fn the_bootstrap_of_a_median_is_as_wide_as_it_should_be() {
    // 0 to 1 in even steps: the median's standard error is 1/(2√n), 0.035 for 200 worlds.
    let values: Vec<(f64, usize)> = (0..200).map(|k| ((k as f64 + 0.5) / 200.0, k)).collect();
    let [low, high] = Resampling::new(200).median(values);
    assert!(
        (low - 0.431).abs() < 0.02 && (high - 0.569).abs() < 0.02,
        "{low} {high}"
    );
    // Two worlds: one of them, the other, or the mean of both.
    let two = vec![(3.0, 0), (1.0, 1)];
    assert_eq!(Resampling::new(2).median(two), [1.0, 3.0]);
    assert_eq!(Resampling::new(0).median(Vec::new()), [0.0, 0.0]);
}

#[test]
fn the_median_is_in_the_middle() {
    assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
    assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
    assert_eq!(median(&mut []), 0.0);
}
