//! Systems of any kind against an evaluation in f64 that shares nothing with them, and at the ends of all numbers.

use fixed::types::I16F16;
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::shape::{points, ramp, singleton, trapezoid, triangle};
use fuzzypilot::fuzzy::system::{
    Block, Controller, Defuzzifier, Degree, Flaw, Input, LIMIT, Linear, Literal,
    Literal::{Is, IsNot},
    Merge, Norm,
    Number::{self, Constant},
    Output, Piece, Rule, Samples, System, WrongSize,
};
use proptest::prelude::*;

/// Pseudo-random numbers: what a system is made of follows from one seed.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((u128::from(self.0.rotate_left(29)) * u128::from(n)) >> 64) as u64
    }

    fn size(&mut self, most: u64) -> usize {
        1 + self.below(most) as usize
    }

    fn index(&mut self, n: usize) -> usize {
        self.below(n as u64) as usize
    }

    fn between(&mut self, low: i32, high: i32) -> i32 {
        (i64::from(low) + self.below((i64::from(high) - i64::from(low) + 1) as u64) as i64) as i32
    }

    fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    fn norm(&mut self) -> Norm {
        if self.coin() {
            Norm::Min
        } else {
            Norm::Product
        }
    }

    fn merge(&mut self) -> Merge {
        if self.coin() { Merge::Sum } else { Merge::Max }
    }
}

/// A term as four numbers: zero up to the first, one from the second to the third, zero from the fourth.
type Corners = [i32; 4];

struct AnInput {
    range: [i32; 2],
    clamp: bool,
    terms: Vec<Corners>,
}

struct ARule {
    when: Vec<Vec<Literal>>,
    then: Vec<(u8, u8)>,
    weight: u32,
}

struct ABlock {
    and: Norm,
    implication: Norm,
    rules: Vec<ARule>,
}

enum Terms {
    Numbers(Vec<(Vec<i32>, u32, i32)>),
    Sets(Samples, bool, Vec<Vec<Grade>>),
}

struct AnOutput {
    range: [i32; 2],
    clamp: bool,
    default: i32,
    merge: Merge,
    terms: Terms,
}

struct Made {
    inputs: Vec<AnInput>,
    blocks: Vec<ABlock>,
    outputs: Vec<AnOutput>,
}

impl Made {
    fn from(seed: u64) -> Self {
        let mut dice = Dice(seed);
        let inputs: Vec<AnInput> = (0..dice.size(4)).map(|_| an_input(&mut dice)).collect();
        let outputs: Vec<AnOutput> = (0..dice.size(3))
            .map(|_| an_output(&mut dice, inputs.len()))
            .collect();
        let blocks = (0..dice.size(2))
            .map(|_| ABlock {
                and: dice.norm(),
                implication: dice.norm(),
                rules: (0..dice.size(9))
                    .map(|_| a_rule(&mut dice, &inputs, &outputs))
                    .collect(),
            })
            .collect();
        Self {
            inputs,
            blocks,
            outputs,
        }
    }

