//! The same controller with the crate oxictl 0.1.1 (Apache-2.0).
//!
//! Its `SugenoEngine` can express the rule base exactly: triangles and trapezoids for the terms, min for AND, a constant
//! for every rule's output, the weighted average. It has one output, so there are two engines, each of which fuzzifies the
//! inputs again; and it knows no physical units, so scales and ends of the axes are put around it. Two terms need care: at
//! the foot of a trapezoid the membership is zero even where the foot is the shoulder's end, so the shoulders begin one
//! unit outside the axes. Everything is made once; evaluating only reads it.

use super::float::Scales;
use fuzzypilot::tables::fine::FineTables;
use oxictl::fuzzy::{
    Antecedent, MembershipFn, SugenoEngine, SugenoRule, TNorm, Trapezoidal, Triangular,
};
use std::f32::consts::PI;

type Terms = &'static [&'static dyn MembershipFn<f32>];

/// Two engines of 25 rules.
pub struct Peer {
    terms: [Terms; 2],
    speed: SugenoEngine<f32, 25>,
    deflection: SugenoEngine<f32, 25>,
    scales: Scales,
}

impl Peer {
    pub fn new(tables: &FineTables, scales: Scales) -> Self {
        Self {
            // Both axes have five terms a unit apart, if half a turn is four units.
            terms: [terms(), terms()],
            speed: engine(|row, col| tables.speed.peak(row, col).to_num()),
            deflection: engine(|row, col| tables.deflection.peak(row, col).to_num()),
            scales,
        }
    }

    /// Speed and yaw rate at `d` metres and a heading error in radians.
    pub fn evaluate(&self, d: f32, error: f32) -> [f32; 2] {
        let x = (d * self.scales.distance).clamp(0.0, 4.0);
        let y = (error.abs() * (4.0 / PI)).clamp(0.0, 4.0);
        let infer = |engine: &SugenoEngine<f32, 25>| {
            engine
                .infer(&[y, x], &self.terms)
                .expect("some rule fires at every input")
        };
        [
            infer(&self.speed) * self.scales.speed,
            (infer(&self.deflection) * self.scales.yaw_rate).copysign(error),
        ]
    }
}

/// Peaks 0 to 4.
fn terms() -> Terms {
    let first = Trapezoidal::new(-1.0, -1.0, 0.0, 1.0).expect("in order");
    let last = Trapezoidal::new(3.0, 4.0, 5.0, 5.0).expect("in order");
    let inner = [1.0, 2.0, 3.0].map(|peak| -> &'static dyn MembershipFn<f32> {
        Box::leak(Box::new(
            Triangular::new(peak - 1.0, peak, peak + 1.0).expect("in order"),
        ))
    });
    let [a, b, c] = inner;
    let all: [&'static dyn MembershipFn<f32>; 5] = [
        Box::leak(Box::new(first)),
        a,
        b,
        c,
        Box::leak(Box::new(last)),
    ];
    Box::leak(Box::new(all))
}

fn engine(peak: impl Fn(usize, usize) -> f32) -> SugenoEngine<f32, 25> {
    let mut engine = SugenoEngine::new(TNorm::Min);
    for (row, col) in (0..25).map(|rule| (rule / 5, rule % 5)) {
        let mut antecedent = Antecedent::new();
        antecedent.add(0, row).expect("room for two");
        antecedent.add(1, col).expect("room for two");
        engine
            .add_rule(SugenoRule::new(antecedent, 0.0, 0.0, peak(row, col)))
            .expect("room for 25");
    }
    engine
}
