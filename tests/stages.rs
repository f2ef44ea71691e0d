//! The stages that touch hardware quantities: dead reckoning, the drive's limits, the guard, and the range ring's
//! judgement of its readings. Against f64, at the ends of the formats, and as properties over random settings.

use core::f64::consts::{PI, TAU};
use fixed::types::{I16F16, U0F32};
use fuzzypilot::drive::{Driven, drive};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guard::guard;
use fuzzypilot::localise::Localiser;
use fuzzypilot::params::{Body, Guard, Integrator, Limits, Mount, RingGeometry};
use fuzzypilot::ports::{Fault, Range, RangeReading, WheelCounts};
use fuzzypilot::sense::{Beams, Odometer, sense_ranges};
use fuzzypilot::signals::{MAX_OBSTACLES, Sensed, Travel, Twist};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond, Seconds};
use proptest::prelude::*;

const STEP: f64 = 1.0 / 65_536.0;

fn fx(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

fn metres(x: f64) -> Metres {
    Metres::new(fx(x))
}

fn speed(x: f64) -> MetresPerSecond {
    MetresPerSecond::new(fx(x))
}

fn seconds(x: f64) -> Seconds {
    Seconds::new(fixed::types::I8F24::from_num(x))
}

fn f(m: Metres) -> f64 {
    m.get().to_num()
}

fn point(x: f64, y: f64) -> Point {
    Point::new(metres(x), metres(y))
}

fn radians(a: Angle) -> f64 {
    f64::from(a.bits()) / 4_294_967_296.0 * TAU
}

fn angle(radians: f64) -> Angle {
    Angle::from_bits((radians.rem_euclid(TAU) / TAU * 4_294_967_296.0) as i64 as i32)
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

// ---- localise ----

/// 0.2 m track; `bits` 2^-32 m a count.
fn body(bits: u32) -> Body {
    Body {
        radius: metres(0.2),
        track: metres(0.2),
        metres_per_count: U0F32::from_bits(bits),
    }
}

/// A count of 2^-20 m, 0.95 µm.
const FINE: u32 = 1 << 12;

fn counts(left: i32, right: i32) -> Travel {
    Travel::Counts { left, right }
}

/// Dead reckoning in f64, exact on arcs.
struct Exact {
    x: f64,
    y: f64,
    heading: f64,
}

impl Exact {
    fn advance(&mut self, body: &Body, left: i32, right: i32) {
        let (track, per_count) = (f(body.track), body.metres_per_count.to_num::<f64>());
        let turned = f64::from(right - left) * per_count / track;
        let travelled = f64::from(left + right) * per_count / 2.0;
        let half = turned / 2.0;
        let chord = if half == 0.0 { 1.0 } else { half.sin() / half };
        self.x += travelled * chord * (self.heading + half).cos();
        self.y += travelled * chord * (self.heading + half).sin();
        self.heading += turned;
    }

    fn miss(&self, pose: Pose) -> f64 {
        (f(pose.at.x) - self.x).hypot(f(pose.at.y) - self.y)
    }

    fn turned_off(&self, pose: Pose) -> f64 {
        let d = (radians(pose.heading) - self.heading).rem_euclid(TAU);
        d.min(TAU - d)
    }
}

#[test]
fn straight_on() {
    let body = body(FINE);
    for heading in [0.0, PI / 2.0, PI, -PI / 2.0, 0.3, 2.0, -2.9] {
        let start = Pose::new(point(1.0, -2.0), angle(heading));
        for rule in [Integrator::Arc, Integrator::Euler] {
            let mut localiser = Localiser::new(&body, start);
            assert_eq!(localiser.pose(), start);
            for _ in 0..1000 {
                localiser.advance(&body, rule, counts(10_486, 10_486));
            }
            let length = 1000.0 * 10_486.0 / f64::from(1 << 20);
            let pose = localiser.pose();
            assert_eq!(pose.heading, start.heading);
            let (x, y) = (1.0 + length * heading.cos(), -2.0 + length * heading.sin());
            let miss = (f(pose.at.x) - x).hypot(f(pose.at.y) - y);
            // Cosine and sine are short by up to 2.3e-5; nothing else is lost over 10 m.
            assert!(
                (3e-6..2.4e-5).contains(&(miss / length)),
                "{heading}: {miss}"
            );
        }
    }
}

#[test]
fn forth_and_back_is_nowhere() {
    let body = body(FINE);
    let start = Pose::new(point(1.0, -2.0), angle(0.7));
    let mut localiser = Localiser::new(&body, start);
    for sign in [1, -1] {
        for _ in 0..5000 {
            localiser.advance(&body, Integrator::Arc, counts(sign * 900, sign * 900));
        }
    }
    let pose = localiser.pose();
    assert_eq!(pose.heading, start.heading);
    assert!(f((pose.at - start.at).norm()) < 1.5 * STEP);
}

#[test]
fn a_circle_of_a_hundred_thousand_ticks() {
    // r = 1 m left and right, 0.3 m/s at 20 Hz: 15 mm, 15 mrad a tick, 239 laps.
    for (left, right) in [(14_156, 17_302), (17_302, 14_156)] {
        let body = body(FINE);
        let mut localiser = Localiser::new(&body, Pose::default());
        let mut exact = Exact {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
        };
        let (mut worst, mut heading) = (0.0f64, 0.0f64);
        for _ in 0..100_000 {
            let pose = localiser.advance(&body, Integrator::Arc, counts(left, right));
            exact.advance(&body, left, right);
            worst = worst.max(exact.miss(pose));
            heading = heading.max(exact.turned_off(pose));
        }
        println!("circle: {:.4} mm, heading {heading:.2e} rad", worst * 1e3);
        assert!((1e-6..1e-3).contains(&worst));
        assert!((1e-9..1e-5).contains(&heading));
    }
}

#[test]
fn one_long_arc_in_a_tick() {
    // The chord correction is the series' first term: x⁴/1920 is missing.
    for (turn, bound) in [(0.1, 2.5e-5), (0.3, 3e-5), (0.5, 6e-5), (1.0, 6e-4)] {
        let body = body(FINE);
        let right = (turn * 0.2 * f64::from(1 << 20)) as i32;
        let mut exact = Exact {
            x: 0.0,
            y: 0.0,
            heading: 0.4,
        };
        let mut localiser = Localiser::new(&body, Pose::new(Point::default(), angle(0.4)));
        exact.advance(&body, 0, right);
        let pose = localiser.advance(&body, Integrator::Arc, counts(0, right));
        let share = exact.miss(pose) / exact.x.hypot(exact.y);
        println!("arc of {turn} rad: {share:.2e} of its chord");
        // Half a step of the coordinates is another 1e-4 of so short a chord.
        assert!(share < bound + STEP / exact.x.hypot(exact.y), "{turn}");
        assert!(exact.turned_off(pose) < 1e-8);
    }
}

#[test]
fn a_chord_is_right_to_1e_5_up_to_a_radian() {
    let body = body(1 << 22); // Long enough that the coordinates' step does not matter.
    let right = (0.2 * 1024.0) as i32;
    let mut exact = Exact {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };
    // Both wheels on 9.9 m and a little more on the right: a turn of one radian.
    let mut localiser = Localiser::new(&body, Pose::default());
    exact.advance(&body, 10_000, 10_000 + right);
    let pose = localiser.advance(&body, Integrator::Arc, counts(10_000, 10_000 + right));
    let share = exact.miss(pose) / exact.x.hypot(exact.y);
    // The 2.3e-5 are cosine's and sine's.
    assert!(share < 1e-5 + 2.3e-5, "{share:.2e}");
}

#[test]
fn standing_jitter_does_not_move_the_robot_far() {
    // An encoder that rests on an edge: a count forth, a count back, 100,000 times.
    let body = body(52_429); // 12.2 µm a count
    let mut localiser = Localiser::new(&body, Pose::default());
    for i in 0..100_000 {
        let jitter = if i % 2 == 0 { 1 } else { -1 };
        localiser.advance(&body, Integrator::Arc, counts(jitter, 0));
    }
    let pose = localiser.pose();
    assert_eq!(pose.heading, Angle::ZERO);
    // Mean travel is rounded down to 60 nm, every tick: see the next test.
    assert!(f(pose.at.x).abs() < 3.1e-3);
}

#[test]
fn standing_jitter_does_not_move_the_robot() {
    let body = body(52_429);
    let mut localiser = Localiser::new(&body, Pose::default());
    for i in 0..100_000 {
        let jitter = if i % 2 == 0 { 1 } else { -1 };
        localiser.advance(&body, Integrator::Arc, counts(jitter, 0));
    }
    assert!(f(localiser.pose().at.x).abs() < 2.0 * STEP);
}

#[test]
fn heading_depends_on_the_total_counts_alone() {
    let body = body(40_961);
    let (mut slow, mut fast) = (
        Localiser::new(&body, Pose::default()),
        Localiser::new(&body, Pose::default()),
    );
    for i in 0..10_000 {
        slow.advance(&body, Integrator::Arc, counts(i % 3, 7 - i % 5));
    }
    let total = |of: fn(i32) -> i32| (0..10_000).map(of).sum::<i32>();
    let pose = fast.advance(
        &body,
        Integrator::Arc,
        counts(total(|i| i % 3), total(|i| 7 - i % 5)),
    );
    assert_eq!(slow.pose().heading, pose.heading);
}

#[test]
fn euler_is_equation_7_1() {
    let body = body(FINE);
    let mut localiser = Localiser::new(&body, Pose::new(point(1.0, 1.0), angle(0.5)));
    let (mut x, mut y, mut psi) = (1.0, 1.0, 0.5f64);
    for i in 0..500 {
        let (left, right) = (9_000 + 13 * i, 12_000 - 7 * i);
        let pose = localiser.advance(&body, Integrator::Euler, counts(left, right));
        // x += T·v·cos ψ, y += T·v·sin ψ, then ψ += Δψ.
        let travelled = f64::from(left + right) / 2.0 / f64::from(1 << 20);
        x += travelled * psi.cos();
        y += travelled * psi.sin();
        psi += f64::from(right - left) / f64::from(1 << 20) / f(body.track);
        let miss = (f(pose.at.x) - x).hypot(f(pose.at.y) - y);
        assert!(
            miss < 2.4e-5 * 0.012 * f64::from(i + 1) + STEP,
            "{i}: {miss}"
        );
    }
}

#[test]
fn unknown_travel_leaves_the_pose_and_is_made_good() {
    let body = body(FINE);
    let mut odometer = Odometer::default();
    let mut localiser = Localiser::new(&body, Pose::new(point(1.0, 2.0), angle(0.3)));
    let reading = |n: i32| {
        Ok(WheelCounts {
            left: 1000i32.wrapping_mul(n),
            right: 1000i32.wrapping_mul(n),
        })
    };
    assert_eq!(odometer.travel(reading(5)), counts(0, 0));
    assert_eq!(odometer.travel(reading(6)), counts(1000, 1000));
    let before = localiser.advance(&body, Integrator::Arc, counts(1000, 1000));
    for fault in [
        Fault::NeverSeen,
        Fault::Timeout,
        Fault::Bus,
        Fault::OutOfRange,
        Fault::Stale,
    ] {
        let travel = odometer.travel(Err(fault));
        assert_eq!(travel, Travel::Unknown(fault));
        assert_eq!(localiser.advance(&body, Integrator::Arc, travel), before);
    }
    assert_eq!(odometer.travel(reading(9)), counts(3000, 3000));
    // A fault before the first reading: that reading is the zero.
    let mut odometer = Odometer::default();
    assert_eq!(
        odometer.travel(Err(Fault::Bus)),
        Travel::Unknown(Fault::Bus)
    );
    assert_eq!(odometer.travel(reading(77)), counts(0, 0));
}

#[test]
fn counters_wrap() {
    let mut odometer = Odometer::default();
    let at = |left, right| Ok(WheelCounts { left, right });
    odometer.travel(at(i32::MAX - 10, i32::MIN + 10));
    assert_eq!(
        odometer.travel(at(i32::MIN + 9, i32::MAX - 9)),
        counts(20, -20)
    );
    assert_eq!(
        odometer.travel(at(i32::MAX - 10, i32::MIN + 10)),
        counts(-20, 20)
    );
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn any_travel_without_panic(
        per_count in any::<u32>(),
        track in any::<i32>(),
        start in any::<[i32; 3]>(),
        ticks in prop::collection::vec(
            (prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX)], any::<i32>(), any::<bool>()),
            1..20,
        ),
    ) {
        let body = Body { track: Metres::from_bits(track), ..body(per_count) };
        let [x, y, heading] = start;
        let start = Pose::new(
            Point::new(Metres::from_bits(x), Metres::from_bits(y)),
            Angle::from_bits(heading),
        );
        let mut localiser = Localiser::new(&body, start);
        prop_assert_eq!(localiser.pose(), start);
        for (left, right, euler) in ticks {
            let rule = if euler { Integrator::Euler } else { Integrator::Arc };
            let pose = localiser.advance(&body, rule, counts(left, right));
            prop_assert_eq!(pose, localiser.pose());
        }
    }
}