    /// Lends the system.
    fn with<R>(&self, use_it: impl FnOnce(System<'_>) -> R) -> R {
        let pieces: Vec<Vec<[Piece; 4]>> = self
            .inputs
            .iter()
            .map(|input| {
                input
                    .terms
                    .iter()
                    .map(|&[a, b, c, d]| trapezoid(a, b, c, d))
                    .collect()
            })
            .collect();
        let terms: Vec<Vec<&[Piece]>> = pieces
            .iter()
            .map(|terms| terms.iter().map(|term| &term[..]).collect())
            .collect();
        let inputs: Vec<Input<'_>> = self
            .inputs
            .iter()
            .zip(&terms)
            .map(|(input, terms)| Input {
                range: input.range,
                clamp: input.clamp,
                complete: false,
                terms,
            })
            .collect();
        let whens: Vec<Vec<Vec<&[Literal]>>> = self
            .blocks
            .iter()
            .map(|block| {
                let rules = block.rules.iter();
                rules
                    .map(|rule| rule.when.iter().map(|all| &all[..]).collect())
                    .collect()
            })
            .collect();
        let rules: Vec<Vec<Rule<'_>>> = self
            .blocks
            .iter()
            .zip(&whens)
            .map(|(block, whens)| {
                let rules = block.rules.iter().zip(whens);
                rules
                    .map(|(rule, when)| {
                        Rule::new(when, &rule.then).weighted(Degree::from_bits(rule.weight))
                    })
                    .collect()
            })
            .collect();
        let blocks: Vec<Block<'_>> = self
            .blocks
            .iter()
            .zip(&rules)
            .map(|(block, rules)| Block {
                and: block.and,
                implication: block.implication,
                rules,
            })
            .collect();
        let numbers: Vec<Vec<Number<'_>>> = self.outputs.iter().map(numbers).collect();
        let sets: Vec<Vec<&[Grade]>> = self.outputs.iter().map(sets).collect();
        let outputs: Vec<Output<'_>> = self
            .outputs
            .iter()
            .zip(numbers.iter().zip(&sets))
            .map(|(output, (numbers, sets))| Output {
                range: output.range,
                clamp: output.clamp,
                default: output.default,
                complete: false,
                defuzzifier: match output.terms {
                    Terms::Numbers(_) => Defuzzifier::WeightedAverage {
                        merge: output.merge,
                        terms: numbers,
                    },
                    Terms::Sets(samples, ..) => Defuzzifier::Centroid {
                        merge: output.merge,
                        samples,
                        terms: sets,
                    },
                },
            })
            .collect();
        use_it(System::checked(&inputs, &blocks, &outputs).unwrap())
    }

    /// Every rule's degree, in f64.
    fn degrees(&self, x: &[f64]) -> Vec<f64> {
        let membership = |literal: Literal| {
            let (Is(input, term) | IsNot(input, term)) = literal;
            let corners = self.inputs[usize::from(input)].terms[usize::from(term)];
            let degree = flanks(corners.map(f64::from), x[usize::from(input)]);
            match literal {
                Is(..) => degree,
                IsNot(..) => 1.0 - degree,
            }
        };
        let degree = |block: &ABlock, rule: &ARule| {
            let any = rule.when.iter().map(|all| {
                let all = all.iter().map(|&literal| membership(literal));
                all.reduce(|a, b| joined(block.and, a, b)).unwrap()
            });
            any.fold(0.0, f64::max) * f64::from(rule.weight) / ONE
        };
        let rules = self
            .blocks
            .iter()
            .flat_map(|block| block.rules.iter().map(move |rule| (block, rule)));
        rules.map(|(block, rule)| degree(block, rule)).collect()
    }

    /// What rules say about an output: term, degree, implication.
    fn said(&self, output: usize, degrees: &[f64]) -> Vec<(usize, f64, Norm)> {
        let rules = self
            .blocks
            .iter()
            .flat_map(|block| block.rules.iter().map(move |rule| (block, rule)));
        let mut said = Vec::new();
        for ((block, rule), &degree) in rules.zip(degrees) {
            for &(of, term) in &rule.then {
                if usize::from(of) == output {
                    said.push((usize::from(term), degree, block.implication));
                }
            }
        }
        said
    }

    /// The output's value and what its degrees add up to, in f64; and by how much it can move with each degree, at most.
    fn value(&self, output: usize, x: &[f64], degrees: &[f64]) -> (f64, f64, f64) {
        let said = self.said(output, degrees);
        let this = &self.outputs[output];
        let merged = |all: &mut dyn Iterator<Item = f64>| match this.merge {
            Merge::Sum => all.sum(),
            Merge::Max => all.fold(0.0, f64::max),
        };
        let mut parts: Vec<(f64, f64)> = Vec::new();
        match &this.terms {
            Terms::Numbers(terms) => {
                for (i, (coefficients, shift, constant)) in terms.iter().enumerate() {
                    let w = merged(&mut said.iter().filter(|s| s.0 == i).map(|s| s.1));
                    let sum: f64 = coefficients
                        .iter()
                        .zip(x)
                        .map(|(&c, x)| f64::from(c) * x)
                        .sum();
                    let z = sum / f64::from(*shift).exp2() + f64::from(*constant);
                    parts.push((w, z.clamp(-LIMIT as f64, LIMIT as f64)));
                }
            }
            Terms::Sets(samples, middles, sets) => {
                let [low, high] = samples.range().map(f64::from);
                let n = samples.count() as f64;
                parts.extend((0..samples.count()).map(|j| {
                    let implied = |&(term, degree, implication): &(usize, f64, Norm)| {
                        joined(
                            implication,
                            degree,
                            f64::from(sets[term][j].bits()) / 32_768.0,
                        )
                    };
                    let w = merged(&mut said.iter().map(implied));
                    let at = if *middles {
                        (j as f64 + 0.5) / n
                    } else {
                        j as f64 / (n - 1.0)
                    };
                    (w, low + at * (high - low))
                }));
            }
        }
        let weight: f64 = parts.iter().map(|p| p.0).sum();
        let value = parts.iter().map(|p| p.0 * p.1).sum::<f64>() / weight;
        let most = parts.iter().map(|p| p.1).fold(f64::MIN, f64::max);
        let least = parts.iter().map(|p| p.1).fold(f64::MAX, f64::min);
        let [low, high] = this.range.map(f64::from);
        (value.clamp(low, high), weight, most - least)
    }
}

const ONE: f64 = 16_777_216.0;

fn joined(norm: Norm, a: f64, b: f64) -> f64 {
    match norm {
        Norm::Min => a.min(b),
        Norm::Product => a * b,
    }
}

fn flanks([a, b, c, d]: [f64; 4], x: f64) -> f64 {
    if x < a || x > d {
        0.0
    } else if x < b {
        (x - a) / (b - a)
    } else if x <= c {
        1.0
    } else {
        (d - x) / (d - c)
    }
}

fn numbers(output: &AnOutput) -> Vec<Number<'_>> {
    match &output.terms {
        Terms::Numbers(terms) => terms
            .iter()
            .map(|(coefficients, shift, constant)| {
                if coefficients.is_empty() {
                    Constant(*constant)
                } else {
                    Number::Linear(Linear {
                        coefficients,
                        shift: *shift,
                        constant: *constant,
                    })
                }
            })
            .collect(),
        Terms::Sets(..) => Vec::new(),
    }
}

