//! Random systems of every kind that the model can hold, in the form that readers give them.

use host_sim::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Sampling, Shape, System, Term,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// Numbers as people write them, and others.
fn number() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        (-800i32..800).prop_map(|n| f64::from(n) / 8.0),
        -1e3..1e3f64,
        -1e-6..1e-6f64,
        -1e18..1e18f64,
    ]
}

fn positive() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![(1i32..800).prop_map(|n| f64::from(n) / 8.0), 1e-9..1e9f64,]
}

/// `N` numbers, none below the one before it, the last above the first.
fn ascending<const N: usize>() -> impl Strategy<Value = [f64; N]> + Clone {
    vec(number(), N).prop_filter_map("all equal", |mut all| {
        all.sort_by(f64::total_cmp);
        let all: [f64; N] = all.try_into().ok()?;
        (all[0] < all[N - 1]).then_some(all)
    })
}

fn two() -> impl Strategy<Value = (f64, f64)> + Clone {
    ascending::<2>().prop_map(|[a, b]| (a, b))
}

/// One way or the other.
fn either() -> impl Strategy<Value = (f64, f64)> + Clone {
    (two(), any::<bool>()).prop_map(|((a, b), swap)| if swap { (b, a) } else { (a, b) })
}

pub fn shape() -> impl Strategy<Value = Shape> + Clone {
    prop_oneof![
        ascending::<3>().prop_map(|[left, peak, right]| Shape::Triangle { left, peak, right }),
        ascending::<4>().prop_map(|[left, rise, fall, right]| Shape::Trapezoid {
            left,
            rise,
            fall,
            right
        }),
        either().prop_map(|(from, to)| Shape::Ramp { from, to }),
        number().prop_map(Shape::Singleton),
        // The first degree keeps it from being one of the shapes above.
        (vec((number(), 0.0..=1.0f64), 2..9), 0.01..0.99f64).prop_map(|(mut points, first)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points[0].1 = first;
            Shape::Points(points)
        }),
        (number(), positive()).prop_map(|(mean, deviation)| Shape::Gaussian { mean, deviation }),
        (two(), positive(), positive()).prop_map(|((a, b), left, right)| Shape::TwoSidedGaussian {
            left: (a, left),
            right: (b, right)
        }),
        (number(), positive(), positive()).prop_map(|(centre, width, slope)| Shape::Bell {
            centre,
            width,
            slope
        }),
        (number(), positive(), any::<bool>()).prop_map(|(inflection, slope, falls)| {
            Shape::Sigmoid {
                inflection,
                slope: if falls { -slope } else { slope },
            }
        }),
        either().prop_map(|(from, to)| Shape::Spline { from, to }),
    ]
}

/// A step without an end, which FCL cannot say.
fn open() -> impl Strategy<Value = Shape> + Clone {
    number().prop_map(|x| Shape::Trapezoid {
        left: f64::NEG_INFINITY,
        rise: f64::NEG_INFINITY,
        fall: x,
        right: x,
    })
}

fn name(prefix: &'static str) -> impl Strategy<Value = String> {
    "[a-zA-Zäßµ_0-9]{0,6}".prop_map(move |s| format!("{prefix}{s}"))
}

/// Different names.
fn names(prefix: &'static str, many: RangeInclusive<usize>) -> impl Strategy<Value = Vec<String>> {
    vec(name(prefix), many).prop_map(|all| {
        let number = |(i, name)| format!("{name}_{i}");
        all.into_iter().enumerate().map(number).collect()
    })
}

fn range() -> impl Strategy<Value = RangeInclusive<f64>> {
    two().prop_map(|(a, b)| a..=b)
}

fn input() -> impl Strategy<Value = Input> {
    let shape = prop_oneof![40 => shape(), 1 => open()];
    (range(), any::<bool>(), names("t", 1..=5), vec(shape, 5)).prop_map(
        |(range, clamp, names, shapes)| Input {
            name: String::new(),
            description: String::new(),
            range,
            clamp,
            terms: names
                .into_iter()
                .zip(shapes)
                .map(|(name, shape)| Term {
                    name,
                    shape,
                    place: Place::default(),
                })
                .collect(),
            place: Place::default(),
        },
    )
}

fn output(inputs: usize) -> impl Strategy<Value = Output> {
    let centroid = prop_oneof![
        Just((1000, Sampling::Middles)),
        (2usize..=10_000).prop_map(|n| (n, Sampling::Middles)),
        (2usize..=10_000).prop_map(|n| (n, Sampling::Ends)),
    ];
    let defuzzifier = prop_oneof![
        Just(Defuzzifier::WeightedAverage),
        centroid.prop_map(|(points, sampling)| Defuzzifier::Centroid { points, sampling }),
    ];
    let wide = |s: &Shape| !matches!(s, Shape::Singleton(_));
    let set = shape().prop_filter("a set has a width", wide);
    let number_conclusion = prop_oneof![
        9 => number().prop_map(Conclusion::Constant),
        1 => (vec(number(), inputs), number()).prop_map(|(coefficients, constant)| {
            Conclusion::Linear { coefficients, constant }
        }),
    ];
    (
        range(),
        any::<bool>(),
        proptest::option::of(number()),
        defuzzifier,
        select(vec![Merge::Sum, Merge::Max]),
        names("u", 1..=5),
        (vec(set, 5), vec(number_conclusion, 5)),
    )
        .prop_map(
            |(range, clamp, default, defuzzifier, merge, names, (sets, numbers))| {
                let conclusions: Vec<Conclusion> = match defuzzifier {
                    Defuzzifier::WeightedAverage => numbers,
                    Defuzzifier::Centroid { .. } => sets.into_iter().map(Conclusion::Set).collect(),
                };
                Output {
                    name: String::new(),
                    description: String::new(),
                    range,
                    clamp,
                    default,
                    defuzzifier,
                    merge,
                    terms: names
                        .into_iter()
                        .zip(conclusions)
                        .map(|(name, conclusion)| OutputTerm {
                            name,
                            conclusion,
                            place: Place::default(),
                        })
                        .collect(),
                    place: Place::default(),
                }
            },
        )
}

