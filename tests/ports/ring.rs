//! The slots between drivers and tick: ages, and no reading that looks fresher than it is.

use super::{config, metres, seconds};
use fuzzypilot::ports::ring::Latest;
use fuzzypilot::ports::{Fault, Range, RangeReading, RangeSensors};
use proptest::prelude::*;

const NEVER: Range = Range::Invalid(Fault::NeverSeen);
const STALE: Range = Range::Invalid(Fault::Stale);

fn read<const N: usize>(latest: &mut Latest<N>, now_us: u32) -> [RangeReading; N] {
    latest.at(now_us);
    let mut readings = [RangeReading::NEVER_SEEN; N];
    latest.read(&mut readings);
    readings
}

#[test]
fn each_sensor_has_its_own_latest_reading_and_age() {
    let mut latest = Latest::<3>::new();
    assert_eq!(read(&mut latest, 5).map(|r| r.range), [NEVER; 3]);
    latest.post(0, Range::Clear, 1_000);
    latest.post(2, Range::Invalid(Fault::Timeout), 21_000);
    latest.post(0, Range::Echo(metres(0.7)), 31_000);
    latest.post(3, Range::Clear, 31_000);
    let readings = read(&mut latest, 41_000);
    assert_eq!(
        readings.map(|r| r.range),
        [
            Range::Echo(metres(0.7)),
            NEVER,
            Range::Invalid(Fault::Timeout)
        ]
    );
    assert_eq!(readings[0].age, seconds(0.01));
    assert_eq!(readings[2].age, seconds(0.02));
    // Nothing new: the same again, older.
    assert_eq!(read(&mut latest, 91_000)[0].age, seconds(0.06));
}

#[test]
fn a_tick_without_the_time_finds_everything_stale() {
    let mut latest = Latest::<2>::new();
    latest.post(0, Range::Clear, 1_000);
    let fresh = read(&mut latest, 1_000)[0];
    assert_eq!(fresh, RangeReading::fresh(Range::Clear));
    let mut readings = [RangeReading::NEVER_SEEN; 2];
    latest.read(&mut readings);
    assert_eq!(readings.map(|r| r.range), [STALE, NEVER]);
}

#[test]
fn a_reading_posted_while_the_tick_read_its_clock_is_fresh() {
    let mut latest = Latest::<1>::new();
    latest.post(0, Range::Clear, 5);
    assert_eq!(
        read(&mut latest, u32::MAX)[0],
        RangeReading::fresh(Range::Clear)
    );
}

#[test]
fn an_old_reading_never_becomes_fresh_when_the_clock_wraps() {
    let mut latest = Latest::<1>::new();
    latest.post(0, Range::Clear, 0);
    let mut now = 0_u32;
    for _ in 0..200 {
        now = now.wrapping_add(31_000_000);
        let reading = read(&mut latest, now)[0];
        assert!(
            reading.range == STALE || reading.age >= seconds(31.0),
            "{now}: {reading:?}"
        );
    }
    latest.post(0, Range::Clear, now);
    assert_eq!(read(&mut latest, now)[0], RangeReading::fresh(Range::Clear));
}

#[test]
fn after_two_minutes_a_reading_is_stale_and_its_age_saturates() {
    for (age, stale) in [
        (120_000_000, false),
        (120_000_001, true),
        (2_000_000_000, true),
    ] {
        let mut latest = Latest::<1>::new();
        latest.post(0, Range::Clear, 7);
        let reading = read(&mut latest, 7 + age)[0];
        assert_eq!(reading.range == STALE, stale, "{age}");
        let expected = (f64::from(age) * 1e-6).min(127.999_999);
        let got: f64 = reading.age.get().to_num();
        assert!((got - expected).abs() < 1e-6, "{got} for {expected}");
    }
}

#[test]
fn more_mounts_than_slots_stay_never_seen() {
    let mut latest = Latest::<1>::new();
    latest.post(0, Range::Clear, 0);
    latest.at(0);
    let mut readings = [RangeReading::NEVER_SEEN; 3];
    latest.read(&mut readings);
    assert_eq!(readings.map(|r| r.range), [Range::Clear, NEVER, NEVER]);
}

proptest! {
    #![proptest_config(config(512))]

    /// To a fraction of a microsecond, from any place of the clock.
    #[test]
    fn ages_are_exact(at in any::<u32>(), age in 0_u32..120_000_000) {
        let mut latest = Latest::<1>::new();
        latest.post(0, Range::Clear, at);
        let reading = read(&mut latest, at.wrapping_add(age))[0];
        let error = reading.age.get().to_num::<f64>() - f64::from(age) / 1e6;
        prop_assert!(reading.range == Range::Clear);
        prop_assert!(error.abs() < 1.6e-7, "{error}");
    }
}