fn sets(output: &AnOutput) -> Vec<&[Grade]> {
    match &output.terms {
        Terms::Sets(_, _, sets) => sets.iter().map(|set| &set[..]).collect(),
        Terms::Numbers(_) => Vec::new(),
    }
}

/// Ranges of all sizes, from a few steps to all numbers.
fn a_range(dice: &mut Dice) -> [i32; 2] {
    let most = [60, 70_000, 30_000_000, LIMIT][dice.index(4)];
    loop {
        let (a, b) = (dice.between(-most, most), dice.between(-most, most));
        if a != b {
            return [a.min(b), a.max(b)];
        }
    }
}

fn an_input(dice: &mut Dice) -> AnInput {
    let range = a_range(dice);
    let count = dice.size(5);
    let terms = (0..count).map(|_| {
        let mut corners = [0; 4].map(|_| dice.between(range[0], range[1]));
        corners.sort_unstable();
        if dice.below(8) == 0 {
            corners[0] = corners[1];
        }
        if dice.below(8) == 0 {
            corners[2] = corners[1];
        }
        corners
    });
    AnInput {
        range,
        terms: terms.collect(),
        clamp: dice.coin(),
    }
}

fn an_output(dice: &mut Dice, inputs: usize) -> AnOutput {
    let range = a_range(dice);
    let count = dice.size(5);
    let terms = if dice.coin() {
        let linear = dice.below(3) == 0;
        let terms = (0..count).map(|_| {
            let constant = dice.between(range[0], range[1]);
            if linear && dice.coin() {
                let coefficients = (0..inputs).map(|_| dice.between(-1 << 20, 1 << 20));
                (coefficients.collect(), 4 + dice.below(30) as u32, constant)
            } else {
                (Vec::new(), 0, constant)
            }
        });
        Terms::Numbers(terms.collect())
    } else {
        let samples = 2 + dice.index(60);
        let middles = dice.coin();
        let grade = |dice: &mut Dice| match dice.below(4) {
            0 => 0,
            1 => 32_768,
            _ => dice.below(32_769) as u16,
        };
        let set = |dice: &mut Dice| {
            let grades = (0..samples).map(|_| Grade::from_bits(grade(dice)));
            let mut set: Vec<Grade> = grades.collect();
            // What rules conclude is not empty.
            if set.iter().all(|&grade| grade == Grade::ZERO) {
                set[0] = Grade::ONE;
            }
            set
        };
        let made = if middles {
            Samples::middles(range, samples)
        } else {
            Samples::ends(range, samples)
        };
        Terms::Sets(made, middles, (0..count).map(|_| set(dice)).collect())
    };
    AnOutput {
        range,
        clamp: true,
        default: dice.between(range[0], range[1]),
        merge: dice.merge(),
        terms,
    }
}

fn a_rule(dice: &mut Dice, inputs: &[AnInput], outputs: &[AnOutput]) -> ARule {
    let literal = |dice: &mut Dice| {
        let input = dice.index(inputs.len());
        let term = dice.index(inputs[input].terms.len());
        if dice.below(5) == 0 {
            IsNot(input as u8, term as u8)
        } else {
            Is(input as u8, term as u8)
        }
    };
    let mut when = Vec::new();
    for _ in 0..dice.size(3) {
        when.push((0..dice.size(4)).map(|_| literal(dice)).collect());
    }
    let mut then = Vec::new();
    for (o, output) in outputs.iter().enumerate() {
        let terms = match &output.terms {
            Terms::Numbers(terms) => terms.len(),
            Terms::Sets(_, _, sets) => sets.len(),
        };
        if dice.coin() || o + 1 == outputs.len() {
            then.push((o as u8, dice.index(terms) as u8));
        }
    }
    let weight = match dice.below(5) {
        0 => 0,
        1 => dice.below(1 << 24) as u32,
        _ => 1 << 24,
    };
    ARule { when, then, weight }
}

/// Inputs anywhere in the range, at the terms' numbers, and at the ends of everything.
fn some_inputs(made: &Made, dice: &mut Dice) -> Vec<i32> {
    let one = |input: &AnInput, dice: &mut Dice| match dice.below(8) {
        0 => [i32::MIN, -LIMIT - 1, -1, 0, LIMIT + 1, i32::MAX][dice.index(6)],
        1 => {
            let corners = input.terms[dice.index(input.terms.len())];
            corners[dice.index(4)] + dice.between(-1, 1)
        }
        _ => dice.between(input.range[0], input.range[1]),
    };
    made.inputs.iter().map(|input| one(input, dice)).collect()
}

