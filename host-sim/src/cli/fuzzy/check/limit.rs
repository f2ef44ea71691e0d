//! How far fixed point may be off: the fast route's bound, and what is beyond a limit.

use super::CheckArguments;
use super::findings::Findings;
use super::text::{FAST, SHOWN_STRENGTHS, share};
use crate::cli::BadInput;
use crate::cli::fuzzy::convert::{Route, unfit};
use crate::cli::fuzzy::design::Design;
use host_sim::fuzzy::describe::number;
use host_sim::fuzzy::emit::{self, rust};

/// What a module of the fast route may be off, an entry an output; `None` if the design is evaluated by the general one.
pub fn fast(design: &Design, arguments: &CheckArguments) -> anyhow::Result<Option<Vec<f64>>> {
    let (Ok(lowered), Route::Auto | Route::Fast) = (&design.fixed, arguments.route) else {
        return Ok(None);
    };
    let emitted = emit::Design {
        system: &design.system,
        lowered,
        name: &design.stem,
        command: "",
        bounds: None,
    };
    match (emitted.rule_base(), arguments.route) {
        (Ok(base), _) => {
            let outputs = 0..base.tables.len();
            Ok(Some(
                outputs.map(|o| rust::output_error(&base, o)).collect(),
            ))
        }
        (Err(why), Route::Fast) => {
            let file = arguments.design.file.display();
            Err(BadInput(unfit(&file, &why)).into())
        }
        (Err(_), _) => Ok(None),
    }
}

/// What may be off by more than `most` per cent of its output's range.
pub fn beyond(findings: &Findings, most: f64) -> Option<String> {
    if findings.no_fixed_point.is_some() {
        return Some("no fixed point, and --max-error asks how far it is off".to_owned());
    }
    let mut beyond = Vec::new();
    for errors in findings.errors.iter().filter(|errors| errors.concluded) {
        let span = errors.range[1] - errors.range[0];
        let bounds = errors
            .shown()
            .map(|(place, class)| (SHOWN_STRENGTHS[place], class.nowhere_above))
            .chain(errors.fast_route.map(|bound| (FAST, bound)));
        let Some((which, worst)) = bounds.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        if 100.0 * worst / span > most {
            beyond.push(format!(
                "{} {} ({which})",
                errors.output,
                share(worst / span)
            ));
        }
    }
    (!beyond.is_empty()).then(|| {
        format!(
            "off by up to {}, and --max-error allows {} %",
            beyond.join(", "),
            number(most)
        )
    })
}
