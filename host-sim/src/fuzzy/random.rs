//! Random systems for tests: every shape, operator, merge and defuzzifier that the model has, the same for the same
//! generator and seed.

use super::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Sampling, Shape, System, Term,
};
use rand::{Rng, RngExt};
use std::ops::RangeInclusive;

/// A system of one to four inputs and one to three outputs. Half of its inputs are partitioned without a gap, half have terms
/// anywhere; its rules are a complete table or a heap of expressions.
pub fn system(rng: &mut impl Rng) -> System {
    let inputs: Vec<Input> = (0..rng.random_range(1..=4))
        .map(|i| input(rng, i))
        .collect();
    let outputs: Vec<Output> = (0..rng.random_range(1..=3))
        .map(|i| output(rng, i, inputs.len()))
        .collect();
    let blocks = (0..if rng.random_bool(0.2) { 2 } else { 1 })
        .map(|i| RuleBlock {
            name: format!("rules{i}"),
            description: String::new(),
            and: conjunction(rng),
            implication: conjunction(rng),
            rules: rules(rng, &inputs, &outputs),
        })
        .collect();
    System {
        name: "random".to_owned(),
        description: String::new(),
        inputs,
        outputs,
        blocks,
    }
}

/// Such a system of three or four inputs whose terms stand on whole numbers: flanks are often upright, points often jump, once
/// or twice at one value, and an input has so many knots that no grid has them all. Some have a tooth or a spike so narrow that
/// a grid sees nothing of it.
pub fn stepped(rng: &mut impl Rng) -> System {
    let mut stepped = system(rng);
    while stepped.inputs.len() < 3 {
        stepped = system(rng);
    }
    for input in &mut stepped.inputs {
        let start = rng.random_range(-20..=5);
        let range = start..=start + rng.random_range(8..=30);
        for term in &mut input.terms {
            term.shape = whole(rng, &range);
        }
        input.range = f64::from(*range.start())..=f64::from(*range.end());
    }
    stepped
}

/// A shape on whole numbers in and around a range.
fn whole(rng: &mut impl Rng, range: &RangeInclusive<i32>) -> Shape {
    let (start, end) = (*range.start(), *range.end());
    let at = |rng: &mut dyn Rng, count: usize| {
        let mut at: Vec<i32> = (0..count)
            .map(|_| rng.random_range(start - 1..=end + 1))
            .collect();
        at.sort_unstable();
        // Not all at one place: that is no triangle.
        at[count - 1] += i32::from(at[0] == at[count - 1]);
        at.into_iter().map(f64::from).collect::<Vec<f64>>()
    };
    match rng.random_range(0..6) {
        0 => {
            let at = at(rng, 3);
            Shape::Triangle {
                left: at[0],
                peak: at[1],
                right: at[2],
            }
        }
        1 => {
            let at = at(rng, 4);
            Shape::Trapezoid {
                left: at[0],
                rise: at[1],
                fall: at[2],
                right: at[3],
            }
        }
        2 => Shape::Singleton(f64::from(rng.random_range(start..=end))),
        3 => {
            let width = 10.0_f64.powf(rng.random_range(-4.0..0.0));
            let at = f64::from(rng.random_range(start + 1..end));
            let tooth = [(at - width, 0.0), (at, 1.0), (at, 0.0), (at + width, 0.0)];
            let spike = [(at - width, 0.0), (at, 0.0), (at, 1.0), (at + width, 0.0)];
            Shape::Points(if rng.random_bool(0.5) { tooth } else { spike }.to_vec())
        }
        _ => {
            let at = {
                let count = rng.random_range(3..=12);
                at(rng, count)
            };
            // Feet and shoulders more often than anything between them.
            let degree = |rng: &mut dyn Rng| [0.0, 1.0, 0.0, 1.0, 0.25][rng.random_range(0..5)];
            Shape::Points(at.into_iter().map(|x| (x, degree(rng))).collect())
        }
    }
}

fn input(rng: &mut impl Rng, index: usize) -> Input {
    let range = range(rng);
    let shapes = if rng.random_bool(0.5) {
        partition(rng, &range)
    } else {
        let count = rng.random_range(1..=5);
        (0..count).map(|_| shape(rng, &range)).collect()
    };
    let terms = shapes.into_iter().enumerate().map(|(i, shape)| Term {
        name: format!("term{i}"),
        shape,
        place: Place::default(),
    });
    Input {
        name: format!("input{index}"),
        description: String::new(),
        clamp: rng.random_bool(0.5),
        terms: terms.collect(),
        range,
        place: Place::default(),
    }
}

