//! What a designer wants to know of a system before it drives something: where no rule fires, what never counts, where a
//! table turns, how far fixed point is from `f64`.
//!
//! Gaps, dead rules and terms out of reach are found exactly ([`coverage()`]); rules that are always outdone and the error of
//! fixed point on a dense [`Grid`].

mod accuracy;
mod bound;
mod coverage;
mod dominance;
mod grid;
mod jumps;
mod turns;

pub use accuracy::{Accuracy, Class, STRENGTHS, class, strength};
pub use bound::{Bounds, bounds};
pub use coverage::{Coverage, Gap, Stretch, coverage};
pub use dominance::Dominance;
pub use grid::{Grid, POINTS};
pub use jumps::Jumps;
pub use turns::{Turn, turns};

use super::evaluate::{Evaluator, Exact, rules};
use super::lower::Lowered;
use super::model::{Antecedent, System};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// All findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Gaps and dead rules; `None` if the system has too many pieces to look through.
    pub coverage: Option<Coverage>,
    /// Rules that fire and never count, each with the one that outdoes it most often.
    pub dominated: Vec<(usize, usize)>,
    /// Input terms that no rule asks about: indices of input and term.
    pub unasked: Vec<(usize, usize)>,
    /// Output terms that no rule concludes, none that ever fires at least: indices of output and term.
    pub unconcluded: Vec<(usize, usize)>,
    /// Where tables turn, an entry an output; `None` for one that has no table.
    pub turns: Vec<Option<Vec<Turn>>>,
    /// Points of the grid.
    pub points: usize,
    /// The error of fixed point, an entry an output; `None` without fixed point.
    pub errors: Option<Vec<Errors>>,
}

/// The error of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// As it was measured on the grid.
    pub measured: Accuracy,
    /// What it is nowhere above, for each of [`STRENGTHS`]: see [`bounds`].
    pub bounds: [f64; STRENGTHS.len()],
}

/// Checks a system, and its fixed point against `f64`, on a grid of about so many points.
pub fn check(system: &System, lowered: Option<&Lowered>, points: usize) -> Report {
    let grid = Grid::new(system, points);
    let (dominance, errors) = match lowered {
        None => (sweep(system, None, &grid).0, None),
        Some(lowered) => {
            let jumps = Jumps::of(system, lowered);
            let (dominance, measured) =
                lowered.open(|fixed| sweep(system, Some((&fixed, &jumps)), &grid));
            let both = measured.into_iter().zip(bounds(system, lowered));
            let errors = both.map(|(measured, bounds)| Errors { measured, bounds });
            (dominance, Some(errors.collect()))
        }
    };
    let coverage = coverage(system);
    Report {
        dominated: dominance.dominated(),
        unasked: unasked(system),
        unconcluded: unconcluded(system, coverage.as_ref()),
        turns: turns(system),
        points: grid.len(),
        coverage,
        errors,
    }
}

/// Fixed point, and where not to compare it.
type Compared<'a> = (&'a dyn Evaluator, &'a Jumps);

/// Looks at every point once.
fn sweep(system: &System, fixed: Option<Compared<'_>>, grid: &Grid) -> (Dominance, Vec<Accuracy>) {
    let exact = Exact::new(system);
    let none = || {
        (
            Dominance::new(system),
            vec![Accuracy::default(); system.outputs.len()],
        )
    };
    // Chunks of a fixed size, put together in order: sums do not depend on the number of cores.
    let starts: Vec<usize> = (0..grid.len()).step_by(1024).collect();
    let parts: Vec<_> = starts
        .into_par_iter()
        .map(|start| {
            let (mut dominance, mut accuracy) = none();
            for index in start..(start + 1024).min(grid.len()) {
                let point = grid.point(index);
                let evaluation = exact.evaluate(&point);
                dominance.see(&evaluation);
                if let Some((fixed, _)) = fixed.filter(|(_, jumps)| !jumps.near(&point)) {
                    let found = fixed.evaluate(&point);
                    Accuracy::see(&mut accuracy, system, &point, &evaluation, &found);
                }
            }
            (dominance, accuracy)
        })
        .collect();
    parts
        .into_iter()
        .fold(none(), |(dominance, accuracy), part| {
            let both = accuracy.into_iter().zip(part.1);
            (dominance.and(part.0), both.map(|(a, b)| a.and(b)).collect())
        })
}

