//! The last barrier's promise under the assumptions that its documentation states: whatever is wanted, no known point is
//! touched.

use fixed::types::{I8F24, I16F16};
use fuzzypilot::geometry::Point;
use fuzzypilot::navigate::{
    BarrierParams, Brakes, Footprint, Guarded, Motion, Near, Outline, Vector, gate, slow,
};
use fuzzypilot::signals::Twist;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond, Seconds};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

const PERIOD: f64 = 0.05;
/// Body of the test: half length and half width.
const HALF: [f64; 2] = [0.254, 0.215];
const GATE: f64 = 0.015;

fn number(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

fn twist([v, w]: [f64; 2]) -> Twist {
    Twist {
        linear: MetresPerSecond::new(number(v)),
        angular: RadiansPerSecond::new(number(w)),
    }
}

fn plain(twist: Twist) -> [f64; 2] {
    [twist.linear.bits(), twist.angular.bits()].map(|bits| f64::from(bits) / 65_536.0)
}

fn brakes() -> Brakes {
    Brakes {
        period: Seconds::new(I8F24::from_num(PERIOD)),
        linear: MetresPerSecond::new(number(2.5 * PERIOD)),
        angular: RadiansPerSecond::new(number(8.0 * PERIOD)),
    }
}

fn clearance([x, y]: [f64; 2]) -> f64 {
    let (a, b) = (x.abs() - HALF[0], y.abs() - HALF[1]);
    if a > 0.0 && b > 0.0 {
        a.hypot(b)
    } else {
        a.max(b)
    }
}

/// The robot of the assumptions: a command acts a period after it was given, under the acceleration limits.
struct Robot {
    pose: [f64; 3],
    twist: [f64; 2],
    last: [f64; 2],
}

impl Robot {
    fn to_body(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (x - self.pose[0], y - self.pose[1]);
        let (sin, cos) = self.pose[2].sin_cos();
        [dx * cos + dy * sin, dy * cos - dx * sin]
    }

    /// A period in which the last command acts; the least clearance on the way.
    fn go(&mut self, command: [f64; 2], points: &[[f64; 2]]) -> f64 {
        let dt = PERIOD / 10.0;
        let mut least = f64::INFINITY;
        for _ in 0..10 {
            let before = self.twist;
            for (now, (to, rate)) in self
                .twist
                .iter_mut()
                .zip(self.last.into_iter().zip([2.5, 8.0]))
            {
                *now += (to - *now).clamp(-rate * dt, rate * dt);
            }
            let [v, w] = [0, 1].map(|k| (before[k] + self.twist[k]) / 2.0);
            let heading = self.pose[2] + w * dt / 2.0;
            self.pose[0] += v * dt * heading.cos();
            self.pose[1] += v * dt * heading.sin();
            self.pose[2] += w * dt;
            let near = points.iter().map(|p| clearance(self.to_body(*p)));
            least = near.fold(least, f64::min);
        }
        self.last = command;
        least
    }
}

fn outline() -> Outline {
    Footprint::Rectangle {
        front: Metres::new(number(HALF[0])),
        rear: Metres::new(number(HALF[0])),
        half_width: Metres::new(number(HALF[1])),
    }
    .outline()
}

fn barrier() -> BarrierParams {
    BarrierParams {
        margin: Metres::new(number(0.02)),
        behind: Metres::new(number(0.04)),
        braking: number(1.0),
        share: number(0.9),
        gate: Metres::new(number(GATE)),
    }
}

fn guarded(robot: &Robot, before: [f64; 2], points: &[[f64; 2]], wanted: [f64; 2]) -> Guarded {
    let (outline, params) = (outline(), barrier());
    let vector = |p: &[f64; 2]| {
        let [x, y] = robot.to_body(*p);
        Vector::of(Point::new(Metres::new(number(x)), Metres::new(number(y))))
    };
    let driven = twist(robot.last);
    let moved = Motion::of(brakes().mean(twist(before), driven), brakes().period);
    let mut near = Near::new();
    near.collect(points.iter().map(|p| moved.sees(vector(p))), &outline);
    let stepped = brakes().toward(driven, twist(wanted));
    gate(&params, &near, &outline, brakes(), driven, stepped)
}

/// Fields of the test below; `FUZZYPILOT_FIELDS=60000 cargo test --release --test navigate_barrier` tries more of them in a minute
/// and a half. A gate that takes the latest contact instead of braking where nothing passes touches number 7,723 first.
const FIELDS: usize = 2000;

/// A reckless driver among random points, the same fields every time.
#[test]
fn whatever_is_wanted_no_known_point_is_touched() {
    let fields = (
        prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 1..30),
        prop::collection::vec((-0.3..2.0f64, -3.0..3.0f64), 1..12),
    );
    let mut runner = TestRunner::deterministic();
    let fields_tried = std::env::var("FUZZYPILOT_FIELDS").map_or(FIELDS, |n| n.parse().unwrap());
    let touched: Vec<usize> = (0..fields_tried)
        .filter(|_| {
            let field = fields.new_tree(&mut runner).unwrap().current();
            touches(&field.0, &field.1)
        })
        .collect();
    assert!(touched.is_empty(), "touched in fields {touched:?}");
}

/// Whether a driver who wants these twists in turn, half a second each, touches one of these points in 5 s.
fn touches(points: &[(f64, f64)], wants: &[(f64, f64)]) -> bool {
    let points: Vec<[f64; 2]> = points
        .iter()
        .map(|(x, y)| [*x, *y])
        .filter(|p| clearance(*p) > GATE + 0.002)
        .collect();
    let mut robot = Robot {
        pose: [0.0; 3],
        twist: [0.0; 2],
        last: [0.0; 2],
    };
    let mut before = [0.0; 2];
    (0..100).any(|tick| {
        let (v, w) = wants[tick / 10 % wants.len()];
        let passed = guarded(&robot, before, &points, [v, w]);
        before = robot.last;
        robot.go(plain(passed.twist), &points) <= 0.0
    })
}

