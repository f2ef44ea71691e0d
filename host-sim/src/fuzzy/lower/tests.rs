use super::{Format, LowerError, lower};
use crate::fuzzy::evaluate::{Evaluator, Exact, rules};
use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Sampling, Shape, System, Term,
};
use crate::fuzzy::random;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Whether all of an input's shapes are straight.
fn straight(input: &Input) -> bool {
    input.terms.iter().all(|term| {
        matches!(
            term.shape,
            Shape::Triangle { .. }
                | Shape::Trapezoid { .. }
                | Shape::Ramp { .. }
                | Shape::Singleton(_)
                | Shape::Points(_)
        )
    })
}

/// Whether an output concludes nothing but what lies in its range.
fn within_range(output: &Output) -> bool {
    let mut terms = output.terms.iter();
    !terms.any(|term| matches!(term.conclusion, Conclusion::Linear { .. }))
}

/// The strongest rule about an output.
fn strength(model: &System, degrees: &[f64], output: usize) -> f64 {
    rules(model)
        .zip(degrees)
        .filter(|((_, rule), _)| rule.conclusions.iter().any(|c| c.0 == output))
        .map(|(_, &degree)| degree)
        .fold(0.0, f64::max)
}

/// Errors of outputs with a rule that fires with 0.1 at least, as shares of their ranges, ascending: of systems with
/// straight shapes where conclusions lie in the range, where linear ones may be far outside, and of systems with curves.
fn errors(systems: usize, points: usize) -> [Vec<f64>; 3] {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut errors = [Vec::new(), Vec::new(), Vec::new()];
    for _ in 0..systems {
        let model = random::system(&mut rng);
        let places: Vec<f64> = (0..points * model.inputs.len())
            .map(|_| rng.random_range(-0.05..=1.05))
            .collect();
        let lowered = match lower(&model) {
            // Narrow sets may lie between the samples.
            Err(LowerError::EmptySet { .. }) => continue,
            lowered => lowered.expect("a random system has a form in fixed point"),
        };
        let exact = Exact::new(&model);
        let straight = model.inputs.iter().all(straight);
        lowered.open(|fixed| {
            for places in places.chunks(model.inputs.len()) {
                // As fixed point sees them, so that an upright flank has one side for both.
                let x: Vec<f64> = model
                    .inputs
                    .iter()
                    .zip(&lowered.tables().inputs)
                    .zip(places)
                    .map(|((input, low), place)| {
                        let (start, end) = (*input.range.start(), *input.range.end());
                        let x = start + (end - start) * place;
                        low.format.value(low.format.nearest(x))
                    })
                    .collect();
                let (wanted, found) = (exact.evaluate(&x), fixed.evaluate(&x));
                assert_eq!(wanted.rules.len(), found.rules.len());
                for (o, output) in model.outputs.iter().enumerate() {
                    let (Some(wanted_), Some(found)) = (wanted.outputs[o], found.outputs[o]) else {
                        continue;
                    };
                    if strength(&model, &wanted.rules, o) >= 0.1 {
                        let width = output.range.end() - output.range.start();
                        let kind = match straight {
                            true => usize::from(!within_range(output)),
                            false => 2,
                        };
                        errors[kind].push((wanted_ - found).abs() / width);
                    }
                }
            }
        });
    }
    for errors in &mut errors {
        errors.sort_by(f64::total_cmp);
    }
    errors
}

/// The error that a share of all is within.
fn within(errors: &[f64], share: f64) -> f64 {
    errors[((errors.len() - 1) as f64 * share) as usize]
}

#[test]
fn fixed_point_agrees_with_f64() {
    let [inside, linear, curved] = errors(400, 60);
    let counts = [inside.len(), linear.len(), curved.len()];
    assert!(counts.iter().all(|count| *count > 1_000), "{counts:?}");
    // Wherever something fires with a tenth at least: the worst, and 99 of 100. The bars are what `fuzzypilot::fuzzy::system`
    // says, and a third more than is measured at most.
    let worst = [&inside, &linear, &curved].map(|errors| within(errors, 1.0));
    let most = [&inside, &linear, &curved].map(|errors| within(errors, 0.99));
    println!("{counts:?} {worst:?} {most:?}");
    assert!(worst[0] < 1.2e-4 && worst[1] < 1.5e-3, "{worst:?}");
    assert!(
        most[0] < 1.3e-5 && most[1] < 2e-4 && most[2] < 3e-4,
        "{most:?}"
    );
    // The worst of curves are linear conclusions many times as large as the output's range, or curves narrower than a step, which
    // are a step wide in fixed point.
    assert!(worst[2] < 2e-1, "{worst:?}");
    // Something is rounded.
    assert!(most.iter().all(|most| *most > 1e-7), "{most:?}");
}

