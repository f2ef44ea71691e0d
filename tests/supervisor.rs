//! The higher level: every arrow of its state diagram, and what keeps it from chattering: dwell, hysteresis and the
//! commitment to a side.

use fixed::types::I16F16;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::params::{Avoider, Supervisor};
use fuzzypilot::ports::Fault;
use fuzzypilot::signals::{Decision, Guidance, Obstacle, Sensed, StopReason, Travel, Turn};
use fuzzypilot::supervisor::{Held, Mode, Situation, SupervisorState, inside_rule, threat};
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::units::{Angle, Metres, PerMetre};
use proptest::prelude::*;

const RADIUS: Metres = Metres::lit("0.1");
const DWELL: u16 = 3;
const PATIENCE: u16 = 6;

fn params() -> Supervisor {
    Supervisor {
        enter: Metres::lit("0.8"),
        exit: Metres::lit("1.4"),
        dwell: DWELL,
        clear: Angle::deg("6"),
        tie: Angle::deg("1"),
        same: Metres::lit("0.3"),
        patience: PATIENCE,
    }
}

fn avoider() -> Avoider {
    Avoider {
        tables: CoarseSet::Corrected,
        speed_input: SpeedInput::Deflection,
        range: Metres::lit("2"),
        margin: Metres::lit("0.08"),
        deflection_rate: I16F16::lit("2.5"),
        overshoot: Angle::deg("20"),
    }
}

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::from_num(x))
}

fn degrees(x: f64) -> Angle {
    Angle::from_degrees(I16F16::from_num(x))
}

fn point(x: f64, y: f64) -> Point {
    Point::new(metres(x), metres(y))
}

/// A world of discs around a robot, and the higher level under test.
struct Scene {
    state: SupervisorState,
    /// World frame: x, y, radius.
    discs: Vec<(f64, f64, f64)>,
    pose: Pose,
    valid: u8,
    travel: Travel,
    guidance: Guidance,
}

impl Scene {
    fn new(discs: &[(f64, f64, f64)]) -> Self {
        Self {
            state: SupervisorState::default(),
            discs: discs.to_vec(),
            pose: Pose::default(),
            valid: 32,
            travel: Travel::Counts { left: 0, right: 0 },
            guidance: Guidance {
                remaining: Metres::lit("100"),
                ..Guidance::default()
            },
        }
    }

    fn sensed(&self) -> Sensed {
        let mut obstacles: Vec<Obstacle> = self
            .discs
            .iter()
            .map(|&(x, y, radius)| Obstacle {
                centre: self.pose.to_body(point(x, y)),
                radius: metres(radius),
                residual: Metres::ZERO,
                echoes: 7,
            })
            .collect();
        obstacles.sort_by_key(|o| o.centre.norm() - o.radius);
        let mut sensed = Sensed {
            valid: self.valid,
            nearest: Metres::MAX,
            ..Sensed::default()
        };
        for obstacle in obstacles {
            sensed.obstacles.push(obstacle).unwrap();
        }
        sensed
    }

