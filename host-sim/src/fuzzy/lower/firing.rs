//! Many evaluations of centroids of thousands of rules: the library looks at every rule at every sample, whatever its degree.
//! That is its constant cost, and needless on a desktop: here it is given the rules that count alone, which makes the same
//! integers.

use super::Fixed;
use crate::fuzzy::evaluate::{Evaluation, Evaluator};
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Degree, Merge, Norm, Number, Output, Rule, System,
};
use std::collections::BTreeMap;

/// A system, and the same with outputs that cost nothing, for the rules' degrees.
#[derive(Clone, Copy, Debug)]
pub struct Firing<'a> {
    fixed: Fixed<'a>,
    degrees: System<'a>,
}

/// A rule that fires, by its place in its block, and of what it concludes that which counts.
struct Kept {
    place: usize,
    then: Vec<(u8, u8)>,
}

impl Fixed<'_> {
    /// Opens it for many evaluations at which few of many rules fire.
    pub fn firing<R>(&self, use_it: impl FnOnce(&dyn Evaluator) -> R) -> R {
        let outputs = self.system.outputs();
        let is_centroid =
            |output: &Output<'_>| matches!(output.defuzzifier, Defuzzifier::Centroid { .. });
        if !outputs.iter().any(is_centroid) {
            return use_it(self);
        }
        let terms: Vec<Vec<Number<'_>>> = outputs
            .iter()
            .map(|output| match output.defuzzifier {
                Defuzzifier::Centroid { terms, .. } => terms.len(),
                Defuzzifier::WeightedAverage { terms, .. } => terms.len(),
            })
            .map(|count| vec![Number::Constant(0); count])
            .collect();
        let outputs: Vec<Output<'_>> = terms
            .iter()
            .map(|terms| Output {
                range: [0, 1],
                clamp: false,
                default: 0,
                complete: false,
                defuzzifier: Defuzzifier::WeightedAverage {
                    merge: Merge::Sum,
                    terms,
                },
            })
            .collect();
        let degrees = System::checked(self.system.inputs(), self.system.blocks(), &outputs);
        use_it(&Firing {
            fixed: *self,
            degrees: degrees.expect("its rules were checked before"),
        })
    }
}

impl Firing<'_> {
    fn steps(&self, inputs: &[i32]) -> (Vec<i32>, Vec<Degree>) {
        let all = self.fixed.system;
        let (_, degrees) = super::steps(&self.degrees, inputs);
        // Without a rule there is no system.
        if degrees.iter().all(|degree| degree.bits() == 0) {
            let defaults = all.outputs().iter().map(|output| output.default);
            return (defaults.collect(), degrees);
        }
        let strongest = self.strongest(&degrees);
        let counts = |rule: usize, implication: Norm, (output, term): (u8, u8)| {
            let key = (output, term, implication == Norm::Min);
            strongest.get(&key).is_none_or(|&(_, first)| first == rule)
        };
        let mut of_blocks: Vec<Vec<Kept>> = Vec::new();
        let mut index = 0;
        for block in all.blocks() {
            let mut kept = Vec::new();
            for (place, rule) in block.rules.iter().enumerate() {
                if degrees[index].bits() > 0 {
                    let conclusions = rule.then.iter().copied();
                    let then: Vec<(u8, u8)> = conclusions
                        .filter(|&conclusion| counts(index, block.implication, conclusion))
                        .collect();
                    if !then.is_empty() {
                        kept.push(Kept { place, then });
                    }
                }
                index += 1;
            }
            of_blocks.push(kept);
        }
        let rules: Vec<Vec<Rule<'_>>> = (all.blocks().iter().zip(&of_blocks))
            .map(|(block, kept)| {
                let kept = kept.iter();
                kept.map(|Kept { place, then }| Rule {
                    then,
                    ..block.rules[*place]
                })
                .collect()
            })
            .collect();
        let blocks: Vec<Block<'_>> = (all.blocks().iter().zip(&rules))
            .map(|(block, rules)| Block { rules, ..*block })
            .collect();
        let few = System::checked(all.inputs(), &blocks, all.outputs());
        let few = few.expect("fewer rules of a system that was checked");
        (super::steps(&few, inputs).0, degrees)
    }

    /// Of centroids where the largest counts, for each set, whether cut off or scaled: the degree of the strongest rule and the
    /// first that has it. The others' sets are nowhere above that one's.
    fn strongest(&self, degrees: &[Degree]) -> BTreeMap<(u8, u8, bool), (Degree, usize)> {
        let system = self.fixed.system;
        let mut strongest = BTreeMap::new();
        let mut index = 0;
        for block in system.blocks() {
            for rule in block.rules {
                let degree = degrees[index];
                for &(output, term) in rule.then {
                    let is_largest = matches!(
                        system.outputs()[usize::from(output)].defuzzifier,
                        Defuzzifier::Centroid {
                            merge: Merge::Max,
                            ..
                        }
                    );
                    if is_largest {
                        let key = (output, term, block.implication == Norm::Min);
                        let best = strongest.entry(key).or_insert((degree, index));
                        if degree > best.0 {
                            *best = (degree, index);
                        }
                    }
                }
                index += 1;
            }
        }
        strongest
    }
}

impl Evaluator for Firing<'_> {
    fn evaluate(&self, inputs: &[f64]) -> Evaluation {
        self.fixed.by(inputs, |steps| self.steps(steps))
    }
}