/// A system of one input and one output, to be changed.
fn small() -> System {
    let place = Place { line: 7, column: 3 };
    let term = |name: &str, shape| Term {
        name: name.into(),
        shape,
        place,
    };
    let conclusion = |name: &str, conclusion| OutputTerm {
        name: name.into(),
        conclusion,
        place,
    };
    let rule = |term, conclusion| Rule {
        antecedent: Antecedent::Is {
            input: 0,
            term,
            negated: false,
        },
        conclusions: vec![(0, conclusion)],
        weight: 1.0,
        place,
    };
    System {
        name: "small".into(),
        description: String::new(),
        inputs: vec![Input {
            name: "heat".into(),
            description: String::new(),
            range: 0.0..=10.0,
            clamp: true,
            terms: vec![
                term(
                    "cold",
                    Shape::Ramp {
                        from: 10.0,
                        to: 0.0,
                    },
                ),
                term(
                    "hot",
                    Shape::Ramp {
                        from: 0.0,
                        to: 10.0,
                    },
                ),
            ],
            place,
        }],
        outputs: vec![Output {
            name: "fan".into(),
            description: String::new(),
            range: 0.0..=100.0,
            clamp: true,
            default: None,
            defuzzifier: Defuzzifier::WeightedAverage,
            merge: Merge::Sum,
            terms: vec![
                conclusion("off", Conclusion::Constant(0.0)),
                conclusion(
                    "on",
                    Conclusion::Linear {
                        coefficients: vec![10.0],
                        constant: 1.0,
                    },
                ),
            ],
            place,
        }],
        blocks: vec![RuleBlock {
            name: String::new(),
            description: String::new(),
            and: Conjunction::Min,
            implication: Conjunction::Min,
            rules: vec![rule(0, 0), rule(1, 1)],
        }],
    }
}

#[test]
fn values_go_in_and_come_out() {
    let lowered = lower(&small()).unwrap();
    let at = |x: f64| lowered.evaluate(&[x]);
    assert_eq!(at(0.0).outputs, [Some(0.0)]);
    assert_eq!(at(-5.0).outputs, [Some(0.0)]);
    // 0.4 · (10 · 4 + 1), but for half a step of the degrees.
    assert!((at(4.0).outputs[0].unwrap() - 16.4).abs() < 1e-4);
    assert!((at(4.0).rules[1] - 0.4).abs() < 1e-7);
    // 101, limited.
    assert_eq!(at(10.0).outputs, [Some(100.0)]);
    assert_eq!(at(f64::INFINITY).outputs, [Some(100.0)]);
    // Nothing fires: the middle of the range, or the default.
    assert_eq!(at(f64::NAN).outputs, [Some(50.0)]);
    assert_eq!(at(f64::NAN).rules, [0.0, 0.0]);
    let mut model = small();
    model.outputs[0].default = Some(12.5);
    assert_eq!(lower(&model).unwrap().evaluate(&[]).outputs, [Some(12.5)]);
    // Without a limit it is what was concluded.
    model.outputs[0].clamp = false;
    let unlimited = lower(&model).unwrap().evaluate(&[10.0]).outputs[0].unwrap();
    assert!((unlimited - 101.0).abs() < 1e-4);
}

#[test]
fn formats_follow_the_range() {
    let fraction = |width, most| Format::of(width, most).map(|format| format.fraction);
    assert_eq!(fraction(10.0, 10.0), Some(16));
    assert_eq!(fraction(1.0, 1.0), Some(16));
    // Narrow ranges get finer steps, large numbers coarser ones.
    assert_eq!(fraction(0.9, 1.0), Some(17));
    assert_eq!(fraction(1e-6, 1e-6), Some(36));
    assert_eq!(fraction(8192.0, 8192.0), Some(16));
    assert_eq!(fraction(8193.0, 8193.0), Some(15));
    assert_eq!(fraction(1e12, 1e12), Some(-11));
    // A thousandth beside a million.
    assert_eq!(fraction(1.0, 1e6), Some(9));
    assert_eq!(fraction(1e-3, 1e6), None);
    assert_eq!(fraction(f64::INFINITY, 1.0), None);
    assert_eq!(fraction(0.0, 1.0), None);
    let format = Format { fraction: 16 };
    assert_eq!(
        [format.nearest(-0.5), format.nearest(f64::NAN)],
        [-32_768, 0]
    );
    assert_eq!(format.value(-32_768), -0.5);
}