    fn ask<T>(&self, question: impl FnOnce(&SupervisorState, &Situation<'_>) -> T) -> T {
        let sensed = self.sensed();
        question(
            &self.state,
            &Situation {
                robot_radius: RADIUS,
                sensed: &sensed,
                travel: self.travel,
                pose: self.pose.frame(),
                guidance: &self.guidance,
            },
        )
    }

    fn tick_with(&mut self, params: &Supervisor) -> Decision {
        let sensed = self.sensed();
        let now = Situation {
            robot_radius: RADIUS,
            sensed: &sensed,
            travel: self.travel,
            pose: self.pose.frame(),
            guidance: &self.guidance,
        };
        self.state.decide(params, &avoider(), &now)
    }

    fn tick(&mut self) -> Decision {
        self.tick_with(&params())
    }

    fn ticks(&mut self, n: u16) -> Decision {
        (0..n).fold(Decision::Follow, |_, _| self.tick())
    }

    fn enters(&self) -> Option<Held> {
        self.ask(|state, now| {
            state.enters_avoid(&params(), now, threat(&params(), &avoider(), now))
        })
    }

    fn leaves(&self) -> bool {
        self.ask(|state, now| {
            state.leaves_avoid(&params(), now, threat(&params(), &avoider(), now))
        })
    }

    fn stops(&self) -> Option<StopReason> {
        self.ask(|state, now| state.stops(&params(), now))
    }

    fn resumes(&self) -> bool {
        self.ask(|state, now| state.resumes(&params(), now))
    }

    /// Straight ahead with this much free distance, radius 0.3.
    fn ahead(free: f64) -> Self {
        Self::new(&[(free + 0.4, 0.0, 0.3)])
    }

    fn avoiding() -> Self {
        let mut scene = Self::ahead(0.6);
        assert!(matches!(scene.tick(), Decision::Avoid { .. }));
        scene
    }

    fn put(&mut self, x: f64, y: f64) {
        self.pose = Pose::new(point(x, y), self.pose.heading);
    }

    fn lose_odometry(&mut self) {
        self.travel = Travel::Unknown(Fault::Bus);
    }

    fn find_odometry(&mut self) {
        self.travel = Travel::Counts { left: 0, right: 0 };
    }
}

/// Equal but for the error of sines and cosines.
fn near(a: Point, b: Point) -> bool {
    (a - b).norm() < Metres::lit("0.0005")
}

fn side(decision: Decision) -> Option<Turn> {
    match decision {
        Decision::Avoid { side, .. } => Some(side),
        _ => None,
    }
}

// ---- the arrows ----

#[test]
fn follow_to_avoid_is_enters_avoid() {
    let mut scene = Scene::ahead(0.9);
    assert_eq!(scene.enters(), None);
    assert_eq!(scene.tick(), Decision::Follow);
    scene.put(0.2, 0.0);
    let held = scene.enters().expect("0.7 m free, straight ahead");
    assert_eq!((held.side, held.unseen), (Turn::Right, 0));
    assert!(near(held.centre, point(1.3, 0.0)));
    let decision = scene.tick();
    assert_eq!(
        decision,
        Decision::Avoid {
            side: Turn::Right,
            obstacle: held.obstacle
        }
    );
    assert_eq!(scene.state.mode(), Mode::Avoid);
}

#[test]
fn avoid_to_follow_is_leaves_avoid() {
    let mut scene = Scene::avoiding();
    scene.ticks(DWELL + 1);
    assert!(!scene.leaves());
    // Beside it, with it on the left: the way ahead is free.
    scene.put(1.0, -0.6);
    scene.tick();
    assert_eq!(scene.state.mode(), Mode::Follow);
}

#[test]
fn avoid_to_avoid_is_retarget() {
    let mut scene = Scene::new(&[(1.0, 0.0, 0.3), (2.2, -0.9, 0.3)]);
    assert_eq!(side(scene.tick()), Some(Turn::Right));
    scene.ticks(DWELL + 1);
    // Past the first, the second covers the way; on its own it would be passed on the left.
    scene.put(1.2, -0.8);
    let Decision::Avoid { side, obstacle } = scene.tick() else {
        panic!("the second is in the way")
    };
    assert_eq!(side, Turn::Right, "the side stays");
    let apart = (scene.pose.to_world(obstacle.centre) - point(2.2, -0.9)).norm();
    assert!(apart < Metres::lit("0.001"));
    let mut fresh = Scene::new(&[(2.2, -0.9, 0.3)]);
    fresh.put(1.2, -0.8);
    assert_eq!(fresh.enters().unwrap().side, Turn::Left);
}

#[test]
fn follow_to_stop_is_stops() {
    for (reason, spoil) in [
        (
            StopReason::NoRanges,
            (|s: &mut Scene| s.valid = 0) as fn(&mut Scene),
        ),
        (StopReason::NoOdometry, Scene::lose_odometry),
    ] {
        let mut scene = Scene::new(&[]);
        scene.ticks(5);
        spoil(&mut scene);
        for _ in 0..PATIENCE {
            assert_eq!(scene.tick(), Decision::Follow, "patience");
            assert_eq!(scene.stops(), None);
        }
        assert_eq!(scene.tick(), Decision::Stop(reason));
        assert_eq!(scene.stops(), Some(reason));
        assert_eq!(scene.state.mode(), Mode::Stop(reason));
    }
}

#[test]
fn avoid_to_stop_is_stops() {
    let mut scene = Scene::avoiding();
    scene.lose_odometry();
    assert!(side(scene.ticks(PATIENCE)).is_some());
    assert_eq!(scene.tick(), Decision::Stop(StopReason::NoOdometry));
    // At once, too, before any dwell in Avoid is over.
    let mut scene = Scene::avoiding();
    scene.guidance.at_end = true;
    assert_eq!(scene.tick(), Decision::Stop(StopReason::PathEnd));
}

#[test]
fn stop_to_follow_is_resumes() {
    for spoil in [(|s: &mut Scene| s.valid = 0) as fn(&mut Scene), |s| {
        s.lose_odometry();
    }] {
        let mut scene = Scene::new(&[]);
        spoil(&mut scene);
        let stopped = scene.ticks(PATIENCE + 5);
        assert!(matches!(stopped, Decision::Stop(_)));
        assert!(!scene.resumes());
        scene.valid = 1;
        scene.find_odometry();
        for _ in 1..DWELL {
            assert_eq!(scene.tick(), stopped, "dwell");
            assert!(!scene.resumes());
        }
        assert_eq!(scene.tick(), Decision::Follow);
    }
}

// ---- stopping and resuming ----

#[test]
fn one_good_tick_renews_patience() {
    let mut scene = Scene::new(&[]);
    for _ in 0..20 {
        scene.valid = 0;
        assert_eq!(scene.ticks(PATIENCE), Decision::Follow);
        scene.valid = 1;
        assert_eq!(scene.tick(), Decision::Follow);
    }
}

#[test]
fn blindness_and_lost_odometry_have_patience_of_their_own() {
    let mut scene = Scene::new(&[]);
    scene.valid = 0;
    scene.ticks(PATIENCE);
    scene.valid = 1;
    scene.lose_odometry();
    assert_eq!(scene.ticks(PATIENCE), Decision::Follow);
    assert_eq!(scene.tick(), Decision::Stop(StopReason::NoOdometry));
}

#[test]
fn a_relapse_begins_the_dwell_of_resuming_anew() {
    let mut scene = Scene::new(&[]);
    scene.valid = 0;
    scene.ticks(PATIENCE + 1);
    for _ in 0..10 {
        scene.valid = 1;
        assert!(matches!(scene.ticks(DWELL - 1), Decision::Stop(_)));
        scene.valid = 0;
        assert!(matches!(scene.tick(), Decision::Stop(_)));
    }
    // One of both back is not enough.
    scene.valid = 1;
    scene.lose_odometry();
    assert!(matches!(scene.ticks(50), Decision::Stop(_)));
}

#[test]
fn without_dwell_the_robot_resumes_with_the_first_good_tick() {
    let eager = Supervisor {
        dwell: 0,
        ..params()
    };
    let mut scene = Scene::new(&[]);
    scene.valid = 0;
    for _ in 0..=PATIENCE {
        scene.tick_with(&eager);
    }
    assert!(matches!(scene.tick_with(&eager), Decision::Stop(_)));
    scene.valid = 1;
    assert_eq!(scene.tick_with(&eager), Decision::Follow);
}

#[test]
fn the_path_end_outranks_every_other_reason_and_lasts() {
    let mut scene = Scene::ahead(0.5);
    scene.valid = 0;
    scene.lose_odometry();
    scene.ticks(PATIENCE + 1);
    scene.guidance.at_end = true;
    assert_eq!(scene.tick(), Decision::Stop(StopReason::PathEnd));
    scene.valid = 32;
    scene.find_odometry();
    for _ in 0..1000 {
        assert_eq!(scene.tick(), Decision::Stop(StopReason::PathEnd));
        assert!(!scene.resumes());
    }
}

#[test]
fn counters_saturate() {
    // u16 ticks are 55 minutes at 20 Hz: the counts must not start again from 0.
    let mut scene = Scene::new(&[]);
    scene.valid = 0;
    scene.lose_odometry();
    for tick in 0..70_000u32 {
        let stopped = matches!(scene.tick(), Decision::Stop(_));
        assert_eq!(stopped, tick >= u32::from(PATIENCE), "{tick}");
    }
    scene.valid = 1;
    scene.find_odometry();
    for tick in 1..70_000u32 {
        let follows = scene.tick() == Decision::Follow;
        assert_eq!(follows, tick >= u32::from(DWELL), "{tick}");
    }
}

// ---- entering ----

#[test]
fn enter_is_measured_from_rim_to_surface() {
    assert!(Scene::ahead(0.801).enters().is_none());
    assert!(Scene::ahead(0.799).enters().is_some());
}

#[test]
fn what_is_beside_the_way_does_not_matter() {
    // Grown by the robot and half the margin the disc is 0.44 m wide to either side; 1 m away that is 26.1°.
    let at = |off: f64| {
        let off = off.to_radians();
        Scene::new(&[(off.cos(), off.sin(), 0.3)])
    };
    for sign in [-1.0, 1.0] {
        assert!(at(sign * 25.5).enters().is_some());
        assert!(at(sign * 26.6).enters().is_none());
    }
    // The way is where guidance points, not the heading.
    let mut scene = at(60.0);
    assert!(scene.enters().is_none());
    scene.guidance.heading_error = degrees(60.0);
    assert!(scene.enters().is_some());
}

#[test]
fn what_the_robot_points_at_matters_within_half_of_enter() {
    for (free, enters) in [(0.39, true), (0.41, false)] {
        let mut scene = Scene::ahead(free);
        scene.guidance.heading_error = degrees(120.0);
        assert_eq!(scene.enters().is_some(), enters, "{free}");
    }
}

#[test]
fn what_stands_beyond_the_path_end_does_not_matter() {
    for (remaining, enters) in [("0.59", false), ("0.61", true)] {
        let mut scene = Scene::ahead(0.6);
        scene.guidance.remaining = Metres::lit(remaining);
        assert_eq!(scene.enters().is_some(), enters);
    }
}

#[test]
fn the_nearest_in_the_way_is_held() {
    let scene = Scene::new(&[(1.1, 0.1, 0.3), (0.9, 0.0, 0.3), (0.5, 0.6, 0.2)]);
    assert!(near(scene.enters().unwrap().centre, point(0.9, 0.0)));
}

// ---- side ----

#[test]
fn obstacle_on_the_left_turns_right_and_the_other_way_round() {
    for (y, expected) in [
        (0.2, Turn::Right),
        (-0.2, Turn::Left),
        // Ties break right, up to 1° on either side.
        (0.0, Turn::Right),
        (-0.015, Turn::Right),
        (-0.02, Turn::Left),
    ] {
        let scene = Scene::new(&[(1.0, y, 0.3)]);
        assert_eq!(scene.enters().unwrap().side, expected, "y = {y}");
    }
}

#[test]
fn left_and_right_are_of_the_way_not_of_the_heading() {
    // On the robot's left, but right of where it is going.
    let mut scene = Scene::new(&[(0.9, 0.2, 0.3)]);
    scene.guidance.heading_error = degrees(25.0);
    assert_eq!(scene.enters().unwrap().side, Turn::Left);
}

/// On a circle of 3 m about the origin at (3, 0), 0.9 m of arc before the obstacle.
fn on_arc(left: bool, from_centre: f64) -> Scene {
    let along: f64 = 0.3;
    let mirror = if left { 1.0 } else { -1.0 };
    let (x, y) = (from_centre * along.cos(), from_centre * along.sin());
    // A right-hand circle is the left-hand one mirrored on the x axis.
    let mut scene = Scene::new(&[(x, y * mirror, 0.3)]);
    scene.pose = Pose::new(point(3.0, 0.0), degrees(90.0 * mirror));
    scene.guidance.foot = point(3.0, 0.0);
    scene.guidance.tangent = degrees(90.0 * mirror);
    scene.guidance.curvature = PerMetre::new(I16F16::from_num(mirror / 3.0));
    scene
}

fn inside(scene: &Scene) -> Option<Turn> {
    scene.ask(|_, now| inside_rule(now, &now.sensed.obstacles[0]))
}

#[test]
fn inside_an_arc_is_passed_outside() {
    // (circle turns left, distance of the obstacle from the circle's centre, rule). A quarter of its radius, 0.075 m,
    // within the path is on neither side.
    for (left, from_centre, expected) in [
        (true, 2.7, Some(Turn::Right)),
        (true, 2.91, Some(Turn::Right)),
        (true, 2.94, None),
        (true, 3.0, None),
        (true, 3.3, None),
        (false, 2.7, Some(Turn::Left)),
        (false, 2.91, Some(Turn::Left)),
        (false, 2.94, None),
        (false, 3.3, None),
    ] {
        let scene = on_arc(left, from_centre);
        assert_eq!(inside(&scene), expected, "{left} {from_centre}");
    }
}

#[test]
fn the_inside_rule_outranks_the_bearing() {
    // The way points a little inside: without the rule, bearing would pass it on the other side.
    for (left, expected, otherwise) in [
        (true, Turn::Right, Turn::Left),
        (false, Turn::Left, Turn::Right),
    ] {
        let mut scene = on_arc(left, 2.85);
        scene.guidance.heading_error = degrees(if left { 30.0 } else { -30.0 });
        assert_eq!(scene.enters().unwrap().side, expected);
        scene.guidance.curvature = PerMetre::ZERO;
        assert_eq!(scene.enters().unwrap().side, otherwise);
    }
}

#[test]
fn a_straight_path_has_no_inside() {
    for y in [-1.0, 0.0, 1.0] {
        assert_eq!(inside(&Scene::new(&[(1.0, y, 0.3)])), None);
    }
}

#[test]
fn a_hardly_bent_path_has_its_inside_on_the_right_side() {
    // 5 km of radius: the cosine's error is worth 10 cm there, less than what the obstacle stands outside.
    for (from_bits, place) in [(13, 0.0), (13, 1000.0), (-13, 0.0)] {
        let mut scene = Scene::new(&[(
            place + 0.9,
            place - 0.3 * f64::from(i32::signum(from_bits)),
            0.3,
        )]);
        scene.pose = Pose::new(point(place, place), Angle::ZERO);
        scene.guidance.foot = point(place, place);
        scene.guidance.curvature = PerMetre::from_bits(from_bits);
        assert_eq!(inside(&scene), None, "{from_bits} at {place}");
    }
}

#[test]
fn an_outside_obstacle_is_never_inside_however_large_the_circle() {
    for bits in [1, 2, 3] {
        let mut scene = Scene::new(&[(50.9, 49.8, 0.3)]);
        scene.pose = Pose::new(point(50.0, 50.0), Angle::ZERO);
        scene.guidance.foot = point(50.0, 50.0);
        scene.guidance.curvature = PerMetre::from_bits(bits);
        // It stands 0.2 m to the right of a path that bends left by 1.5e-5 /m.
        assert_eq!(inside(&scene), None, "{bits}");
        assert_eq!(scene.enters().unwrap().side, Turn::Left, "{bits}");
    }
}

#[test]
fn any_curvature_is_asked_without_panic() {
    for bits in [1, -1, 7, i32::MAX, i32::MIN, 65_536] {
        for at in [Metres::MAX, Metres::from_bits(i32::MIN), Metres::ZERO] {
            let mut scene = Scene::new(&[(1.0, 0.5, 0.3)]);
            scene.guidance.curvature = PerMetre::from_bits(bits);
            scene.guidance.foot = Point::new(at, at);
            scene.pose.at = Point::new(at, at);
            let _ = inside(&scene);
        }
    }
}

// ---- commitment ----

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// The robot stands before a disc whose estimate jitters about straight ahead; the disc is lost now and then.
    #[test]
    fn jitter_around_straight_ahead_never_changes_the_side(
        first in -4.0..4.0f64,
        scan in prop::collection::vec((-4.0..4.0f64, 0.62..0.84f64, 0.0..1.0f64), 400),
    ) {
        let mut scene = Scene::ahead(0.7);
        let mut committed = None;
        for (bearing, free, seen) in std::iter::once((first, 0.75, 1.0)).chain(scan) {
            let (sin, cos) = bearing.to_radians().sin_cos();
            scene.discs = match seen > 0.2 {
                true => vec![((free + 0.4) * cos, (free + 0.4) * sin, 0.3)],
                false => Vec::new(),
            };
            if let Some(side) = side(scene.tick()) {
                prop_assert_eq!(side, *committed.get_or_insert(side));
            }
        }
        prop_assert!(committed.is_some());
    }
}

