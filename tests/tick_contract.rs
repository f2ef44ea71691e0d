//! The contract of one tick: each port once and in order whatever fails, limits kept whatever the ports say, rest
//! reached when sensing is gone, and the same records from the same tape.

use fixed::types::{I16F16, U0F32};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::localise::Localiser;
use fuzzypilot::params::{
    Avoider, Body, Follower, Guard, Integrator, Law, Limits, Mount, ParamError, Params,
    RingGeometry, Supervisor,
};
use fuzzypilot::ports::{
    Fault, Ports, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::signals::{Controller, Decision, StopReason, TickRecord, Travel, Turn};
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::{FineSet, SpeedAxis};
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, PerMetre, Seconds};
use proptest::prelude::*;
use std::cell::RefCell;
use std::rc::Rc;

const PATIENCE: u32 = 6;

fn num(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

fn metres(x: f64) -> Metres {
    Metres::new(num(x))
}

/// A small robot: 1 m/s, 20 Hz, 8 beams all round.
fn params<const N: usize>() -> Params<N> {
    Params {
        body: Body {
            radius: metres(0.1),
            track: metres(0.16),
            metres_per_count: U0F32::from_bits(1 << 12),
        },
        limits: Limits {
            speed: MetresPerSecond::lit("1"),
            yaw_rate: num(4.0),
            acceleration: num(2.5),
            yaw_acceleration: num(8.0),
            wheel_speed: MetresPerSecond::lit("1.3"),
        },
        period: Seconds::lit("0.05"),
        latency: Seconds::lit("0.05"),
        integrator: Integrator::Arc,
        ring: RingGeometry {
            mounts: (0..N)
                .map(|i| Mount {
                    pose: Pose::new(
                        Point::default(),
                        Angle::from_degrees(num(360.0 * i as f64 / N as f64 - 180.0)),
                    ),
                    width: Angle::ZERO,
                })
                .collect(),
            closed: true,
            max_range: metres(2.0),
            max_age: Seconds::lit("0.2"),
            gap: metres(0.35),
            radius: [metres(0.05), metres(2.0)],
            residual: metres(0.03),
        },
        follower: Follower {
            law: Law::Guided,
            tables: FineSet::Tuned,
            speed_axis: SpeedAxis::Scaled,
            distance_scale: num(10.0),
            deflection_rate: num(5.0),
            approach_gain: PerMetre::lit("2"),
            approach_angle: Angle::deg("68"),
            feed_forward_band: metres(0.3),
            lateral_acceleration: num(3.0),
            corner_speed: MetresPerSecond::lit("0.3"),
            reach: metres(0.5),
            arrival: metres(0.02),
            end_radius: metres(0.15),
        },
        avoider: Avoider {
            tables: CoarseSet::Corrected,
            speed_input: SpeedInput::Deflection,
            range: metres(2.0),
            margin: metres(0.08),
            deflection_rate: num(2.5),
            overshoot: Angle::deg("20"),
        },
        supervisor: Supervisor {
            enter: metres(0.8),
            exit: metres(1.4),
            dwell: 3,
            clear: Angle::deg("6"),
            tie: Angle::deg("1"),
            same: metres(0.3),
            patience: PATIENCE as u16,
        },
        guard: Guard {
            margin: metres(0.03),
            braking: num(2.5),
        },
    }
}

fn line(length: f64) -> [Segment; 1] {
    [Segment::line(Pose::default(), metres(length))]
}

// ---- fakes ----

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Call {
    Encoders,
    Ranges,
    Left,
    Right,
}

/// The order in which the ports were used; complains about any other at once.
#[derive(Clone, Default)]
struct Order(Rc<RefCell<Vec<Call>>>);

impl Order {
    const OF_A_TICK: [Call; 4] = [Call::Encoders, Call::Ranges, Call::Left, Call::Right];

    fn note(&self, call: Call) {
        let mut calls = self.0.borrow_mut();
        assert_eq!(
            Some(&call),
            Self::OF_A_TICK.get(calls.len()),
            "after {calls:?}"
        );
        calls.push(call);
    }

    /// To be called after every tick.
    fn complete(&self) {
        assert_eq!(self.0.replace(Vec::new()), Self::OF_A_TICK);
    }
}

/// Wheels that do at once what they are told, and what they have travelled, in counts.
#[derive(Clone, Default)]
struct Wheels(Rc<RefCell<[i64; 4]>>);

impl Wheels {
    /// A period of 0.05 s passes; a count is 2^-20 m.
    fn roll(&self) {
        let [left, right, speed_left, speed_right] = *self.0.borrow();
        *self.0.borrow_mut() = [
            left + speed_left * 16 / 20,
            right + speed_right * 16 / 20,
            speed_left,
            speed_right,
        ];
    }
}

struct FakeDrive(Order, Wheels);
struct FakeEncoders(Order, Wheels);
struct FakeRanges(Order);

impl WheelDrive for FakeDrive {
    type Error = &'static str;
    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), Self::Error> {
        let (call, index) = match wheel {
            Side::Left => (Call::Left, 2),
            Side::Right => (Call::Right, 3),
        };
        self.0.note(call);
        self.1.0.borrow_mut()[index] = i64::from(speed.bits());
        Ok(())
    }
}

