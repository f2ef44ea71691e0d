//! Output sets, sampled.

use crate::fuzzy::model::Shape;
use fuzzypilot::fuzzy::Grade;

/// A shape's degree at every sample.
pub fn set(shape: &Shape, samples: &[f64]) -> Vec<Grade> {
    let grade = |&x: &f64| {
        let bits = shape.degree(x) * f64::from(Grade::ONE.bits());
        Grade::from_bits(bits.round() as u16)
    };
    samples.iter().map(grade).collect()
}
