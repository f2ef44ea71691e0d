//! Gaps and dead rules as a grid shows them: where the exact search would take too long. What is between the grid's points
//! is not seen.

use crate::fuzzy::evaluate::{Evaluation, meets, rules};
use crate::fuzzy::model::System;

/// What was found, point by point.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Each rule: the outputs that it has a conclusion for.
    about: Vec<Vec<usize>>,
    /// Each output: points at which it has no conclusion, and the first of them.
    pub gaps: Vec<(usize, Option<Vec<f64>>)>,
    /// Each rule: whether it fires at some point.
    pub fires: Vec<bool>,
}

impl Sampled {
    /// Nothing seen yet.
    pub fn new(system: &System) -> Self {
        let about = rules(system).map(|(_, rule)| {
            let conclusions = rule.conclusions.iter();
            let met = conclusions.filter(|&&(output, term)| meets(&system.outputs[output], term));
            met.map(|&(output, _)| output).collect()
        });
        Self {
            about: about.collect(),
            gaps: vec![(0, None); system.outputs.len()],
            fires: vec![false; rules(system).count()],
        }
    }

    /// Takes one evaluation into account.
    pub fn see(&mut self, at: &[f64], evaluation: &Evaluation) {
        let mut concluded = vec![false; self.gaps.len()];
        let degrees = evaluation.rules.iter().enumerate();
        for (rule, _) in degrees.filter(|(_, degree)| **degree > 0.0) {
            self.fires[rule] = true;
            for &output in &self.about[rule] {
                concluded[output] = true;
            }
        }
        for (gap, _) in self.gaps.iter_mut().zip(concluded).filter(|(_, has)| !has) {
            gap.0 += 1;
            gap.1.get_or_insert_with(|| at.to_vec());
        }
    }

    /// Puts two halves together, this one first.
    pub fn and(mut self, other: Self) -> Self {
        for (mine, theirs) in self.gaps.iter_mut().zip(other.gaps) {
            mine.0 += theirs.0;
            mine.1 = mine.1.take().or(theirs.1);
        }
        for (mine, theirs) in self.fires.iter_mut().zip(other.fires) {
            *mine |= theirs;
        }
        self
    }
}