impl WheelEncoders for FakeEncoders {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.0.note(Call::Encoders);
        let [left, right, ..] = *self.1.0.borrow();
        Ok(WheelCounts {
            left: left as i32,
            right: right as i32,
        })
    }
}

impl RangeSensors for FakeRanges {
    fn read(&mut self, readings: &mut [RangeReading]) {
        self.0.note(Call::Ranges);
        readings.fill(RangeReading::fresh(Range::Clear));
    }
}

/// Faults around any port: each is asked whether it strikes in this tick.
struct Faulty<P, F> {
    port: P,
    strikes: F,
    tick: u32,
}

fn faulty<P, F>(port: P, strikes: F) -> Faulty<P, F> {
    Faulty {
        port,
        strikes,
        tick: 0,
    }
}

impl<D: WheelDrive, F: FnMut(u32, Side) -> bool> WheelDrive for Faulty<D, F> {
    type Error = ();
    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), ()> {
        let done = self.port.set_speed(wheel, speed);
        let bad = (self.strikes)(self.tick, wheel);
        self.tick += u32::from(wheel == Side::Right);
        if bad { Err(()) } else { done.map_err(|_| ()) }
    }
}

impl<E: WheelEncoders, F: FnMut(u32) -> bool> WheelEncoders for Faulty<E, F> {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        let counts = self.port.counts();
        self.tick += 1;
        if (self.strikes)(self.tick - 1) {
            return Err(Fault::Bus);
        }
        counts
    }
}

impl<R: RangeSensors, F: FnMut(u32, usize) -> Option<RangeReading>> RangeSensors for Faulty<R, F> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        self.port.read(readings);
        for (i, reading) in readings.iter_mut().enumerate() {
            *reading = (self.strikes)(self.tick, i).unwrap_or(*reading);
        }
        self.tick += 1;
    }
}

const INVALID: RangeReading = RangeReading::fresh(Range::Invalid(Fault::Timeout));

/// One robot with its complaining fakes, faults wrapped around them.
struct Bench<D, E, R> {
    robot: Robot<8>,
    ports: Ports<D, E, R>,
    order: Order,
    wheels: Wheels,
    last: (i32, i32),
}

#[rustfmt::skip]
fn bench<DF, EF, RF>(drive: DF, encoders: EF, ranges: RF)
    -> Bench<Faulty<FakeDrive, DF>, Faulty<FakeEncoders, EF>, Faulty<FakeRanges, RF>>
where
    DF: FnMut(u32, Side) -> bool,
    EF: FnMut(u32) -> bool,
    RF: FnMut(u32, usize) -> Option<RangeReading>,
{
    let (order, wheels) = (Order::default(), Wheels::default());
    Bench {
        robot: Robot::new(params().checked().unwrap(), Pose::default()),
        ports: Ports {
            drive: faulty(FakeDrive(order.clone(), wheels.clone()), drive),
            encoders: faulty(FakeEncoders(order.clone(), wheels.clone()), encoders),
            ranges: faulty(FakeRanges(order.clone()), ranges),
        },
        order,
        wheels,
        last: (0, 0),
    }
}

impl<D: WheelDrive, E: WheelEncoders, R: RangeSensors> Bench<D, E, R> {
    fn tick(&mut self, path: &Path<'_>) -> TickRecord {
        let record = self.robot.tick(path, &mut self.ports);
        self.order.complete();
        self.wheels.roll();
        // What was written is what the record says.
        let [_, _, left, right] = *self.wheels.0.borrow();
        assert_eq!(
            (left, right),
            (
                record.wheels.left.bits().into(),
                record.wheels.right.bits().into()
            )
        );
        keeps_limits(self.robot.params(), &record);
        self.last = (record.twist.linear.bits(), record.twist.angular.bits());
        record
    }
}

fn keeps_limits<const N: usize>(p: &Params<N>, record: &TickRecord) {
    for wheel in [record.wheels.left, record.wheels.right] {
        assert!(wheel.abs() <= p.limits.wheel_speed, "{record:?}");
    }
    assert!(record.twist.linear.abs() <= p.limits.speed, "{record:?}");
    let yaw = i64::from(record.twist.angular.bits()).abs();
    assert!(yaw <= i64::from(p.limits.yaw_rate.to_bits()), "{record:?}");
}

fn stopped(record: &TickRecord, reason: StopReason) -> bool {
    record.decision == Decision::Stop(reason)
}

fn at_rest(record: &TickRecord) -> bool {
    (record.twist, record.wheels) == Default::default()
}

// ---- order and faults ----

#[test]
fn each_port_once_and_in_order() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    let mut bench = bench(|_, _| false, |_| false, |_, _| None);
    let mut fastest = 0;
    for _ in 0..300 {
        let record = bench.tick(&path);
        assert!(!record.drive_fault);
        fastest = fastest.max(record.twist.linear.bits());
    }
    // The fakes move the robot: it got to the end and stands there.
    assert!(fastest > 60_000);
    let record = bench.tick(&path);
    assert!(stopped(&record, StopReason::PathEnd) && at_rest(&record));
    assert!((record.pose.at.x - metres(10.0)).abs() < metres(0.03));
}