fn evaluate(system: &System<'_>, inputs: &[i32]) -> (Vec<i32>, Vec<Degree>) {
    let mut terms = vec![Degree::ONE; system.term_count()];
    let mut rules = vec![Degree::ONE; system.rule_count()];
    let mut outputs = vec![77; system.outputs().len()];
    system
        .evaluate(inputs, &mut terms, &mut rules, &mut outputs)
        .unwrap();
    (outputs, rules)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_system_agrees_with_f64(seed in any::<u64>()) {
        let made = Made::from(seed);
        let mut dice = Dice(!seed);
        made.with(|system| {
            for _ in 0..20 {
                let inputs = some_inputs(&made, &mut dice);
                let x: Vec<f64> = inputs.iter().zip(&made.inputs).map(|(&x, input)| {
                    let [low, high] = if input.clamp { input.range } else { [-LIMIT, LIMIT] };
                    f64::from(x.clamp(low, high))
                }).collect();
                let (outputs, rules) = evaluate(&system, &inputs);
                let degrees = made.degrees(&x);
                // A membership is right to 3/4 of a step; four of them, three products and a weight add up.
                for (rule, exact) in rules.iter().zip(&degrees) {
                    prop_assert!((f64::from(rule.bits()) - exact * ONE).abs() <= 5.1, "{rule:?}, {exact} at {inputs:?}");
                }
                for (o, &output) in outputs.iter().enumerate() {
                    let this = &made.outputs[o];
                    prop_assert!((this.range[0]..=this.range[1]).contains(&output));
                    let (exact, weight, span) = made.value(o, &x, &degrees);
                    let said = made.said(o, &degrees).len() as f64;
                    // What all degrees together can be wrong by; at every sample for sets.
                    let (wrong, rounding) = match &this.terms {
                        Terms::Numbers(_) => (5.1 * said / ONE, 1.01),
                        // A place among the samples has 21 fractional bits, and the step 32.
                        Terms::Sets(samples, ..) => (6.1 * said * samples.count() as f64 / ONE, 0.51 + span * 1e-6),
                    };
                    if weight == 0.0 {
                        // Nothing fires, or nothing but a step or two.
                        prop_assert!(output == this.default || rules.iter().any(|rule| rule.bits() > 0));
                    } else if weight > 4.0 * wrong {
                        let bound = rounding + 2.0 * span * wrong / weight;
                        prop_assert!((f64::from(output) - exact).abs() <= bound,
                            "output {o}: {output}, exactly {exact} ± {bound} at {inputs:?}");
                    }
                }
            }
            Ok(())
        })?;
    }
}

/// A number in steps of 2^-16.
const fn q(text: &str) -> i32 {
    I16F16::lit(text).to_bits()
}

const SEVEN: Number<'_> = Constant(q("7"));
const TWICE: [i32; 1] = [q("2")];

/// One input from 0 to 10, three terms; the output 0, 5 or 9 or what `defuzzifier` says.
static TERMS: [&[Piece]; 3] = [
    &ramp(q("5"), q("0")),
    &triangle(q("0"), q("5"), q("10")),
    &ramp(q("5"), q("10")),
];

fn lone<'a>(terms: &'a [&'a [Piece]]) -> Input<'a> {
    Input::new([q("0"), q("10")], terms)
}

fn height<'a>(terms: &'a [Number<'a>]) -> Output<'a> {
    Output {
        range: [q("0"), q("10")],
        clamp: false,
        default: q("3"),
        complete: false,
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms,
        },
    }
}

#[test]
fn a_lone_conclusion_is_exact() {
    let rules = [
        Rule::new(&[&[Is(0, 0)]], &[(0, 0)]),
        Rule::new(&[&[Is(0, 1)]], &[(0, 1)]),
        Rule::new(&[&[Is(0, 2)]], &[(0, 2)]),
    ];
    let inputs = [lone(&TERMS)];
    let blocks = [Block::min(&rules)];
    let constants = [-LIMIT, q("0.37"), LIMIT].map(Constant);
    let outputs = [Output {
        range: [-LIMIT, LIMIT],
        ..height(&constants)
    }];
    let controller =
        Controller::<1, 3, 3, 1>::new(System::checked(&inputs, &blocks, &outputs).unwrap());
    for (x, wanted) in [
        (i32::MIN, -LIMIT),
        (0, -LIMIT),
        (q("5"), q("0.37")),
        (q("10"), LIMIT),
        (i32::MAX, LIMIT),
    ] {
        let now = controller.evaluate([x]);
        assert_eq!(now.outputs, [wanted]);
        assert_eq!(now.fired().count(), 1);
        assert_eq!(now.fired().next().unwrap().1, Degree::ONE);
    }
    // Halfway, and by symmetry.
    let half = controller.evaluate([q("2.5")]);
    assert_eq!(
        half.rules,
        [Degree::lit("0.5"), Degree::lit("0.5"), Degree::ZERO]
    );
    assert_eq!(half.outputs, [(q("0.37") - LIMIT) / 2]);
}

#[test]
fn where_nothing_fires_the_default_holds() {
    let terms: [&[Piece]; 1] = [&triangle(q("2"), q("3"), q("4"))];
    let rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0), (1, 0)])];
    let inputs = [lone(&terms).with_gaps()];
    let blocks = [Block::product(&rules)];
    let set = [0, 100, 32_768, 100].map(Grade::from_bits);
    let sets = [&set[..]];
    let outputs = [
        height(&[SEVEN]),
        Output {
            defuzzifier: Defuzzifier::Centroid {
                merge: Merge::Max,
                samples: Samples::ends([q("0"), q("9")], 4),
                terms: &sets,
            },
            ..height(&[])
        },
    ];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    for x in [q("0"), q("2"), q("4"), q("10"), i32::MIN, i32::MAX] {
        assert_eq!(evaluate(&system, &[x]).0, [q("3"), q("3")]);
    }
    // The least that fires is enough: a step beside the foot of the triangle it is 2^-16.
    let (outputs_, rules_) = evaluate(&system, &[q("2") + 1]);
    assert_eq!(rules_, [Degree::from_bits(1 << 8)]);
    assert_eq!(outputs_[0], q("7"));
    assert!((outputs_[1] - q("6")).abs() < q("0.02"));
    // No weight, no rule.
    let rules = [rules[0].weighted(Degree::ZERO)];
    let blocks = [Block::min(&rules)];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    assert_eq!(evaluate(&system, &[q("3")]).0, [q("3"), q("3")]);
}

