//! `ticks.csv`: every field of every TickRecord. Values are the fixed-point numbers written out exactly, so two files
//! are equal byte for byte if and only if the records were.

use crate::recorder::mode;
use fuzzypilot::fuzzy::FiredRule;
use fuzzypilot::signals::{Controller, Decision, TickRecord, Turn};
use fuzzypilot::units::Angle;

/// The header row.
#[rustfmt::skip]
pub const COLUMNS: [&str; 49] = [
    "tick", "mode", "side", "reason", "x_m", "y_m", "heading_turn32", "foot_x_m", "foot_y_m",
    "cross_track_m", "distance_m", "tangent_turn32", "curvature_per_m", "heading_error_turn32",
    "progress_m", "remaining_m", "laps", "speed_limit_mps", "at_end", "missed_end", "obstacles", "valid_ranges",
    "nearest_m", "held_x_m", "held_y_m", "held_radius_m", "held_residual_m", "held_echoes",
    "controller", "distance_input", "angle_input_deg", "speed_output", "deflection_output_deg",
    "rule1", "rule2", "rule3", "rule4", "speed_rule1", "speed_rule2", "speed_rule3", "speed_rule4",
    "desired_v_mps", "desired_w_radps", "v_mps", "w_radps", "left_mps", "right_mps", "guarded",
    "drive_fault",
];

/// One row, in the order of [`COLUMNS`].
pub fn row(record: &TickRecord) -> Vec<String> {
    let (mode, note) = mode(&record.decision);
    let (side, reason) = match record.decision {
        Decision::Follow => ("", ""),
        Decision::Avoid {
            side: Turn::Left, ..
        } => ("left", ""),
        Decision::Avoid {
            side: Turn::Right, ..
        } => ("right", ""),
        Decision::Stop(_) => ("", note),
    };
    let held = match record.decision {
        Decision::Avoid { obstacle, .. } => [
            q16(obstacle.centre.x.bits()),
            q16(obstacle.centre.y.bits()),
            q16(obstacle.radius.bits()),
            q16(obstacle.residual.bits()),
            obstacle.echoes.to_string(),
        ],
        _ => Default::default(),
    };
    let guidance = &record.guidance;
    let trace = &record.trace;
    let (controller, speed_bits) = match trace.controller {
        Controller::None => ("none", 13),
        Controller::Fine => ("fine", 13),
        Controller::Coarse => ("coarse", 14),
    };
    let mut row = vec![
        record.tick.to_string(),
        mode.to_owned(),
        side.to_owned(),
        reason.to_owned(),
        q16(record.pose.at.x.bits()),
        q16(record.pose.at.y.bits()),
        turns(record.pose.heading),
        q16(guidance.foot.x.bits()),
        q16(guidance.foot.y.bits()),
        q16(guidance.cross_track.bits()),
        q16(guidance.distance.bits()),
        turns(guidance.tangent),
        q16(guidance.curvature.bits()),
        turns(guidance.heading_error),
        q16(guidance.progress.bits()),
        q16(guidance.remaining.bits()),
        guidance.laps.to_string(),
        q16(guidance.speed_limit.bits()),
        u8::from(guidance.at_end).to_string(),
        u8::from(guidance.missed_end).to_string(),
        record.obstacles.to_string(),
        record.valid_ranges.to_string(),
        q16(record.nearest.bits()),
    ];
    row.extend(held);
    row.extend([
        controller.to_owned(),
        q16(trace.distance_input),
        q16(trace.angle_input),
        fixed(trace.speed_output.into(), speed_bits),
        fixed(trace.deflection_output.into(), 8),
    ]);
    row.extend(rules(&trace.rules.fired()));
    row.extend(rules(&trace.speed_rules.fired()));
    row.extend([
        q16(record.desired.linear.bits()),
        q16(record.desired.angular.bits()),
        q16(record.twist.linear.bits()),
        q16(record.twist.angular.bits()),
        q16(record.wheels.left.bits()),
        q16(record.wheels.right.bits()),
        u8::from(record.guarded).to_string(),
        u8::from(record.drive_fault).to_string(),
    ]);
    row
}

fn q16(bits: i32) -> String {
    fixed(bits, 16)
}

/// A binary fraction has a finite decimal form; this is it.
fn fixed(bits: i32, fraction: u32) -> String {
    (f64::from(bits) / f64::from(1u32 << fraction)).to_string()
}

fn turns(angle: Angle) -> String {
    angle.bits().to_string()
}

/// `row:col:degree` with the degree in 1/32768.
fn rules(rules: &[FiredRule]) -> [String; 4] {
    std::array::from_fn(|i| {
        rules.get(i).map_or_else(String::new, |r| {
            format!("{}:{}:{}", r.row, r.col, r.degree.bits())
        })
    })
}

/// The whole file.
pub fn csv<'a>(rows: impl IntoIterator<Item = &'a Vec<String>>) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for row in rows {
        writer.write_record(row)?;
    }
    Ok(writer.into_inner()?)
}