#[test]
fn a_drive_error_reaches_the_record_and_skips_nothing() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    for (left, right) in [(true, false), (false, true), (true, true)] {
        // The fakes complain when the second wheel is skipped.
        let mut bench = bench(
            |tick, side| tick % 2 == 1 && if side == Side::Left { left } else { right },
            |_| false,
            |_, _| None,
        );
        for tick in 0..50 {
            assert_eq!(bench.tick(&path).drive_fault, tick % 2 == 1);
        }
    }
}

#[test]
fn errors_everywhere_skip_nothing() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    let mut bench = bench(|_, _| true, |_| true, |_, _| Some(INVALID));
    for _ in 0..50 {
        let record = bench.tick(&path);
        assert!(record.drive_fault);
        assert_eq!(record.valid_ranges, 0);
    }
}

/// From a standstill to full speed, then a fault for good from tick 60 on.
const FAULT: u32 = 60;

#[test]
fn encoder_errors_stop_the_robot_within_patience() {
    let pieces = line(30.0);
    let path = Path::segments(&pieces, false).unwrap();
    stops_after_the_fault(
        bench(|_, _| false, |tick| tick >= FAULT, |_, _| None),
        &path,
        StopReason::NoOdometry,
    );
}

#[test]
fn dead_ranges_stop_the_robot_within_patience() {
    let pieces = line(30.0);
    let path = Path::segments(&pieces, false).unwrap();
    let stale = RangeReading {
        range: Range::Clear,
        age: Seconds::lit("0.21"),
    };
    for dead in [INVALID, stale] {
        stops_after_the_fault(
            bench(
                |_, _| false,
                |_| false,
                move |tick, _| (tick >= FAULT).then_some(dead),
            ),
            &path,
            StopReason::NoRanges,
        );
    }
}

fn stops_after_the_fault<D: WheelDrive, E: WheelEncoders, R: RangeSensors>(
    mut bench: Bench<D, E, R>,
    path: &Path<'_>,
    reason: StopReason,
) {
    for tick in 0..FAULT + PATIENCE {
        assert_eq!(bench.tick(path).decision, Decision::Follow, "{tick}");
    }
    let mut speed = bench.last.0;
    assert!(speed > 60_000, "at full speed before: {speed}");
    // 1 m/s at 2.5 m/s² is 0.4 s: 8 ticks, each slower by the whole step.
    let step = 65_536 * 25 / 200;
    for braking in 0..8 {
        let record = bench.tick(path);
        assert!(stopped(&record, reason));
        let now = record.twist.linear.bits();
        assert!(now < speed && speed - now <= step + 1, "{braking}: {now}");
        speed = now;
    }
    for _ in 0..100 {
        let record = bench.tick(path);
        assert!(stopped(&record, reason) && at_rest(&record));
    }
}

#[test]
fn one_live_beam_is_enough_to_go_on() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    let mut bench = bench(
        |_, _| false,
        |_| false,
        |_, beam| (beam != 4).then_some(INVALID),
    );
    for _ in 0..100 {
        let record = bench.tick(&path);
        assert_eq!(
            (record.decision, record.valid_ranges),
            (Decision::Follow, 1)
        );
    }
}

#[test]
fn random_losses_and_stale_readings_are_survived() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    let mut lcg = Lcg(7);
    let mut other = Lcg(8);
    let mut third = Lcg(9);
    let mut bench = bench(
        move |_, _| other.below(3) == 0,
        move |_| third.below(3) == 0,
        move |_, _| match lcg.below(3) {
            0 => Some(INVALID),
            1 => Some(RangeReading {
                range: Range::Clear,
                age: Seconds::from_bits(lcg.next() as i32),
            }),
            _ => None,
        },
    );
    let mut record = bench.tick(&path);
    for _ in 0..1000 {
        record = bench.tick(&path);
    }
    // Odometry makes missed ticks good, so the end is found; what is driven meanwhile is past it.
    assert!(stopped(&record, StopReason::PathEnd) && at_rest(&record));
    println!("stands at {:?}", record.pose.at.x);
    assert!((record.pose.at.x - metres(10.0)).abs() < metres(0.15));
}

#[test]
fn counters_wrap_on_the_way() {
    let pieces = line(10.0);
    let path = Path::segments(&pieces, false).unwrap();
    let run = |offset: i64| {
        let mut bench = bench(|_, _| false, |_| false, |_, _| None);
        *bench.wheels.0.borrow_mut() = [offset, offset, 0, 0];
        (0..250).map(|_| bench.tick(&path)).collect::<Vec<_>>()
    };
    // 10 m are 10.5 million counts: both wrap halfway.
    let plain = run(0);
    assert_eq!(plain, run(i64::from(i32::MAX) - 5_000_000));
    assert_eq!(plain, run(-5_000_000));
}