#[test]
fn an_obstacle_that_vanishes_and_reappears_keeps_its_side() {
    // For a tick, for as long as patience lasts, and for so long that avoiding ended.
    for gone in [1, PATIENCE, 10 * PATIENCE] {
        let mut scene = Scene::new(&[(1.0, -0.1, 0.3)]);
        assert_eq!(side(scene.tick()), Some(Turn::Left));
        scene.ticks(DWELL + 1);
        let disc = scene.discs.pop();
        let meanwhile = scene.ticks(gone);
        assert_eq!(
            side(meanwhile).is_some(),
            gone <= PATIENCE,
            "out of sight for {gone}"
        );
        // It comes back on the other side of straight ahead.
        scene.discs = disc.map(|(x, _, r)| (x, 0.1, r)).into_iter().collect();
        let back: Vec<_> = (0..=DWELL).filter_map(|_| side(scene.tick())).collect();
        assert!(!back.is_empty());
        assert!(back.iter().all(|s| *s == Turn::Left), "{gone}: {back:?}");
    }
}

#[test]
fn a_different_obstacle_chooses_its_own_side() {
    let mut scene = Scene::new(&[(1.0, -0.1, 0.3)]);
    assert_eq!(side(scene.tick()), Some(Turn::Left));
    scene.ticks(DWELL + 1);
    scene.discs.clear();
    assert_eq!(scene.ticks(PATIENCE + DWELL + 2), Decision::Follow);
    scene.discs = vec![(1.0, 0.3, 0.3)];
    assert_eq!(side(scene.tick()), Some(Turn::Right));
}

