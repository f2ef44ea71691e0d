//! Echo timing: distances, every way a ping can fail, turns and spacing, and the speed of sound's error.

use super::{config, fx, metres, seconds, speed};
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use fuzzypilot::ports::echo::{EchoRing, EchoSettings, HC_SR04, speed_of_sound};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::{Fault, Range};
use micromath::F32Ext;
use proptest::prelude::*;
use std::cell::RefCell;
use std::io::ErrorKind;
use std::rc::Rc;

/// Sensors that answer as the test wants: delay to the rise and width of the echo, in µs; none is no rise, or no fall.
type Answer = Option<(u32, Option<u32>)>;

/// A trigger pin that notes when it rose and fell.
#[derive(Clone, Default)]
struct Trigger(Rc<RefCell<Log>>);

#[derive(Default)]
struct Log {
    now: u32,
    edges: Vec<(u32, bool)>,
}

impl Trigger {
    fn at(&self, now: u32) {
        self.0.borrow_mut().now = now;
    }

    fn rises(&self) -> Vec<u32> {
        let log = self.0.borrow();
        log.edges.iter().filter(|e| e.1).map(|e| e.0).collect()
    }

    fn note(&self, high: bool) -> Result<(), core::convert::Infallible> {
        let mut log = self.0.borrow_mut();
        let now = log.now;
        log.edges.push((now, high));
        Ok(())
    }
}

impl embedded_hal::digital::ErrorType for Trigger {
    type Error = core::convert::Infallible;
}

impl embedded_hal::digital::OutputPin for Trigger {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.note(false)
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.note(true)
    }
}

/// Runs `N` sensors for `until` µs from `start` on; edges by interrupt to the microsecond, polls every `step` µs.
fn run<const N: usize>(
    answers: [Answer; N],
    settings: EchoSettings,
    start: u32,
    until: u32,
    step: u32,
) -> (Vec<Sample>, Vec<Trigger>) {
    let triggers: [Trigger; N] = core::array::from_fn(|_| Trigger::default());
    let mut ring = EchoRing::new(triggers.clone(), settings).unwrap();
    let mut samples = Vec::new();
    let mut edges: Vec<(u32, usize, bool)> = Vec::new();
    let mut heard = [0; N];
    for now in 0..until {
        let clock = start.wrapping_add(now);
        edges.retain(|&(at, index, level)| {
            if at == now {
                ring.edge(index, level, clock);
            }
            at > now
        });
        if now % step != 0 {
            continue;
        }
        triggers.iter().for_each(|t| t.at(now));
        samples.extend(ring.poll(clock));
        for (i, trigger) in triggers.iter().enumerate() {
            let falls = trigger.0.borrow().edges.iter().filter(|e| !e.1).count();
            if falls > heard[i] {
                heard[i] = falls;
                if let Some((rise, width)) = answers[i] {
                    edges.push((now + rise, i, true));
                    edges.extend(width.map(|width| (now + rise + width, i, false)));
                }
            }
        }
    }
    (samples, triggers.to_vec())
}

fn first(answer: Answer) -> Range {
    let (samples, _) = run([answer], HC_SR04, 0, 60_000, 50);
    samples[0].range
}

#[test]
fn every_end_of_a_ping_has_its_reading() {
    let Range::Echo(distance) = first(Some((450, Some(5_828)))) else {
        panic!("5.8 ms is 1 m")
    };
    assert!((distance.get().to_num::<f64>() - 1.000).abs() < 5e-4);
    assert_eq!(first(Some((450, Some(38_000)))), Range::Clear);
    assert_eq!(
        first(Some((450, Some(90)))),
        Range::Invalid(Fault::OutOfRange)
    );
    assert_eq!(first(None), Range::Invalid(Fault::Timeout));
    assert_eq!(first(Some((450, None))), Range::Invalid(Fault::Timeout));
}

