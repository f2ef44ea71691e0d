//! The navigator in closed loop, at the level where a user notices: it arrives, touches nothing, gets out of a trap or says
//! that it is blocked, with the sensor sets that are presets, and the same bits every time.

use fixed::types::I16F16;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::navigate::{
    Manoeuvre, NavigationRecord, Navigator, NavigatorParams, RangeSet, Setup, Task, presets,
};
use fuzzypilot::ports::{Fault, Range, RangeReading};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, Seconds};
use std::f64::consts::{PI, TAU};

const PERIOD: f64 = 0.05;
const HALF: [f64; 2] = [0.254, 0.215];

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::saturating_from_num(x))
}

fn point([x, y]: [f64; 2]) -> Point {
    Point::new(metres(x), metres(y))
}

fn angle(radians: f64) -> Angle {
    Angle::from_bits((radians.rem_euclid(TAU) / TAU * 4_294_967_296.0) as i64 as i32)
}

/// x, y, radius.
type Disc = [f64; 3];

/// A wall of discs.
fn wall(from: [f64; 2], to: [f64; 2]) -> Vec<Disc> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let count = (length / 0.1).ceil() as i32;
    let at = |k: usize, i: i32| from[k] + (to[k] - from[k]) * f64::from(i) / f64::from(count);
    (0..=count).map(|i| [at(0, i), at(1, i), 0.05]).collect()
}

fn walls(corners: &[[f64; 2]]) -> Vec<Disc> {
    corners.windows(2).flat_map(|c| wall(c[0], c[1])).collect()
}

/// The nearest place of a disc inside a cone at the origin along x.
fn echo(disc: Disc, half_width: f64) -> f64 {
    let [x, y, r] = disc;
    let (distance, bearing) = (x.hypot(y), y.atan2(x).abs());
    if bearing <= half_width {
        return (distance - r).max(0.0);
    }
    let off = bearing - half_width;
    let beside = distance * off.sin();
    if off > PI / 2.0 || beside > r {
        return f64::INFINITY;
    }
    (distance * off.cos() - (r * r - beside * beside).sqrt()).max(0.0)
}

/// How a run ended.
#[derive(Debug, PartialEq)]
struct Run {
    last: Manoeuvre,
    touched: bool,
    pose: [f64; 3],
    seconds: f64,
    /// Longest time within 0.4 m of a place without saying that it is blocked or there.
    stall: f64,
    /// Of all commands.
    digest: u64,
}

struct Robot<const N: usize> {
    setup: Setup<N>,
    navigator: Box<Navigator<N>>,
    params: NavigatorParams<N>,
    pose: [f64; 3],
    twist: [f64; 2],
    command: [f64; 2],
    noise: u64,
}

impl<const N: usize> Robot<N> {
    fn new(params: NavigatorParams<N>, pose: [f64; 3]) -> Self {
        Self {
            setup: params.clone().setup().unwrap(),
            navigator: Box::new(Navigator::new()),
            params,
            pose,
            twist: [0.0; 2],
            command: [0.0; 2],
            noise: 1,
        }
    }