/// Widths from hundredths to thousands, with and without the zero inside.
fn range(rng: &mut impl Rng) -> RangeInclusive<f64> {
    let width = 10.0_f64.powf(rng.random_range(-2.0..3.0));
    let start = width * rng.random_range(-2.0..1.0);
    start..=start + width
}

/// Triangles between neighbouring peaks, or trapezoids, shoulders at both ends.
fn partition(rng: &mut impl Rng, range: &RangeInclusive<f64>) -> Vec<Shape> {
    let (start, width) = (*range.start(), range.end() - range.start());
    let count = rng.random_range(2..=5);
    let peaks: Vec<f64> = (0..count)
        .map(|i| {
            let free = if i == 0 || i + 1 == count {
                0.0
            } else {
                rng.random_range(-0.4..0.4)
            };
            start + width * (f64::from(i) + free) / f64::from(count - 1)
        })
        .collect();
    let last = peaks.len() - 1;
    let term = |i: usize| match i {
        0 => Shape::Ramp {
            from: peaks[1],
            to: peaks[0],
        },
        i if i == last => Shape::Ramp {
            from: peaks[i - 1],
            to: peaks[i],
        },
        i => Shape::Triangle {
            left: peaks[i - 1],
            peak: peaks[i],
            right: peaks[i + 1],
        },
    };
    (0..=last).map(term).collect()
}

/// A shape of any kind in and around a range.
pub fn shape(rng: &mut impl Rng, range: &RangeInclusive<f64>) -> Shape {
    any_shape(rng, range, 0.25)
}

/// Of its curves a part is `narrow`: so much that an even grid sees nothing of them.
fn any_shape(rng: &mut impl Rng, range: &RangeInclusive<f64>, narrow: f64) -> Shape {
    let (start, width) = (*range.start(), range.end() - range.start());
    let mut at = |count: usize| {
        let mut at: Vec<f64> = (0..count)
            .map(|_| start + width * rng.random_range(-0.2..1.2))
            .collect();
        at.sort_by(f64::total_cmp);
        at
    };
    let (mut three, four) = (at(3), at(4));
    let mut spread = width * rng.random_range(0.05..0.5);
    let kind = rng.random_range(0..12);
    if kind >= 7 && rng.random_bool(narrow) {
        let narrow = 10.0_f64.powf(rng.random_range(-5.0..-2.0));
        spread *= narrow;
        three[2] = three[1] + narrow * (three[2] - three[1]);
        three[0] = three[1] - narrow * (three[1] - three[0]);
    }
    let turned = rng.random_bool(0.5);
    let (from, to) = if turned {
        (three[2], three[0])
    } else {
        (three[0], three[2])
    };
    match kind {
        0 | 1 => Shape::Triangle {
            left: if rng.random_bool(0.1) {
                three[1]
            } else {
                three[0]
            },
            peak: three[1],
            right: three[2],
        },
        2 => Shape::Trapezoid {
            left: four[0],
            rise: four[1],
            fall: four[2],
            right: four[3],
        },
        3 => Shape::Trapezoid {
            left: if turned { f64::NEG_INFINITY } else { four[0] },
            rise: four[1],
            fall: four[2],
            right: if turned { four[3] } else { f64::INFINITY },
        },
        4 => Shape::Ramp { from, to },
        5 => Shape::Singleton(three[1]),
        6 => {
            let mut points: Vec<(f64, f64)> = at_degrees(rng, &four);
            if turned {
                // A step.
                points[2].0 = points[1].0;
            }
            Shape::Points(points)
        }
        7 => Shape::Gaussian {
            mean: three[1],
            deviation: spread,
        },
        8 => Shape::TwoSidedGaussian {
            left: (three[0], spread),
            right: (three[2], spread * rng.random_range(0.3..2.0)),
        },
        9 => Shape::Bell {
            centre: three[1],
            width: spread,
            slope: rng.random_range(0.7..5.0),
        },
        10 => Shape::Sigmoid {
            inflection: three[1],
            slope: if turned { -5.0 } else { 5.0 } / spread,
        },
        _ => Shape::Spline { from, to },
    }
}

fn at_degrees(rng: &mut impl Rng, at: &[f64]) -> Vec<(f64, f64)> {
    at.iter()
        .map(|&x| (x, f64::from(rng.random_range(0..=8)) / 8.0))
        .collect()
}

