//! How many rules can fire at once: few of thousands, where an input's terms overlap with their neighbours alone.

use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Antecedent, Input, Shape, System};
use std::collections::BTreeMap;

/// Values of an input at which its terms are counted, beside those between its knots.
const VALUES: usize = 64;

/// About how many rules with a conclusion about an output fire at once, at most. Rules that ask some inputs for one term each
/// cannot fire for more combinations than there are of overlapping terms; all others are taken to fire.
pub fn at_once(system: &System, output: usize) -> usize {
    let overlaps: Vec<usize> = system.inputs.iter().map(overlap).collect();
    // By the inputs that are asked, how often each combination of terms is.
    let mut asked: BTreeMap<Vec<usize>, BTreeMap<Vec<usize>, usize>> = BTreeMap::new();
    let mut others = 0;
    for (_, rule) in rules(system) {
        if !rule.conclusions.iter().any(|&(of, _)| of == output) {
            continue;
        }
        match terms(&rule.antecedent) {
            Some(terms) => {
                let (inputs, terms) = terms.into_iter().unzip();
                *asked.entry(inputs).or_default().entry(terms).or_insert(0) += 1;
            }
            None => others += 1,
        }
    }
    let groups = asked.iter().map(|(inputs, of)| {
        let all: usize = of.values().sum();
        let same = of.values().max().copied().unwrap_or(0);
        let combinations = inputs.iter().map(|&input| overlaps[input]);
        all.min(combinations.fold(same, usize::saturating_mul))
    });
    groups.sum::<usize>() + others
}

/// The inputs that are asked, ascending, each with its term; `None` if it is no AND of such questions or asks an input twice.
fn terms(antecedent: &Antecedent) -> Option<BTreeMap<usize, usize>> {
    let one = std::slice::from_ref(antecedent);
    let parts = match antecedent {
        Antecedent::And(parts) => parts,
        _ => one,
    };
    let mut terms = BTreeMap::new();
    for part in parts {
        let Antecedent::Is {
            input,
            term,
            negated: false,
        } = part
        else {
            return None;
        };
        if terms.insert(*input, *term).is_some() {
            return None;
        }
    }
    Some(terms)
}

/// The most terms of an input that hold at one value, 1 at least.
fn overlap(input: &Input) -> usize {
    let (start, end) = (*input.range.start(), *input.range.end());
    let shapes = || input.terms.iter().map(|term| &term.shape);
    let mut values: Vec<f64> = shapes().flat_map(Shape::knots).collect();
    values.extend((0..=VALUES).map(|i| start + (end - start) * (i as f64 / VALUES as f64)));
    values.retain(|x| input.range.contains(x));
    values.sort_by(f64::total_cmp);
    let between = values.windows(2).map(|two| two[0].midpoint(two[1]));
    let places = values.iter().copied().chain(between);
    let holding = places.map(|x| shapes().filter(|shape| shape.degree(x) > 0.0).count());
    holding.max().unwrap_or(0).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::{fan, rule};

    #[test]
    fn neighbours_fire_together_and_no_others() {
        let mut fan = fan();
        assert_eq!(at_once(&fan, 0), 4);
        // Twice the same rule fires twice.
        let first = fan.blocks[0].rules[0].clone();
        fan.blocks[0].rules.push(first);
        assert_eq!(at_once(&fan, 0), 7);
        fan.blocks[0].rules = vec![
            rule(&[(0, 0, false)], &[(0, 0)]),
            rule(&[(0, 1, false)], &[(0, 0)]),
            rule(&[(0, 2, false)], &[(0, 0)]),
            rule(&[(0, 2, true)], &[(0, 0)]),
        ];
        assert_eq!(at_once(&fan, 0), 3);
        assert_eq!(at_once(&fan, 1), 0);
    }
}
