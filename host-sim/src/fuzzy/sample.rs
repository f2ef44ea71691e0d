//! Small systems for the tests of this folder.

use super::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Shape, System, Term,
};

/// A fan: three terms of temperature (18, 24, 32 °C of 0 to 40) by two of humidity (30, 80 % of 0 to 100), a complete
/// table; its speed 0, 40 or 100 %.
pub fn fan() -> System {
    let term = |name: &str, shape| Term {
        name: name.to_owned(),
        shape,
        place: Place::default(),
    };
    let input = |name: &str, end: f64, terms| Input {
        name: name.to_owned(),
        description: String::new(),
        range: 0.0..=end,
        clamp: true,
        terms,
        place: Place::default(),
    };
    let speed = |name: &str, value| OutputTerm {
        name: name.to_owned(),
        conclusion: Conclusion::Constant(value),
        place: Place::default(),
    };
    let table = [[0, 0], [0, 1], [1, 2]];
    let cells = (0..3).flat_map(|row| (0..2).map(move |col| (row, col)));
    System {
        name: "fan".to_owned(),
        description: String::new(),
        inputs: vec![
            input(
                "temperature",
                40.0,
                vec![
                    term(
                        "low",
                        Shape::Ramp {
                            from: 24.0,
                            to: 18.0,
                        },
                    ),
                    term(
                        "mid",
                        Shape::Triangle {
                            left: 18.0,
                            peak: 24.0,
                            right: 32.0,
                        },
                    ),
                    term(
                        "high",
                        Shape::Ramp {
                            from: 24.0,
                            to: 32.0,
                        },
                    ),
                ],
            ),
            input(
                "humidity",
                100.0,
                vec![
                    term(
                        "low",
                        Shape::Ramp {
                            from: 80.0,
                            to: 30.0,
                        },
                    ),
                    term(
                        "high",
                        Shape::Ramp {
                            from: 30.0,
                            to: 80.0,
                        },
                    ),
                ],
            ),
        ],
        outputs: vec![Output {
            name: "speed".to_owned(),
            description: String::new(),
            range: 0.0..=100.0,
            clamp: true,
            default: None,
            defuzzifier: Defuzzifier::WeightedAverage,
            merge: Merge::Sum,
            terms: vec![speed("off", 0.0), speed("half", 40.0), speed("full", 100.0)],
            place: Place::default(),
        }],
        blocks: vec![RuleBlock {
            name: String::new(),
            description: String::new(),
            and: Conjunction::Min,
            implication: Conjunction::Min,
            rules: cells
                .map(|(row, col)| {
                    rule(&[(0, row, false), (1, col, false)], &[(0, table[row][col])])
                })
                .collect(),
        }],
    }
}

/// A rule of (input, term, negated), joined by AND, and of (output, term).
pub fn rule(antecedent: &[(usize, usize, bool)], conclusions: &[(usize, usize)]) -> Rule {
    let mut parts: Vec<Antecedent> = antecedent
        .iter()
        .map(|&(input, term, negated)| Antecedent::Is {
            input,
            term,
            negated,
        })
        .collect();
    Rule {
        antecedent: if parts.len() == 1 {
            parts.remove(0)
        } else {
            Antecedent::And(parts)
        },
        conclusions: conclusions.to_vec(),
        weight: 1.0,
        place: Place::default(),
    }
}
