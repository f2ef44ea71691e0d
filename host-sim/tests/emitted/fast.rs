//! What the library's tables give, and how far that is from `f64`.

use super::cases;
use super::systems::{Made, fast_systems};
use host_sim::fuzzy::emit::rust::output_error;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::fast::Fast;

/// The outputs at every input by the library itself, its tables made while this runs.
pub fn expected(made: &Made, inputs: &[Vec<i32>]) -> Vec<Vec<i32>> {
    let fast = Fast::new(&made.system, &made.lowered).unwrap();
    let one = |input: &Vec<i32>| fast.steps([input[0], input[1]]);
    inputs.iter().map(one).collect()
}

#[test]
fn the_error_is_within_what_is_announced() {
    for made in fast_systems(60) {
        let base = made.design("").rule_base().unwrap();
        let inputs = cases::inputs(&made, 3000);
        let found = expected(&made, &inputs);
        let exact = Exact::new(&made.system);
        let mut worst = vec![0.0_f64; base.tables.len()];
        for (input, found) in inputs.iter().zip(&found) {
            let values: Vec<f64> = input.iter().map(|&x| f64::from(x) / 65_536.0).collect();
            let exact = exact.evaluate(&values).outputs;
            for (o, table) in base.tables.iter().enumerate() {
                let step = if base.is_twin() {
                    table.step() / 4096.0
                } else {
                    table.step()
                };
                let error = f64::from(found[o]) * step - exact[o].unwrap();
                worst[o] = worst[o].max(error.abs());
            }
        }
        for (o, worst) in worst.into_iter().enumerate() {
            let announced = output_error(&base, o);
            assert!(worst <= announced, "{}: {worst} of {announced}", made.name);
            // It is no idle number either.
            let constant = base.tables[o].peaks.len() == 1;
            assert!(
                constant || worst > announced / 100.0,
                "{}: {worst} of {announced}",
                made.name
            );
        }
    }
}
