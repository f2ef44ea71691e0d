//! `RuleBlock` and its rules.

use super::{Component, GRAMMAR, OTHER_DISJUNCTIONS};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::conditions::{Names, WrittenRule, rule};
use crate::fuzzy::files::error::{ReadError, Source, one_of};
use crate::fuzzy::files::limits;
use crate::fuzzy::files::norms::{ALLOWED_AND, ALLOWED_OR, Norm, Used, concludes_set};
use crate::fuzzy::model::{Conjunction, RuleBlock, System};

/// FuzzyLite's other conjunctions.
const OTHER_CONJUNCTIONS: &[&str] = &[
    "BoundedDifference",
    "DrasticProduct",
    "EinsteinProduct",
    "HamacherProduct",
    "NilpotentMinimum",
    "TNormFunction",
];

/// FuzzyLite's ways to let some rules fire only.
const OTHER_ACTIVATIONS: &[&str] = &[
    "First",
    "Highest",
    "Last",
    "Lowest",
    "Proportional",
    "Threshold",
];

const CONJUNCTIONS: &[(&str, Conjunction)] = &[
    ("Minimum", Conjunction::Min),
    ("AlgebraicProduct", Conjunction::Product),
];

pub(super) struct WrittenBlock<'s> {
    name: &'s str,
    description: String,
    and: Norm<'s, Conjunction>,
    or: Norm<'s, ()>,
    implication: Norm<'s, Conjunction>,
    rules: Vec<WrittenRule<'s>>,
}

impl<'s> Component<'s, '_> {
    /// A rule block, if it is enabled.
    pub(super) fn block(self) -> Result<Option<WrittenBlock<'s>>, ReadError> {
        self.keys(&[
            "description",
            "enabled",
            "conjunction",
            "disjunction",
            "implication",
            "activation",
            "rule",
        ])?;
        let enabled = self.flag("enabled", true)?;
        if let Some(property) = self.property("activation").filter(|p| !p.value.is_empty()) {
            self.value(property, "the end of the line", |cursor| {
                let known = [("General", ()), ("none", ())];
                self.operator(cursor, "activation", &known, OTHER_ACTIVATIONS)
            })?;
        }
        let mut rules = Vec::new();
        for property in self.component.properties.iter().filter(|p| p.key == "rule") {
            rules.push(self.value(*property, "", |cursor| {
                let rule = rule(cursor, self.source, &GRAMMAR)?;
                cursor.end(match rule.weight {
                    Some(_) => "the end of the line",
                    None => "`and`, `with` or the end of the line",
                })?;
                Ok(rule)
            })?);
            checks::count(
                self.source,
                property.place,
                "rules",
                rules.len(),
                limits::RULES,
            )?;
        }
        let block = WrittenBlock {
            name: self.component.head.value,
            description: self.description(),
            and: self.norm("conjunction", CONJUNCTIONS, OTHER_CONJUNCTIONS)?,
            or: self.norm("disjunction", &[("Maximum", ())], OTHER_DISJUNCTIONS)?,
            implication: self.norm("implication", CONJUNCTIONS, OTHER_CONJUNCTIONS)?,
            rules,
        };
        Ok(enabled.then_some(block))
    }

    /// An operator that may be none. One that is not supported matters only where it is used.
    fn norm<T: Copy>(
        self,
        key: &'static str,
        known: &[(&str, T)],
        others: &[&str],
    ) -> Result<Norm<'s, T>, ReadError> {
        let Some(property) = self.property(key).filter(|p| !p.value.is_empty()) else {
            return Ok(Norm::None);
        };
        self.value(property, "the end of the line", |cursor| {
            let token = cursor.peek();
            if cursor.eat_word("none") {
                return Ok(Norm::None);
            }
            if others.contains(&token.text) {
                cursor.take();
                return Ok(Norm::Other(token));
            }
            let mut allowed: Vec<&str> = known.iter().map(|(k, _)| *k).collect();
            allowed.push("none");
            match cursor.choice("", known) {
                Ok((_, norm)) => Ok(Norm::Known(norm)),
                Err(_) => Err(cursor.unexpected(one_of(allowed))),
            }
        })
    }
}

impl WrittenBlock<'_> {
    pub(super) fn resolve(
        &self,
        source: Source<'_>,
        system: &System,
    ) -> Result<RuleBlock, ReadError> {
        let used = Used::by(&self.rules);
        let and = self
            .and
            .used(source, "conjunction", used.and, ALLOWED_AND)?;
        self.or.used(source, "disjunction", used.or, ALLOWED_OR)?;
        let and = and.unwrap_or(Conjunction::Min);
        let names = Names {
            inputs: &system.inputs,
            outputs: &system.outputs,
        };
        let rules = self
            .rules
            .iter()
            .map(|rule| rule.resolve(source, names, and))
            .collect::<Result<Vec<_>, _>>()?;
        let set = concludes_set(&rules, &system.outputs);
        let implication = self
            .implication
            .used(source, "implication", set, ALLOWED_AND)?;
        Ok(RuleBlock {
            name: self.name.to_owned(),
            description: self.description.clone(),
            and,
            implication: implication.unwrap_or(Conjunction::Min),
            rules,
        })
    }
}
