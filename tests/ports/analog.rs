//! Analog distance: the table's points exactly, between them monotone, outside it nothing guessed.

use super::{config, metres};
use fuzzypilot::ports::analog::{AnalogIn, AnalogRange, DistanceTable, GP2Y0A21};
use fuzzypilot::ports::{Fault, Range};
use proptest::prelude::*;

struct Input(Result<u16, Fault>);

impl AnalogIn for Input {
    fn millivolts(&mut self) -> Result<u16, Fault> {
        self.0
    }
}

fn read(input: Result<u16, Fault>, connected: u16) -> Range {
    AnalogRange::new(Input(input), &GP2Y0A21, connected).read()
}

#[test]
fn the_preset_meets_the_datasheets_typical_values() {
    assert_eq!(read(Ok(2300), 0), Range::Echo(metres(0.1)));
    assert_eq!(read(Ok(400), 0), Range::Echo(metres(0.8)));
    let Range::Echo(distance) = read(Ok(1000), 0) else {
        panic!("1 V is inside")
    };
    // Between 25 and 30 cm, half way.
    assert!((distance.get().to_num::<f64>() - 0.275).abs() < 1e-4);
}

#[test]
fn beyond_the_table_nothing_is_guessed() {
    assert_eq!(read(Ok(399), 0), Range::Clear);
    assert_eq!(read(Ok(0), 0), Range::Clear);
    assert_eq!(read(Ok(2301), 0), Range::Invalid(Fault::OutOfRange));
    assert_eq!(read(Ok(u16::MAX), 0), Range::Invalid(Fault::OutOfRange));
    assert_eq!(read(Ok(99), 100), Range::Invalid(Fault::Bus));
    assert_eq!(read(Ok(100), 100), Range::Clear);
    assert_eq!(read(Err(Fault::Timeout), 0), Range::Invalid(Fault::Timeout));
}

/// Valid points: gaps of voltage and distance summed up.
fn points() -> impl Strategy<Value = ([(u16, u16); 6], bool)> {
    (
        prop::array::uniform6((1_u16..9_000, 1_u16..9_000)),
        any::<bool>(),
    )
        .prop_map(|(gaps, rising)| {
            let mut at = (0_u16, 0_u16);
            let mut points = gaps.map(|(v, d)| {
                at = (at.0 + v, at.1 + d);
                at
            });
            if !rising {
                let volts: Vec<_> = points.iter().rev().map(|p| p.0).collect();
                for (point, v) in points.iter_mut().zip(volts) {
                    point.0 = v;
                }
            }
            (points, rising)
        })
}

proptest! {
    #![proptest_config(config(128))]

    #[test]
    fn any_table_is_monotone_within_its_points((points, rising) in points()) {
        let table = DistanceTable::new(points);
        let ends = [points[0], points[5]];
        let mut last = None;
        for step in 0..=u16::MAX {
            // Towards greater distances.
            let mv = if rising { step } else { u16::MAX - step };
            let (near, far) = if rising {
                (mv < ends[0].0, mv > ends[1].0)
            } else {
                (mv > ends[0].0, mv < ends[1].0)
            };
            match table.range(mv) {
                Range::Invalid(fault) => prop_assert!(near && fault == Fault::OutOfRange),
                Range::Clear => prop_assert!(far),
                Range::Echo(distance) => {
                    prop_assert!(!near && !far);
                    prop_assert!(last.is_none_or(|last| last <= distance), "{mv} mV");
                    last = Some(distance);
                    // Against f64.
                    let place = points.windows(2).find(|w| {
                        let (a, b) = (w[0].0.min(w[1].0), w[0].0.max(w[1].0));
                        (a..=b).contains(&mv)
                    }).unwrap();
                    let share = (f64::from(mv) - f64::from(place[0].0))
                        / (f64::from(place[1].0) - f64::from(place[0].0));
                    let exact = f64::from(place[0].1)
                        + share * (f64::from(place[1].1) - f64::from(place[0].1));
                    let error = distance.get().to_num::<f64>() - exact / 1000.0;
                    prop_assert!(error.abs() < 2.5e-5, "{mv} mV: {error}");
                }
            }
        }
        for (mv, mm) in points {
            let exact = metres(f64::from(mm) / 1000.0);
            let Range::Echo(distance) = table.range(mv) else { panic!("a point is inside") };
            prop_assert!((distance.bits() - exact.bits()).abs() <= 1);
        }
    }
}