#[test]
fn the_largest_sums_fit() {
    // 255 rules that fire fully with the largest numbers, and as many whole sets.
    let rule = Rule::new(&[&[Is(0, 0)]], &[(0, 0), (1, 0)]);
    let rules = vec![rule; 255];
    let terms: [&[Piece]; 1] = [&points([(0, Degree::ONE)])];
    let inputs = [lone(&terms)];
    let blocks = [Block::min(&rules)];
    let set = [Grade::ONE; Samples::MOST];
    let sets = [&set[..]];
    let constants = [Constant(LIMIT)];
    let wide = Output {
        range: [-LIMIT, LIMIT],
        default: 0,
        ..height(&constants)
    };
    let outputs = [
        wide,
        Output {
            defuzzifier: Defuzzifier::Centroid {
                merge: Merge::Sum,
                samples: Samples::ends([-LIMIT, LIMIT], Samples::MOST),
                terms: &sets,
            },
            ..wide
        },
    ];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    let (values, _) = evaluate(&system, &[0]);
    assert_eq!(values[0], LIMIT);
    assert!(values[1].abs() <= 512, "{}", values[1]);
    // One more set does not, nor two more numbers.
    for (output, count) in [(outputs[1], 2048), (outputs[0], 257)] {
        let rules = vec![Rule::new(&[&[Is(0, 0)]], &[(0, 0)]); count];
        let last_good = [Block::min(&rules[1..])];
        System::checked(&inputs, &last_good, &[output]).unwrap();
        assert_eq!(
            System::checked(&inputs, &[Block::min(&rules)], &[output]).unwrap_err(),
            Flaw::Accumulator { output: 0 }
        );
    }
    // Small numbers leave room for many more.
    let small = [Constant(q("1"))];
    let outputs = [height(&small)];
    let rules = vec![Rule::new(&[&[Is(0, 0)]], &[(0, 0)]); 4096];
    let blocks = [Block::min(&rules)];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    assert_eq!(evaluate(&system, &[0]).0, [q("1")]);
}

#[test]
fn samples_lie_where_they_should() {
    for (range, n) in [
        ([0, 99], 100),
        ([-7, 8], 2),
        ([-LIMIT, LIMIT], 1024),
        ([-5, -4], 1000),
        ([0, 1 << 20], 65),
    ] {
        let terms: [&[Piece]; 1] = [&points([(0, Degree::ONE)])];
        let inputs = [lone(&terms)];
        let rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0)])];
        let blocks = [Block::min(&rules)];
        for (samples, middles) in [
            (Samples::ends(range, n), false),
            (Samples::middles(range, n), true),
        ] {
            for j in [0, 1, n / 2, n - 1] {
                let mut set = vec![Grade::ZERO; n];
                set[j] = Grade::ONE;
                let sets = [&set[..]];
                let outputs = [Output {
                    range,
                    default: range[0],
                    defuzzifier: Defuzzifier::Centroid {
                        merge: Merge::Max,
                        samples,
                        terms: &sets,
                    },
                    ..height(&[])
                }];
                let system = System::checked(&inputs, &blocks, &outputs).unwrap();
                let [low, high] = range.map(f64::from);
                let at = if middles {
                    (j as f64 + 0.5) / n as f64
                } else {
                    j as f64 / (n as f64 - 1.0)
                };
                let exact = low + at * (high - low);
                let got = f64::from(evaluate(&system, &[0]).0[0]);
                assert!(
                    (got - exact).abs() <= 0.8,
                    "{got} {exact}: {range:?} {n} {j}"
                );
            }
        }
    }
    // A set from a shape has the shape's degrees.
    const SAMPLES: Samples = Samples::ends([q("0"), q("8")], 9);
    static SET: [Grade; 9] = SAMPLES.of(&triangle(q("0"), q("4"), q("8")));
    assert_eq!(
        SET.map(Grade::bits),
        [0, 8192, 16_384, 24_576, 32_768, 24_576, 16_384, 8192, 0]
    );
}