fn unasked(system: &System) -> Vec<(usize, usize)> {
    let mut asked = BTreeSet::new();
    for (_, rule) in rules(system) {
        ask(&rule.antecedent, &mut asked);
    }
    let terms = system.inputs.iter().enumerate();
    terms
        .flat_map(|(input, of)| (0..of.terms.len()).map(move |term| (input, term)))
        .filter(|term| !asked.contains(term))
        .collect()
}

fn ask(antecedent: &Antecedent, asked: &mut BTreeSet<(usize, usize)>) {
    match antecedent {
        Antecedent::Is { input, term, .. } => {
            asked.insert((*input, *term));
        }
        Antecedent::And(parts) | Antecedent::Or(parts) => {
            for part in parts {
                ask(part, asked);
            }
        }
    }
}

fn unconcluded(system: &System, coverage: Option<&Coverage>) -> Vec<(usize, usize)> {
    let fires = |rule: usize| coverage.is_none_or(|coverage| coverage.fires[rule]);
    let concluded: BTreeSet<(usize, usize)> = rules(system)
        .enumerate()
        .filter(|(index, _)| fires(*index))
        .flat_map(|(_, (_, rule))| rule.conclusions.iter().copied())
        .collect();
    let terms = system.outputs.iter().enumerate();
    terms
        .flat_map(|(output, of)| (0..of.terms.len()).map(move |term| (output, term)))
        .filter(|term| !concluded.contains(term))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::Evaluation;
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::sample::{fan, rule};

    /// The exact values, off by `error` at 40 °C and 100 %.
    struct Off<'a>(Exact<'a>, f64);

    impl Evaluator for Off<'_> {
        fn evaluate(&self, inputs: &[f64]) -> Evaluation {
            let mut evaluation = self.0.evaluate(inputs);
            if inputs == [40.0, 100.0] {
                evaluation.outputs = vec![evaluation.outputs[0].map(|x| x - self.1)];
            }
            evaluation
        }
    }

    #[test]
    fn the_error_is_found_where_it_is() {
        let fan = fan();
        let (grid, jumps) = (
            Grid::new(&fan, 10_000),
            Jumps::of(&fan, &lower(&fan).unwrap()),
        );
        let off = Off(Exact::new(&fan), 0.25);
        let found = &sweep(&fan, Some((&off, &jumps)), &grid).1[0].classes[0];
        assert_eq!(
            (found.worst, found.at.as_slice()),
            (0.25, &[40.0, 100.0][..])
        );
        assert!((found.rms() - 0.25 / (found.points as f64).sqrt()).abs() < 1e-12);
        assert_eq!(found.points, grid.len());
    }

    #[test]
    fn what_is_measured_is_within_the_bounds() {
        let fan = fan();
        let errors = check(&fan, lower(&fan).ok().as_ref(), 10_000)
            .errors
            .unwrap();
        for (class, bound) in errors[0].measured.classes.iter().zip(errors[0].bounds) {
            assert!(class.points > 1000 && class.worst > 0.0 && class.worst <= bound);
        }
    }

    #[test]
    fn terms_without_a_use_are_found() {
        let mut fan = fan();
        let extra = fan.inputs[1].terms[0].clone();
        fan.inputs[1].terms.push(extra);
        fan.blocks[0]
            .rules
            .retain(|rule| rule.conclusions != [(0, 2)]);
        let report = check(&fan, None, 100);
        assert_eq!(report.unasked, [(1, 2)]);
        assert_eq!(report.unconcluded, [(0, 2)]);
        // A rule that never fires concludes nothing.
        let mut never = rule(&[(0, 0, false)], &[(0, 2)]);
        never.weight = 0.0;
        fan.blocks[0].rules.push(never);
        assert_eq!(check(&fan, None, 100).unconcluded, [(0, 2)]);
    }

    #[test]
    fn a_clean_system_has_no_finding() {
        let report = check(&fan(), None, 1000);
        assert_eq!(
            (
                report.dominated,
                report.unasked,
                report.unconcluded,
                report.turns,
                report.errors
            ),
            (vec![], vec![], vec![], vec![Some(vec![])], None)
        );
    }
}