#[test]
fn an_echo_pin_stuck_high_is_told() {
    // Its echo never falls: timeout, then stuck.
    let trigger = Trigger::default();
    let mut ring = EchoRing::new([trigger], HC_SR04).unwrap();
    let mut samples = Vec::new();
    for now in (0..300_000).step_by(100) {
        ring.edge(0, now > 1_000, now);
        samples.extend(ring.poll(now));
    }
    let ranges: Vec<_> = samples.iter().map(|s| s.range).collect();
    assert_eq!(ranges[0], Range::Invalid(Fault::Timeout));
    assert!(ranges.len() >= 4, "{ranges:?}");
    for range in &ranges[1..] {
        assert_eq!(*range, Range::Invalid(Fault::Bus));
    }
}

/// As the firmware does: edges by interrupt, and the level once more after a reading.
#[test]
fn an_echo_pin_without_edges_is_told_each_time() {
    let triggers: [Trigger; 2] = core::array::from_fn(|_| Trigger::default());
    let mut ring = EchoRing::new(triggers, HC_SR04).unwrap();
    let mut ranges = Vec::new();
    for now in (0..900_000).step_by(100) {
        // Stuck from the beginning of its first echo on; the other is silent.
        if now == 1_000 {
            ring.edge(0, true, now);
        }
        if let Some(sample) = ring.poll(now) {
            ring.edge(sample.index, sample.index == 0, now);
            ranges.push((sample.index, sample.range));
        }
    }
    assert_eq!(ranges[0], (0, Range::Invalid(Fault::Timeout)));
    assert!(ranges.len() > 10, "{ranges:?}");
    for (index, range) in &ranges[1..] {
        let fault = [Fault::Bus, Fault::Timeout][*index];
        assert_eq!(*range, Range::Invalid(fault), "{ranges:?}");
    }
}

#[test]
fn a_missed_falling_edge_costs_one_reading() {
    let mut ring = EchoRing::new([Trigger::default()], HC_SR04).unwrap();
    let mut ranges = Vec::new();
    for turn in 0..3 {
        let start = turn * 100_000;
        for now in (start..start + 100_000).step_by(100) {
            if now == start + 600 {
                ring.edge(0, true, now);
            }
            if now == start + 6_600 && turn != 0 {
                ring.edge(0, false, now);
            }
            let sample = ring.poll(now);
            ranges.extend(sample.map(|s| s.range));
            if ranges.len() > turn as usize {
                break;
            }
        }
    }
    assert_eq!(ranges[0], Range::Invalid(Fault::Timeout));
    for range in &ranges[1..] {
        assert!(matches!(range, Range::Echo(_)), "{ranges:?}");
    }
}

#[test]
fn waiting_ends_when_the_settings_say() {
    // No rise: 10 ms after the trigger, whenever the polls come.
    for poll in [10_001, 10_700] {
        let mut ring = EchoRing::new([Trigger::default()], HC_SR04).unwrap();
        ring.poll(0);
        ring.poll(10);
        assert_eq!(ring.poll(10_000), None);
        assert_eq!(
            ring.poll(poll).map(|s| s.range),
            Some(Range::Invalid(Fault::Timeout))
        );
    }
    // No fall: 50 ms after the rise.
    for poll in [50_501, 51_900] {
        let mut ring = EchoRing::new([Trigger::default()], HC_SR04).unwrap();
        ring.poll(0);
        ring.poll(10);
        ring.edge(0, true, 500);
        assert_eq!(ring.poll(50_500), None);
        assert_eq!(
            ring.poll(poll).map(|s| s.range),
            Some(Range::Invalid(Fault::Timeout))
        );
    }
}