#[test]
fn the_path_end_is_final_until_the_path_is_restarted() {
    let pieces = line(2.0);
    let path = Path::segments(&pieces, false).unwrap();
    let mut bench = bench(|_, _| false, |_| false, |_, _| None);
    for _ in 0..100 {
        bench.tick(&path);
    }
    // Pushed back to the start by hand it stays where it is put.
    for _ in 0..100 {
        let mut wheels = bench.wheels.0.borrow_mut();
        wheels[0] -= 20_000;
        wheels[1] -= 20_000;
        drop(wheels);
        let record = bench.tick(&path);
        assert!(stopped(&record, StopReason::PathEnd) && at_rest(&record));
    }
    bench.robot.restart_path();
    assert_eq!(bench.tick(&path).decision, Decision::Follow);
    let end = (0..100).map(|_| bench.tick(&path)).last().unwrap();
    assert!(stopped(&end, StopReason::PathEnd));
    assert!((end.pose.at.x - metres(2.0)).abs() < metres(0.03));
}

// ---- arbitrary ports and settings ----

/// The minimal standard generator of 64 bits; its upper half.
struct Lcg(u64);

impl Lcg {
    fn next(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.next()) * u64::from(n)) >> 32) as u32
    }

    /// Extremes, any number, and sensible ones.
    fn value(&mut self) -> i32 {
        const ENDS: [i32; 7] = [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
        match self.below(4) {
            0 => ENDS[self.below(7) as usize],
            1 => self.next() as i32,
            2 => self.next() as i32 >> 12,
            _ => self.below(200_000) as i32,
        }
    }

    /// A positive number of any size.
    fn positive(&mut self) -> i32 {
        match self.below(8) {
            0 => 1,
            1 => i32::MAX - 1,
            _ => (self.next() as i32 & i32::MAX) >> self.below(31),
        }
        .max(1)
    }

    fn metres(&mut self) -> Metres {
        Metres::from_bits(self.positive())
    }

    fn number(&mut self) -> I16F16 {
        I16F16::from_bits(self.positive())
    }

    fn any_number(&mut self) -> I16F16 {
        I16F16::from_bits(self.value())
    }

    fn reading(&mut self) -> RangeReading {
        RangeReading {
            range: match self.below(6) {
                0 => Range::Clear,
                1 => Range::Invalid(Fault::OutOfRange),
                _ => Range::Echo(Metres::from_bits(self.value())),
            },
            age: match self.below(3) {
                0 => Seconds::from_bits(self.value()),
                _ => Seconds::ZERO,
            },
        }
    }

    fn pose(&mut self) -> Pose {
        let (x, y) = (
            Metres::from_bits(self.value()),
            Metres::from_bits(self.value()),
        );
        Pose::new(Point::new(x, y), Angle::from_bits(self.value()))
    }

    /// Every field arbitrary, now and then sensible; until `checked` has nothing against it.
    fn params<const N: usize>(&mut self) -> Params<N> {
        loop {
            let usual = params::<N>();
            let mut p = usual.clone();
            p.body = Body {
                radius: self.metres(),
                track: self.metres(),
                metres_per_count: U0F32::from_bits((self.next() >> self.below(32)).max(1)),
            };
            p.limits = Limits {
                speed: MetresPerSecond::from_bits(self.positive()),
                yaw_rate: self.number(),
                acceleration: self.number(),
                yaw_acceleration: self.number(),
                wheel_speed: MetresPerSecond::from_bits(self.positive()),
            };
            p.period = Seconds::from_bits(16_778 + self.below((2 << 24) - 16_778) as i32);
            p.latency = Seconds::from_bits(self.below((2 << 24) + 1) as i32);
            if self.below(2) == 0 {
                p.integrator = Integrator::Euler;
            }
            for mount in &mut p.ring.mounts {
                mount.pose = self.pose();
            }
            p.ring.closed = self.below(2) == 0;
            p.ring.max_range = self.metres();
            p.ring.max_age = Seconds::from_bits(self.value());
            p.ring.gap = self.metres();
            p.ring.radius = [self.metres(), self.metres()];
            p.ring.residual = Metres::from_bits(self.value());
            p.follower = Follower {
                law: [Law::Guided, Law::Paper][self.below(2) as usize],
                tables: [FineSet::Tuned, FineSet::Printed, FineSet::PrintedProse]
                    [self.below(3) as usize],
                speed_axis: [SpeedAxis::Scaled, SpeedAxis::Literal][self.below(2) as usize],
                distance_scale: self.number(),
                deflection_rate: self.any_number(),
                approach_gain: PerMetre::from_bits(self.value()),
                approach_angle: Angle::from_bits(self.positive().min(1 << 30)),
                feed_forward_band: Metres::from_bits(self.value()),
                lateral_acceleration: self.number(),
                corner_speed: MetresPerSecond::from_bits(self.value()),
                reach: self.metres(),
                arrival: Metres::from_bits(self.value()),
                end_radius: self.metres(),
            };
            p.avoider = Avoider {
                tables: [CoarseSet::Corrected, CoarseSet::Printed][self.below(2) as usize],
                speed_input: [SpeedInput::Deflection, SpeedInput::Bearing][self.below(2) as usize],
                range: self.metres(),
                margin: self.metres(),
                deflection_rate: self.any_number(),
                overshoot: Angle::from_bits(self.value()),
            };
            p.supervisor = Supervisor {
                enter: self.metres(),
                exit: self.metres(),
                dwell: self.value() as u16,
                clear: Angle::from_bits(self.positive().min((1 << 30) - 1)),
                tie: Angle::from_bits(self.positive().min(1 << 30)),
                same: Metres::from_bits(self.value()),
                patience: self.value() as u16,
            };
            p.guard = Guard {
                margin: self.metres(),
                braking: self.number(),
            };
            // What settings depend on each other is made to fit; half of the time single groups are sensible.
            p.ring.radius.sort();
            p.supervisor.enter = p.supervisor.enter.min(p.avoider.range);
            p.guard.braking = p.guard.braking.min(p.limits.acceleration);
            if self.below(2) == 0 {
                p.limits = usual.limits;
                p.guard = usual.guard;
            }
            if self.below(2) == 0 {
                p.body = usual.body;
                p.ring = usual.ring;
            }
            if self.below(2) == 0 {
                p.follower = usual.follower;
            }
            if self.below(2) == 0 {
                p.avoider = usual.avoider;
                p.supervisor = usual.supervisor;
            }
            // Fields that `checked` may refuse in time to come are drawn again.
            if let Ok(p) = p.checked() {
                return p;
            }
        }
    }

    fn segments(&mut self) -> Vec<Segment> {
        (0..=self.below(4))
            .map(|_| match self.below(2) {
                0 => Segment::line(self.pose(), self.metres()),
                _ => Segment::Arc {
                    centre: self.pose().at,
                    radius: self.metres(),
                    from: Angle::from_bits(self.value()),
                    sweep: match self.below((2 << 24) + 1) as i32 - (1 << 24) {
                        0 => 1,
                        sweep => sweep,
                    },
                },
            })
            .collect()
    }
}

