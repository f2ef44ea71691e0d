//! What a designer wants to know of a system before it drives something: where no rule fires, what never counts, where a
//! table turns, how far fixed point is from `f64`.
//!
//! Gaps, dead rules and terms out of reach are found exactly ([`coverage()`]); rules that are always outdone and the error of
//! fixed point on a dense [`Grid`].

mod accuracy;
mod at_once;
mod beyond;
mod bound;
mod coverage;
mod dominance;
mod grid;
mod jumps;
mod ripples;
mod sampled;
mod sweep;
mod turns;
mod watch;

pub use accuracy::{Accuracy, Class, FAINTEST, STRENGTHS, class, strength};
pub use beyond::{Beyond, beyond};
pub use bound::{Bounds, bounds};
pub use coverage::{Coverage, Gap, MOST_WORK, Stretch, bare, coverage, outside};
pub use dominance::Dominance;
pub use grid::{Grid, POINTS};
pub use jumps::Jumps;
pub use ripples::{LEAST as LEAST_TURN, Ripple, Ripples, ripples};
pub use sampled::Sampled;
pub use turns::{NoTable, Turn, turns};
pub use watch::Watch;

use super::evaluate::{meets, rules};
use super::lower::Lowered;
use super::model::{Antecedent, Output, System};
use std::collections::BTreeSet;
use sweep::Sweep;

/// Values of outputs that are kept, 8 bytes each, to look for turns in them.
const MOST_VALUES: usize = 32_000_000;

/// All findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Gaps and dead rules; as the grid shows them if the exact search takes too long.
    pub coverage: Result<Coverage, Sampled>,
    /// Rules that fire and never count, each with the one that outdoes it most often.
    pub dominated: Vec<(usize, usize)>,
    /// Where an input has no term at all: index of the input, and where.
    pub bare: Vec<(usize, Stretch)>,
    /// Input terms that reach no value of their input's range: indices of input and term.
    pub outside: Vec<(usize, usize)>,
    /// Input terms that no rule asks about: indices of input and term.
    pub unasked: Vec<(usize, usize)>,
    /// Output terms that no rule concludes, none that ever fires at least: indices of output and term.
    pub unconcluded: Vec<(usize, usize)>,
    /// Output terms whose set is nothing at any sample: indices of output and term.
    pub unmet: Vec<(usize, usize)>,
    /// Conclusions beyond their output's range.
    pub beyond: Vec<Beyond>,
    /// Where tables turn, an entry an output.
    pub turns: Vec<Turns>,
    /// Points of the grid.
    pub points: usize,
    /// Whether all corners of the inputs' terms are among them.
    pub has_corners: bool,
    /// Whether there would be more of them if each took less work.
    pub is_limited: bool,
    /// The error of fixed point, an entry an output; `None` without fixed point.
    pub errors: Option<Vec<Errors>>,
}

/// Where an output turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Turns {
    /// In its rule table, or why it has none.
    pub table: Result<Vec<Turn>, NoTable>,
    /// Along every input on the grid: the output may turn where its table does not. `None` if the grid has too many points.
    pub sampled: Option<Vec<Ripples>>,
}

/// The error of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// As it was measured on the grid.
    pub measured: Accuracy,
    /// What it is nowhere above, for each of [`STRENGTHS`]: see [`bounds`].
    pub bounds: [f64; STRENGTHS.len()],
}

impl Errors {
    /// The first of [`STRENGTHS`] at which more was measured than its bound allows: then the bounds are wrong, and nothing
    /// may be built on them. All of the output's range is above nothing.
    pub fn broken(&self, output: &Output) -> Option<usize> {
        let whole = output.range.end() - output.range.start();
        let mut classes = self.measured.classes.iter().zip(self.bounds);
        classes.position(|(class, bound)| class.worst > bound && !(output.clamp && bound >= whole))
    }
}