#[test]
fn a_new_temperature_counts_from_the_next_reading() {
    let mut ring = EchoRing::new([Trigger::default()], HC_SR04).unwrap();
    let mut ping = |start: u32, settings: Option<EchoSettings>| {
        if let Some(settings) = settings {
            ring.set(settings).unwrap();
        }
        ring.poll(start);
        ring.poll(start + 10);
        ring.edge(0, true, start + 500);
        ring.edge(0, false, start + 10_500);
        match ring.poll(start + 10_600).unwrap().range {
            Range::Echo(distance) => distance.get().to_num::<f64>(),
            other => panic!("{other:?}"),
        }
    };
    let warm = ping(0, None);
    let sound = speed_of_sound(fx(-10.0));
    let cold = ping(60_000, Some(EchoSettings { sound, ..HC_SR04 }));
    assert!((warm - 1.716).abs() < 1e-3, "{warm}");
    assert!((cold - 1.626).abs() < 1e-3, "{cold}");
}

#[test]
fn sensors_fire_in_turn_with_the_spacing_between() {
    let near = Some((450, Some(2_914)));
    let (samples, triggers) = run([near, None, near], HC_SR04, u32::MAX - 90_000, 400_000, 100);
    let indices: Vec<_> = samples.iter().map(|s| s.index).collect();
    assert_eq!(indices, [0, 1, 2, 0, 1, 2, 0]);
    let mut rises: Vec<_> = triggers.iter().flat_map(Trigger::rises).collect();
    rises.sort_unstable();
    assert_eq!(rises.len(), 7);
    for pair in rises.windows(2) {
        assert_eq!(pair[1] - pair[0], 60_000);
    }
    for trigger in &triggers {
        for pulse in trigger.0.borrow().edges.chunks(2) {
            assert_eq!([pulse[0].1, pulse[1].1], [true, false]);
            assert!(pulse[1].0 - pulse[0].0 >= 10, "{pulse:?}");
        }
    }
    assert_eq!(samples[1].range, Range::Invalid(Fault::Timeout));
}

#[test]
fn another_sensors_echo_is_not_taken() {
    let mut ring = EchoRing::new([Trigger::default(), Trigger::default()], HC_SR04).unwrap();
    ring.poll(0);
    ring.poll(100);
    ring.edge(1, true, 500);
    ring.edge(1, false, 3_000);
    assert_eq!(ring.poll(4_000), None);
    ring.edge(0, true, 5_000);
    ring.edge(0, false, 8_000);
    assert!(matches!(
        ring.poll(9_000),
        Some(Sample {
            index: 0,
            range: Range::Echo(_),
            at_us: 8_000
        })
    ));
    ring.edge(7, true, 9_000);
}

#[test]
fn a_failing_trigger_is_a_bus_fault_and_the_next_sensor_has_its_turn() {
    let failing = || MockError::Io(ErrorKind::NotConnected);
    let mut broken = Pin::new(&[Level::set(State::High).with_error(failing())]);
    let mut good = Pin::new(&[
        Level::set(State::High),
        Level::set(State::Low).with_error(failing()),
    ]);
    let mut ring = EchoRing::new([broken.clone(), good.clone()], HC_SR04).unwrap();
    let bus = |index, at_us| {
        Some(Sample {
            index,
            range: Range::Invalid(Fault::Bus),
            at_us,
        })
    };
    assert_eq!(ring.poll(0), bus(0, 0));
    assert_eq!(ring.poll(59_000), None);
    assert_eq!(ring.poll(60_000), None);
    assert_eq!(ring.poll(60_005), None, "10 µs at least");
    assert_eq!(ring.poll(60_010), bus(1, 60_010));
    broken.done();
    good.done();
}

#[test]
fn settings_are_checked() {
    let with = |change: fn(&mut EchoSettings)| {
        let mut settings = HC_SR04;
        change(&mut settings);
        EchoRing::new([Trigger::default()], settings)
            .map(|_| ())
            .map_err(|e| e.field)
    };
    assert_eq!(with(|_| ()), Ok(()));
    assert_eq!(with(|s| s.sound = speed(99.0)), Err("echo.sound"));
    assert_eq!(with(|s| s.spacing = seconds(0.0)), Err("echo.spacing"));
    assert_eq!(with(|s| s.rise = seconds(1.1)), Err("echo.rise"));
    // 4 m there and back take 23.3 ms.
    assert_eq!(with(|s| s.fall = seconds(0.0233)), Err("echo.fall"));
    assert_eq!(with(|s| s.fall = seconds(0.0234)), Ok(()));
    let field = "echo.min_range, echo.max_range";
    assert_eq!(with(|s| s.max_range = s.min_range), Err(field));
    assert_eq!(with(|s| s.min_range = metres(-0.1)), Err(field));
}