/// Ports that say anything.
struct Wild(Lcg);

impl WheelDrive for Wild {
    type Error = ();
    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), ()> {
        if self.0.below(4) == 0 {
            Err(())
        } else {
            Ok(())
        }
    }
}

impl WheelEncoders for Wild {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        match self.0.below(5) {
            0 => Err(Fault::Timeout),
            _ => Ok(WheelCounts {
                left: self.0.value(),
                right: self.0.value(),
            }),
        }
    }
}

impl RangeSensors for Wild {
    fn read(&mut self, readings: &mut [RangeReading]) {
        readings.fill_with(|| self.0.reading());
    }
}

fn wild(seed: u64) -> Ports<Wild, Wild, Wild> {
    Ports {
        drive: Wild(Lcg(seed ^ 1)),
        encoders: Wild(Lcg(seed ^ 2)),
        ranges: Wild(Lcg(seed ^ 3)),
    }
}

/// How far the twist may move in a tick.
fn steps<const N: usize>(p: &Params<N>) -> (i64, i64) {
    let step = |rate: I16F16| (i64::from(rate.to_bits()) * i64::from(p.period.bits())) >> 24;
    (step(p.limits.acceleration), step(p.limits.yaw_acceleration))
}

fn drive_wildly<const N: usize>(seed: u64, p: Params<N>, ticks: u32, strict: bool) {
    let mut lcg = Lcg(seed);
    let (pieces, points) = (lcg.segments(), [lcg.pose(), lcg.pose(), lcg.pose()]);
    let closed = lcg.below(2) == 0;
    let usual = line(10.0);
    let path = match lcg.below(3) {
        0 => Path::segments_with_gaps(&pieces, closed).ok(),
        1 => Path::points(&points, closed).ok(),
        _ => None,
    }
    .unwrap_or_else(|| Path::segments(&usual, false).unwrap());
    let (v_step, w_step) = steps(&p);
    let mut robot = Robot::new(p.clone(), lcg.pose());
    let mut ports = wild(seed);
    let mut last = (0i64, 0i64);
    for tick in 0..ticks {
        if lcg.below(500) == 0 {
            robot.restart_path();
        }
        let record = robot.tick(&path, &mut ports);
        assert_eq!(record.tick, tick);
        keeps_limits(&p, &record);
        let now: (i64, i64) = (
            record.twist.linear.bits().into(),
            record.twist.angular.bits().into(),
        );
        // A wheel at its limit scales both parts down at once, beyond what acceleration allows.
        let rim = ((now.1.abs() + 1) * i64::from(p.body.track.bits() >> 1)) >> 16;
        let saturated = now.0.abs() + rim + 4 >= i64::from(p.limits.wheel_speed.bits());
        if strict || !saturated {
            assert!(
                (now.0 - last.0).abs() <= v_step,
                "v {last:?} {now:?} {v_step}"
            );
            assert!(
                (now.1 - last.1).abs() <= w_step,
                "w {last:?} {now:?} {w_step}"
            );
        }
        last = now;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_the_ports_say_the_limits_hold(seed in any::<u64>()) {
        drive_wildly::<16>(seed, params().checked().unwrap(), 400, false);
    }

    #[test]
    fn whatever_checked_lets_pass_the_limits_hold(seed in any::<u64>()) {
        let mut lcg = Lcg(seed);
        let p = lcg.params::<8>();
        drive_wildly(seed, p, 300, false);
    }
}

#[test]
fn long_nonsense() {
    drive_wildly::<64>(1, params().checked().unwrap(), 10_000, false);
    drive_wildly::<1>(2, params().checked().unwrap(), 10_000, false);
}

#[test]
fn acceleration_limits_hold_even_when_a_wheel_saturates() {
    let mut p = params::<16>();
    p.limits.wheel_speed = MetresPerSecond::lit("1");
    for seed in 0..200 {
        drive_wildly(seed, p.clone().checked().unwrap(), 200, true);
    }
}

#[test]
fn the_greatest_tie_and_clear_that_checked_allows_do_not_panic() {
    let mut p = params::<16>();
    p.supervisor.tie = Angle::deg("89.99");
    p.supervisor.clear = Angle::deg("89.99");
    drive_wildly(1, p.checked().unwrap(), 400, false);
}

#[test]
fn a_pose_at_the_end_of_the_world_does_not_panic() {
    let body = Body {
        metres_per_count: U0F32::MAX,
        ..params::<1>().body
    };
    let mut localiser = Localiser::new(&body, Pose::default());
    for _ in 0..17_000_000 {
        localiser.advance(
            &body,
            Integrator::Euler,
            Travel::Counts {
                left: i32::MAX,
                right: i32::MAX,
            },
        );
    }
}

// ---- determinism ----

/// FNV-1a over every field of a record, in the order of ticks.csv.
struct Digest(u64);

impl Digest {
    fn add(&mut self, value: i64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn record(&mut self, r: &TickRecord) {
        self.add(r.tick.into());
        match r.decision {
            Decision::Follow => self.add(0),
            Decision::Avoid { side, obstacle } => {
                self.add(match side {
                    Turn::Left => 1,
                    Turn::Right => 2,
                });
                for m in [
                    obstacle.centre.x,
                    obstacle.centre.y,
                    obstacle.radius,
                    obstacle.residual,
                ] {
                    self.add(m.bits().into());
                }
                self.add(obstacle.echoes.into());
            }
            Decision::Stop(reason) => self.add(match reason {
                StopReason::NoRanges => 3,
                StopReason::NoOdometry => 4,
                StopReason::PathEnd => 5,
                StopReason::PathMissed => 6,
            }),
        }
        let g = &r.guidance;
        for bits in [
            r.pose.at.x.bits(),
            r.pose.at.y.bits(),
            r.pose.heading.bits(),
            g.foot.x.bits(),
            g.foot.y.bits(),
            g.cross_track.bits(),
            g.distance.bits(),
            g.tangent.bits(),
            g.curvature.bits(),
            g.heading_error.bits(),
            g.progress.bits(),
            g.remaining.bits(),
            g.laps.into(),
            g.speed_limit.bits(),
            g.at_end.into(),
            g.missed_end.into(),
            r.obstacles.into(),
            r.valid_ranges.into(),
            r.nearest.bits(),
            match r.trace.controller {
                Controller::None => 0,
                Controller::Fine => 1,
                Controller::Coarse => 2,
            },
            r.trace.distance_input,
            r.trace.angle_input,
            r.trace.speed_output.into(),
            r.trace.deflection_output.into(),
            r.desired.linear.bits(),
            r.desired.angular.bits(),
            r.twist.linear.bits(),
            r.twist.angular.bits(),
            r.wheels.left.bits(),
            r.wheels.right.bits(),
            r.guarded.into(),
            r.drive_fault.into(),
        ] {
            self.add(bits.into());
        }
        for rules in [&r.trace.rules, &r.trace.speed_rules] {
            let fired = rules.fired();
            self.add(fired.len() as i64);
            for rule in &fired {
                self.add(rule.row.into());
                self.add(rule.col.into());
                self.add(rule.degree.bits().into());
            }
        }
    }
}

/// A tape that needs no float and no robot: an S of travel, discs that come and go, losses and errors.
struct Tape(Lcg, u32);

impl Tape {
    fn new(seed: u64) -> Self {
        Self(Lcg(seed), 0)
    }
}

impl WheelDrive for Tape {
    type Error = ();
    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), ()> {
        self.1 += 1;
        if self.1.is_multiple_of(97) {
            Err(())
        } else {
            Ok(())
        }
    }
}

impl WheelEncoders for Tape {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.1 += 1;
        let t = self.1 as i32;
        // 40 mm a tick, bending left and right every 100 ticks.
        let bend = (t % 200 - 100).abs() * 60 - 3000;
        Ok(WheelCounts {
            left: t * 42_000 - bend * 10 + self.0.below(50) as i32,
            right: t * 42_000 + bend * 10 + self.0.below(50) as i32,
        })
        .and_then(|counts| {
            if t % 61 < 9 && t > 700 {
                Err(Fault::Bus)
            } else {
                Ok(counts)
            }
        })
    }
}