#[test]
fn odometry_carries_the_held_obstacle() {
    let mut scene = Scene::avoiding();
    scene.discs.clear();
    scene.pose = Pose::new(point(0.2, -0.1), degrees(-20.0));
    let Decision::Avoid { obstacle, .. } = scene.tick() else {
        panic!("dwell")
    };
    let off = (scene.pose.to_world(obstacle.centre) - point(1.0, 0.0)).norm();
    assert!(off < Metres::lit("0.0005"), "{off:?}");
    assert_eq!(obstacle.radius, metres(0.3));
}

#[test]
fn a_noisy_estimate_is_followed_halfway() {
    let mut scene = Scene::avoiding();
    scene.discs = vec![(1.2, 0.1, 0.4)];
    let Decision::Avoid { obstacle, .. } = scene.tick() else {
        panic!("dwell")
    };
    assert!((obstacle.centre - point(1.1, 0.05)).norm() < Metres::lit("0.0001"));
    assert!((obstacle.radius - metres(0.35)).abs() < Metres::lit("0.0001"));
}

// ---- dwell and hysteresis ----

#[test]
fn the_first_obstacle_needs_no_dwell() {
    assert!(side(Scene::ahead(0.5).tick()).is_some());
}

#[test]
fn dwell_holds_avoid() {
    let mut scene = Scene::avoiding();
    // Far away at once: only the dwell keeps it.
    scene.put(-5.0, 0.0);
    for _ in 1..DWELL {
        assert!(!scene.leaves());
        assert!(side(scene.tick()).is_some());
    }
    assert!(scene.leaves());
    assert_eq!(scene.tick(), Decision::Follow);
}