// ---- drive ----

fn limits() -> Limits {
    Limits {
        speed: speed(0.5),
        yaw_rate: fx(2.0),
        acceleration: fx(1.0),
        yaw_acceleration: fx(8.0),
        wheel_speed: speed(0.6),
    }
}

fn twist(linear: f64, angular: f64) -> Twist {
    Twist {
        linear: speed(linear),
        angular: RadiansPerSecond::new(fx(angular)),
    }
}

fn parts(t: Twist) -> (f64, f64) {
    (t.linear.get().to_num(), t.angular.get().to_num())
}

/// Drives with the same wish until nothing changes any more.
fn settled(body: &Body, limits: &Limits, wanted: Twist) -> Driven {
    let mut last = Twist::default();
    for _ in 0..2000 {
        let driven = drive(body, limits, seconds(0.05), last, wanted);
        if driven.twist == last {
            return driven;
        }
        last = driven.twist;
    }
    panic!("{wanted:?} does not settle");
}

#[test]
fn wheels_are_v_plus_minus_half_the_track() {
    let driven = settled(&body(FINE), &limits(), twist(0.3, 0.5));
    assert_eq!(driven.twist, twist(0.3, 0.5));
    let wheel = |s: MetresPerSecond| s.get().to_num::<f64>();
    assert!((wheel(driven.wheels.left) - 0.25).abs() < 2.0 * STEP);
    assert!((wheel(driven.wheels.right) - 0.35).abs() < 2.0 * STEP);
    let turning = settled(&body(FINE), &limits(), twist(0.0, -1.0));
    assert!((wheel(turning.wheels.left) - 0.1).abs() < 2.0 * STEP);
    assert!((wheel(turning.wheels.right) + 0.1).abs() < 2.0 * STEP);
    assert_eq!(
        settled(&body(FINE), &limits(), twist(0.0, 0.0)),
        Driven::default()
    );
}

