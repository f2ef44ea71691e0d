//! A whole robot on these drivers: motors, 16-bit counters and analog sensors modelled, the tick and the wheel loop on
//! their own rates, as firmware runs them.

use super::{fx, metres, seconds, speed};
use fixed::types::U0F32;
use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::ports::analog::{AnalogIn, AnalogRange, GP2Y0A21};
use fuzzypilot::ports::bridge::{Bridge, Effort, Motor};
use fuzzypilot::ports::quadrature::{QuadratureCounter, QuadratureEncoders};
use fuzzypilot::ports::ring::Latest;
use fuzzypilot::ports::wheel_loop::{Gains, Rest, Stall, WheelLoop, WheelLoopSettings};
use fuzzypilot::ports::{Fault, Ports, Range, RangeReading, RangeSensors, WheelEncoders};
use fuzzypilot::presets;
use fuzzypilot::signals::{Decision, StopReason, TickRecord};
use fuzzypilot::tick::Robot;
use std::cell::Cell;
use std::rc::Rc;

/// 65 mm wheel, 1440 counts a turn.
const COUNT: f64 = 0.000_142;

/// A wheel with its motor and encoder: effort, speed, travel.
#[derive(Clone, Default)]
struct Wheel(Rc<Cell<(f64, f64, f64)>>);

impl Wheel {
    fn roll(&self, dt: f64) {
        let (effort, speed, travel) = self.0.get();
        let goal = 1.05 * effort.signum() * (effort.abs() - 0.08).max(0.0) / 0.92;
        let speed = speed + (goal - speed) * (dt / 0.06);
        self.0.set((effort, speed, travel + speed * dt));
    }
}

impl Motor for Wheel {
    type Error = core::convert::Infallible;
    fn drive(&mut self, effort: Effort) -> Result<(), Self::Error> {
        let (_, speed, travel) = self.0.get();
        let effort = f64::from(effort.bits()) / 32_767.0;
        self.0.set((effort, speed, travel));
        Ok(())
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        self.drive(Effort::ZERO)
    }
    fn coast(&mut self) -> Result<(), Self::Error> {
        self.drive(Effort::ZERO)
    }
}

impl QuadratureCounter for Wheel {
    type Raw = u16;
    fn raw(&mut self) -> Result<u16, Fault> {
        // Wraps after some metres.
        Ok(((self.0.get().2 / COUNT).floor() as i64 + 60_000) as u16)
    }
}

/// What all four analog inputs say.
#[derive(Clone)]
struct Input(Rc<Cell<Result<u16, Fault>>>);

impl AnalogIn for Input {
    fn millivolts(&mut self) -> Result<u16, Fault> {
        self.0.get()
    }
}

struct Machine {
    robot: Robot<4>,
    ports: Ports<WheelLoop<Wheel, Wheel>, QuadratureEncoders<Wheel, Wheel>, Latest<4>>,
    sensors: [AnalogRange<Input, 11>; 4],
    wheels: [Wheel; 2],
    input: Input,
    now: u32,
}

impl Machine {
    fn new() -> Self {
        let mut params = presets::small_robot::<4>();
        params.limits.speed = speed(0.6);
        params.limits.wheel_speed = speed(0.8);
        params.body.metres_per_count = U0F32::from_num(COUNT);
        let gains = Gains {
            static_effort: fx(0.08),
            feed_forward: fx(0.9),
            proportional: fx(1.0),
            integral: fx(5.0),
        };
        let settings = WheelLoopSettings {
            metres_per_count: params.body.metres_per_count,
            gains: [gains; 2],
            reverse: [false; 2],
            limit: Effort::lit("0.9"),
            deadband: speed(0.02),
            rest: Rest::Brake,
            timeout: seconds(0.2),
            stall: Stall {
                effort: Effort::lit("0.8"),
                counts: 4,
                time: seconds(0.5),
            },
        };
        let wheels = [Wheel::default(), Wheel::default()];
        let [left, right] = wheels.clone();
        let bridge = Bridge::new(left.clone(), right.clone());
        let input = Input(Rc::new(Cell::new(Ok(300))));
        Self {
            robot: Robot::new(params.checked().unwrap(), Pose::default()),
            ports: Ports {
                drive: WheelLoop::new(bridge, settings).unwrap(),
                // 0.8 m/s for 5 ms are 28 counts.
                encoders: QuadratureEncoders::new(left, right).at_most(40),
                ranges: Latest::new(),
            },
            sensors: core::array::from_fn(|_| AnalogRange::new(input.clone(), &GP2Y0A21, 100)),
            wheels,
            input,
            now: u32::MAX - 1_000_000,
        }
    }