/// The figures of `speed_of_sound`'s documentation.
#[test]
fn the_speed_of_sound_is_as_good_as_documented() {
    let (mut root_alone, mut ours, mut absolute) = (0.0_f64, 0.0_f64, 0.0_f64);
    for milli in (-40_000..=85_000).step_by(25) {
        let celsius = f64::from(milli) / 1000.0;
        let exact = 331.3 * (1.0 + celsius / 273.15).sqrt();
        let ratio = (1.0 + celsius / 273.15) as f32;
        let rough = f64::from(F32Ext::sqrt(ratio)) * 331.3;
        let got: f64 = speed_of_sound(fx(celsius)).get().to_num();
        root_alone = root_alone.max((rough / exact - 1.0).abs());
        ours = ours.max((got / exact - 1.0).abs());
        absolute = absolute.max((got - exact).abs());
    }
    assert!((0.0091..0.0092).contains(&root_alone), "{root_alone}");
    assert!((0.00004..0.000042).contains(&ours), "{ours}");
    assert!((0.0155..0.016).contains(&absolute), "{absolute}");
    // Clamped outside.
    assert_eq!(speed_of_sound(fx(1000.0)), speed_of_sound(fx(85.0)));
    assert_eq!(speed_of_sound(fx(-300.0)), speed_of_sound(fx(-40.0)));
}

proptest! {
    #![proptest_config(config(256))]

    /// Distance is speed times half the time, within a step of `Metres` and what the settings let through.
    #[test]
    fn distance_is_half_the_way(width in 0_u32..50_000, sound in 300.0..360.0_f64) {
        let settings = EchoSettings { sound: speed(sound), ..HC_SR04 };
        let (samples, _) = run([Some((450, Some(width.max(1))))], settings, 0, 58_000, 500);
        let exact = f64::from(width.max(1)) * 1e-6 * settings.sound.get().to_num::<f64>() / 2.0;
        match samples[0].range {
            Range::Echo(d) => {
                let d: f64 = d.get().to_num();
                prop_assert!((d - exact).abs() < 3e-5, "{d} for {exact}");
                prop_assert!((0.02..=4.0).contains(&d));
            }
            Range::Clear => prop_assert!(exact > 4.0 - 3e-5),
            Range::Invalid(fault) => {
                prop_assert!(fault == Fault::OutOfRange && exact < 0.02 + 3e-5);
            }
        }
    }

    /// Whatever edges and polls come, when and in whatever order: turns go on, and nothing panics.
    #[test]
    fn any_edges_are_survived(
        noise in prop::collection::vec((0_usize..4, any::<bool>(), 0_u32..20_000), 200),
        start in any::<u32>(),
    ) {
        let mut ring = EchoRing::new(core::array::from_fn::<_, 3, _>(|_| Trigger::default()), HC_SR04)
            .unwrap();
        let (mut now, mut last, mut ends) = (start, None, 0);
        for (index, level, pause) in noise {
            now = now.wrapping_add(pause);
            ring.edge(index, level, now);
            if let Some(sample) = ring.poll(now) {
                if let Some(last) = last {
                    prop_assert_eq!(sample.index, (last + 1) % 3);
                }
                last = Some(sample.index);
                ends += 1;
            }
        }
        // 200 polls, 10 ms apart on average; a turn lasts up to 60 + 50 ms and some polls.
        prop_assert!(ends >= 8, "{ends} turns");
    }
}