#[test]
fn a_saturated_wheel_keeps_the_curvature() {
    let mut saturated = 0;
    for linear in [-0.5, -0.3, 0.05, 0.2, 0.41, 0.5] {
        for angular in [-2.0, -1.4, -0.3, 0.6, 1.9, 2.0] {
            for wheel_speed in [0.1, 0.25, 0.6] {
                let limits = Limits {
                    wheel_speed: speed(wheel_speed),
                    ..limits()
                };
                let driven = settled(&body(FINE), &limits, twist(linear, angular));
                let (v, w) = parts(driven.twist);
                let share = wheel_speed / f64::abs(linear).mul_add(1.0, 0.1 * f64::abs(angular));
                // Two rounded parts; the larger one carries the smaller relative error.
                let cross = (v * angular - w * linear).abs();
                assert!(
                    cross < 3.0 * STEP * (f64::abs(angular) + f64::abs(linear)),
                    "{linear} {angular} {wheel_speed}: {v} {w}"
                );
                if share < 1.0 {
                    saturated += 1;
                    assert!(
                        (v - linear * share).abs() < 4.0 * STEP,
                        "{linear} {angular}: {v}"
                    );
                    let fastest = [driven.wheels.left, driven.wheels.right]
                        .map(|w| w.abs().get().to_num::<f64>())
                        .into_iter()
                        .fold(0.0, f64::max);
                    assert!((fastest - wheel_speed).abs() < 4.0 * STEP);
                } else {
                    assert_eq!(driven.twist, twist(linear, angular));
                }
            }
        }
    }
    assert!(saturated > 20);
}

#[test]
fn too_fast_a_wish_keeps_its_curvature() {
    let limits = Limits {
        wheel_speed: speed(50.0),
        ..limits()
    };
    // Twice too fast: both parts halve. Then three times too much yaw.
    let (v, w) = parts(settled(&body(FINE), &limits, twist(1.0, 0.8)).twist);
    assert!((v - 0.5).abs() < 2.0 * STEP && (w - 0.4).abs() < 2.0 * STEP);
    let (v, w) = parts(settled(&body(FINE), &limits, twist(-0.45, 6.0)).twist);
    assert!((v + 0.15).abs() < 2.0 * STEP && (w - 2.0).abs() < 2.0 * STEP);
}

#[test]
fn the_commanded_curve_from_the_first_metre() {
    for sign in [1.0, -1.0] {
        let wanted = twist(sign * 0.5, 1.0);
        let mut last = Twist::default();
        for tick in 1..=10 {
            let driven = drive(&body(FINE), &limits(), seconds(0.05), last, wanted);
            let (v, w) = parts(driven.twist);
            assert!(
                (v - sign * 0.05 * f64::from(tick)).abs() < 20.0 * STEP,
                "{tick}: {v}"
            );
            assert!((w - v * sign * 2.0).abs() < 3.0 * STEP, "{tick}: {v} {w}");
            last = driven.twist;
        }
    }
}