/// A condition over four inputs of five terms; [`fit`] brings the indices into range.
fn condition() -> impl Strategy<Value = Antecedent> {
    let is = (0usize..4, 0usize..5, any::<bool>())
        .prop_map(|(input, term, negated)| Antecedent::Is {
            input,
            term,
            negated,
        })
        .boxed();
    let and = |inner: BoxedStrategy<Antecedent>| vec(inner, 2..4).prop_map(Antecedent::And).boxed();
    let or = |inner: BoxedStrategy<Antecedent>| vec(inner, 2..4).prop_map(Antecedent::Or).boxed();
    let mixed = |a: BoxedStrategy<Antecedent>, b: BoxedStrategy<Antecedent>| {
        prop_oneof![2 => a, 1 => b].boxed()
    };
    let (and1, or1) = (and(is.clone()), or(is.clone()));
    let (and2, or2) = (
        and(mixed(is.clone(), or1.clone())),
        or(mixed(is.clone(), and1.clone())),
    );
    let and3 = and(mixed(is.clone(), or2.clone()));
    prop_oneof![is, and1, or1, and2, or2, and3]
}

fn fit(antecedent: &mut Antecedent, inputs: &[Input]) {
    match antecedent {
        Antecedent::Is { input, term, .. } => {
            *input %= inputs.len();
            *term %= inputs[*input].terms.len();
        }
        Antecedent::And(all) | Antecedent::Or(all) => all.iter_mut().for_each(|a| fit(a, inputs)),
    }
}

/// The same text for conditions that differ in their order only.
fn key(antecedent: &Antecedent) -> String {
    match antecedent {
        Antecedent::Is { .. } => format!("{antecedent:?}"),
        Antecedent::And(all) | Antecedent::Or(all) => {
            let mut keys: Vec<String> = all.iter().map(key).collect();
            keys.sort();
            let and = matches!(antecedent, Antecedent::And(_));
            format!("{and}{keys:?}")
        }
    }
}

fn rule() -> impl Strategy<Value = Rule> {
    let weight = prop_oneof![3 => Just(1.0), 1 => 0.0..=1.0f64];
    (condition(), vec(proptest::option::of(0usize..5), 3), weight).prop_map(
        |(antecedent, terms, weight)| Rule {
            antecedent,
            conclusions: terms
                .into_iter()
                .enumerate()
                .filter_map(|(o, t)| Some((o, t?)))
                .collect(),
            weight,
            place: Place::default(),
        },
    )
}

fn block() -> impl Strategy<Value = RuleBlock> {
    let conjunction = select(vec![Conjunction::Min, Conjunction::Product]);
    let name = prop_oneof![Just(String::new()), name("block")];
    (name, conjunction.clone(), conjunction, vec(rule(), 1..8)).prop_map(
        |(name, and, implication, rules)| RuleBlock {
            name,
            description: String::new(),
            and,
            implication,
            rules,
        },
    )
}

pub fn system() -> impl Strategy<Value = System> {
    let variables = (1usize..=4).prop_flat_map(|inputs| {
        (
            vec(input(), inputs),
            names("i", inputs..=inputs),
            vec(output(inputs), 1..=3),
            names("o", 3..=3),
        )
    });
    let name = prop_oneof![Just(String::new()), name("system")];
    (name, variables, vec(block(), 1..4)).prop_map(
        |(name, (mut inputs, input_names, mut outputs, output_names), mut blocks)| {
            for (input, name) in inputs.iter_mut().zip(input_names) {
                input.name = name;
            }
            for (output, name) in outputs.iter_mut().zip(output_names) {
                output.name = name;
            }
            let mut seen = HashSet::new();
            for rule in blocks.iter_mut().flat_map(|b| &mut b.rules) {
                fit(&mut rule.antecedent, &inputs);
                rule.conclusions.retain(|c| c.0 < outputs.len());
                if rule.conclusions.is_empty() {
                    rule.conclusions.push((0, 0));
                }
                for (output, term) in &mut rule.conclusions {
                    *term %= outputs[*output].terms.len();
                }
            }
            for block in &mut blocks {
                block.rules.retain(|r| seen.insert(key(&r.antecedent)));
            }
            System {
                name,
                description: String::new(),
                inputs,
                outputs,
                blocks,
            }
        },
    )
}
