//! The table that a bench prints.

use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::bench::results::Results;

/// A row a controller. Intervals are 95 %, worlds resampled.
pub fn of(results: &[Results]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "controller",
        "runs",
        "success %",
        "collision %",
        "time-out %",
        "blocked %",
        "score",
        "time s",
        "least clearance m",
        "cross-track m",
        "yaw acc. rad/s²",
        "stall s",
    ]);
    for result in results {
        let f = &result.figures;
        let i = &result.intervals_95;
        let share = |x: f64, [low, high]: [f64; 2]| {
            format!("{:.1} ({:.1}–{:.1})", 100.0 * x, 100.0 * low, 100.0 * high)
        };
        table.add_row([
            result.conditions.controller.clone(),
            f.runs.to_string(),
            share(f.success, i.success_worlds),
            share(f.collision, i.collision_worlds),
            format!("{:.1}", 100.0 * f.timeout),
            format!("{:.1}", 100.0 * f.blocked),
            format!(
                "{:.4} ({:.3}–{:.3})",
                f.score, i.score_worlds[0], i.score_worlds[1]
            ),
            format!("{:.1}", f.mean_time_s),
            format!("{:.3}", f.median_min_clearance_m),
            format!("{:.3}", f.cross_track_rms_m),
            format!("{:.1}", f.omega_rate_rms),
            format!("{:.1}", f.longest_stall_s),
        ]);
    }
    table
}
