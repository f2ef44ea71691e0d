//! The last barrier's promise under the assumptions that its documentation states: whatever is wanted, no known point is
//! touched.

use fixed::types::{I8F24, I16F16};
use fuzzypilot::geometry::Point;
use fuzzypilot::navigate::{
    BarrierParams, Brakes, Footprint, Guarded, Motion, Near, Outline, Trajectory, Vector, gate,
    slow,
};
use fuzzypilot::signals::Twist;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond, Seconds};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Body of most tests: half length and half width.
const HALF: [f64; 2] = [0.254, 0.215];

fn number(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

fn metres(x: f64) -> Metres {
    Metres::new(number(x))
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

/// A robot: its outline, and what the barrier's promise depends on.
#[derive(Clone, Copy, Debug)]
struct Kind {
    body: Body,
    period: f64,
    /// Periods.
    latency: usize,
    /// m/s² and rad/s².
    brakes: [f64; 2],
    /// m/s and rad/s.
    fastest: [f64; 2],
    gate: f64,
}

#[derive(Clone, Copy, Debug)]
enum Body {
    Rectangle,
    Disc,
    Wedge,
}

const JACKAL: Kind = Kind {
    body: Body::Rectangle,
    period: 0.05,
    latency: 1,
    brakes: [2.5, 8.0],
    fastest: [2.0, 3.0],
    gate: 0.015,
};

/// Corners of the wedge, counter-clockwise.
const WEDGE: [[f64; 2]; 3] = [[0.4, 0.0], [-0.2, 0.25], [-0.2, -0.25]];
const RADIUS: f64 = 0.25;

impl Body {
    fn outline(self) -> Outline {
        let footprint = match self {
            Self::Rectangle => Footprint::Rectangle {
                front: metres(HALF[0]),
                rear: metres(HALF[0]),
                half_width: metres(HALF[1]),
            },
            Self::Disc => Footprint::Disc {
                radius: metres(RADIUS),
            },
            Self::Wedge => Footprint::Polygon(
                WEDGE
                    .map(|[x, y]| Point::new(metres(x), metres(y)))
                    .into_iter()
                    .collect(),
            ),
        };
        footprint.check().unwrap();
        footprint.outline()
    }

    /// Distance of a place from the outline, negative inside.
    fn clearance(self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Rectangle => {
                let (a, b) = (x.abs() - HALF[0], y.abs() - HALF[1]);
                if a > 0.0 && b > 0.0 {
                    a.hypot(b)
                } else {
                    a.max(b)
                }
            }
            Self::Disc => x.hypot(y) - RADIUS,
            Self::Wedge => {
                let (mut inside, mut nearest) = (f64::NEG_INFINITY, f64::INFINITY);
                for (from, to) in WEDGE.iter().zip(WEDGE.iter().cycle().skip(1)) {
                    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
                    let [px, py] = [x - from[0], y - from[1]];
                    let length = dx.hypot(dy);
                    inside = inside.max((px * dy - py * dx) / length);
                    let along = ((px * dx + py * dy) / length.powi(2)).clamp(0.0, 1.0);
                    nearest = nearest.min((px - along * dx).hypot(py - along * dy));
                }
                if inside > 0.0 { nearest } else { inside }
            }
        }
    }
}

impl Kind {
    fn seconds(&self, periods: usize) -> Seconds {
        Seconds::new(I8F24::from_num(self.period * periods as f64))
    }

    fn brakes(&self) -> Brakes {
        let [linear, angular] = self.brakes.map(|rate| number(rate * self.period));
        Brakes {
            period: self.seconds(1),
            linear: MetresPerSecond::new(linear),
            angular: RadiansPerSecond::new(angular),
        }
    }

    fn barrier(&self) -> BarrierParams {
        BarrierParams {
            margin: metres(0.02),
            behind: metres(0.04),
            braking: number(1.0),
            share: number(0.9),
            gate: metres(self.gate),
        }
    }
}

/// The robot of the assumptions: a command acts the latency after it was given, under the acceleration limits.
struct Robot {
    kind: Kind,
    pose: [f64; 3],
    twist: [f64; 2],
    /// The last commands, the newest last.
    commands: Vec<[f64; 2]>,
}

impl Robot {
    fn new(kind: Kind) -> Self {
        Self {
            kind,
            pose: [0.0; 3],
            twist: [0.0; 2],
            commands: vec![[0.0; 2]; kind.latency.max(2)],
        }
    }

    fn to_body(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (x - self.pose[0], y - self.pose[1]);
        let (sin, cos) = self.pose[2].sin_cos();
        [dx * cos + dy * sin, dy * cos - dx * sin]
    }

    /// A period in which the command of so long ago acts; the least clearance on the way.
    fn go(&mut self, command: [f64; 2], points: &[[f64; 2]]) -> f64 {
        self.commands.push(command);
        let acting = self.commands[self.commands.len() - 1 - self.kind.latency];
        let dt = self.kind.period / 10.0;
        let mut least = f64::INFINITY;
        for _ in 0..10 {
            let before = self.twist;
            for (now, (to, rate)) in self
                .twist
                .iter_mut()
                .zip(acting.into_iter().zip(self.kind.brakes))
            {
                *now += (to - *now).clamp(-rate * dt, rate * dt);
            }
            let [v, w] = [0, 1].map(|k| (before[k] + self.twist[k]) / 2.0);
            let heading = self.pose[2] + w * dt / 2.0;
            self.pose[0] += v * dt * heading.cos();
            self.pose[1] += v * dt * heading.sin();
            self.pose[2] += w * dt;
            let near = points
                .iter()
                .map(|p| self.kind.body.clearance(self.to_body(*p)));
            least = near.fold(least, f64::min);
        }
        least
    }

    fn guarded(&self, points: &[[f64; 2]], wanted: [f64; 2]) -> Guarded {
        let (outline, params) = (self.kind.body.outline(), self.kind.barrier());
        let vector = |p: &[f64; 2]| {
            let [x, y] = self.to_body(*p);
            Vector::of(Point::new(metres(x), metres(y)))
        };
        let [.., before, last] = self.commands.as_slice() else {
            panic!("two commands at least");
        };
        let (brakes, driven) = (self.kind.brakes(), twist(*last));
        let moved = Motion::of(
            brakes.mean(twist(*before), driven),
            self.kind.seconds(self.kind.latency),
        );
        let mut near = Near::new();
        near.collect(points.iter().map(|p| moved.sees(vector(p))), &outline);
        let stepped = brakes.toward(driven, twist(wanted));
        gate(
            &mut Trajectory::new(),
            &params,
            &near,
            &outline,
            brakes,
            driven,
            stepped,
        )
    }
}

/// Fields of the test below; `FUZZYPILOT_FIELDS=60000 cargo test --release --test navigate_barrier` tries more of them in a
/// minute and a half. A gate that takes the latest contact instead of braking where nothing passes touches number 7,723 first.
const FIELDS: usize = 2000;

fn fields_to_try(usual: usize) -> usize {
    std::env::var("FUZZYPILOT_FIELDS").map_or(usual, |n| n.parse().unwrap())
}

/// A reckless driver among random points, the same fields every time.
#[test]
fn whatever_is_wanted_no_known_point_is_touched() {
    let touched = fields_touched(JACKAL, fields_to_try(FIELDS));
    assert!(touched.is_empty(), "touched in fields {touched:?}");
}

/// The same with other outlines, and where `NavigatorParams::setup` draws the line: brakes that take 23 periods, long and
/// short periods, a latency of none and of two, the least margin. Past the line it is touched.
#[test]
fn nor_with_other_outlines_or_at_the_limits_of_the_settings() {
    let kinds = [
        Kind {
            body: Body::Disc,
            ..JACKAL
        },
        Kind {
            body: Body::Wedge,
            gate: 0.018,
            ..JACKAL
        },
        Kind {
            fastest: [2.8, 3.0],
            ..JACKAL
        },
        Kind {
            brakes: [0.87, 2.7],
            fastest: [1.0, 3.0],
            ..JACKAL
        },
        Kind {
            period: 0.1,
            fastest: [1.5, 3.0],
            gate: 0.03,
            ..JACKAL
        },
        Kind {
            period: 0.02,
            fastest: [1.1, 3.0],
            ..JACKAL
        },
        Kind {
            latency: 0,
            ..JACKAL
        },
        Kind {
            latency: 2,
            ..JACKAL
        },
        Kind {
            gate: 0.01,
            fastest: [2.0, 2.0],
            ..JACKAL
        },
    ];
    for kind in kinds {
        let touched = fields_touched(kind, fields_to_try(FIELDS) / 10);
        assert!(touched.is_empty(), "{kind:?}: touched in {touched:?}");
    }
    let weak = Kind {
        period: 0.01,
        fastest: [1.0, 3.0],
        ..JACKAL
    };
    let late = Kind {
        latency: 4,
        fastest: [1.0, 3.0],
        ..JACKAL
    };
    let close = Kind {
        gate: 0.0,
        ..JACKAL
    };
    for kind in [weak, late, close] {
        assert!(!fields_touched(kind, 100).is_empty(), "{kind:?}");
    }
}

/// Fields of up to 30 points in which a driver who wants random twists touches one.
fn fields_touched(kind: Kind, tried: usize) -> Vec<usize> {
    let [v, w] = kind.fastest;
    let fields = (
        prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 1..30),
        prop::collection::vec((-0.3..v, -w..w), 1..12),
    );
    let mut runner = TestRunner::deterministic();
    (0..tried)
        .filter(|_| {
            let field = fields.new_tree(&mut runner).unwrap().current();
            touches(kind, &field.0, &field.1)
        })
        .collect()
}

