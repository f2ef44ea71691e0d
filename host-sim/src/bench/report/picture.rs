//! A small picture of a run: the world, the route, the track and the body where it ended.

use crate::bench::arena::Arena;
use crate::bench::body::Rectangle;
use crate::recording::Recording;
use std::fmt::Write;

/// Height of the picture, pixels, and its widest.
const HEIGHT: f64 = 220.0;
const WIDEST: f64 = 320.0;

/// As SVG, y up.
pub fn picture(arena: &Arena, body: &Rectangle, recording: &Recording) -> String {
    let track: Vec<[f64; 2]> = recording
        .frames
        .iter()
        .map(|f| [f.truth[0], f.truth[1]])
        .collect();
    let places = || {
        track
            .iter()
            .chain(&arena.route)
            .copied()
            .chain(arena.circles.iter().map(|c| c.at))
    };
    let least = |k: usize| places().map(|p| p[k]).fold(f64::INFINITY, f64::min) - 0.4;
    let most = |k: usize| places().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) + 0.4;
    let (left, right, bottom, top) = (least(0), most(0), least(1), most(1));
    let scale = (HEIGHT / (top - bottom)).min(WIDEST / (right - left));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0}\" height=\"{:.0}\" viewBox=\"{left:.2} {:.2} {:.2} {:.2}\"><g transform=\"scale(1,-1)\" fill=\"none\" stroke-width=\"{:.3}\">",
        (right - left) * scale,
        (top - bottom) * scale,
        -top,
        right - left,
        top - bottom,
        1.5 / scale,
    );
    let _ = write!(
        svg,
        "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" stroke=\"#2a2\"/>",
        arena.goal[0], arena.goal[1], arena.goal_radius
    );
    svg.push_str("<g fill=\"#555\">");
    for c in &arena.circles {
        let _ = write!(
            svg,
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.3}\"/>",
            c.at[0], c.at[1], c.radius
        );
    }
    svg.push_str("</g>");
    for route in &recording.path {
        line(&mut svg, route, "stroke=\"#8ac\" stroke-dasharray=\".2\"");
    }
    line(&mut svg, &track, "stroke=\"#c33\"");
    if let Some(last) = recording.frames.last() {
        let mut corners = body.corners(last.truth).to_vec();
        corners.push(corners[0]);
        line(&mut svg, &corners, "stroke=\"#c33\"");
    }
    svg.push_str("</g></svg>");
    svg
}

fn line(svg: &mut String, points: &[[f64; 2]], style: &str) {
    let _ = write!(svg, "<polyline {style} points=\"");
    for [x, y] in points {
        let _ = write!(svg, "{x:.2},{y:.2} ");
    }
    svg.push_str("\"/>");
}
