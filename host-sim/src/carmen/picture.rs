//! A replay as the house's figure of a run: the recorded way in the manoeuvres' colours, the remembered points, and the
//! decided twists as arrows.

use super::replay::{PERIOD, Replay, name};
use super::summary::{Summary, clearance};
use super::timeline::Clock;
use crate::bench::body::BodyFrame;
use crate::bench::vehicle::along;
use crate::plot::run::{Extras, svg};
use crate::recording::{Disc, Frame, Recording};
use crate::si;

/// Way between two arrows, as a share of the way's longer side and at least in m, and the turn that is worth one, too, rad.
const APART_SHARE: f64 = 0.03;
const APART: f64 = 0.6;
const TURNED: f64 = 0.8;

/// Most arrows: more would cover each other.
const MOST_ARROWS: usize = 400;

/// How far into the future an arrow shows the decided twist, s.
const AHEAD: f64 = 0.8;

/// Where an arrow of a turn in place begins, m ahead of the robot.
const TURN_RADIUS: f64 = 0.25;

/// Radius of a remembered point on the map, m.
const POINT: f64 = 0.025;

/// Draws it; `robot_radius` in metres is what the robot is drawn with.
///
/// # Errors
///
/// When the picture cannot be drawn.
pub fn picture(replay: &Replay, summary: &Summary, robot_radius: f64) -> anyhow::Result<String> {
    let recording = Recording {
        scenario: format!("{}: what the navigator would have done", summary.source),
        variant: "open loop".to_owned(),
        seed: 0,
        period: PERIOD,
        robot_radius,
        outline: Vec::new(),
        obstacles: replay
            .remembered
            .iter()
            .map(|&[x, y]| Disc {
                name: String::new(),
                x,
                y,
                radius: POINT,
            })
            .collect(),
        path: Vec::new(),
        beams: Vec::new(),
        tables: Vec::new(),
        frames: frames(replay),
        ..Recording::default()
    };
    svg(
        &recording,
        &Extras {
            facts: Some(match summary.clock {
                Clock::Pace => format!("{} scans, no times: driven at --pace", summary.scans),
                Clock::Messages | Clock::Logger => format!("{} scans", summary.scans),
            }),
            obstacles: "remembered point",
            arrows: &arrows(replay),
            driven: Some(summary.driven_m),
        },
    )
}

fn frames(replay: &Replay) -> Vec<Frame> {
    let frame = |decision: &super::replay::Decision| Frame {
        t: decision.time,
        truth: decision.pose,
        believed: decision.pose,
        mode: name(decision.record.manoeuvre),
        note: "",
        cross_track: f64::NAN,
        clearance: clearance(decision),
        twist: [
            si::from_speed(decision.record.twist.linear),
            si::from_rate(decision.record.twist.angular),
        ],
        wheels: [0.0; 2],
        ..Frame::default()
    };
    replay.decisions.iter().map(frame).collect()
}

/// The arcs of the decided twists, some way apart.
fn arrows(replay: &Replay) -> Vec<Vec<[f64; 2]>> {
    let side = |k: usize| {
        let along = || replay.decisions.iter().map(|d| d.pose[k]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let way = APART.max(APART_SHARE * side(0).max(side(1)));
    let mut chosen = Vec::new();
    let mut apart = 1.0;
    loop {
        chosen.clear();
        let mut last: Option<[f64; 3]> = None;
        for decision in &replay.decisions {
            let [x, y, heading] = decision.pose;
            let far = last.is_none_or(|[u, v, h]| {
                let turn = crate::world::wrap(heading - h).abs();
                libm::hypot(x - u, y - v) >= way * apart || turn >= TURNED * apart
            });
            if far {
                last = Some(decision.pose);
                chosen.push(decision);
            }
        }
        if chosen.len() <= MOST_ARROWS {
            break;
        }
        apart *= 1.5;
    }
    chosen
        .into_iter()
        .filter_map(|decision| {
            let twist = decision.record.twist;
            let twist = [si::from_speed(twist.linear), si::from_rate(twist.angular)];
            arrow(decision.pose, twist)
        })
        .collect()
}

/// The way of a point of the robot under a twist; none for a robot that stands.
fn arrow(pose: [f64; 3], twist: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    const PIECES: usize = 8;
    let turns = twist[0].abs() < 0.05;
    if turns && twist[1].abs() < 0.1 {
        return None;
    }
    // A turn in place moves the front only.
    let front = if turns { TURN_RADIUS } else { 0.0 };
    let place = |k: usize| {
        let pose = along(pose, twist, AHEAD * k as f64 / PIECES as f64);
        BodyFrame::new(pose).tell([front, 0.0])
    };
    Some((0..=PIECES).map(place).collect())
}