#[test]
fn dwell_holds_follow() {
    let mut scene = Scene::avoiding();
    scene.put(-5.0, 0.0);
    scene.ticks(DWELL);
    assert_eq!(scene.state.mode(), Mode::Follow);
    scene.put(0.0, 0.0);
    for _ in 1..DWELL {
        assert_eq!(scene.tick(), Decision::Follow);
    }
    assert!(side(scene.tick()).is_some());
}

#[test]
fn a_mode_lasts_dwell_ticks_and_no_more() {
    let mut scene = Scene::ahead(0.6);
    let mut avoided = 0;
    while side(scene.tick()).is_some() {
        avoided += 1;
        scene.put(-5.0, 0.0);
    }
    assert_eq!(avoided, DWELL);
}

#[test]
fn between_enter_and_exit_nothing_changes() {
    let mut scene = Scene::ahead(1.0);
    assert_eq!(scene.ticks(50), Decision::Follow);
    // Free distance is 1.0 − x here.
    scene.put(0.3, 0.0);
    assert!(side(scene.tick()).is_some());
    for i in 0..200 {
        scene.put(if i % 2 == 0 { -0.38 } else { 0.3 }, 0.0);
        assert!(side(scene.tick()).is_some(), "tick {i}");
    }
    scene.put(-0.42, 0.0);
    assert_eq!(scene.tick(), Decision::Follow);
}