/// Checks a system, and its fixed point against `f64`, on a grid of about so many points.
pub fn check(
    system: &System,
    lowered: Option<&Lowered>,
    points: usize,
    watch: &dyn Watch,
) -> Report {
    watch.begin("looking for gaps", None);
    let coverage = coverage(system, MOST_WORK);
    let grid = Grid::new(system, points);
    let outputs = system.outputs.len();
    let sweep = Sweep {
        system,
        grid: &grid,
        keep: outputs.saturating_mul(grid.len()) <= MOST_VALUES,
        covers: coverage.is_none(),
        watch,
    };
    watch.begin("evaluating a grid", Some(grid.len()));
    let (seen, errors) = match lowered {
        None => (sweep.all(None), None),
        Some(lowered) => {
            let jumps = Jumps::of(system, lowered);
            let seen = lowered
                .open(|fixed| fixed.firing(|evaluator| sweep.all(Some((evaluator, &jumps)))));
            watch.begin("bounding the error of fixed point", None);
            let both = seen.accuracy.iter().zip(bounds(system, lowered));
            let errors = both.map(|(measured, bounds)| Errors {
                measured: measured.clone(),
                bounds,
            });
            let errors = errors.collect();
            (seen, Some(errors))
        }
    };
    let turns = turns(system).into_iter().enumerate();
    let turns = turns.map(|(output, table)| {
        let values = seen.values.iter().skip(output).step_by(outputs.max(1));
        let values: Vec<f64> = values.copied().collect();
        let sampled = sweep.keep.then(|| ripples(system, &grid, output, &values));
        Turns { table, sampled }
    });
    Report {
        bare: bare(system),
        outside: outside(system),
        unasked: unasked(system),
        unconcluded: unconcluded(system, coverage.as_ref()),
        unmet: (output_terms(system))
            .filter(|&(output, term)| !meets(&system.outputs[output], term))
            .collect(),
        beyond: beyond(system),
        turns: turns.collect(),
        points: grid.len(),
        has_corners: grid.has_knots,
        is_limited: grid.is_limited,
        errors,
        dominated: seen.dominance.dominated(),
        coverage: coverage.ok_or(seen.sampled),
    }
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
    output_terms(system)
        .filter(|term| !concluded.contains(term))
        .collect()
}

fn output_terms(system: &System) -> impl Iterator<Item = (usize, usize)> {
    let outputs = system.outputs.iter().enumerate();
    outputs.flat_map(|(output, of)| (0..of.terms.len()).map(move |term| (output, term)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::sample::{fan, rule};

    #[test]
    fn what_is_measured_is_within_the_bounds() {
        let fan = fan();
        let errors = check(&fan, lower(&fan).ok().as_ref(), 10_000, &())
            .errors
            .unwrap();
        for (class, bound) in errors[0].measured.classes.iter().zip(errors[0].bounds) {
            assert!(class.points > 1000 && class.worst > 0.0 && class.worst <= bound);
        }
    }

    #[test]
    fn a_bound_below_what_is_measured_is_seen() {
        let mut fan = fan();
        let errors = check(&fan, lower(&fan).ok().as_ref(), 10_000, &()).errors;
        let mut errors = errors.unwrap().remove(0);
        assert_eq!(errors.broken(&fan.outputs[0]), None);
        errors.bounds[1] = errors.measured.classes[1].worst / 2.0;
        assert_eq!(errors.broken(&fan.outputs[0]), Some(1));
        // Rounded limits may be half a step outside the range.
        errors.bounds[1] = 100.0;
        errors.measured.classes[1].worst = 100.000_01;
        assert_eq!(errors.broken(&fan.outputs[0]), None);
        fan.outputs[0].clamp = false;
        assert_eq!(errors.broken(&fan.outputs[0]), Some(1));
    }

    #[test]
    fn terms_without_a_use_are_found() {
        let mut fan = fan();
        let extra = fan.inputs[1].terms[0].clone();
        fan.inputs[1].terms.push(extra);
        fan.blocks[0]
            .rules
            .retain(|rule| rule.conclusions != [(0, 2)]);
        let report = check(&fan, None, 100, &());
        assert_eq!(report.unasked, [(1, 2)]);
        assert_eq!(report.unconcluded, [(0, 2)]);
        // A rule that never fires concludes nothing.
        let mut never = rule(&[(0, 0, false)], &[(0, 2)]);
        never.weight = 0.0;
        fan.blocks[0].rules.push(never);
        assert_eq!(check(&fan, None, 100, &()).unconcluded, [(0, 2)]);
    }

    #[test]
    fn a_clean_system_has_no_finding() {
        let report = check(&fan(), None, 1000, &());
        let still = Turns {
            table: Ok(vec![]),
            sampled: Some(vec![]),
        };
        assert_eq!(
            (
                report.dominated,
                report.unasked,
                report.unconcluded,
                report.turns,
                report.errors
            ),
            (vec![], vec![], vec![], vec![still], None)
        );
    }
}