    /// A tick every 50 ms, the wheel loop every 5, the sensors every 40.
    fn tick(&mut self, path: &Path<'_>) -> TickRecord {
        for step in 0..10 {
            self.now = self.now.wrapping_add(5_000);
            for wheel in &self.wheels {
                wheel.roll(0.005);
            }
            if step % 8 == 0 {
                for (index, sensor) in self.sensors.iter_mut().enumerate() {
                    self.ports.ranges.post(index, sensor.read(), self.now);
                }
            }
            let counts = self.ports.encoders.counts();
            let _ = self.ports.drive.step(self.now, counts);
        }
        self.ports.ranges.at(self.now);
        self.robot.tick(path, &mut self.ports)
    }

    fn travel(&self) -> [f64; 2] {
        [self.wheels[0].0.get().2, self.wheels[1].0.get().2]
    }
}

fn line(length: f64) -> [Segment; 1] {
    [Segment::line(Pose::default(), metres(length))]
}

#[test]
fn it_drives_a_line_to_its_end() {
    let segments = line(12.0);
    let path = Path::segments(&segments, false).unwrap();
    let mut machine = Machine::new();
    let mut last = None;
    for _ in 0..1_000 {
        let record = machine.tick(&path);
        assert!(!record.drive_fault, "tick {}", record.tick);
        assert_eq!(record.valid_ranges, 4, "tick {}", record.tick);
        last = Some(record);
        if record_ended(&last) {
            break;
        }
    }
    assert!(record_ended(&last), "{last:?}");
    let [left, right] = machine.travel();
    // Counted over more than one wrap-around of 16 bits.
    assert!(
        left > 65_536.0 * COUNT && (left - 12.0).abs() < 0.05,
        "{left}"
    );
    assert!((left - right).abs() < 0.005, "{left} {right}");
}

fn record_ended(record: &Option<TickRecord>) -> bool {
    let decision = record.as_ref().map(|r| r.decision);
    decision == Some(Decision::Stop(StopReason::PathEnd))
}

#[test]
fn it_stops_when_all_sensors_fail_and_says_why() {
    let segments = line(12.0);
    let path = Path::segments(&segments, false).unwrap();
    let mut machine = Machine::new();
    for _ in 0..60 {
        machine.tick(&path);
    }
    machine.input.0.set(Err(Fault::Timeout));
    let at_failure = machine.travel()[0];
    let mut record = machine.tick(&path);
    for _ in 0..100 {
        record = machine.tick(&path);
    }
    assert_eq!(record.decision, Decision::Stop(StopReason::NoRanges));
    let mut readings = [RangeReading::NEVER_SEEN; 4];
    machine.ports.ranges.at(machine.now);
    machine.ports.ranges.read(&mut readings);
    let timeout = Range::Invalid(Fault::Timeout);
    assert_eq!(readings.map(|r| r.range), [timeout; 4]);
    let [stopped, _] = machine.travel();
    machine.tick(&path);
    assert!(machine.travel()[0] - stopped < 1e-4, "still moving");
    assert!(stopped - at_failure < 0.6, "{}", stopped - at_failure);
}
