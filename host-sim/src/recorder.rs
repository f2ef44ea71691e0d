//! Turns ticks into a [`Recording`] for pictures and replay.

use crate::recording::{FiredView, Frame, Recording};
use crate::robot::beams;
use crate::run::{Gap, Period, Step};
use crate::scenario::Scenario;
use crate::si;
use crate::tables::{COARSE_DEFLECTION, COARSE_SPEED, FINE_DEFLECTION, FINE_SPEED, views};
use fuzzypilot::fuzzy::ActiveRules;
use fuzzypilot::signals::{Controller, Decision, RuleTrace, StopReason, Turn};
use fuzzypilot::tables::{coarse, fine};

/// An empty recording of a scenario.
pub fn start(scenario: &Scenario, seed: u64) -> Recording {
    let control = &scenario.control;
    let preset = scenario.robot.preset;
    Recording {
        scenario: scenario.name.clone(),
        variant: control.describe(preset),
        seed,
        period: scenario.robot.period,
        robot_radius: scenario.robot.radius,
        outline: Vec::new(),
        obstacles: scenario.world.discs.clone(),
        path: scenario.path.track().polylines(),
        beams: beams(&scenario.sensors),
        tables: views(control.fine_set(preset), control.coarse_set()),
        frames: Vec::new(),
        ..Recording::default()
    }
}

/// Adds a tick.
pub fn record(recording: &mut Recording, step: &Step<'_>) {
    let record = step.record;
    let (mode, note) = mode(&record.decision);
    let estimate = match record.decision {
        Decision::Avoid { obstacle, .. } => {
            let centre = record.pose.to_world(obstacle.centre);
            Some([
                si::from_metres(centre.x),
                si::from_metres(centre.y),
                si::from_metres(obstacle.radius),
            ])
        }
        _ => None,
    };
    recording.frames.push(Frame {
        t: step.time,
        truth: step.truth,
        believed: si::from_pose(record.pose),
        mode,
        note,
        cross_track: step.cross_track,
        clearance: step.clearance.0,
        twist: [
            si::from_speed(record.twist.linear),
            si::from_rate(record.twist.angular),
        ],
        wheels: step.wheels,
        ranges: step.ranges.to_vec(),
        estimate,
        signals: signals(&record.trace),
        fired: fired(&record.trace),
        ..Frame::default()
    });
}

/// Adds a control period, with a tick or without.
pub fn period(recording: &mut Recording, period: &Period<'_>) {
    match period {
        Period::Tick(step) => record(recording, step),
        Period::Gap(gap) => pause(recording, gap),
    }
}

/// What the robot believes and was told before, it believes and does still.
fn pause(recording: &mut Recording, gap: &Gap) {
    let (believed, mode, twist) = match (recording.frames.last(), gap.disarmed) {
        (Some(last), None) => (last.believed, last.mode, last.twist),
        (Some(last), Some(_)) => (last.believed, "stop", [0.0; 2]),
        (None, _) => (gap.truth, "stop", [0.0; 2]),
    };
    let note = match gap.disarmed {
        Some(_) => "disarmed",
        None => "no answer",
    };
    recording.frames.push(Frame {
        t: gap.time,
        truth: gap.truth,
        believed,
        mode,
        note,
        cross_track: gap.cross_track,
        clearance: gap.clearance.0,
        twist,
        wheels: gap.wheels,
        ranges: vec![None; recording.beams.len()],
        ..Frame::default()
    });
}

/// The mode and why, in words.
pub fn mode(decision: &Decision) -> (&'static str, &'static str) {
    match decision {
        Decision::Follow => ("follow", ""),
        Decision::Avoid {
            side: Turn::Left, ..
        } => ("avoid", "turning left"),
        Decision::Avoid {
            side: Turn::Right, ..
        } => ("avoid", "turning right"),
        Decision::Stop(StopReason::PathEnd) => ("stop", "path end"),
        Decision::Stop(StopReason::PathMissed) => ("stop", "path missed"),
        Decision::Stop(StopReason::NoRanges) => ("stop", "no ranges"),
        Decision::Stop(StopReason::NoOdometry) => ("stop", "no odometry"),
    }
}

fn signals(trace: &RuleTrace) -> Vec<(&'static str, f64)> {
    let input = |bits: i32| f64::from(bits) / 65_536.0;
    match trace.controller {
        Controller::None => Vec::new(),
        Controller::Fine => vec![
            ("d [axis units]", input(trace.distance_input)),
            ("φ [°]", input(trace.angle_input)),
            (
                "v [axis units]",
                fine::Speed::from_bits(trace.speed_output).to_num(),
            ),
            (
                "Δφ [°]",
                fine::Deflection::from_bits(trace.deflection_output).to_num(),
            ),
        ],
        Controller::Coarse => vec![
            ("s [share of D]", input(trace.distance_input)),
            ("θ [°]", input(trace.angle_input)),
            (
                "Δθ [°]",
                coarse::Deflection::from_bits(trace.deflection_output).to_num(),
            ),
            (
                "v [share of Vmax]",
                coarse::SpeedShare::from_bits(trace.speed_output).to_num(),
            ),
        ],
    }
}

fn fired(trace: &RuleTrace) -> Vec<FiredView> {
    let of = |table: usize, rules: &ActiveRules| -> Vec<FiredView> {
        rules
            .fired()
            .iter()
            .map(|rule| FiredView {
                table,
                row: rule.row.into(),
                col: rule.col.into(),
                degree: f64::from(rule.degree.bits()) / 32_768.0,
            })
            .collect()
    };
    match trace.controller {
        Controller::None => Vec::new(),
        Controller::Fine => [
            of(FINE_SPEED, &trace.rules),
            of(FINE_DEFLECTION, &trace.rules),
        ]
        .concat(),
        Controller::Coarse => [
            of(COARSE_DEFLECTION, &trace.rules),
            of(COARSE_SPEED, &trace.speed_rules),
        ]
        .concat(),
    }
}