#[test]
fn a_standstill_on_the_way_to_reversing_is_like_one_before_driving_on() {
    // An acceleration too small for this period leaves the robot standing; a curve is not driven while it stands.
    let limits = Limits {
        acceleration: I16F16::from_bits(1),
        ..limits()
    };
    let yaw = |linear: f64| {
        let wanted = twist(linear, 1.0);
        drive(
            &body(FINE),
            &limits,
            seconds(0.05),
            Twist::default(),
            wanted,
        )
        .twist
        .angular
    };
    assert_eq!(yaw(0.4), RadiansPerSecond::ZERO);
    assert_eq!(yaw(-0.4), RadiansPerSecond::ZERO);
}

/// Settings that `Params::checked` accepts, small and huge.
fn any_limits() -> impl Strategy<Value = Limits> {
    // A limit of i32::MAX lets i32::MIN through, a step more: it is no limit.
    let positive = || prop_oneof![1..i32::MAX, 1..200_000i32, Just(1), Just(i32::MAX - 1)];
    [positive(), positive(), positive(), positive(), positive()].prop_map(
        |[speed, yaw_rate, acceleration, yaw_acceleration, wheel_speed]| Limits {
            speed: MetresPerSecond::from_bits(speed),
            yaw_rate: I16F16::from_bits(yaw_rate),
            acceleration: I16F16::from_bits(acceleration),
            yaw_acceleration: I16F16::from_bits(yaw_acceleration),
            wheel_speed: MetresPerSecond::from_bits(wheel_speed),
        },
    )
}

fn any_twist() -> impl Strategy<Value = Twist> {
    let part = || {
        prop_oneof![
            any::<i32>(),
            -200_000..200_000i32,
            prop::sample::select(vec![i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX]),
        ]
    };
    (part(), part()).prop_map(|(linear, angular)| Twist {
        linear: MetresPerSecond::from_bits(linear),
        angular: RadiansPerSecond::from_bits(angular),
    })
}

proptest! {
    #![proptest_config(config(6000))]

    #[test]
    fn limits_are_never_exceeded(
        limits in any_limits(),
        track in prop_oneof![1..=i32::MAX, 1..100_000i32],
        period in 16_777..=(2i32 << 24),
        wishes in prop::collection::vec(any_twist(), 1..8),
    ) {
        let body = Body { track: Metres::from_bits(track), ..body(FINE) };
        let period = Seconds::from_bits(period);
        let mut last = Twist::default();
        for wanted in wishes {
            let driven = drive(&body, &limits, period, last, wanted);
            let (v, w) = (i64::from(driven.twist.linear.bits()), i64::from(driven.twist.angular.bits()));
            prop_assert!(v.abs() <= i64::from(limits.speed.bits()).max(1), "{v}");
            prop_assert!(w.abs() <= i64::from(limits.yaw_rate.to_bits()));
            for wheel in [driven.wheels.left, driven.wheels.right] {
                prop_assert!(wheel.abs() <= limits.wheel_speed);
            }
            // Yaw and speed step no further than their accelerations; only a wheel at its limit may shorten them more.
            let step = |rate: I16F16| {
                (i128::from(rate.to_bits()) * i128::from(period.bits())) >> 24
            };
            let v_step = i128::from(v) - i128::from(last.linear.bits());
            let w_step = i128::from(w) - i128::from(last.angular.bits());
            let outward = |now: i64, before: i32| now.abs() > i64::from(before).abs() && now.signum() * i64::from(before) >= 0;
            if outward(v, last.linear.bits()) {
                prop_assert!(v_step.abs() <= step(limits.acceleration), "{v_step}");
            }
            if outward(w, last.angular.bits()) {
                prop_assert!(w_step.abs() <= step(limits.yaw_acceleration), "{w_step}");
            }
            // Scaling down leaves both parts up to a step short of the limit.
            let rim = ((w.unsigned_abs() + 1) * (track as u64 >> 1)) >> 16;
            let saturated = v.unsigned_abs() + rim + 4 >= limits.wheel_speed.bits() as u64;
            if !saturated {
                prop_assert!(v_step.abs() <= step(limits.acceleration), "{v_step}");
                prop_assert!(w_step.abs() <= step(limits.yaw_acceleration), "{w_step}");
            }
            last = driven.twist;
        }
    }

    #[test]
    fn any_drive_without_panic(
        raw in any::<[i32; 7]>(),
        last in any_twist(),
        wanted in any_twist(),
    ) {
        let [track, period, speed, yaw_rate, acceleration, yaw_acceleration, wheel_speed] = raw;
        let body = Body { track: Metres::from_bits(track), ..body(FINE) };
        let limits = Limits {
            speed: MetresPerSecond::from_bits(speed),
            yaw_rate: I16F16::from_bits(yaw_rate),
            acceleration: I16F16::from_bits(acceleration),
            yaw_acceleration: I16F16::from_bits(yaw_acceleration),
            wheel_speed: MetresPerSecond::from_bits(wheel_speed),
        };
        let _ = drive(&body, &limits, Seconds::from_bits(period), last, wanted);
    }
}

// ---- guard ----

fn echoes(points: &[Point]) -> Sensed {
    let mut sensed = Sensed {
        nearest: Metres::MAX,
        ..Sensed::default()
    };
    for &p in points.iter().take(64) {
        sensed.echoes.push(p).unwrap();
    }
    sensed
}

/// A period of 0.1 s and no latency.
const AT_ONCE: (Seconds, Seconds) = (Seconds::lit("0.1"), Seconds::ZERO);
const GUARD: Guard = Guard {
    margin: Metres::lit("0.05"),
    braking: I16F16::lit("0.5"),
};