#[test]
fn other_sizes_are_refused() {
    let rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0)])];
    let inputs = [lone(&TERMS)];
    let blocks = [Block::min(&rules)];
    let outputs = [height(&[SEVEN])];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    for [i, t, r, o] in [
        [0, 3, 1, 1],
        [2, 3, 1, 1],
        [1, 2, 1, 1],
        [1, 3, 0, 1],
        [1, 3, 2, 1],
        [1, 3, 1, 0],
    ] {
        let mut results = vec![55; o];
        let answer = system.evaluate(
            &vec![0; i],
            &mut vec![Degree::ZERO; t],
            &mut vec![Degree::ZERO; r],
            &mut results,
        );
        assert_eq!(answer, Err(WrongSize));
        assert!(results.iter().all(|&result| result == 55));
    }
}

fn linear(coefficients: &[i32], shift: u32, constant: i32) -> Number<'_> {
    Number::Linear(Linear {
        coefficients,
        shift,
        constant,
    })
}

fn centroid<'a>(terms: &'a [&'a [Grade]], range: [i32; 2]) -> Output<'a> {
    Output {
        defuzzifier: Defuzzifier::Centroid {
            merge: Merge::Sum,
            samples: Samples::ends(range, 3),
            terms,
        },
        ..height(&[])
    }
}

#[test]
fn every_flaw_is_found() {
    let good_rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0)])];
    let constants = [SEVEN];
    let (good_input, good_output) = (lone(&TERMS), height(&constants));
    let flaw = |inputs: &[Input<'_>], rules: &[Rule<'_>], outputs: &[Output<'_>]| {
        System::checked(inputs, &[Block::min(rules)], outputs).unwrap_err()
    };
    let of_input = |input: Input<'_>| flaw(&[good_input, input], &good_rules, &[good_output]);
    let of_rule = |rule: Rule<'_>| flaw(&[good_input], &[good_rules[0], rule], &[good_output]);
    let of_output = |output: Output<'_>| flaw(&[good_input], &good_rules, &[good_output, output]);

    assert_eq!(
        flaw(&[], &good_rules, &[good_output]),
        Flaw::Inputs { count: 0 }
    );
    assert_eq!(
        flaw(&[good_input; 5], &good_rules, &[good_output]),
        Flaw::Inputs { count: 5 }
    );
    assert_eq!(
        flaw(&[good_input], &good_rules, &[]),
        Flaw::Outputs { count: 0 }
    );
    assert_eq!(
        flaw(&[good_input], &good_rules, &[good_output; 256]),
        Flaw::Outputs { count: 256 }
    );
    assert_eq!(
        flaw(&[good_input], &[], &[good_output]),
        Flaw::Rules { count: 0 }
    );
    assert_eq!(
        flaw(&[good_input], &[good_rules[0]; 4097], &[good_output]),
        Flaw::Rules { count: 4097 }
    );

    for range in [
        [1, 1],
        [2, 1],
        [-LIMIT - 1, 0],
        [0, LIMIT + 1],
        [i32::MIN, i32::MAX],
    ] {
        assert_eq!(
            of_input(Input {
                range,
                ..good_input
            }),
            Flaw::InputRange { input: 1 }
        );
        assert_eq!(
            of_output(Output {
                range,
                ..good_output
            }),
            Flaw::OutputRange { output: 1 }
        );
    }
    assert_eq!(
        of_input(Input {
            terms: &[],
            ..good_input
        }),
        Flaw::InputTerms { input: 1, count: 0 }
    );
    let many = vec![TERMS[0]; 256];
    assert_eq!(
        of_input(Input {
            terms: &many,
            ..good_input
        }),
        Flaw::InputTerms {
            input: 1,
            count: 256
        }
    );
    // Pieces of different terms do not meet; one without a last piece does not end.
    let mixed = [TERMS[0][0], TERMS[1][1], TERMS[1][2]];
    let [open, reversed] = [&TERMS[1][..2], &[TERMS[1][1], TERMS[1][0]]];
    for (wrong, piece) in [(&mixed[..], 1), (&[], 0), (open, 1), (reversed, 1)] {
        let found = of_input(Input {
            terms: &[TERMS[0], wrong],
            ..good_input
        });
        assert_eq!(
            found,
            Flaw::Pieces {
                input: 1,
                term: 1,
                piece
            }
        );
    }
    assert_eq!(
        of_input(Input {
            terms: &TERMS[..2],
            range: [q("0"), q("11")],
            ..good_input
        }),
        Flaw::Gap {
            input: 1,
            at: q("11")
        }
    );

    assert_eq!(
        of_rule(Rule {
            when: &[],
            ..good_rules[0]
        }),
        Flaw::NoAntecedent { rule: 1 }
    );
    assert_eq!(
        of_rule(Rule {
            when: &[&[Is(0, 0)], &[]],
            ..good_rules[0]
        }),
        Flaw::NoAntecedent { rule: 1 }
    );
    assert_eq!(
        of_rule(Rule {
            when: &[&[Is(0, 0), IsNot(1, 0)]],
            ..good_rules[0]
        }),
        Flaw::UnknownInput { rule: 1, input: 1 }
    );
    assert_eq!(
        of_rule(Rule {
            when: &[&[Is(0, 3)]],
            ..good_rules[0]
        }),
        Flaw::UnknownTerm {
            rule: 1,
            input: 0,
            term: 3
        }
    );
    assert_eq!(
        of_rule(Rule {
            then: &[],
            ..good_rules[0]
        }),
        Flaw::NoConclusion { rule: 1 }
    );
    assert_eq!(
        of_rule(Rule {
            then: &[(1, 0)],
            ..good_rules[0]
        }),
        Flaw::UnknownOutput { rule: 1, output: 1 }
    );
    assert_eq!(
        of_rule(Rule {
            then: &[(0, 1)],
            ..good_rules[0]
        }),
        Flaw::UnknownConclusion {
            rule: 1,
            output: 0,
            term: 1
        }
    );
    assert_eq!(
        of_rule(Rule {
            then: &[(0, 0), (0, 0)],
            ..good_rules[0]
        }),
        Flaw::TwoConclusions { rule: 1, output: 0 }
    );

    assert_eq!(
        of_output(height(&[])),
        Flaw::OutputTerms {
            output: 1,
            count: 0
        }
    );
    assert_eq!(
        of_output(height(&[Constant(0); 256])),
        Flaw::OutputTerms {
            output: 1,
            count: 256
        }
    );
    for default in [-1, q("10") + 1] {
        assert_eq!(
            of_output(Output {
                default,
                ..good_output
            }),
            Flaw::Default { output: 1 }
        );
    }
    for beyond in [-1, q("10") + 1] {
        let terms = [Constant(0), Constant(beyond)];
        let output = height(&terms);
        assert_eq!(of_output(output), Flaw::OutOfRange { output: 1, term: 1 });
        System::checked(
            &[good_input],
            &[Block::min(&good_rules)],
            &[Output {
                clamp: true,
                ..output
            }],
        )
        .unwrap();
    }
    assert_eq!(
        of_output(Output {
            clamp: true,
            ..height(&[Constant(i32::MIN)])
        }),
        Flaw::OutOfRange { output: 1, term: 0 }
    );
    // 2·x + 0 of 0 to 10 reaches 20.
    assert_eq!(
        of_output(height(&[linear(&TWICE, 16, 0)])),
        Flaw::OutOfRange { output: 1, term: 0 }
    );
    for wrong in [
        linear(&[], 16, 0),
        linear(&[1, 1], 16, 0),
        linear(&[1], 61, 0),
        linear(&[(1 << 30) + 1], 16, 0),
        linear(&[1], 16, LIMIT + 1),
    ] {
        assert_eq!(
            of_output(height(&[wrong])),
            Flaw::Coefficients { output: 1, term: 0 }
        );
    }
    const WHOLE: &[Grade] = &[Grade::ONE; 3];
    const SHORT: &[Grade] = &[Grade::ONE; 2];
    assert_eq!(
        of_output(centroid(&[WHOLE, SHORT], [0, 9])),
        Flaw::SetLength { output: 1, term: 1 }
    );
    assert_eq!(
        of_output(centroid(&[WHOLE], [0, q("11")])),
        Flaw::SampleRange { output: 1 }
    );
    // A set of nothing is a flaw where a rule concludes it, whether the output claims to be complete or not.
    const NOTHING: &[Grade] = &[Grade::ZERO; 3];
    let sets = centroid(&[WHOLE, NOTHING], [0, 9]);
    let concluding = |term: u8, weight: Degree| {
        let then = [(1, term)];
        let rule = Rule::new(&[&[Is(0, 0)]], &then).weighted(weight);
        let rules = [good_rules[0], rule];
        System::checked(&[good_input], &[Block::min(&rules)], &[good_output, sets]).map(|_| ())
    };
    assert_eq!(
        concluding(1, Degree::ONE),
        Err(Flaw::EmptySet { output: 1, term: 1 })
    );
    assert_eq!(concluding(1, Degree::ZERO), Ok(()));
    assert_eq!(concluding(0, Degree::ONE), Ok(()));
    assert_eq!(
        of_output(Output {
            complete: true,
            ..good_output
        }),
        Flaw::Hole {
            output: 1,
            terms: [0; 4],
            inputs: 1
        }
    );
}