fn output(rng: &mut impl Rng, index: usize, inputs: usize) -> Output {
    let range = range(rng);
    let within = |rng: &mut dyn Rng| {
        let share: f64 = rng.random_range(0.0..=1.0);
        range.start() + share * (range.end() - range.start())
    };
    let mamdani = rng.random_bool(0.5);
    let linear = rng.random_bool(0.3);
    let count = rng.random_range(1..=5);
    let terms = (0..count).map(|i| {
        let conclusion = if mamdani {
            Conclusion::Set(set(rng, &range))
        } else if linear && rng.random_bool(0.5) {
            let span = range.end() - range.start();
            Conclusion::Linear {
                coefficients: (0..inputs)
                    .map(|_| span * rng.random_range(-0.1..0.1))
                    .collect(),
                constant: within(rng),
            }
        } else {
            Conclusion::Constant(within(rng))
        };
        OutputTerm {
            name: format!("term{i}"),
            conclusion,
            place: Place::default(),
        }
    });
    let terms: Vec<OutputTerm> = terms.collect();
    Output {
        name: format!("output{index}"),
        description: String::new(),
        clamp: rng.random_bool(0.5),
        default: rng.random_bool(0.5).then(|| within(rng)),
        defuzzifier: if mamdani {
            Defuzzifier::Centroid {
                points: rng.random_range(50..=200),
                sampling: if rng.random_bool(0.5) {
                    Sampling::Middles
                } else {
                    Sampling::Ends
                },
            }
        } else {
            Defuzzifier::WeightedAverage
        },
        merge: if rng.random_bool(0.5) {
            Merge::Sum
        } else {
            Merge::Max
        },
        terms,
        range,
        place: Place::default(),
    }
}

/// A shape that a centroid can use: samples miss a singleton and what is narrow.
fn set(rng: &mut impl Rng, range: &RangeInclusive<f64>) -> Shape {
    loop {
        match any_shape(rng, range, 0.0) {
            Shape::Singleton(_) => {}
            other => return other,
        }
    }
}

fn conjunction(rng: &mut impl Rng) -> Conjunction {
    if rng.random_bool(0.5) {
        Conjunction::Min
    } else {
        Conjunction::Product
    }
}

/// Most rules of a complete table.
const MOST_CELLS: usize = 150;

fn rules(rng: &mut impl Rng, inputs: &[Input], outputs: &[Output]) -> Vec<Rule> {
    let cells: usize = inputs.iter().map(|input| input.terms.len()).product();
    let antecedents: Vec<Antecedent> = if cells <= MOST_CELLS && rng.random_bool(0.5) {
        (0..cells).map(|cell| table_cell(inputs, cell)).collect()
    } else {
        let count = rng.random_range(1..=12);
        (0..count).map(|_| antecedent(rng, inputs, 2)).collect()
    };
    antecedents
        .into_iter()
        .map(|antecedent| Rule {
            antecedent,
            conclusions: conclusions(rng, outputs),
            weight: if rng.random_bool(0.7) {
                1.0
            } else {
                rng.random_range(0.0..=1.0)
            },
            place: Place::default(),
        })
        .collect()
}

fn table_cell(inputs: &[Input], mut cell: usize) -> Antecedent {
    let mut parts = Vec::new();
    for (index, input) in inputs.iter().enumerate() {
        parts.push(Antecedent::Is {
            input: index,
            term: cell % input.terms.len(),
            negated: false,
        });
        cell /= input.terms.len();
    }
    joined(parts, Antecedent::And)
}

fn joined(mut parts: Vec<Antecedent>, many: fn(Vec<Antecedent>) -> Antecedent) -> Antecedent {
    match parts.pop() {
        Some(only) if parts.is_empty() => only,
        Some(last) => {
            parts.push(last);
            many(parts)
        }
        None => many(parts),
    }
}

/// An expression at most `depth` operators deep; no AND directly in an AND, as readers make none.
fn antecedent(rng: &mut impl Rng, inputs: &[Input], depth: usize) -> Antecedent {
    let outer = rng.random_bool(0.3);
    nested(rng, inputs, depth, outer)
}

fn nested(rng: &mut impl Rng, inputs: &[Input], depth: usize, or: bool) -> Antecedent {
    if depth == 0 || rng.random_bool(0.2) {
        let input = rng.random_range(0..inputs.len());
        return Antecedent::Is {
            input,
            term: rng.random_range(0..inputs[input].terms.len()),
            negated: rng.random_bool(0.15),
        };
    }
    let parts = (0..rng.random_range(2..=3))
        .map(|_| nested(rng, inputs, depth - 1, !or))
        .collect();
    if or {
        Antecedent::Or(parts)
    } else {
        Antecedent::And(parts)
    }
}

/// A term of some outputs, of one at least, each output once.
fn conclusions(rng: &mut impl Rng, outputs: &[Output]) -> Vec<(usize, usize)> {
    let sure = rng.random_range(0..outputs.len());
    (0..outputs.len())
        .filter(|&output| output == sure || rng.random_bool(0.6))
        .collect::<Vec<_>>()
        .into_iter()
        .map(|output| (output, rng.random_range(0..outputs[output].terms.len())))
        .collect()
}