/// The property can fail: without the gate the same driver runs into the first wall.
#[test]
fn without_the_gate_it_is_touched() {
    let wall: Vec<[f64; 2]> = (-10..=10).map(|i| [1.5, f64::from(i) * 0.1]).collect();
    let drive = |gated: bool| {
        let mut robot = Robot {
            pose: [0.0; 3],
            twist: [0.0; 2],
            last: [0.0; 2],
        };
        let (mut before, mut least) = ([0.0; 2], f64::INFINITY);
        for _ in 0..100 {
            let wanted = [2.0, 0.0];
            let passed = guarded(&robot, before, &wall, wanted);
            before = robot.last;
            let command = if gated { plain(passed.twist) } else { wanted };
            least = robot.go(command, &wall).min(least);
        }
        (least, robot.pose[0])
    };
    let (least, _) = drive(false);
    assert!(least < 0.0);
    let (least, x) = drive(true);
    assert!(least > 0.0, "{least}");
    // It stops close before the wall, not far from it.
    assert!(x > 1.5 - HALF[0] - 0.1, "{x}");
}

/// A point that is too close already does not hold a robot that leaves it.
#[test]
fn a_robot_may_leave_what_it_touches() {
    let robot = Robot {
        pose: [0.0; 3],
        twist: [0.0; 2],
        last: [0.0; 2],
    };
    let touching = [[HALF[0] + 0.005, 0.0]];
    let back = guarded(&robot, [0.0; 2], &touching, [-0.3, 0.0]);
    assert!(!back.gated && back.twist.linear < MetresPerSecond::ZERO);
    let on = guarded(&robot, [0.0; 2], &touching, [0.3, 0.0]);
    assert!(on.gated && on.twist.linear <= MetresPerSecond::ZERO);
}

/// Whatever the format can express comes to an end.
#[test]
fn extreme_twists_end() {
    let robot = Robot {
        pose: [0.0; 3],
        twist: [0.0; 2],
        last: [30_000.0, -30_000.0],
    };
    let passed = guarded(
        &robot,
        [-30_000.0, 30_000.0],
        &[[1.0, 0.0]],
        [30_000.0, 30_000.0],
    );
    assert!(passed.twist.linear <= MetresPerSecond::MAX);
}

/// What limits no speed that the next period can reach need not be looked for: the next twist is the same as if the arcs were
/// looked along as far as the wanted speed asks for.
#[test]
fn a_short_look_slows_the_next_period_as_a_long_one() {
    let (outline, params) = (outline(), barrier());
    let room = (Angle::from_bits(i32::MAX), Angle::from_bits(i32::MAX));
    let tireless = Brakes {
        linear: MetresPerSecond::new(number(8.0)),
        ..brakes()
    };
    let tries = (
        prop::collection::vec((-1.5..1.5f64, -1.0..1.0f64), 12),
        // Driven and wanted speeds, and one curvature: two that nearly agree count as one, the more so the shorter the look.
        (0.0..1.2f64, 0.0..2.0f64, -2.0..2.0f64),
        any::<bool>(),
    );
    let mut runner = TestRunner::deterministic();
    let (mut slowed, mut shorter) = (0, 0);
    for _ in 0..4000 {
        let (points, (driven, wanted, curvature), backward) =
            tries.new_tree(&mut runner).unwrap().current();
        let mut near = Near::new();
        let points = points.iter().filter(|(x, y)| clearance([*x, *y]) > 0.0);
        let places = points
            .map(|(x, y)| Vector::of(Point::new(Metres::new(number(*x)), Metres::new(number(*y)))));
        near.collect(places, &outline);
        let way = if backward { -1.0 } else { 1.0 };
        let [driven, wanted] = [driven, wanted].map(|v| twist([way * v, way * v * curvature]));
        let look = |brakes| slow(&params, &near, &outline, room, brakes, driven, wanted);
        let ((short, few), (long, many)) = (look(brakes()), look(tireless));
        let next = |slowed| brakes().toward(driven, slowed);
        assert_eq!(next(short), next(long), "{driven:?} {wanted:?}");
        slowed += u32::from(next(short) != next(wanted));
        shorter += u32::from(few < many);
    }
    assert!(slowed > 400 && shorter > 400, "{slowed}, {shorter}");
}

#[test]
fn backward_a_margin_of_its_own_counts() {
    let outline = outline();
    let room = (Angle::ZERO, Angle::ZERO);
    let speed = |way: f64, behind: f64| {
        let params = BarrierParams {
            behind: Metres::new(number(behind)),
            ..barrier()
        };
        let ahead = Metres::new(number(way * (HALF[0] + 0.1)));
        let mut near = Near::new();
        let place = Vector::of(Point::new(ahead, Metres::ZERO));
        near.collect(std::iter::once(place), &outline);
        let wanted = twist([way * 0.3, 0.0]);
        let (slowed, _) = slow(&params, &near, &outline, room, brakes(), wanted, wanted);
        plain(slowed)[0].abs()
    };
    assert_eq!(speed(1.0, 0.02), speed(1.0, 0.08));
    assert_eq!(speed(-1.0, 0.02), speed(1.0, 0.02));
    assert!(speed(-1.0, 0.02) > 0.2 && speed(-1.0, 0.08) < 0.05);
}
