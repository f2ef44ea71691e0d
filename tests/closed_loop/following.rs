//! Free paths: accuracy at full speed, and convergence from anywhere.

use crate::harness::{Run, run, scenario};
use host_sim::control::LawName;
use host_sim::scenario::Scenario;
use host_sim::world::wrap;
use rayon::prelude::*;
use std::f64::consts::PI;

#[test]
fn free_paths_at_full_speed() {
    for name in ["line", "arc-5", "arc-2", "arc-1", "dual-semicircle"] {
        let r = run(&scenario(name), 1);
        // Away from start and end: acceleration and braking are not following.
        let settled = r.settled(0.05).expect("converges");
        let (rms, worst) = r.cross_track_from(settled);
        let speed = r.summary.mean_speed_mps;
        println!("{name}: rms {rms:.5} m, max {worst:.5} m, mean speed {speed:.3} m/s");
        assert!(r.summary.reached_end, "{name}");
        assert_eq!(settled, 0, "{name} starts on its path");
        assert!(rms <= 0.01 && worst <= 0.03, "{name}: {rms} {worst}");
        assert!(rms >= 1e-7, "{name}: {rms}");
        assert!((0.9..=1.0).contains(&speed), "{name}: {speed}");
    }
}

#[test]
fn half_a_metre_beside_a_line() {
    let r = run(&scenario("line-offset"), 1);
    let settled = r.settled(0.05).expect("converges");
    let after = r.travelled()[settled];
    println!("line-offset: within 0.05 m after {after:.3} m");
    assert!(after > 0.5 && after <= 2.0, "{after}");
    assert!(r.summary.reached_end);
    // It comes from one side and does not swing far past.
    assert!(r.ticks.iter().all(|t| t.cross_track > -0.05));
}

fn from(base: &Scenario, start: [f64; 3]) -> Run {
    let mut scenario = base.clone();
    scenario.start = start;
    run(&scenario, 1)
}

/// Ends on the path, and has been there for the last fifth of the run.
fn converges(base: &Scenario, starts: &[[f64; 3]]) {
    let failures: Vec<String> = starts
        .par_iter()
        .filter_map(|start| {
            let r = from(base, *start);
            let (rms, worst) = r.cross_track_from(r.ticks.len() * 4 / 5);
            let good = r.summary.reached_end && worst <= 0.05 && rms <= 0.02;
            (!good).then(|| format!("{start:?}: {rms:.3} {worst:.3} {}", r.summary.reached_end))
        })
        .collect();
    assert!(
        failures.is_empty(),
        "{} of {}: {failures:#?}",
        failures.len(),
        starts.len()
    );
}

fn grid() -> Vec<(f64, f64)> {
    let lateral = [-2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0];
    let headings = (0..12).map(|i| f64::from(i) * PI / 6.0);
    headings
        .flat_map(|h| lateral.map(|l| (l, wrap(h))))
        .collect()
}

#[test]
fn converges_on_a_line_from_anywhere() {
    let starts: Vec<_> = grid().into_iter().map(|(l, h)| [0.0, l, h]).collect();
    converges(&scenario("line"), &starts);
}

#[test]
fn converges_on_an_arc_from_anywhere() {
    // From 3 m to 7 m of the centre of a circle of 5 m.
    let starts: Vec<_> = grid().into_iter().map(|(l, h)| [5.0 + l, 0.0, h]).collect();
    converges(&scenario("arc-5"), &starts);
}

#[test]
fn converges_around_the_corners_of_a_square() {
    // Two laps, so that the second is judged whole; a corner is taken a hand wide: it is passed
    // before the robot begins to turn, and the yaw acceleration takes its time.
    let mut base = scenario("square");
    base.laps = 2;
    let failures: Vec<String> = grid()
        .into_par_iter()
        .filter_map(|(l, h)| {
            let r = from(&base, [0.5, l, h]);
            let lap = r.ticks.iter().position(|t| t.record.guidance.laps >= 1);
            let (rms, worst) = r.cross_track_from(lap.unwrap_or(0));
            let good = r.summary.reached_end && rms <= 0.09 && worst <= 0.25;
            (!good).then(|| format!("{l} {h:.2}: {rms:.3} {worst:.3}"))
        })
        .collect();
    assert!(failures.is_empty(), "{failures:#?}");
}

/// A long straight path, 3 m beside it and parallel.
fn parallel(law: LawName) -> Run {
    let mut scenario = scenario("worked-example");
    scenario.start = [0.0, 3.0, 0.0];
    scenario.control.law = law;
    run(&scenario, 1)
}

#[test]
fn the_paper_law_never_turns_towards_a_straight_path() {
    let r = parallel(LawName::Paper);
    assert!(r.ticks.len() > 50);
    for t in &r.ticks {
        assert!((t.truth[1] - 3.0).abs() < 1e-3, "{:?}", t.truth);
        assert_eq!(t.record.twist.angular.bits(), 0);
    }
}

#[test]
fn the_guided_law_does() {
    let r = parallel(LawName::Guided);
    let settled = r.settled(0.05).expect("converges");
    let after = r.travelled()[settled];
    println!("guided, 3 m beside: within 0.05 m after {after:.2} m");
    assert!(
        r.summary.reached_end && (3.0..10.0).contains(&after),
        "{after}"
    );
}

#[test]
fn closed_paths_and_points_are_driven() {
    for (name, bound) in [
        ("circle", 0.02),
        ("figure-eight", 0.02),
        ("square", 0.09),
        ("points", 0.02),
        ("facing-away", 0.02),
    ] {
        let r = run(&scenario(name), 1);
        let rms = r.summary.cross_track_rms_m.unwrap();
        println!(
            "{name}: rms {rms:.5} m, {:.3} m/s",
            r.summary.mean_speed_mps
        );
        assert!(r.summary.reached_end, "{name}");
        assert!(rms > 1e-6 && rms <= bound, "{name}: {rms}");
    }
}

#[test]
fn an_end_that_was_passed_by_is_driven_back_to() {
    // Starts beyond the end and beside it; the printed law would drive on along the last tangent for ever.
    for piece in [
        "line = { from = [0.0, 0.0], to = [0.4, 0.0] }",
        "arc = { centre = [0.0, 1.0], radius = 1.0, from = -90.0, sweep = 20.0 }",
    ] {
        let text = format!(
            "[robot]\npreset = \"small\"\n[start]\nx = 1.5\ny = -0.6\nheading = 20.0\n\
             [path]\n[[path.piece]]\n{piece}\n[run]\nduration = 30.0\n"
        );
        let scenario = host_sim::scenario::parse("beyond", "beyond.toml", &text).unwrap();
        let mut last = [0.0; 3];
        let ending = host_sim::run::simulate(&scenario, 1, &mut |step| last = step.truth).unwrap();
        assert_eq!(ending, host_sim::run::Ending::PathEnd, "{piece}");
        // The end's radius, and what 50 ms of latency predict ahead at up to 1 m/s.
        let end = scenario.path.track().beside(1.0, 0.0);
        assert!(
            (last[0] - end[0]).hypot(last[1] - end[1]) < 0.2,
            "{piece}: {last:?}"
        );
    }
}