impl RangeSensors for Tape {
    fn read(&mut self, readings: &mut [RangeReading]) {
        self.1 += 1;
        let t = self.1;
        let (from, width) = (t / 7 % 32, 3 + t / 50 % 7);
        for (i, reading) in readings.iter_mut().enumerate() {
            let seen = (i as u32 + 32 - from) % 32 < width && t % 90 > 25;
            let noise = self.0.below(1300) as i32;
            *reading = RangeReading {
                range: match self.0.below(40) {
                    0 => Range::Invalid(Fault::Timeout),
                    _ if t % 300 > 280 => Range::Invalid(Fault::Bus),
                    _ if seen => {
                        Range::Echo(Metres::from_bits(130_000 - (t % 90) as i32 * 1350 + noise))
                    }
                    _ => Range::Clear,
                },
                age: Seconds::from_bits(self.0.below(1 << 20) as i32),
            };
        }
    }
}

fn play(seed: u64, law: Law, ticks: u32) -> Vec<TickRecord> {
    let mut p = params::<32>();
    p.follower.law = law;
    let pieces = [
        Segment::line(Pose::default(), metres(3.0)),
        Segment::arc(
            Point::new(metres(3.0), metres(2.0)),
            metres(2.0),
            Angle::deg("-90"),
            num(180.0),
        ),
        Segment::arc(
            Point::new(metres(3.0), metres(7.0)),
            metres(3.0),
            Angle::deg("-90"),
            num(-270.0),
        ),
        Segment::line(
            Pose::new(Point::new(metres(6.0), metres(7.0)), Angle::deg("-90")),
            metres(12.0),
        ),
    ];
    let path = Path::segments_with_gaps(&pieces, false).unwrap();
    let mut robot = Robot::new(p.checked().unwrap(), Pose::default());
    let mut ports = Ports {
        drive: Tape::new(seed),
        encoders: Tape::new(seed + 1),
        ranges: Tape::new(seed + 2),
    };
    (0..ticks).map(|_| robot.tick(&path, &mut ports)).collect()
}

