//! How far fixed point may be off: the fast route's bound, and what is beyond a limit.

use super::CheckArguments;
use super::findings::{Findings, rounded};
use super::text::{FAST, SHOWN_STRENGTHS, share};
use crate::cli::fuzzy::convert::Route;
use crate::cli::fuzzy::design::Design;
use host_sim::fuzzy::check::Report;
use host_sim::fuzzy::describe::{given_point, number};
use host_sim::fuzzy::emit::rust;
use host_sim::fuzzy::model::System;

/// What a module of the fast route may be off, an entry an output; `None` if the design is evaluated by the general one.
pub fn fast(design: &Design, arguments: &CheckArguments) -> anyhow::Result<Option<Vec<f64>>> {
    if design.fixed.is_err() {
        return Ok(None);
    }
    let fast = design.fast(&arguments.design, arguments.route)?;
    Ok(fast.map(|fast| {
        let outputs = 0..fast.base().tables.len();
        outputs
            .map(|o| rust::output_error(fast.base(), o))
            .collect()
    }))
}

/// What may be off by more than `most` per cent of its output's range. With [`Route::Fast`] the fast route's bound counts alone:
/// nothing else is to be made of the design; otherwise it counts among the others.
pub fn beyond(findings: &Findings, route: Route, most: f64) -> Option<String> {
    if findings.no_fixed_point.is_some() {
        return Some("no fixed point, and --max-error asks how far it is off".to_owned());
    }
    let mut beyond = Vec::new();
    for errors in findings.errors.iter().filter(|errors| errors.concluded) {
        let span = errors.range[1] - errors.range[0];
        // All classes, whether a point of the grid is in them or not. And if ever a bound is wrong, what was measured counts.
        let classes = SHOWN_STRENGTHS.into_iter().zip(&errors.classes);
        let bounds = classes
            .map(|(name, class)| (name, class.nowhere_above.max(class.greatest)))
            .filter(|_| route != Route::Fast)
            .chain(errors.fast_route.map(|bound| (FAST, bound)));
        let Some((which, worst)) = bounds.reduce(|a, b| if b.1 > a.1 { b } else { a }) else {
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

/// What was measured above its own bound: a fault of this program, which is not to be kept quiet.
pub fn broken(system: &System, report: &Report) -> Option<String> {
    let errors = report.errors.iter().flatten().zip(&system.outputs);
    let broken: Vec<String> = errors
        .filter_map(|(errors, output)| {
            let place = errors.broken(output)?;
            let class = &errors.measured.classes[place];
            Some(format!(
                "{} ({}) is off by {} at {}, and its bound is {}",
                output.name,
                SHOWN_STRENGTHS[place],
                rounded(class.worst),
                given_point(system, &class.at),
                rounded(errors.bounds[place]),
            ))
        })
        .collect();
    (!broken.is_empty()).then(|| {
        format!(
            "the bounds are wrong, by a fault of this program and not of the design: {}",
            broken.join("; ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::fuzzy::check::check;
    use host_sim::fuzzy::files::{Format, parse};
    use host_sim::fuzzy::lower::lower;

    #[test]
    fn a_route_that_is_asked_for_counts_alone() {
        let text = include_bytes!("../../../../designs/fan.fll");
        let fan = parse("fan.fll", text, Format::Fll).unwrap();
        let report = check(&fan, lower(&fan).ok().as_ref(), 1000, &());
        let mut findings = Findings::new(&fan, &report, "fan".to_owned(), None);
        // Where rules may be weak the general bound is wide, and the fast route's is not.
        findings.errors[0].classes[3].nowhere_above = 2.0;
        findings.errors[0].fast_route = Some(0.5);
        assert_eq!(beyond(&findings, Route::Fast, 1.0), None);
        assert!(beyond(&findings, Route::Fast, 0.1).unwrap().contains(FAST));
        for route in [Route::Auto, Route::General] {
            assert!(
                beyond(&findings, route, 1.0)
                    .unwrap()
                    .contains("fan 2.0 % (> 0)")
            );
        }
    }

    #[test]
    fn a_broken_bound_is_told_with_its_place() {
        let text = include_bytes!("../../../../designs/fan.fll");
        let fan = parse("fan.fll", text, Format::Fll).unwrap();
        let mut report = check(&fan, lower(&fan).ok().as_ref(), 1000, &());
        assert_eq!(broken(&fan, &report), None);
        report.errors.as_mut().unwrap()[0].bounds[0] = 1e-9;
        let said = broken(&fan, &report).unwrap();
        assert!(said.contains("the bounds are wrong") && said.contains("fan (≥ 1/2) is off by"));
        assert!(said.contains("temperature = ") && said.ends_with("its bound is 1.0e-9"));
    }
}
