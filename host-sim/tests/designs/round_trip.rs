//! What is written reads back as what it was; what cannot be written is refused, and why.

use super::arbitrary::system;
use super::read;
use host_sim::fuzzy::files::{Format, adapt, fcl, fll};
use host_sim::fuzzy::model::{Conclusion, Defuzzifier, Sampling, Shape, System};
use proptest::prelude::*;

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A centroid from end to end.
fn has_ends(system: &System) -> bool {
    let ends = |d| {
        matches!(
            d,
            Defuzzifier::Centroid {
                sampling: Sampling::Ends,
                ..
            }
        )
    };
    system.outputs.iter().any(|o| ends(o.defuzzifier))
}

fn has_linear(system: &System) -> bool {
    let mut terms = system.outputs.iter().flat_map(|o| &o.terms);
    terms.any(|t| matches!(t.conclusion, Conclusion::Linear { .. }))
}

fn has_open(system: &System) -> bool {
    let mut terms = system.inputs.iter().flat_map(|i| &i.terms);
    terms.any(|t| matches!(t.shape, Shape::Trapezoid { left, .. } if left.is_infinite()))
}

proptest! {
    #![proptest_config(config(1_000))]

    #[test]
    fn fll_reads_as_it_was_written(mut system in system()) {
        if has_ends(&system) {
            let error = fll::write(&system).unwrap_err();
            prop_assert!(error.adaptable && error.to_string().contains("end to end"), "{}", error);
            prop_assert!(!adapt::to_fll(&mut system).is_empty());
        }
        system.description = "what: it is for".to_owned();
        system.inputs[0].description = "°C".to_owned();
        system.outputs[0].description = "if it is so, then".to_owned();
        system.blocks[0].description = "Engine".to_owned();
        let text = fll::write(&system).unwrap();
        prop_assert_eq!(read(&text, Format::Fll).without_places(), system, "{}", text);
    }

    #[test]
    fn fcl_reads_as_it_was_written(system in system()) {
        match fcl::write(&system) {
            Ok(text) => {
                prop_assert!(!has_linear(&system) && !has_open(&system));
                prop_assert_eq!(read(&text, Format::Fcl).without_places(), system, "{}", text);
            }
            Err(error) => {
                let said = error.to_string();
                prop_assert!(
                    said.contains("linear") && has_linear(&system) || said.contains("step") && has_open(&system),
                    "{}", said
                );
            }
        }
    }
}

/// fuzzylite's Discrete has its last point's degree at a jump, its Triangle the peak's.
#[test]
fn what_ends_in_a_jump_is_the_same_in_every_format() {
    let text = "Engine: e\nInputVariable: x\n  range: 0 10\n  \
         term: saw Discrete 0 0 5 1 5 0\n  term: box Discrete 3 0 3 1 6 1 6 0\n  \
         term: peak Triangle 0 5 5\n  term: wall Trapezoid 0 3 6 6\n  term: foot Discrete 3 0 3 1 6 0\n\
         OutputVariable: y\n  range: 0 1\n  defuzzifier: WeightedAverage\n  term: p Constant 1\n\
         RuleBlock: r\n  activation: General\n  rule: if x is saw then y is p\n";
    let system = read(text, Format::Fll).without_places();
    let degrees = |system: &System, x: f64| -> Vec<f64> {
        let terms = &system.inputs[0].terms;
        terms.iter().map(|term| term.shape.degree(x)).collect()
    };
    assert_eq!(degrees(&system, 5.0), [0.0, 1.0, 1.0, 1.0, 1.0 / 3.0]);
    assert_eq!(degrees(&system, 6.0), [0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(degrees(&system, 3.0), [0.6, 1.0, 0.6, 1.0, 1.0]);
    let through_fll = read(&fll::write(&system).unwrap(), Format::Fll);
    let through_fcl = read(&fcl::write(&system).unwrap(), Format::Fcl);
    assert_eq!(through_fll.without_places(), system);
    assert_eq!(through_fcl.without_places(), system);
}