#[test]
fn holes_are_found_where_they_are() {
    let inputs = [lone(&TERMS), lone(&TERMS[..2]).with_gaps()];
    let constants = [Constant(0)];
    let outputs = [Output {
        complete: true,
        ..height(&constants)
    }];
    let cell = |row: u8, col: u8| vec![Is(0, row), Is(1, col)];
    let cells: Vec<Vec<Literal>> = (0..3)
        .flat_map(|row| (0..2).map(move |col| cell(row, col)))
        .collect();
    for missing in 0..6 {
        let whens: Vec<[&[Literal]; 1]> = cells.iter().map(|cell| [&cell[..]]).collect();
        let mut rules: Vec<Rule<'_>> = whens
            .iter()
            .map(|when| Rule::new(when, &[(0, 0)]))
            .collect();
        System::checked(&inputs, &[Block::min(&rules)], &outputs).unwrap();
        let [row, col] = [missing as u8 / 2, missing as u8 % 2];
        let hole = Flaw::Hole {
            output: 0,
            terms: [row, col, 0, 0],
            inputs: 2,
        };
        // A rule without a weight, and one that may not hold, fill nothing.
        rules[missing] = rules[missing].weighted(Degree::ZERO);
        assert_eq!(
            System::checked(&inputs, &[Block::min(&rules)], &outputs).unwrap_err(),
            hole
        );
        let not: [&[Literal]; 1] = [&[Is(0, row), IsNot(1, 1 - col)]];
        rules[missing] = Rule::new(&not, &[(0, 0)]);
        assert_eq!(
            System::checked(&inputs, &[Block::min(&rules)], &outputs).unwrap_err(),
            hole
        );
        // A rule about one input alone fills both cells.
        let row: [&[Literal]; 2] = [&[Is(0, (row + 1) % 3), Is(1, 0)], &[Is(0, row)]];
        rules[missing] = Rule::new(&row, &[(0, 0)]);
        System::checked(&inputs, &[Block::min(&rules)], &outputs).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn gaps_are_found_where_they_are(seed in any::<u64>()) {
        let mut dice = Dice(seed);
        // Narrow ranges, to look at every value; wide feet, whose degrees vanish by rounding.
        let range = [dice.between(-60, 0), dice.between(1, 60)];
        let reach = if dice.below(3) == 0 { LIMIT } else { 70 };
        let made: Vec<[Piece; 4]> = (0..dice.size(5)).map(|_| {
            let mut corners = [0; 4].map(|_| dice.between(-70, 70));
            corners[0] = dice.between(-reach, 70);
            corners[3] = dice.between(-70, reach);
            corners.sort_unstable();
            if dice.below(3) == 0 {
                let same = corners[3 * dice.index(2)];
                corners[1..3].fill(same);
            }
            corners.sort_unstable();
            trapezoid(corners[0], corners[1], corners[2], corners[3])
        }).collect();
        let terms: Vec<&[Piece]> = made.iter().map(|term| &term[..]).collect();
        let rules: Vec<[Literal; 1]> = (0..terms.len()).map(|i| [Is(0, i as u8)]).collect();
        let whens: Vec<[&[Literal]; 1]> = rules.iter().map(|all| [&all[..]]).collect();
        let rules: Vec<Rule<'_>> = whens.iter().map(|when| Rule::new(when, &[(0, 0)])).collect();
        let blocks = [Block::min(&rules)];
        let constants = [Constant(0)];
        let outputs = [height(&constants)];
        let input = Input::new(range, &terms);
        let open = [input.with_gaps()];
        let system = System::checked(&open, &blocks, &outputs).unwrap();
        let is_gap = |x: i32| evaluate(&system, &[x]).1.iter().all(|rule| rule.bits() == 0);
        let gaps: Vec<i32> = (range[0]..=range[1]).filter(|&x| is_gap(x)).collect();
        match System::checked(&[input], &blocks, &outputs) {
            Ok(_) => prop_assert!(gaps.is_empty(), "{gaps:?} not found"),
            Err(Flaw::Gap { input: 0, at }) => prop_assert!(gaps.contains(&at), "{at} is none of {gaps:?}"),
            Err(other) => prop_assert!(false, "{other}"),
        };
    }
}

#[test]
fn a_gap_without_a_foot_in_it_is_found() {
    // Flanks so flat that they are below half a step for 32 steps beside their feet, which overlap: the gap is between.
    let falling = trapezoid(-LIMIT, -LIMIT, -LIMIT, 20);
    let rising = trapezoid(-20, LIMIT, LIMIT, LIMIT);
    let terms: [&[Piece]; 2] = [&falling, &rising];
    let rules = [Rule::new(&[&[Is(0, 0)], &[Is(0, 1)]], &[(0, 0)])];
    let blocks = [Block::min(&rules)];
    let outputs = [height(&[SEVEN])];
    let open = [Input::new([-60, 60], &terms).with_gaps()];
    let system = System::checked(&open, &blocks, &outputs).unwrap();
    let fires = |x: i32| evaluate(&system, &[x]).1[0] > Degree::ZERO;
    assert_eq!([-20, 0, 20].map(fires), [true, false, true]);
    let flaw = System::checked(&[Input::new([-60, 60], &terms)], &blocks, &outputs).unwrap_err();
    assert_eq!(flaw, Flaw::Gap { input: 0, at: 0 });
}

#[test]
fn a_singleton_input_holds_at_its_step_alone() {
    let terms: [&[Piece]; 1] = [&singleton(q("5"))];
    let inputs = [lone(&terms).with_gaps()];
    let rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0)])];
    let constants = [SEVEN];
    let outputs = [height(&constants)];
    let blocks = [Block::min(&rules)];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    let at = |x: i32| evaluate(&system, &[x]).0[0];
    assert_eq!(
        [at(q("5") - 1), at(q("5")), at(q("5") + 1)],
        [q("3"), q("7"), q("3")]
    );
}