    /// Roughly normal, standard deviation 1 cm.
    fn noise(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.noise = self
                .noise
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (self.noise >> 40) as f64 / (1u64 << 24) as f64;
        }
        0.01 * sum
    }

    fn see(&mut self, discs: &[Disc]) {
        let mut readings = [RangeReading::NEVER_SEEN; N];
        let mounts = self.params.sensors.mounts.clone();
        for (reading, mount) in readings.iter_mut().zip(&mounts) {
            let half = f64::from(mount.width.bits()) / 4_294_967_296.0 * PI;
            let heading = f64::from(mount.pose.heading.bits()) / 4_294_967_296.0 * TAU;
            let (sin, cos) = (self.pose[2] + heading).sin_cos();
            let near = discs.iter().map(|[x, y, r]| {
                let (dx, dy) = (x - self.pose[0], y - self.pose[1]);
                echo([dx * cos + dy * sin, dy * cos - dx * sin, *r], half)
            });
            let range = near.fold(f64::INFINITY, f64::min) + self.noise();
            *reading = RangeReading::fresh(if range < 4.0 {
                Range::Echo(metres(range.max(0.0)))
            } else {
                Range::Clear
            });
        }
        self.navigator.see(&self.setup, &readings);
    }

    /// The command's period; whether something was touched.
    fn go(&mut self, next: [f64; 2], discs: &[Disc]) -> bool {
        let dt = PERIOD / 5.0;
        let mut touched = false;
        for _ in 0..5 {
            let before = self.twist;
            for (now, (to, rate)) in self
                .twist
                .iter_mut()
                .zip(self.command.into_iter().zip([2.5, 8.0]))
            {
                *now += (to - *now).clamp(-rate * dt, rate * dt);
            }
            let [v, w] = [0, 1].map(|k| (before[k] + self.twist[k]) / 2.0);
            let heading = self.pose[2] + w * dt / 2.0;
            self.pose[0] += v * dt * heading.cos();
            self.pose[1] += v * dt * heading.sin();
            self.pose[2] += w * dt;
            let (sin, cos) = self.pose[2].sin_cos();
            touched |= discs.iter().any(|[x, y, r]| {
                let (dx, dy) = (x - self.pose[0], y - self.pose[1]);
                let (a, b) = (dx * cos + dy * sin, dy * cos - dx * sin);
                (a.abs() - HALF[0])
                    .max(0.0)
                    .hypot((b.abs() - HALF[1]).max(0.0))
                    < *r
            });
        }
        self.command = next;
        touched
    }

    /// One period; whether something was touched.
    fn tick(&mut self, discs: &[Disc], task: Task<'_>) -> (NavigationRecord, bool) {
        self.see(discs);
        let [x, y, heading] = self.pose;
        let pose = Pose::new(point([x, y]), angle(heading));
        let record = self.navigator.step(&self.setup, pose, task);
        let twist = [record.twist.linear.bits(), record.twist.angular.bits()];
        let touched = self.go(twist.map(|bits| f64::from(bits) / 65_536.0), discs);
        (record, touched)
    }

    fn drive(&mut self, discs: &[Disc], task: Task<'_>, seconds: f64) -> Run {
        let mut run = Run {
            last: Manoeuvre::Avoid,
            touched: false,
            pose: self.pose,
            seconds: 0.0,
            stall: 0.0,
            digest: 0xcbf2_9ce4_8422_2325,
        };
        let (mut anchor, mut since) = (self.pose, 0.0);
        let mut standing = 0;
        while run.seconds < seconds && !run.touched && standing < 100 {
            let (record, touched) = self.tick(discs, task);
            let bits = [record.twist.linear.bits(), record.twist.angular.bits()];
            for byte in bits.iter().flat_map(|bits| bits.to_le_bytes()) {
                run.digest = (run.digest ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
            run.touched = touched;
            run.seconds += PERIOD;
            run.last = record.manoeuvre;
            let stands = matches!(run.last, Manoeuvre::Blocked | Manoeuvre::Arrived);
            standing = match run.last {
                Manoeuvre::Arrived => standing + 20,
                Manoeuvre::Blocked => standing + 1,
                _ => 0,
            };
            if stands || (self.pose[0] - anchor[0]).hypot(self.pose[1] - anchor[1]) > 0.4 {
                (anchor, since) = (self.pose, run.seconds);
            }
            run.stall = run.stall.max(run.seconds - since);
        }
        run.pose = self.pose;
        run
    }
}

fn to_goal<const N: usize>(params: NavigatorParams<N>, discs: &[Disc], goal: [f64; 2]) -> Run {
    Robot::new(params, [0.0; 3]).drive(discs, Task::Goal(point(goal)), 120.0)
}

fn arrived(run: &Run, goal: [f64; 2]) {
    assert_eq!(run.last, Manoeuvre::Arrived, "{run:?}");
    assert!(!run.touched, "{run:?}");
    assert!(
        (run.pose[0] - goal[0]).hypot(run.pose[1] - goal[1]) < 0.25,
        "{run:?}"
    );
}

/// Staggered posts between two walls.
fn slalom() -> Vec<Disc> {
    let mut discs = walls(&[[-1.0, 1.3], [9.0, 1.3]]);
    discs.extend(walls(&[[-1.0, -1.3], [9.0, -1.3]]));
    discs.extend((0..4).map(|i| {
        [
            1.5 + 1.8 * f64::from(i),
            if i % 2 == 0 { 0.35 } else { -0.35 },
            0.2,
        ]
    }));
    discs
}

#[test]
fn an_open_field_is_crossed_straight_at_full_speed() {
    let run = to_goal(presets::jackal::<16>(), &[], [6.0, 0.0]);
    arrived(&run, [6.0, 0.0]);
    assert!(run.seconds < 8.5, "{run:?}");
}

#[test]
fn a_slalom_is_driven_with_every_preset() {
    let goal = [8.0, 0.0];
    arrived(&to_goal(presets::jackal::<16>(), &slalom(), goal), goal);
    arrived(
        &to_goal(presets::jackal_eight::<8>(), &slalom(), goal),
        goal,
    );
    arrived(
        &to_goal(presets::ultrasonic_five::<5>(), &slalom(), goal),
        goal,
    );
    // As if every sector of a lidar heard the nearest thing across it.
    arrived(
        &to_goal(presets::jackal_lidar::<32>(), &slalom(), goal),
        goal,
    );
}

/// A pocket two metres deep, open to the robot's side.
#[test]
fn a_trap_is_left() {
    let trap = walls(&[[1.0, 1.2], [3.0, 1.2], [3.0, -1.2], [1.0, -1.2]]);
    let goal = [6.0, 0.0];
    let run = to_goal(presets::jackal::<16>(), &trap, goal);
    assert!(!run.touched && run.stall <= 5.0, "{run:?}");
    assert!(
        matches!(run.last, Manoeuvre::Arrived | Manoeuvre::Blocked),
        "{run:?}"
    );
}

/// A bent passage that ends: too narrow to turn in it, and backward nothing is seen.
#[test]
fn a_dead_end_is_left_the_way_that_it_came() {
    let bend = |radius: f64| {
        let arc = (0..=8).map(move |i| {
            let (sin, cos) = (f64::from(i) * 0.15).sin_cos();
            [0.3 + radius * sin, 1.5 - radius * cos]
        });
        std::iter::once([-0.3, 1.5 - radius])
            .chain(arc)
            .collect::<Vec<_>>()
    };
    let (outer, inner) = (bend(1.9), bend(1.1));
    let end = [outer[outer.len() - 1], inner[inner.len() - 1]];
    let passage = [walls(&outer), walls(&inner), walls(&end)].concat();
    let mut robot = Robot::new(presets::jackal::<16>(), [-0.3, 0.0, 0.0]);
    let task = Task::Goal(point([3.0, 3.5]));
    let (mut way, mut backed, mut farthest) = (Vec::new(), 0.0f64, 0.0f64);
    for _ in 0..600 {
        let (record, touched) = robot.tick(&passage, task);
        assert!(!touched);
        let at = [robot.pose[0], robot.pose[1]];
        let from = |place: &[f64; 2]| (place[0] - at[0]).hypot(place[1] - at[1]);
        if record.manoeuvre == Manoeuvre::Escape && robot.twist[0] < 0.0 {
            backed += -robot.twist[0] * PERIOD;
            let off = way.iter().map(from).fold(f64::INFINITY, f64::min);
            farthest = farthest.max(off);
        } else if backed > 0.0 {
            break;
        } else {
            way.push(at);
        }
    }
    assert!(backed > 0.25, "{backed}");
    assert!(farthest < 0.02, "{farthest}");
}

/// Lanes that end, hardly wider than the robot: as soon as their end is seen the way leads back, and there is no room to turn.
#[test]
fn a_lane_that_ends_is_backed_out_of() {
    let goal = [6.0, 0.0];
    for wide in [0.6, 0.65, 0.7] {
        let aside = wide / 2.0 + 0.05;
        let corners = [[0.4, 1.6], [1.2, aside], [3.2, aside]];
        let mirrored = corners.iter().rev().map(|[x, y]| [*x, -y]);
        let corners: Vec<_> = corners.into_iter().chain(mirrored).collect();
        let run = to_goal(presets::jackal::<16>(), &walls(&corners), goal);
        arrived(&run, goal);
    }
}

#[test]
fn in_a_sealed_room_it_says_that_it_is_blocked() {
    let room = walls(&[
        [-1.5, -1.5],
        [2.0, -1.5],
        [2.0, 1.5],
        [-1.5, 1.5],
        [-1.5, -1.5],
    ]);
    let run = to_goal(presets::jackal::<16>(), &room, [6.0, 0.0]);
    assert_eq!(run.last, Manoeuvre::Blocked, "{run:?}");
    assert!(!run.touched && run.stall <= 5.0, "{run:?}");
}

#[test]
fn an_unknown_post_on_the_path_is_passed_and_the_path_met_again() {
    let line = [Segment::line(Pose::default(), metres(8.0))];
    let path = Path::segments(&line, false).unwrap();
    let post = [[4.0, 0.0, 0.15]];
    let run = Robot::new(presets::jackal::<16>(), [0.0; 3]).drive(&post, Task::Path(&path), 60.0);
    arrived(&run, [8.0, 0.0]);
    assert!(run.pose[1].abs() < 0.05, "{run:?}");
    assert!(run.seconds < 12.0, "{run:?}");
}

#[test]
fn the_same_run_is_the_same_to_the_last_bit() {
    let run = || to_goal(presets::jackal::<16>(), &slalom(), [8.0, 0.0]);
    assert_eq!(run(), run());
}

/// A scan of many beams is reduced to sectors: the nearest of each stays, what returns nothing is silent.
#[test]
fn a_lidar_sees_what_the_cones_see() {
    let params = presets::jackal::<32>();
    let setup = params.setup().unwrap();
    let mut navigator: Navigator<32> = Navigator::new();
    let beams = (0..720).map(|i| {
        let direction = (f64::from(i) - 359.5) * 1.5 * PI / 720.0;
        // A wall one metre ahead.
        let range = if direction.abs() < 1.0 {
            1.0 / direction.cos()
        } else {
            0.0
        };
        (angle(direction), metres(range))
    });
    navigator.see_scan(&setup, beams);
    let record = navigator.step(&setup, Pose::default(), Task::Goal(point([5.0, 0.0])));
    assert!(record.points >= 5, "{record:?}");
    for place in navigator.memory().points() {
        let x = f64::from(place.x.bits()) / 4096.0;
        assert!((x - 1.0).abs() < 0.005, "{x}");
    }
    assert!((f64::from(record.clearance.bits()) / 65_536.0 - 0.746).abs() < 0.01);
}

/// Readings that say nothing change nothing, and faults of all kinds are silence.
#[test]
fn silence_is_not_free_space() {
    let setup = presets::jackal::<16>().setup().unwrap();
    let mut navigator: Navigator<16> = Navigator::new();
    let wall = [RangeReading::fresh(Range::Echo(metres(0.6))); 16];
    navigator.see(&setup, &wall);
    let seen = navigator.step(&setup, Pose::default(), Task::Goal(point([5.0, 0.0])));
    assert!(seen.points >= 16, "{seen:?}");
    for silent in [
        RangeReading::fresh(Range::Clear),
        RangeReading::fresh(Range::Invalid(Fault::Timeout)),
        RangeReading {
            range: Range::Echo(metres(3.0)),
            age: Seconds::lit("1"),
        },
    ] {
        navigator.see(&setup, &[silent; 16]);
        let record = navigator.step(&setup, Pose::default(), Task::Goal(point([5.0, 0.0])));
        assert_eq!(record.points, seen.points, "{silent:?}");
    }
}

/// A standing robot whose cones hear these ranges for some ticks, metres; 0 is nothing. Its navigator and last decision.
fn hearing(ranges: [f64; 16], ticks: usize) -> (Navigator<16>, NavigationRecord) {
    hearing_with(presets::jackal(), ranges, ticks)
}

fn hearing_with(
    params: NavigatorParams<16>,
    ranges: [f64; 16],
    ticks: usize,
) -> (Navigator<16>, NavigationRecord) {
    let setup = params.setup().unwrap();
    let mut navigator: Navigator<16> = Navigator::new();
    let readings = ranges.map(|range| {
        RangeReading::fresh(if range > 0.0 {
            Range::Echo(metres(range))
        } else {
            Range::Clear
        })
    });
    let mut record = NavigationRecord::default();
    for _ in 0..ticks {
        navigator.see(&setup, &readings);
        record = navigator.step(&setup, Pose::default(), Task::Goal(point([50.0, 0.0])));
    }
    (navigator, record)
}

#[test]
fn an_obstacle_that_is_neared_does_not_fill_the_memory() {
    let setup = presets::jackal::<16>().setup().unwrap();
    let mut navigator = Navigator::<16>::new();
    let mut most = 0;
    for tick in 0..28 {
        // A cone ahead hears something that the robot nears by 2 cm a tick and whose nearest place is each time 2 cm nearer than
        // the last; the others hear nothing.
        let gone = 0.02 * f64::from(tick);
        let mut readings = [RangeReading::fresh(Range::Clear); 16];
        readings[8] = RangeReading::fresh(Range::Echo(metres(1.6 - 2.0 * gone)));
        navigator.see(&setup, &readings);
        let pose = Pose::new(point([gone, 0.0]), Angle::ZERO);
        navigator.step(&setup, pose, Task::Goal(point([9.0, 0.0])));
        most = most.max(navigator.memory().len());
    }
    assert!((1..=4).contains(&most), "{most}");
}

/// A post is seen from all around as the robot passes: a place of its surface is remembered once.
#[test]
fn a_lidar_that_passes_a_post_does_not_fill_the_memory_with_it() {
    let setup = presets::jackal_lidar::<32>().setup().unwrap();
    let mut navigator: Navigator<32> = Navigator::new();
    for tick in 0..170 {
        let x = 0.01 * f64::from(tick);
        let (px, py, radius) = (1.0 - x, 0.45, 0.1);
        let beams = (0..720).map(|i| {
            let direction = (f64::from(i) - 359.5) * 1.5 * PI / 720.0;
            let (sin, cos) = direction.sin_cos();
            let (along, beside) = (px * cos + py * sin, py * cos - px * sin);
            let range = if along > 0.0 && beside.abs() < radius {
                along - (radius * radius - beside * beside).sqrt()
            } else {
                0.0
            };
            (angle(direction), metres(range))
        });
        navigator.see_scan(&setup, beams);
        let pose = Pose::new(point([x, 0.0]), Angle::ZERO);
        navigator.step(&setup, pose, Task::Goal(point([9.0, 0.0])));
    }
    // Two thirds of its circumference were seen: 0.42 m.
    let points = navigator.memory().len();
    assert!((6..=12).contains(&points), "{points}");
}

#[test]
fn what_is_no_sensor_is_not_dead() {
    let mut params = presets::jackal::<32>();
    params.sensors.mounts.truncate(8);
    let setup = params.setup().unwrap();
    let mut navigator: Navigator<32> = Navigator::new();
    for _ in 0..60 {
        navigator.see(&setup, &[RangeReading::fresh(Range::Echo(metres(1.0))); 8]);
        let record = navigator.step(&setup, Pose::default(), Task::Goal(point([50.0, 0.0])));
        assert_eq!(record.dead, 0);
    }
}

#[test]
fn a_dead_cone_ahead_is_found_out_and_caps_the_speed() {
    let mut ranges = [2.0; 16];
    assert_eq!(hearing(ranges, 60).1.dead, 0);
    ranges[8] = 0.0;
    let (_, record) = hearing(ranges, 60);
    assert_eq!(record.dead, 1 << 8);
    assert!(record.twist.linear <= MetresPerSecond::lit("0.5"));
    // At a side it is told, but costs no speed.
    ranges[8] = 2.0;
    ranges[2] = 0.0;
    let (_, record) = hearing(ranges, 60);
    assert_eq!(record.dead, 1 << 2);
    assert!(record.twist.linear > MetresPerSecond::lit("0.9"));
}

/// An echo 0.7 m away in the cone from 17° to 34°: what made it may stand 0.2 m beside the middle line, where the front
/// passes, or beyond. A slow robot waits and sees.
#[test]
fn a_fast_robot_slows_down_for_what_an_echo_may_mean() {
    let speed = |fastest: &str, careful: &str| {
        let mut params = presets::jackal::<16>();
        params.limits.speed = fastest.parse().map(MetresPerSecond::new).unwrap();
        params.doubt.careful = careful.parse().map(MetresPerSecond::new).unwrap();
        let mut ranges = [2.5; 16];
        ranges[9] = 0.7;
        let (_, record) = hearing_with(params, ranges, 60);
        record.twist.linear.get().to_num::<f64>()
    };
    let doubting = speed("2", "1");
    assert!((1.0..1.3).contains(&doubting), "{doubting}");
    let blind = speed("2", "4");
    assert!(blind > 1.4, "{blind}");
    assert_eq!(speed("0.9", "1"), speed("0.9", "4"));
}

#[test]
fn an_open_field_makes_no_cone_dead() {
    let (_, record) = hearing([0.0; 16], 60);
    assert_eq!(record.dead, 0);
    assert!(record.twist.linear > MetresPerSecond::lit("0.9"));
}

/// What its neighbour hears close by may stand in the dead cone, too.
#[test]
fn a_dead_cone_is_not_taken_for_free() {
    let mut ranges = [2.0; 16];
    ranges[8] = 0.0;
    ranges[9] = 0.4;
    let in_cone = |ranges: [f64; 16]| {
        let (navigator, _) = hearing(ranges, 60);
        // Cone 8 looks from straight ahead to 16.9° left.
        let points = navigator.memory().points();
        points
            .filter(|place| {
                let [x, y] = [place.x, place.y].map(|v| f64::from(v.bits()));
                (0.0..0.29).contains(&y.atan2(x))
            })
            .count()
    };
    assert!(in_cone(ranges) > 0);
    ranges[9] = 2.0;
    assert_eq!(in_cone(ranges), 0);
}

#[test]
fn settings_that_cannot_be_driven_with_are_named() {
    let refused = |change: fn(&mut NavigatorParams<16>)| {
        let mut params = presets::jackal();
        change(&mut params);
        params.setup().unwrap_err().field
    };
    assert_eq!(refused(|p| p.reverse = Default::default()), "reverse");
    assert_eq!(refused(|p| p.period = Seconds::ZERO), "period");
    assert_eq!(refused(|p| p.memory.keep = metres(5.0)), "memory.keep");
    assert_eq!(refused(|p| p.sensors.mounts.truncate(2)), "sensors.mounts");
    assert_eq!(refused(|p| p.field.budget = 0), "field.budget");
    assert_eq!(refused(|p| p.doubt.braking = I16F16::ZERO), "doubt.braking");
    assert_eq!(
        refused(|p| p.barrier.braking = I16F16::lit("3")),
        "barrier.braking"
    );
    assert_eq!(
        refused(|p| p.barrier.margin = metres(-0.01)),
        "barrier.margin"
    );
    assert_eq!(
        refused(|p| p.barrier.behind = metres(0.6)),
        "barrier.behind"
    );
    assert_eq!(refused(|p| p.barrier.gate = metres(0.009)), "barrier.gate");
    // What the barrier's promise needs.
    assert_eq!(refused(|p| p.period = Seconds::lit("0.11")), "period");
    assert_eq!(refused(|p| p.latency = Seconds::lit("0.11")), "latency");
    assert_eq!(
        refused(|p| p.limits.speed = MetresPerSecond::lit("3.1")),
        "limits.speed"
    );
    assert_eq!(
        refused(|p| p.limits.acceleration = I16F16::lit("0.8")),
        "limits.acceleration"
    );
    assert_eq!(
        refused(|p| p.limits.yaw_acceleration = I16F16::lit("2.5")),
        "limits.yaw_acceleration"
    );
    assert_eq!(
        refused(|p| p.reverse = MetresPerSecond::lit("3.1")),
        "reverse"
    );
    // The gate's margin goes with what the corners sweep: the Jackal's 15 mm with 3 rad/s.
    assert_eq!(
        refused(|p| p.limits.yaw_rate = I16F16::lit("3.1")),
        "barrier.gate"
    );
    let taken = |change: fn(&mut NavigatorParams<16>)| {
        let mut params = presets::jackal::<16>();
        change(&mut params);
        params.setup().is_ok()
    };
    assert!(taken(|p| p.limits.speed = MetresPerSecond::lit("2.875")));
    assert!(taken(|p| p.limits.acceleration = I16F16::lit("0.87")));
    assert!(taken(|p| p.latency = Seconds::lit("0.1")));
    let far = RangeSet::sectors(
        point([3.0, 0.0]),
        Angle::QUARTER,
        metres(4.0),
        Seconds::ZERO,
    );
    let mut params = presets::jackal::<16>();
    params.sensors = far;
    assert_eq!(params.setup().unwrap_err().field, "sensors.mounts.pose");
}