#[test]
fn the_corridor_is_as_wide_as_the_robot() {
    let pass = |x: f64, y: f64| {
        let sensed = echoes(&[point(x, y)]);
        guard(
            &GUARD,
            metres(0.2),
            AT_ONCE,
            &sensed,
            Twist::default(),
            twist(0.5, 0.3),
        )
    };
    let (fast, slow) = (twist(0.5, 0.3), 0.5 - 0.01);
    // Beside, behind or far ahead: free.
    for (x, y) in [
        (0.3, 0.26),
        (0.3, -0.26),
        (-0.1, 0.0),
        (0.0, 0.0),
        (5.0, 0.0),
    ] {
        assert_eq!(pass(x, y), (fast, false), "{x} {y}");
    }
    for (x, y) in [(0.4, 0.0), (0.4, 0.2), (0.4, -0.2), (0.3, 0.24)] {
        let (got, limited) = pass(x, y);
        assert!(limited && parts(got).0 < slow, "{x} {y}: {got:?}");
        assert_eq!(got.angular, fast.angular);
        // v ≤ free/2T and v ≤ √(a·free), free to the disc's front at this y.
        let free = (x - f64::sqrt(0.0625 - y * y)).max(0.0);
        let exact = (free / 0.2).min((0.5 * free).sqrt());
        assert!(
            (parts(got).0 - exact).abs() < 4e-4,
            "{x} {y}: {got:?} {exact}"
        );
    }
    // Touching: no way ahead, but turning and backing stay.
    assert_eq!(pass(0.2, 0.0), (twist(0.0, 0.3), true));
    let touching = echoes(&[point(0.2, 0.0)]);
    for wish in [twist(0.0, 1.0), twist(-0.3, 0.2)] {
        assert_eq!(
            guard(
                &GUARD,
                metres(0.2),
                AT_ONCE,
                &touching,
                Twist::default(),
                wish
            ),
            (wish, false)
        );
    }
    // A cone's echo beside the corridor counts where its arc reaches into it.
    let mut heard = echoes(&[point(0.3, 0.4)]);
    let pass = |heard: &Sensed| guard(&GUARD, metres(0.2), AT_ONCE, heard, Twist::default(), fast);
    assert!(!pass(&heard).1);
    heard.spreads.push(metres(0.3)).unwrap();
    assert!(pass(&heard).1);
    // Nothing seen, nothing limited.
    let blank = echoes(&[]);
    assert_eq!(
        guard(&GUARD, metres(0.2), AT_ONCE, &blank, Twist::default(), fast),
        (fast, false)
    );
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn the_guard_only_slows(
        points in prop::collection::vec((any::<i32>(), any::<i32>(), 0..30u32), 0..64),
        margin in 0..=i32::MAX,
        braking in 1..=i32::MAX,
        radius in 1..=i32::MAX,
        reaction in prop_oneof![0..=i32::MAX, 0..(1i32 << 24), Just(0)],
        small in any::<bool>(),
        wish in any_twist(),
    ) {
        let points: Vec<_> = points
            .into_iter()
            .map(|(x, y, shift)| Point::new(Metres::from_bits(x >> shift), Metres::from_bits(y >> shift)))
            .collect();
        let shift = if small { 14 } else { 0 };
        let params = Guard { margin: Metres::from_bits(margin >> shift), braking: I16F16::from_bits(braking) };
        let radius = Metres::from_bits(radius >> shift);
        let (got, limited) = guard(&params, radius, (Seconds::from_bits(reaction), Seconds::ZERO), &echoes(&points), Twist::default(), wish);
        prop_assert_eq!(got.angular, wish.angular);
        prop_assert_eq!(limited, got.linear != wish.linear);
        prop_assert!(got.linear <= wish.linear);
        if wish.linear > MetresPerSecond::ZERO {
            prop_assert!(got.linear >= MetresPerSecond::ZERO);
        } else {
            prop_assert_eq!(got.linear, wish.linear);
        }
        // Nearer by a metre is never faster.
        let nearer: Vec<_> = points
            .iter()
            .map(|p| Point::new(p.x - Metres::lit("1"), p.y))
            .filter(|p| p.x > Metres::ZERO)
            .collect();
        if nearer.len() == points.len() {
            let (less, _) = guard(&params, radius, (Seconds::from_bits(reaction), Seconds::ZERO), &echoes(&nearer), Twist::default(), wish);
            prop_assert!(less.linear <= got.linear);
        }
    }
}

/// Drives at full wish towards an echo straight ahead at (`x`, `y`) and returns the least free distance of the disc
/// grown by the margin, and the last speed. A command takes effect `delay` periods after its reading.
fn approach(
    x: f64,
    y: f64,
    top: f64,
    braking: f64,
    period: f64,
    delay: usize,
    guarded: bool,
) -> (f64, f64) {
    let limits = Limits {
        speed: speed(top),
        wheel_speed: speed(top),
        acceleration: fx(braking),
        ..limits()
    };
    let params = Guard {
        braking: fx(braking),
        ..GUARD
    };
    let latency = period * delay as f64;
    let front = (0.25f64.powi(2) - y * y).sqrt();
    let mut last = Twist::default();
    let mut on_the_way = std::collections::VecDeque::from(vec![0.0; delay]);
    let (mut at, mut least, mut moving) = (0.0, f64::MAX, 0.0);
    // Long enough to get there, to brake, and for the last approach to die away.
    let time = x / top + 4.0 * top / braking + 30.0 * (period + latency);
    for _ in 0..(time / period) as usize {
        let sensed = echoes(&[point(x - at, y)]);
        let wish = twist(top, 0.0);
        let timing = (seconds(period), seconds(latency));
        let passed = if guarded {
            guard(&params, metres(0.2), timing, &sensed, last, wish).0
        } else {
            wish
        };
        let driven = drive(&body(FINE), &limits, seconds(period), last, passed);
        last = driven.twist;
        on_the_way.push_back(parts(driven.twist).0);
        moving = on_the_way.pop_front().unwrap();
        at += moving * period;
        least = f64::min(least, x - at - front);
        if at > x {
            break;
        }
    }
    (least, moving)
}

