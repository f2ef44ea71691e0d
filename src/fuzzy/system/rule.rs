//! Rules: IF terms of the inputs THEN terms of the outputs.

use super::Degree;

/// A conjunction of degrees; as an implication, what a rule's degree does to the set that it concludes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// The smaller one; the set is cut off.
    Min,
    /// The product; the set is scaled.
    Product,
}

/// An input is, or is not, a term: the input's place among the inputs, and the term's among its terms, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Literal {
    /// It is.
    Is(u8, u8),
    /// It is not: one minus the degree.
    IsNot(u8, u8),
}

/// A rule.
///
/// ```
/// use fuzzypilot::fuzzy::system::{Degree, Literal::{Is, IsNot}, Rule};
///
/// const TEMPERATURE: u8 = 0;
/// const HOT: u8 = 2;
/// const HUMIDITY: u8 = 1;
/// const DRY: u8 = 0;
/// const FAN: u8 = 0;
/// const FAST: u8 = 3;
/// // IF temperature is hot AND humidity is not dry THEN fan is fast, half as much as other rules.
/// const RULE: Rule = Rule::new(&[&[Is(TEMPERATURE, HOT), IsNot(HUMIDITY, DRY)]], &[(FAN, FAST)])
///     .weighted(Degree::lit("0.5"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rule<'a> {
    /// Any of these (OR, the largest degree), each of them all of its literals (AND). Neither is empty.
    pub when: &'a [&'a [Literal]],
    /// Places of an output and of one of its terms, from 0; each output once at most.
    pub then: &'a [(u8, u8)],
    /// Multiplies the degree.
    pub weight: Degree,
}

impl<'a> Rule<'a> {
    /// A rule of full weight.
    pub const fn new(when: &'a [&'a [Literal]], then: &'a [(u8, u8)]) -> Self {
        Self {
            when,
            then,
            weight: Degree::ONE,
        }
    }

    /// The same with this weight.
    pub const fn weighted(self, weight: Degree) -> Self {
        Self { weight, ..self }
    }
}

/// Rules that share their operators. OR is always the largest degree.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// AND.
    pub and: Norm,
    /// What a degree does to a set; nothing to a number.
    pub implication: Norm,
    /// The rules.
    pub rules: &'a [Rule<'a>],
}

impl<'a> Block<'a> {
    /// Rules with the minimum for AND and implication.
    pub const fn min(rules: &'a [Rule<'a>]) -> Self {
        Self {
            and: Norm::Min,
            implication: Norm::Min,
            rules,
        }
    }

    /// Rules with the product for AND and implication.
    pub const fn product(rules: &'a [Rule<'a>]) -> Self {
        Self {
            and: Norm::Product,
            implication: Norm::Product,
            rules,
        }
    }
}