#[test]
fn a_way_that_just_clears_does_not_end_it() {
    // Grown by the whole margin: 0.48 m; at 1 m that is 28.7°. Avoiding ends 6° later.
    let mut scene = Scene::avoiding();
    scene.ticks(DWELL + 1);
    for (way, leaves) in [
        (0.0, false),
        (-20.0, false),
        (-34.2, false),
        (-35.2, true),
        // To the other side only if the robot points there already.
        (35.2, false),
    ] {
        scene.guidance.heading_error = degrees(way);
        assert_eq!(scene.leaves(), leaves, "{way}");
    }
    scene.pose.heading = degrees(36.0);
    scene.guidance.heading_error = Angle::ZERO;
    assert_eq!(scene.tick(), Decision::Follow);
}

#[test]
fn another_one_in_the_way_keeps_it() {
    let mut scene = Scene::avoiding();
    scene.ticks(DWELL + 1);
    scene.guidance.heading_error = degrees(-50.0);
    assert!(scene.leaves());
    scene.discs.push((0.6, -0.7, 0.2));
    assert!(!scene.leaves());
}

#[test]
fn a_way_straight_back_ends_it() {
    // What lies more than a quarter turn off the way is not in it, wherever the robot points.
    let mut scene = Scene::avoiding();
    scene.ticks(DWELL + 1);
    for way in [-170.0, -120.0, -60.0] {
        scene.guidance.heading_error = degrees(way);
        assert!(scene.leaves(), "{way}");
    }
}

#[test]
fn a_way_that_leads_away_ends_it_whatever_the_heading() {
    let mut scene = Scene::avoiding();
    scene.ticks(DWELL + 1);
    // Obstacle 100° to the left, the way 90° to the right: it is 170° off the way.
    scene.pose.heading = degrees(-100.0);
    scene.guidance.heading_error = degrees(-90.0);
    assert_eq!(scene.tick(), Decision::Follow);
}
