//! How far a rule may be off in a box, from how far its terms may be.

use super::DEGREE;
use super::along::Cell;
use crate::fuzzy::evaluate::conjoined;
use crate::fuzzy::model::{Antecedent, Conjunction, Rule, RuleBlock};

/// A degree's least and greatest value in a box, and how far fixed point may be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The least.
    pub low: f64,
    /// The greatest.
    pub high: f64,
    /// How far.
    pub error: f64,
}

impl Spread {
    /// Zero everywhere.
    pub const NONE: Self = Self {
        low: 0.0,
        high: 0.0,
        error: 0.0,
    };

    /// What is zero everywhere is so in fixed point.
    fn settled(self) -> Self {
        if self.high <= 0.0 { Self::NONE } else { self }
    }
}

/// A rule's, its weight with it.
pub fn of_rule(rule: &Rule, block: &RuleBlock, place: &[Cell]) -> Spread {
    let antecedent = of_antecedent(&rule.antecedent, block.and, place);
    let rounding = if rule.weight < 1.0 { DEGREE } else { 0.0 };
    Spread {
        low: antecedent.low * rule.weight,
        high: antecedent.high * rule.weight,
        error: antecedent.error * rule.weight + rounding,
    }
    .settled()
}

fn of_antecedent(antecedent: &Antecedent, and: Conjunction, place: &[Cell]) -> Spread {
    match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            let spread = place[*input].terms[*term];
            let turned = Spread {
                low: 1.0 - spread.high,
                high: 1.0 - spread.low,
                ..spread
            };
            if *negated { turned } else { spread }.settled()
        }
        Antecedent::And(parts) => {
            let whole = Spread {
                low: 1.0,
                high: 1.0,
                error: 0.0,
            };
            let all = parts.iter().map(|part| of_antecedent(part, and, place));
            all.fold(whole, |a, b| Spread {
                low: conjoined(and, a.low, b.low),
                high: conjoined(and, a.high, b.high),
                error: match and {
                    Conjunction::Min => a.error.max(b.error),
                    Conjunction::Product => {
                        a.error * (b.high + b.error).min(1.0) + b.error * a.high + DEGREE
                    }
                },
            })
            .settled()
        }
        Antecedent::Or(parts) => {
            let any = parts.iter().map(|part| of_antecedent(part, and, place));
            any.fold(Spread::NONE, |a, b| Spread {
                low: a.low.max(b.low),
                high: a.high.max(b.high),
                error: a.error.max(b.error),
            })
        }
    }
}