#[test]
fn tiny_and_huge_ranges_keep_their_digits() {
    for scale in [1e-9, 1e-3, 1.0, 1e6, 1e12] {
        let mut model = small();
        model.inputs[0].range = 0.0..=10.0 * scale;
        let to = 10.0 * scale;
        model.inputs[0].terms[0].shape = Shape::Ramp { from: to, to: 0.0 };
        model.inputs[0].terms[1].shape = Shape::Gaussian {
            mean: to,
            deviation: 3.0 * scale,
        };
        model.outputs[0].range = 0.0..=100.0 * scale;
        model.outputs[0].terms[1].conclusion = Conclusion::Linear {
            coefficients: vec![10.0],
            constant: scale,
        };
        let lowered = lower(&model).unwrap();
        let exact = Exact::new(&model);
        for i in 0..=50 {
            let x = [f64::from(i) * 0.2 * scale];
            let (wanted, found) = (exact.evaluate(&x), lowered.evaluate(&x));
            let error = wanted.outputs[0].unwrap() - found.outputs[0].unwrap();
            assert!(error.abs() < 1e-3 * 100.0 * scale, "{scale}: {error}");
        }
    }
}

/// The small system with its two rules so many times.
fn crowd(pairs: usize, change: impl Fn(&mut System)) -> System {
    let mut model = small();
    model.outputs[0].terms[1].conclusion = Conclusion::Constant(100.0);
    change(&mut model);
    let rules = model.blocks[0].rules.clone();
    model.blocks[0].rules = (0..pairs).flat_map(|_| rules.clone()).collect();
    model
}

/// Its output becomes a centroid of sums over these sets.
fn sets(model: &mut System, off: Shape, on: Shape) {
    let output = &mut model.outputs[0];
    output.defuzzifier = Defuzzifier::Centroid {
        points: 200,
        sampling: Sampling::Middles,
    };
    output.terms[0].conclusion = Conclusion::Set(off);
    output.terms[1].conclusion = Conclusion::Set(on);
}

#[test]
fn thousands_of_rules_have_a_fixed_point() {
    let ramp = |from, to| Shape::Ramp { from, to };
    let numbers = crowd(2048, |model| {
        // As large as numbers get: with finer steps the sums would overflow.
        model.outputs[0].range = 0.0..=8192.0;
        model.outputs[0].terms[1].conclusion = Conclusion::Constant(8192.0);
    });
    let crossing = crowd(1023, |model| {
        sets(model, ramp(100.0, 0.0), ramp(0.0, 100.0));
    });
    // 4,096 rules, but at no sample more than half of them.
    let apart = crowd(2047, |model| {
        sets(model, ramp(50.0, 0.0), ramp(50.0, 100.0));
    });
    for model in [numbers, crossing, apart] {
        let (lowered, exact) = (lower(&model).unwrap(), Exact::new(&model));
        let range = model.outputs[0].range.end();
        for x in [0.0, 0.1, 2.5, 5.0, 9.9, 10.0] {
            let value = |of: &dyn Evaluator| of.evaluate(&[x]).outputs[0].unwrap();
            let off = (value(&exact) - value(&lowered)).abs();
            assert!(off < 2e-5 * range, "{x}: {off} of {range}");
        }
    }
    let flat = || ramp(-2.0, -1.0);
    let too_many = crowd(1024, |model| sets(model, flat(), flat()));
    assert_eq!(
        lower(&too_many).unwrap_err().to_string(),
        "line 7, column 3: the output `fan` is concluded by 2048 rules whose sets are added: 2047 are possible at one place, \
         those of overlapping sets together, or any number where the largest counts"
    );
    let largest = crowd(1024, |model| {
        sets(model, flat(), flat());
        model.outputs[0].merge = Merge::Max;
    });
    assert!(lower(&largest).is_ok());
}

