//! A run again, kept tick by tick for the replay page.

use super::arena::{Arena, Circle};
use super::attempt::{CLEARANCE_REACH, End, Outcome, PERIOD, Setting, Step, drive_to_end};
use super::body::Body;
use super::controllers::Controller;
use super::discs::Discs;
use super::navigator::Mode;
use crate::recording::{Disc, Frame, Recording};
use crate::si;
use fuzzypilot::ports::Range;

/// Runs a navigator through a world once more.
pub fn record(
    controller: &Controller,
    arena: &Arena,
    setting: &Setting,
    seed: u64,
) -> (Outcome, Recording) {
    let mission = setting.mission(arena);
    let mut navigator = (controller.build)(&mission);
    let mut frames = Vec::new();
    let half_track = setting.body.half_width();
    let (outcome, end) = drive_to_end(
        arena,
        &Discs::new(&arena.circles),
        setting,
        seed,
        navigator.as_mut(),
        &mut |step| {
            frames.push(Frame {
                movers: moving(arena, step.time),
                view: step.navigator.view(),
                ..frame(step, half_track)
            });
        },
    );
    let ended = frames.last().is_none_or(|last| last.t < end.time);
    if ended {
        frames.push(Frame {
            movers: moving(arena, end.time),
            ..last(frames.last(), &end, half_track)
        });
    }
    let known = arena.circles.len() - arena.unmapped;
    let (mapped, unmapped) = arena.circles.split_at(known);
    let recording = Recording {
        scenario: format!("{} in world {}", controller.name, arena.number),
        variant: format!("{} at {:.1} s", outcome.ending.words(), outcome.time_s),
        seed,
        period: PERIOD,
        robot_radius: setting.body.outer_radius(),
        outline: match setting.body {
            Body::Disc(_) => Vec::new(),
            _ => setting.body.corners([0.0; 3]),
        },
        obstacles: discs(mapped),
        unmapped: discs(unmapped),
        movers: arena.movers.iter().map(|m| m.radius).collect(),
        path: vec![mission.route],
        beams: setting.sensors.clone(),
        tables: Vec::new(),
        frames,
        ended,
        contact: end.contact,
        goal: Some([arena.goal[0], arena.goal[1], arena.goal_radius]),
        straight: !setting.planned,
        clearance_cap: Some(CLEARANCE_REACH),
        dead: setting.dead.sensor(seed, setting.sensors.len()),
        ..Recording::default()
    };
    (outcome, recording)
}

fn frame(step: &Step<'_>, half_track: f64) -> Frame {
    Frame {
        t: step.time,
        truth: step.pose,
        believed: step.believed,
        mode: step.command.mode.name(),
        note: "",
        cross_track: step.cross_track,
        clearance: step.clearance,
        twist: [step.command.speed, step.command.yaw_rate],
        wheels: wheels(step.twist, half_track),
        ranges: step
            .ranges
            .iter()
            .map(|reading| match reading.range {
                Range::Echo(range) => Some(si::from_metres(range)),
                _ => None,
            })
            .collect(),
        ..Frame::default()
    }
}

/// Where the run ended, under the command of the tick before, if there was one.
fn last(before: Option<&Frame>, end: &End, half_track: f64) -> Frame {
    Frame {
        t: end.time,
        truth: end.pose,
        believed: end.believed,
        mode: before.map_or(Mode::Follow.name(), |frame| frame.mode),
        cross_track: end.cross_track,
        clearance: end.clearance,
        twist: before.map_or([0.0; 2], |frame| frame.twist),
        wheels: wheels(end.twist, half_track),
        ..Frame::default()
    }
}

fn discs(circles: &[Circle]) -> Vec<Disc> {
    let disc = |c: &Circle| Disc {
        name: String::new(),
        x: c.at[0],
        y: c.at[1],
        radius: c.radius,
    };
    circles.iter().map(disc).collect()
}

fn moving(arena: &Arena, time: f64) -> Vec<[f64; 2]> {
    arena.movers.iter().map(|m| m.at(time).at).collect()
}

fn wheels([v, w]: [f64; 2], half_track: f64) -> [f64; 2] {
    [v - w * half_track, v + w * half_track]
}
