//! Rules that fire and yet never count: where the largest of several equal conclusions counts, they are never it.

use crate::fuzzy::evaluate::{Evaluation, rules};
use crate::fuzzy::model::{Merge, System};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Gathers, point by point, which rules are the strongest of those that conclude the same.
#[derive(Clone, Debug)]
pub struct Dominance {
    /// Rules that conclude one term of an output that takes the largest: only they compete.
    rivals: Vec<Vec<usize>>,
    /// Each rule: whether it counts for sure, as it adds to others or is stronger than all somewhere.
    counts: Vec<bool>,
    /// Rules that were equally strong somewhere, or one that was stronger than all: one of each is enough.
    ties: BTreeSet<Arc<[usize]>>,
    /// How often a rule was no stronger than the others of which tie. Some ties a rule are remembered, so that thousands
    /// of rules that fire together do not take all memory.
    outdone: Vec<BTreeMap<Arc<[usize]>, usize>>,
}

/// Ties a rule.
const MOST_TIES: usize = 32;

impl Dominance {
    /// Nothing seen yet.
    pub fn new(system: &System) -> Self {
        let mut groups: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        let mut counts = vec![false; rules(system).count()];
        // Where sets are cut off and scaled side by side, the largest degree need not make the largest set.
        let alike = (system.blocks.windows(2)).all(|two| two[0].implication == two[1].implication);
        for (index, (_, rule)) in rules(system).enumerate() {
            for &(output, term) in &rule.conclusions {
                if system.outputs[output].merge == Merge::Max && alike {
                    groups.entry((output, term)).or_default().push(index);
                } else {
                    counts[index] = true;
                }
            }
        }
        Self {
            rivals: groups.into_values().collect(),
            outdone: vec![BTreeMap::new(); counts.len()],
            counts,
            ties: BTreeSet::new(),
        }
    }

    /// Takes one evaluation into account.
    pub fn see(&mut self, evaluation: &Evaluation) {
        let degree = |rule: usize| evaluation.rules.get(rule).copied().unwrap_or(0.0);
        for group in &self.rivals {
            let most = group.iter().fold(0.0, |most, &rule| degree(rule).max(most));
            let strongest = |rule: &usize| degree(*rule) >= most;
            if most <= 0.0 {
                continue;
            }
            let tied: Arc<[usize]> = group.iter().copied().filter(strongest).collect();
            if let [only] = *tied {
                self.counts[only] = true;
                self.outdone[only].clear();
            } else if !self.ties.contains(&tied) {
                self.ties.insert(Arc::clone(&tied));
            }
            for &rule in group.iter().filter(|rule| degree(**rule) > 0.0) {
                if !self.counts[rule] {
                    remember(&mut self.outdone[rule], &tied, 1);
                }
            }
        }
    }

    /// Puts two halves together.
    pub fn and(mut self, other: Self) -> Self {
        for (mine, theirs) in self.counts.iter_mut().zip(other.counts) {
            *mine |= theirs;
        }
        self.ties.extend(other.ties);
        let all = self.outdone.iter_mut().zip(other.outdone).zip(&self.counts);
        for ((mine, theirs), counts) in all {
            if *counts {
                mine.clear();
                continue;
            }
            for (tie, times) in theirs {
                remember(mine, &tie, times);
            }
        }
        self
    }

    /// Rules that fired somewhere and can all be left out, each with the one that is kept and outdid it most often, as far as that is
    /// remembered.
    pub fn dominated(&self) -> Vec<(usize, usize)> {
        let kept = self.kept();
        let mut found = Vec::new();
        for (rule, ties) in self
            .outdone
            .iter()
            .enumerate()
            .filter(|(rule, _)| !kept[*rule])
        {
            let mut by: BTreeMap<usize, usize> = BTreeMap::new();
            for (tie, times) in ties {
                for &other in tie.iter().filter(|other| kept[**other]) {
                    *by.entry(other).or_default() += times;
                }
            }
            let most = by.into_iter().max_by_key(|(_, times)| *times);
            found.extend(most.map(|(by, _)| (rule, by)));
        }
        found
    }

    /// Rules that count for sure, and of the ties without one the rule that settles the most, the first of equals.
    fn kept(&self) -> Vec<bool> {
        let mut kept = self.counts.clone();
        let mut of: Vec<Vec<usize>> = vec![Vec::new(); kept.len()];
        let mut settles = vec![0_usize; kept.len()];
        let open = self
            .ties
            .iter()
            .filter(|tie| !tie.iter().any(|&rule| kept[rule]));
        let ties: Vec<&Arc<[usize]>> = open.collect();
        for (index, tie) in ties.iter().enumerate() {
            for &rule in tie.iter() {
                of[rule].push(index);
                settles[rule] += 1;
            }
        }
        let mut settled = vec![false; ties.len()];
        loop {
            // Backwards: of equals the last is taken.
            let most = settles
                .iter()
                .enumerate()
                .rev()
                .max_by_key(|(_, ties)| **ties);
            let Some((rule, _)) = most.filter(|(_, ties)| **ties > 0) else {
                return kept;
            };
            kept[rule] = true;
            for &index in &of[rule] {
                if std::mem::replace(&mut settled[index], true) {
                    continue;
                }
                for &other in ties[index].iter() {
                    settles[other] -= 1;
                }
            }
        }
    }
}

fn remember(ties: &mut BTreeMap<Arc<[usize]>, usize>, tie: &Arc<[usize]>, times: usize) {
    if let Some(known) = ties.get_mut(tie) {
        *known += times;
    } else if ties.len() < MOST_TIES {
        ties.insert(Arc::clone(tie), times);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::check::Grid;
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::sample::{fan, rule};

    fn dominated(system: &System) -> Vec<(usize, usize)> {
        let (grid, exact) = (Grid::even(system, 21), Exact::new(system));
        let mut seen = Dominance::new(system);
        for index in 0..grid.len() {
            seen.see(&exact.evaluate(&grid.point(index)));
        }
        seen.dominated()
    }

    #[test]
    fn of_two_equal_rules_one_is_kept() {
        let mut fan = fan();
        fan.outputs[0].merge = Merge::Max;
        let twin = fan.blocks[0].rules[5].clone();
        fan.blocks[0].rules.push(twin);
        assert_eq!(dominated(&fan), [(6, 5)]);
    }

    #[test]
    fn a_special_case_of_a_rule_that_concludes_the_same_is_dominated_where_the_largest_counts() {
        let mut fan = fan();
        fan.blocks[0].rules.push(rule(&[(0, 0, false)], &[(0, 0)]));
        assert_eq!(dominated(&fan), []);
        fan.outputs[0].merge = Merge::Max;
        // low and low, low and high: both off, as low alone.
        assert_eq!(dominated(&fan), [(0, 6), (1, 6)]);
        // Halved, it never beats the stronger of the two.
        fan.blocks[0].rules[6].weight = 0.5;
        let found: Vec<usize> = dominated(&fan).into_iter().map(|d| d.0).collect();
        assert_eq!(found, [6]);
    }
}