#[test]
fn the_rules_that_count_make_the_same_integers() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let (mut centroids, mut silent) = (0, 0);
    for _ in 0..300 {
        let model = random::system(&mut rng);
        let Ok(lowered) = lower(&model) else { continue };
        let points: Vec<Vec<f64>> = (0..30)
            .map(|_| {
                let inputs = model.inputs.iter().map(|input| &input.range);
                let at = |range: &std::ops::RangeInclusive<f64>| {
                    let place: f64 = rng.random_range(-0.05..=1.05);
                    range.start() + place * (range.end() - range.start())
                };
                inputs.map(at).collect()
            })
            .collect();
        lowered.open(|fixed| {
            fixed.firing(|quick| {
                for point in &points {
                    let whole = fixed.evaluate(point);
                    assert_eq!(quick.evaluate(point), whole, "{model:?} at {point:?}");
                    silent += usize::from(whole.rules.iter().all(|degree| *degree == 0.0));
                }
            });
        });
        let mut outputs = model.outputs.iter();
        centroids +=
            usize::from(outputs.any(|o| matches!(o.defuzzifier, Defuzzifier::Centroid { .. })));
    }
    assert!(centroids > 50 && silent > 50, "{centroids}, {silent}");
}

/// All rules' conclusions together, in ranges of the output: 2^30 where the coarsest steps cut the range into 256, down to half
/// of that where they cut it into almost 512.
#[test]
fn a_weighted_average_of_too_large_numbers_is_refused() {
    let times = |number: f64, range: f64| {
        let model = crowd(2048, |model| {
            model.outputs[0].range = 0.0..=range;
            model.outputs[0].clamp = true;
            model.outputs[0].terms[1].conclusion = Conclusion::Constant(number * range);
        });
        lower(&model).map(|lowered| lowered.tables().outputs[0].format.fraction)
    };
    // 2048 = 2^11 of the 4096 rules conclude it.
    let most = f64::from(1 << 19);
    assert_eq!(times(most - 1.0, 1.0), Ok(8));
    assert_eq!(
        times(most, 1.0).unwrap_err().to_string(),
        "line 7, column 3: the conclusions of the output `fan`'s 4096 rules are too large for its range: fewer rules, or \
         conclusions nearer to the range, are possible"
    );
    assert_eq!(times(most / 2.0, 511.0 / 256.0), Ok(8));
    assert!(times(most / 1.99, 511.0 / 256.0).is_err());
}

#[test]
fn what_does_not_fit_is_named_with_its_place() {
    let message = |change: &dyn Fn(&mut System)| {
        let mut model = small();
        change(&mut model);
        lower(&model).unwrap_err().to_string()
    };
    assert_eq!(
        message(&|model| model.inputs[0].range = 1e6..=1e6 + 1e-3),
        "line 7, column 3: the input `heat` does not fit: its largest number is more than two million times as large as \
         its range is wide"
    );
    assert_eq!(
        message(&|model| model.outputs[0].terms[0].conclusion = Conclusion::Constant(1e12)),
        "line 7, column 3: the output `fan` does not fit: its largest number is more than two million times as large as \
         its range is wide"
    );
    let centroid = |points| Defuzzifier::Centroid {
        points,
        sampling: Sampling::Ends,
    };
    assert_eq!(
        message(&|model| model.outputs[0].defuzzifier = centroid(1025)),
        "line 7, column 3: the output `fan` is sampled at 1025 points: 2 to 1024 are possible"
    );
    assert_eq!(
        message(&|model| model.outputs[0].defuzzifier = centroid(100)),
        "line 7, column 3: the term `off` does not fit: a centroid takes sets"
    );
    assert_eq!(
        message(&|model| {
            let term = &mut model.outputs[0].terms[0];
            term.conclusion = Conclusion::Set(Shape::Singleton(0.0));
        }),
        "line 7, column 3: the term `off` does not fit: a weighted average takes numbers"
    );
    let is = |term| Antecedent::Is {
        input: 0,
        term,
        negated: false,
    };
    let either = Antecedent::Or(vec![is(0), is(1)]);
    assert_eq!(
        message(&|model| {
            let rule = &mut model.blocks[0].rules[0];
            rule.antecedent = Antecedent::And(vec![either.clone(); 12]);
        }),
        "line 7, column 3: the rule, written as OR of ANDs, asks 4608 times for a term: 4096 are possible"
    );
    assert_eq!(
        message(&|model| model.blocks[0].rules[0].antecedent = is(300)),
        "line 7, column 3: the rule asks for term 301 of input 1: 4 inputs with 255 terms are possible"
    );
    assert_eq!(
        message(&|model| model.blocks[0].rules[0].conclusions = vec![(0, 300)]),
        "line 7, column 3: the rule concludes term 301 of output 1: 255 outputs with 255 terms are possible"
    );
    // What the library itself finds.
    let mut model = small();
    model.inputs = vec![model.inputs[0].clone(); 5];
    assert!(matches!(lower(&model), Err(LowerError::Flawed(_))));
}
