//! What one run is worth: the benchmark's own score.

/// The benchmark's optimal speed, m/s.
const OPTIMAL_SPEED: f64 = 2.0;

/// The score of the BARN challenge (since 2023) for a run of `time` seconds along a reference of `route_length` metres:
/// success · OT / clip(T, 2·OT, 8·OT) with OT = length / 2 m/s. From 0 to 0.5.
pub fn barn(success: bool, time: f64, route_length: f64) -> f64 {
    let optimal = route_length / OPTIMAL_SPEED;
    if success && optimal > 0.0 {
        optimal / time.clamp(2.0 * optimal, 8.0 * optimal)
    } else {
        0.0
    }
}
