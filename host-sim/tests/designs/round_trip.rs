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