/// The least free distance over all speeds, brakings, periods and sides, for commands that take `delay` periods.
fn closest(delay: usize) -> f64 {
    let mut closest = f64::MAX;
    for top in [0.1, 0.5, 2.0] {
        for braking in [0.2, 1.0, 5.0] {
            for period in [0.01, 0.05, 0.2] {
                for y in [0.0, 0.1, -0.2] {
                    let (least, moving) = approach(14.0, y, top, braking, period, delay, true);
                    assert!(
                        moving < 0.01,
                        "{top} {braking} {period} {y}: still {moving} m/s"
                    );
                    closest = closest.min(least);
                }
            }
        }
    }
    println!(
        "guard, {delay} periods of latency: {:.3} mm free",
        closest * 1e3
    );
    closest
}

#[test]
fn the_guard_stops_before_an_echo() {
    for delay in [0, 1] {
        // The margin stays free but for the steps of the echo's place and the disc's leg; and it is used.
        assert!((-3.0 * STEP..0.001).contains(&closest(delay)));
    }
    let (least, _) = approach(4.0, 0.0, 0.5, 1.0, 0.05, 1, true);
    assert!((-3.0 * STEP..0.01).contains(&least));
    // Without it the same run ends in the obstacle.
    assert!(approach(4.0, 0.0, 0.5, 1.0, 0.05, 1, false).0 < -0.2);
}

#[test]
fn the_guard_stops_before_an_echo_at_any_latency() {
    for delay in [2, 3, 4] {
        assert!(closest(delay) > -3.0 * STEP);
    }
}

// ---- sense_ranges ----

/// A ring of `N` beams from the body's centre, evenly around from straight ahead.
fn ring<const N: usize>() -> RingGeometry<N> {
    RingGeometry {
        mounts: (0..N)
            .map(|i| Mount {
                pose: Pose::new(Point::default(), angle(i as f64 * TAU / N as f64)),
                width: Angle::ZERO,
            })
            .collect(),
        closed: true,
        max_range: metres(4.0),
        max_age: seconds(0.2),
        gap: metres(0.3),
        radius: [metres(0.05), metres(1.0)],
        residual: metres(0.02),
    }
}

fn echo(distance: f64) -> RangeReading {
    RangeReading::fresh(Range::Echo(metres(distance)))
}

const CLEAR: RangeReading = RangeReading::fresh(Range::Clear);

/// What the beams of `ring` read of round obstacles (x, y, radius), exactly.
fn look<const N: usize>(ring: &RingGeometry<N>, discs: &[(f64, f64, f64)]) -> [RangeReading; N] {
    core::array::from_fn(|i| {
        let mount = ring.mounts[i].pose;
        let (sin, cos) = radians(mount.heading).sin_cos();
        let hits = discs.iter().filter_map(|&(x, y, r)| {
            let (x, y) = (x - f(mount.at.x), y - f(mount.at.y));
            let (along, aside) = (x * cos + y * sin, y * cos - x * sin);
            let half = (r * r - aside * aside).sqrt();
            (along > 0.0 && half.is_finite()).then_some(along - half)
        });
        let nearest = hits.fold(f64::MAX, f64::min);
        if nearest < 30.0 { echo(nearest) } else { CLEAR }
    })
}

fn sense<const N: usize>(ring: &RingGeometry<N>, readings: &[RangeReading; N]) -> Sensed {
    sense_at(ring, readings, MetresPerSecond::ZERO)
}

/// What `sense_ranges` finds at a speed, whatever stood there before.
fn sense_at<const N: usize>(
    ring: &RingGeometry<N>,
    readings: &[RangeReading; N],
    speed: MetresPerSecond,
) -> Sensed {
    let mut sensed = Sensed::default();
    let before = [RangeReading::fresh(Range::Echo(metres(0.5))); N];
    let mut beams = Beams::new();
    beams.place(ring);
    sense_ranges(ring, &beams, &before, speed, &mut sensed);
    sense_ranges(ring, &beams, readings, speed, &mut sensed);
    sensed
}

#[test]
fn every_kind_of_reading() {
    let ring = ring::<12>();
    let aged = |range, age| RangeReading {
        range,
        age: seconds(age),
    };
    let mut readings = [CLEAR; 12];
    readings[1] = echo(1.0);
    readings[2] = RangeReading::fresh(Range::Invalid(Fault::Bus));
    readings[3] = aged(Range::Echo(metres(1.0)), 0.25); // Stale.
    readings[4] = echo(-0.5); // No distance.
    readings[5] = echo(4.5); // Farther than what counts.
    readings[6] = aged(Range::Clear, 0.3); // Stale, too.
    readings[7] = aged(Range::Echo(metres(2.0)), 0.2);
    readings[9] = echo(0.0);
    readings[11] = RangeReading::fresh(Range::Echo(Metres::MAX));
    let sensed = sense_at(&ring, &readings, speed(-0.5));
    assert_eq!(sensed.valid, 8);
    assert_eq!(sensed.echoes.len(), 3);
    let at = |i: usize| sensed.echoes[i];
    assert!(f((at(0) - point(30f64.to_radians().cos(), 0.5)).norm()) < 1e-4);
    // 0.2 s at 0.5 m/s either way: drawn 0.1 m nearer.
    let seventh = 210f64.to_radians();
    assert!(f((at(1) - point(1.9 * seventh.cos(), 1.9 * seventh.sin())).norm()) < 1e-4);
    assert_eq!(at(2), Point::default());
    assert_eq!(sensed.nearest, Metres::ZERO);
    assert_eq!(sensed.obstacles.len(), 3);

    // Age can draw an echo to the sensor, not behind it.
    let mut readings = [CLEAR; 12];
    readings[0] = aged(Range::Echo(metres(0.1)), 0.2);
    assert_eq!(
        sense_at(&ring, &readings, speed(3.0)).echoes[0],
        Point::default()
    );

    let nothing = sense(&ring, &[CLEAR; 12]);
    assert_eq!((nothing.valid, nothing.nearest), (12, Metres::MAX));
    assert!(nothing.echoes.is_empty() && nothing.obstacles.is_empty());
    let blind = sense(
        &ring,
        &[RangeReading::fresh(Range::Invalid(Fault::NeverSeen)); 12],
    );
    assert_eq!((blind.valid, blind.nearest), (0, Metres::MAX));
}