fn digest(records: &[TickRecord]) -> u64 {
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    for record in records {
        digest.record(record);
    }
    digest.0
}

#[test]
fn the_same_tape_gives_the_same_records() {
    let first = play(1, Law::Guided, 1200);
    assert_eq!(first, play(1, Law::Guided, 1200));
    assert_ne!(digest(&first), digest(&play(2, Law::Guided, 1200)));
    assert_ne!(digest(&first), digest(&play(1, Law::Paper, 1200)));
    // The tape visits everything.
    let count = |f: fn(&TickRecord) -> bool| first.iter().filter(|r| f(r)).count();
    for (what, n) in [
        ("follow", count(|r| r.decision == Decision::Follow)),
        (
            "avoid",
            count(|r| matches!(r.decision, Decision::Avoid { .. })),
        ),
        ("blind", count(|r| stopped(r, StopReason::NoRanges))),
        ("lost", count(|r| stopped(r, StopReason::NoOdometry))),
        ("guarded", count(|r| r.guarded)),
        ("fault", count(|r| r.drive_fault)),
    ] {
        println!("{what}: {n} ticks");
        assert!(n > 5, "{what}: {n}");
    }
}

/// Of the tape above. A new value means that some bit of some tick is different: intended, or another architecture's
/// arithmetic. The tape uses integers only, so every machine must agree.
const DIGESTS: [(Law, u64); 2] = [
    (Law::Guided, 0x4392_f399_55c4_090c),
    (Law::Paper, 0x6c3f_2bd8_f86e_6c9e),
];

#[test]
fn every_bit_of_every_tick_is_as_it_was() {
    let found = DIGESTS.map(|(law, _)| (law, digest(&play(1, law, 1200))));
    assert_eq!(found, DIGESTS, "{found:#018x?}");
}

// ---- settings ----

type Spoil = fn(&mut Params<8>);