/// Whether a driver who wants these twists in turn, half a second each, touches one of these points in 5 s.
fn touches(kind: Kind, points: &[(f64, f64)], wants: &[(f64, f64)]) -> bool {
    let points: Vec<[f64; 2]> = points
        .iter()
        .map(|(x, y)| [*x, *y])
        .filter(|p| kind.body.clearance(*p) > kind.gate + 0.002)
        .collect();
    let mut robot = Robot::new(kind);
    let ticks = (5.0 / kind.period).round() as usize;
    (0..ticks).any(|tick| {
        let (v, w) = wants[tick * 10 / ticks % wants.len()];
        let passed = robot.guarded(&points, [v, w]);
        robot.go(plain(passed.twist), &points) <= 0.0
    })
}

/// The property can fail: without the gate the same driver runs into the first wall.
#[test]
fn without_the_gate_it_is_touched() {
    let wall: Vec<[f64; 2]> = (-10..=10).map(|i| [1.5, f64::from(i) * 0.1]).collect();
    let drive = |gated: bool| {
        let mut robot = Robot::new(JACKAL);
        let mut least = f64::INFINITY;
        for _ in 0..100 {
            let wanted = [2.0, 0.0];
            let passed = robot.guarded(&wall, wanted);
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
    let robot = Robot::new(JACKAL);
    let touching = [[HALF[0] + 0.005, 0.0]];
    let back = robot.guarded(&touching, [-0.3, 0.0]);
    assert!(!back.gated && back.twist.linear < MetresPerSecond::ZERO);
    let on = robot.guarded(&touching, [0.3, 0.0]);
    assert!(on.gated && on.twist.linear <= MetresPerSecond::ZERO);
}

/// A motion that rounding hides would come closer period after period.
#[test]
fn nobody_creeps_up_to_a_point() {
    let robot = Robot::new(JACKAL);
    let ahead = [[HALF[0] + 0.005, 0.0]];
    let aside = [[HALF[0] - 0.05, HALF[1] + 0.005]];
    let passed = |points: &[[f64; 2]], wanted| plain(robot.guarded(points, wanted).twist);
    assert_eq!(passed(&ahead, [0.004, 0.0]), [0.0; 2]);
    assert_eq!(passed(&aside, [0.0, 0.01]), [0.0; 2]);
    // Where there is room it may.
    let [v, w] = passed(&[[1.0, 0.0]], [0.004, 0.01]);
    assert!(v > 0.003 && w > 0.009);
}

/// However little a period's brakes change: from a point inside the margin every robot that `setup` takes gets away.
#[test]
fn who_starts_slowly_leaves_what_it_touches() {
    for (period, acceleration) in [(0.02, 1.0), (0.01, 2.5), (0.01, 0.5)] {
        let kind = Kind {
            period,
            brakes: [acceleration, 4.0],
            ..JACKAL
        };
        let ahead = [[HALF[0] + 0.005, 0.0]];
        let aside = [[HALF[0] - 0.02, HALF[1] + 0.005]];
        let driven = |point: [[f64; 2]; 1], wanted| {
            let mut robot = Robot::new(kind);
            for _ in 0..(2.0 / period) as usize {
                let passed = robot.guarded(&point, wanted);
                robot.go(plain(passed.twist), &point);
            }
            robot.pose
        };
        let [x, ..] = driven(ahead, [-0.3, 0.0]);
        assert!(x < -0.3, "{kind:?}: {x}");
        let [.., heading] = driven(aside, [0.0, -0.5]);
        assert!(heading < -0.2, "{kind:?}: {heading}");
    }
}

/// Whatever the format can express comes to an end.
#[test]
fn extreme_twists_end() {
    let mut robot = Robot::new(JACKAL);
    robot.commands = vec![[-30_000.0, 30_000.0], [30_000.0, -30_000.0]];
    let passed = robot.guarded(&[[1.0, 0.0]], [30_000.0, 30_000.0]);
    assert!(passed.twist.linear <= MetresPerSecond::MAX);
}

/// What limits no speed that the next period can reach need not be looked for: the next twist is the same as if the arcs were
/// looked along as far as the wanted speed asks for.
#[test]
fn a_short_look_slows_the_next_period_as_a_long_one() {
    let (outline, params) = (JACKAL.body.outline(), JACKAL.barrier());
    let room = (Angle::from_bits(i32::MAX), Angle::from_bits(i32::MAX));
    let tireless = Brakes {
        linear: MetresPerSecond::new(number(8.0)),
        ..JACKAL.brakes()
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
        let points = points
            .iter()
            .filter(|(x, y)| JACKAL.body.clearance([*x, *y]) > 0.0);
        let places = points
            .map(|(x, y)| Vector::of(Point::new(Metres::new(number(*x)), Metres::new(number(*y)))));
        near.collect(places, &outline);
        let way = if backward { -1.0 } else { 1.0 };
        let [driven, wanted] = [driven, wanted].map(|v| twist([way * v, way * v * curvature]));
        let look = |brakes| {
            slow(
                &mut Trajectory::new(),
                &params,
                &near,
                &outline,
                room,
                brakes,
                driven,
                wanted,
            )
        };
        let ((short, few), (long, many)) = (look(JACKAL.brakes()), look(tireless));
        let next = |slowed| JACKAL.brakes().toward(driven, slowed);
        assert_eq!(next(short), next(long), "{driven:?} {wanted:?}");
        slowed += u32::from(next(short) != next(wanted));
        shorter += u32::from(few < many);
    }
    assert!(slowed > 400 && shorter > 400, "{slowed}, {shorter}");
}

#[test]
fn backward_a_margin_of_its_own_counts() {
    let outline = JACKAL.body.outline();
    let room = (Angle::ZERO, Angle::ZERO);
    let speed = |way: f64, behind: f64| {
        let params = BarrierParams {
            behind: Metres::new(number(behind)),
            ..JACKAL.barrier()
        };
        let ahead = Metres::new(number(way * (HALF[0] + 0.1)));
        let mut near = Near::new();
        let place = Vector::of(Point::new(ahead, Metres::ZERO));
        near.collect(std::iter::once(place), &outline);
        let wanted = twist([way * 0.3, 0.0]);
        let (slowed, _) = slow(
            &mut Trajectory::new(),
            &params,
            &near,
            &outline,
            room,
            JACKAL.brakes(),
            wanted,
            wanted,
        );
        plain(slowed)[0].abs()
    };
    assert_eq!(speed(1.0, 0.02), speed(1.0, 0.08));
    assert_eq!(speed(-1.0, 0.02), speed(1.0, 0.02));
    assert!(speed(-1.0, 0.02) > 0.2 && speed(-1.0, 0.08) < 0.05);
}