#[test]
fn a_negative_age_draws_nothing_away() {
    let ring = ring::<12>();
    let mut readings = [CLEAR; 12];
    readings[0] = RangeReading {
        range: Range::Echo(metres(1.0)),
        age: seconds(-1.0),
    };
    let sensed = sense_at(&ring, &readings, speed(1.0));
    assert!(sensed.nearest <= metres(1.0));
}

#[test]
fn a_sensor_sits_where_its_mount_says() {
    let mut ring = ring::<1>();
    ring.closed = false;
    ring.mounts[0].pose = Pose::new(point(0.1, 0.05), angle(PI / 2.0));
    let sensed = sense(&ring, &[echo(1.0)]);
    assert!(f((sensed.echoes[0] - point(0.1, 1.05)).norm()) < 1e-4);
    assert!((f(sensed.nearest) - 0.1f64.hypot(1.05)).abs() < 1e-4);
}

#[test]
fn a_disc_is_found_where_it_stands() {
    let ring = ring::<64>();
    for bearing in [0.4, 1.9, 3.0, 5.5] {
        let (x, y) = (1.2 * f64::cos(bearing), 1.2 * f64::sin(bearing));
        let sensed = sense(&ring, &look(&ring, &[(x, y, 0.4)]));
        assert_eq!(sensed.obstacles.len(), 1);
        let found = sensed.obstacles[0];
        assert!((f(found.radius) - 0.4).abs() < 0.004, "{found:?}");
        assert!(f((found.centre - point(x, y)).norm()) < 0.005, "{found:?}");
        assert!(f(found.residual) < 0.001 && found.echoes >= 6);
        assert!((f(sensed.nearest) - 0.8).abs() < 0.02);
    }
}

#[test]
fn neighbours_join_and_gaps_separate() {
    let ring = ring::<64>();
    // Two discs beside each other, silence between them.
    let sensed = sense(&ring, &look(&ring, &[(1.0, 0.7, 0.2), (1.0, -0.7, 0.2)]));
    assert_eq!(sensed.obstacles.len(), 2);
    // One in front of the other: no silence, but a step of more than the gap.
    let sensed = sense(&ring, &look(&ring, &[(1.0, 0.9, 0.3), (2.0, 0.6, 0.4)]));
    assert_eq!(sensed.obstacles.len(), 2);
    // A dead sensor in the middle separates, too: unknown is not joined over.
    let mut readings = look(&ring, &[(0.0, 1.0, 0.4)]);
    assert_eq!(sense(&ring, &readings).obstacles.len(), 1);
    readings[16] = RangeReading::fresh(Range::Invalid(Fault::Timeout));
    assert_eq!(sense(&ring, &readings).obstacles.len(), 2);
}

#[test]
fn a_closed_ring_joins_its_ends() {
    let mut ring = ring::<64>();
    // Straight ahead: half of the echoes at the array's start, half at its end; another behind.
    let readings = look(&ring, &[(1.0, 0.0, 0.4), (-1.5, 0.0, 0.3)]);
    let sensed = sense(&ring, &readings);
    assert_eq!(sensed.obstacles.len(), 2);
    let (ahead, behind) = (sensed.obstacles[0], sensed.obstacles[1]);
    assert!(
        f((ahead.centre - point(1.0, 0.0)).norm()) < 0.01,
        "{ahead:?}"
    );
    assert!((f(ahead.radius) - 0.4).abs() < 0.01);
    assert!(
        f((behind.centre - point(-1.5, 0.0)).norm()) < 0.01,
        "{behind:?}"
    );
    let total: u8 = sensed.obstacles.iter().map(|o| o.echoes).sum();
    assert_eq!(usize::from(total), sensed.echoes.len());
    // An open one, a silent end, or a gap at the seam does not.
    let mut silent = readings;
    silent[63] = CLEAR;
    silent[0] = CLEAR;
    assert_eq!(sense(&ring, &silent).obstacles.len(), 3);
    let mut stepped = readings;
    for r in &mut stepped[..12] {
        if let Range::Echo(d) = r.range {
            r.range = Range::Echo(d + metres(0.5));
        }
    }
    assert_eq!(sense(&ring, &stepped).obstacles.len(), 3);
    ring.closed = false;
    assert_eq!(sense(&ring, &readings).obstacles.len(), 3);
}

#[test]
fn a_wall_all_around_is_one_segment() {
    let ring = ring::<64>();
    let sensed = sense(&ring, &[echo(1.0); 64]);
    assert_eq!(sensed.echoes.len(), 64);
    assert_eq!(sensed.obstacles.len(), 1);
    // A hollow is no disc: the stand-in keeps its surface through the nearest echo.
    let stand_in = sensed.obstacles[0];
    let surface = f(stand_in.centre.norm()) - f(stand_in.radius);
    assert!((surface - 1.0).abs() < 0.01, "{stand_in:?}");
}

