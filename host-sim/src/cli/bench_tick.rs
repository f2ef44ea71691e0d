//! `host-sim bench-tick`

use super::{Variants, load, number};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use fuzzypilot::ports::{
    Fault, Ports, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::tick::Robot;
use fuzzypilot::units::MetresPerSecond;
use host_sim::params::params;
use host_sim::run::{OwnedPath, simulate};
use host_sim::scenario::Scenario;
use host_sim::si;
use std::hint::black_box;
use std::time::{Duration, Instant};

#[derive(Args)]
pub struct BenchArguments {
    /// Seconds a measurement.
    #[arg(long, default_value_t = 1.0, value_parser = number(0.001, 600.0), allow_hyphen_values = true)]
    seconds: f64,
}

pub fn execute(arguments: &BenchArguments) -> anyhow::Result<()> {
    let time = Duration::from_secs_f64(arguments.seconds);
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["one core", "ranges", "ticks per second"]);
    for count in [8, 16, 64] {
        let mut scenario = load("one-obstacle", &Variants::default())?;
        scenario.sensors.count = count;
        let rate = match count {
            8 => library::<8>(&scenario, time)?,
            16 => library::<16>(&scenario, time)?,
            _ => library::<64>(&scenario, time)?,
        };
        table.add_row(["library alone".to_owned(), count.to_string(), grouped(rate)]);
    }
    for name in ["one-obstacle", "experiment-1"] {
        let scenario = load(name, &Variants::default())?;
        let rate = simulation(&scenario, time)?;
        table.add_row([
            format!("whole simulation, {name}"),
            scenario.sensors.count.to_string(),
            grouped(rate),
        ]);
    }
    super::print(format_args!("{table}\n"))
}

/// Ports that replay what a real run saw, so that every branch of the tick is taken as often as in life.
struct Tape<const N: usize> {
    counts: Vec<WheelCounts>,
    ranges: Vec<[RangeReading; N]>,
}

struct Player<'a, const N: usize> {
    tape: &'a Tape<N>,
    at: usize,
}

impl<const N: usize> WheelDrive for Player<'_, N> {
    type Error = core::convert::Infallible;
    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), Self::Error> {
        black_box((wheel, speed));
        Ok(())
    }
}

impl<const N: usize> WheelEncoders for Player<'_, N> {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.at += 1;
        self.tape
            .counts
            .get(self.at - 1)
            .copied()
            .ok_or(Fault::Timeout)
    }
}

impl<const N: usize> RangeSensors for Player<'_, N> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        self.at += 1;
        readings.copy_from_slice(&self.tape.ranges[self.at - 1]);
    }
}

fn library<const N: usize>(scenario: &Scenario, time: Duration) -> anyhow::Result<f64> {
    let tape = record::<N>(scenario)?;
    let owned = OwnedPath::new(scenario);
    let path = owned.view()?;
    let params = params::<N>(scenario)?;
    let player = || Player { tape: &tape, at: 0 };
    let mut ticks = 0u64;
    let mut spent = Duration::ZERO;
    while spent < time {
        let mut robot = Robot::new(params.clone(), si::pose(scenario.start));
        let mut ports = Ports {
            drive: player(),
            encoders: player(),
            ranges: player(),
        };
        let begin = Instant::now();
        for _ in 0..tape.counts.len() {
            black_box(robot.tick(black_box(&path), &mut ports));
        }
        spent += begin.elapsed();
        ticks += tape.counts.len() as u64;
    }
    Ok(ticks as f64 / spent.as_secs_f64())
}

/// Encoder counts and readings of one run of the scenario.
fn record<const N: usize>(scenario: &Scenario) -> anyhow::Result<Tape<N>> {
    use fuzzypilot::ports::Range;
    let metres_per_count =
        f64::from(params::<N>(scenario)?.body.metres_per_count.to_bits()) / 4_294_967_296.0;
    let mut tape = Tape {
        counts: Vec::new(),
        ranges: Vec::new(),
    };
    let mut travel = [0.0; 2];
    simulate(scenario, 1, &mut |step| {
        let counts = travel.map(|t: f64| (t / metres_per_count).round() as i64 as i32);
        tape.counts.push(WheelCounts {
            left: counts[0],
            right: counts[1],
        });
        let mut readings = [RangeReading::fresh(Range::Clear); N];
        for (reading, seen) in readings.iter_mut().zip(step.ranges) {
            if let Some(range) = seen {
                *reading = RangeReading::fresh(Range::Echo(si::metres(*range)));
            }
        }
        tape.ranges.push(readings);
        travel[0] += step.wheels[0] * scenario.robot.period;
        travel[1] += step.wheels[1] * scenario.robot.period;
    })?;
    Ok(tape)
}

fn simulation(scenario: &Scenario, time: Duration) -> anyhow::Result<f64> {
    let mut ticks = 0u64;
    let begin = Instant::now();
    let mut seed = 1;
    while begin.elapsed() < time {
        simulate(scenario, seed, &mut |step| {
            ticks += 1;
            black_box(step);
        })?;
        seed += 1;
    }
    Ok(ticks as f64 / begin.elapsed().as_secs_f64())
}

fn grouped(rate: f64) -> String {
    let digits = format!("{rate:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