#[test]
fn checked_names_the_field_that_forbids_driving() {
    assert!(params::<8>().checked().is_ok());
    let cases: [(&str, Spoil); 46] = [
        ("body.radius", |p| p.body.radius = Metres::ZERO),
        ("body.radius", |p| p.body.radius = metres(-0.1)),
        ("body.track", |p| p.body.track = Metres::ZERO),
        ("body.metres_per_count", |p| {
            p.body.metres_per_count = U0F32::ZERO;
        }),
        ("limits.speed", |p| p.limits.speed = MetresPerSecond::ZERO),
        ("limits.speed", |p| {
            p.limits.speed = MetresPerSecond::from_bits(-1);
        }),
        ("limits.yaw_rate", |p| p.limits.yaw_rate = num(0.0)),
        ("limits.yaw_rate", |p| p.limits.yaw_rate = num(-1.0)),
        ("limits.acceleration", |p| p.limits.acceleration = num(0.0)),
        ("limits.acceleration", |p| p.limits.acceleration = num(-1.0)),
        ("limits.yaw_acceleration", |p| {
            p.limits.yaw_acceleration = num(0.0);
        }),
        ("limits.wheel_speed", |p| {
            p.limits.wheel_speed = MetresPerSecond::ZERO;
        }),
        ("period", |p| p.period = Seconds::ZERO),
        ("period", |p| p.period = Seconds::lit("0.0009")),
        ("period", |p| p.period = Seconds::lit("2.001")),
        ("period", |p| p.period = Seconds::lit("-0.05")),
        ("latency", |p| p.latency = Seconds::from_bits(-1)),
        ("latency", |p| p.latency = Seconds::lit("2.001")),
        ("ring.max_range", |p| p.ring.max_range = Metres::ZERO),
        ("ring.gap", |p| p.ring.gap = Metres::ZERO),
        ("ring.radius", |p| {
            p.ring.radius = [Metres::ZERO, metres(1.0)];
        }),
        ("ring.radius", |p| {
            p.ring.radius = [metres(1.0), metres(0.9)];
        }),
        ("follower.distance_scale", |p| {
            p.follower.distance_scale = num(0.0);
        }),
        ("follower.approach_angle", |p| {
            p.follower.approach_angle = Angle::ZERO;
        }),
        ("follower.approach_angle", |p| {
            p.follower.approach_angle = Angle::deg("-30");
        }),
        ("follower.approach_angle", |p| {
            p.follower.approach_angle = Angle::deg("90.01");
        }),
        ("follower.reach", |p| p.follower.reach = Metres::ZERO),
        ("follower.lateral_acceleration", |p| {
            p.follower.lateral_acceleration = num(0.0);
        }),
        ("avoider.range", |p| p.avoider.range = Metres::ZERO),
        ("avoider.margin", |p| {
            p.avoider.margin = Metres::from_bits(-1);
        }),
        ("avoider.overshoot", |p| {
            p.avoider.overshoot = Angle::deg("-1");
        }),
        ("ring.max_age", |p| p.ring.max_age = Seconds::from_bits(-1)),
        ("ring.residual", |p| p.ring.residual = Metres::ZERO),
        ("follower.corner_speed", |p| {
            p.follower.corner_speed = MetresPerSecond::ZERO;
        }),
        ("follower.arrival", |p| {
            p.follower.arrival = Metres::from_bits(-1);
        }),
        (ENTER, |p| p.supervisor.exit = p.supervisor.enter),
        (ENTER, |p| p.supervisor.exit = Metres::ZERO),
        (ENTER, |p| p.supervisor.enter = Metres::ZERO),
        (ENTER, |p| p.supervisor.enter = metres(-0.1)),
        (ENTER, |p| {
            p.supervisor.enter = metres(2.1);
            p.supervisor.exit = metres(2.2);
        }),
        ("guard.margin", |p| p.guard.margin = Metres::from_bits(-1)),
        ("guard.braking", |p| p.guard.braking = num(0.0)),
        ("guard.braking", |p| p.guard.braking = num(-2.0)),
        ("guard.braking", |p| p.guard.braking = num(2.51)),
        // The first of two is named.
        ("body.track", |p| {
            p.body.track = Metres::ZERO;
            p.guard.braking = num(0.0);
        }),
        ("limits.acceleration", |p| {
            p.limits.acceleration = num(0.0);
            p.guard.braking = num(0.0);
        }),
    ];
    for (field, spoil) in cases {
        let mut p = params();
        spoil(&mut p);
        let error = p.checked().expect_err(field);
        assert_eq!(error.field, field);
        assert!(!error.allowed.is_empty());
        assert_eq!(
            error.to_string(),
            format!("{field}: allowed is {}", error.allowed)
        );
    }
}

const ENTER: &str = "supervisor.enter, supervisor.exit";

#[test]
fn checked_wants_one_to_sixty_four_sensors() {
    fn field<const N: usize>() -> Option<&'static str> {
        params::<N>()
            .checked()
            .err()
            .map(|ParamError { field, .. }| field)
    }
    assert_eq!(field::<0>(), Some("ring.mounts"));
    assert_eq!(field::<1>(), None);
    assert_eq!(field::<64>(), None);
    assert_eq!(field::<65>(), Some("ring.mounts"));
}

#[test]
fn the_ends_of_what_is_allowed_are_allowed() {
    let cases: [Spoil; 8] = [
        |p| p.period = Seconds::lit("0.001"),
        |p| p.period = Seconds::lit("2"),
        |p| p.latency = Seconds::ZERO,
        |p| p.latency = Seconds::lit("2"),
        |p| p.follower.approach_angle = Angle::QUARTER,
        |p| p.ring.radius[0] = p.ring.radius[1],
        |p| p.avoider.margin = Metres::ZERO,
        |p| p.guard.margin = Metres::ZERO,
    ];
    for spoil in cases {
        let mut p = params();
        spoil(&mut p);
        assert!(p.checked().is_ok());
    }
}

#[test]
fn checked_refuses_what_drives_into_obstacles_or_away_from_the_path() {
    let cases: [(&str, Spoil); 7] = [
        ("avoider.deflection_rate", |p| {
            p.avoider.deflection_rate = num(-1.0);
        }),
        ("follower.deflection_rate", |p| {
            p.follower.deflection_rate = num(-1.0);
        }),
        ("follower.approach_gain", |p| {
            p.follower.approach_gain = PerMetre::lit("-1");
        }),
        ("supervisor.same", |p| {
            p.supervisor.same = Metres::from_bits(-1);
        }),
        ("supervisor.clear", |p| {
            p.supervisor.clear = Angle::deg("-30");
        }),
        ("supervisor.clear", |p| p.supervisor.clear = Angle::QUARTER),
        ("supervisor.tie", |p| p.supervisor.tie = Angle::HALF),
    ];
    let passed: Vec<&str> = cases
        .into_iter()
        .filter(|(_, spoil)| {
            let mut p = params();
            spoil(&mut p);
            p.checked().is_ok()
        })
        .map(|(field, _)| field)
        .collect();
    assert!(passed.is_empty(), "accepted: {passed:?}");
}