#[test]
fn what_is_no_circle_gets_a_stand_in() {
    let ring = ring::<64>();
    // One echo, two echoes, a straight wall ahead (its seam closed).
    let mut readings = [CLEAR; 64];
    readings[16] = echo(1.0);
    let one = sense(&ring, &readings).obstacles[0];
    // Half the ring's spacing to either side: sin(2.8°) at 1 m is 0.049, and 0.05 is the least radius.
    assert_eq!((one.radius, one.echoes), (metres(0.05), 1));
    assert!(f((one.centre - point(0.0, 1.05)).norm()) < 1e-3);
    // The same echo heard by a cone of 20° may stand anywhere on its arc.
    let mut cones = ring.clone();
    for mount in &mut cones.mounts {
        mount.width = Angle::deg("20");
    }
    let heard = sense(&cones, &readings);
    let half = (10.0f64).to_radians().sin();
    assert!((f(heard.obstacles[0].radius) - half).abs() < 1e-3);
    assert!((f(heard.spreads[0]) - half).abs() < 1e-4);
    readings[17] = echo(1.0);
    let two = sense(&ring, &readings).obstacles[0];
    assert_eq!(two.echoes, 2);
    assert!((f(two.centre.norm()) - f(two.radius) - 1.0).abs() < 1e-3);

    let mut wall = [CLEAR; 64];
    for i in (0..7).chain(58..64) {
        wall[i] = echo(1.0 / (i as f64 * TAU / 64.0).cos());
    }
    let sensed = sense(&ring, &wall);
    assert_eq!(sensed.obstacles.len(), 1);
    let found = sensed.obstacles[0];
    assert!((f(found.centre.norm()) - f(found.radius) - 1.0).abs() < 1e-3);
    // As wide as the echoes, and less than another beam's spacing to either side.
    let half = (6.0 * TAU / 64.0).tan();
    assert!(
        (half - 0.01..half + 0.1).contains(&f(found.radius)),
        "{found:?}"
    );
    assert!(f(found.centre.y).abs() < 0.06);
}

#[test]
fn the_nearest_obstacles_come_first_and_stay() {
    let ring = ring::<64>();
    // Eleven separate echoes, nearer and farther in turn.
    let mut readings = [CLEAR; 64];
    let distances = [3.0, 1.0, 2.5, 0.6, 2.8, 1.4, 2.0, 0.9, 1.8, 3.4, 2.2];
    for (i, distance) in distances.into_iter().enumerate() {
        readings[i * 5] = echo(distance);
    }
    let sensed = sense(&ring, &readings);
    assert_eq!(sensed.echoes.len(), 11);
    let surfaces: Vec<f64> = sensed
        .obstacles
        .iter()
        .map(|o| f(o.centre.norm()) - f(o.radius))
        .collect();
    let mut expected = distances.to_vec();
    expected.sort_by(f64::total_cmp);
    expected.truncate(MAX_OBSTACLES);
    assert_eq!(surfaces.len(), MAX_OBSTACLES);
    for (got, wanted) in surfaces.iter().zip(&expected) {
        assert!((got - wanted).abs() < 1e-3, "{surfaces:?}");
    }
    assert!((f(sensed.nearest) - 0.6).abs() < 1e-3);
}

fn any_reading() -> impl Strategy<Value = RangeReading> {
    let range = prop_oneof![
        3 => any::<i32>().prop_map(|bits| Range::Echo(Metres::from_bits(bits))),
        9 => (0..400_000i32).prop_map(|bits| Range::Echo(Metres::from_bits(bits))),
        1 => prop::sample::select(vec![i32::MIN, i32::MAX, 0]).prop_map(|bits| Range::Echo(Metres::from_bits(bits))),
        2 => Just(Range::Clear),
        1 => Just(Range::Invalid(Fault::Timeout)),
    ];
    let age = prop_oneof![4 => Just(0), 2 => 0..(1 << 22), 1 => any::<i32>()];
    (range, age).prop_map(|(range, age)| RangeReading {
        range,
        age: Seconds::from_bits(age),
    })
}

proptest! {
    #![proptest_config(config(1000))]

    #[test]
    fn any_turn_of_the_ring_without_panic(
        readings in prop::collection::vec(any_reading(), 64),
        mounts in prop::option::of(prop::collection::vec(any::<[i32; 3]>(), 64)),
        raw in any::<[i32; 6]>(),
        sane in any::<bool>(),
        closed in any::<bool>(),
        speed in any::<i32>(),
    ) {
        let mut ring = ring::<64>();
        ring.closed = closed;
        let centred = mounts.is_none();
        if let Some(mounts) = mounts {
            for (mount, [x, y, turn]) in ring.mounts.iter_mut().zip(mounts) {
                mount.pose = Pose::new(
                    Point::new(Metres::from_bits(x), Metres::from_bits(y)),
                    Angle::from_bits(turn),
                );
            }
        }
        if !sane {
            let [range, age, gap, least, most, residual] = raw;
            ring.max_range = Metres::from_bits(range);
            ring.max_age = Seconds::from_bits(age);
            ring.gap = Metres::from_bits(gap);
            ring.radius = [Metres::from_bits(least), Metres::from_bits(most)];
            ring.residual = Metres::from_bits(residual);
        }
        let readings: [RangeReading; 64] = readings.try_into().unwrap();
        let sensed = sense_at(&ring, &readings, MetresPerSecond::from_bits(speed));
        prop_assert!(usize::from(sensed.valid) >= sensed.echoes.len());
        if centred && sane {
            // The order is that of the nearest echoes; a believed circle misses them by its residual.
            let surface = |o: &fuzzypilot::signals::Obstacle| o.centre.norm() - o.radius;
            let slack = ring.residual + ring.residual + metres(0.001);
            let pairs = sensed.obstacles.windows(2);
            prop_assert!(pairs.into_iter().all(|w| surface(&w[0]) <= surface(&w[1]) + slack));
        }
        let total: usize = sensed.obstacles.iter().map(|o| usize::from(o.echoes)).sum();
        prop_assert!(total <= sensed.echoes.len());
        if sensed.obstacles.len() < MAX_OBSTACLES {
            prop_assert_eq!(total, sensed.echoes.len());
        }
    }

    #[test]
    fn more_beams_than_are_allowed_do_not_panic(readings in prop::collection::vec(any_reading(), 100)) {
        let ring = ring::<100>();
        let readings: [RangeReading; 100] = readings.try_into().unwrap();
        prop_assert!(sense(&ring, &readings).echoes.len() <= 64);
    }
}
