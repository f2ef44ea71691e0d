//! The operators of a rule block: AND, OR and what a rule's degree does to a set. One that is not supported matters only
//! where it is used, for tools write them whether they are or not.

use super::conditions::WrittenRule;
use super::error::{ReadError, Source, quoted};
use super::lexer::Token;
use crate::fuzzy::model::{Conclusion, Output, Place, Rule};

/// An operator.
#[derive(Clone, Copy, Debug)]
pub enum Norm<'s, T> {
    /// There is none.
    None,
    /// One of those that are supported.
    Known(T),
    /// Another one, where it is named.
    Other(Token<'s>),
}

/// How FLL calls what an AND or an implication may be.
pub const ALLOWED_AND: &str = "Minimum or AlgebraicProduct";
/// How FLL calls what an OR may be.
pub const ALLOWED_OR: &str = "Maximum";

impl<T: Copy> Norm<'_, T> {
    /// The operator; an error if it is used (at the place `by`) but there is none, or none that is supported.
    pub fn used(
        self,
        source: Source<'_>,
        what: &str,
        by: Option<Place>,
        allowed: &str,
    ) -> Result<Option<T>, ReadError> {
        match (self, by) {
            (Norm::Known(norm), _) => Ok(Some(norm)),
            (_, None) => Ok(None),
            (Norm::Other(token), Some(by)) => {
                let name = quoted(token.text);
                let found = format!(
                    "the {what} {name}, which line {} uses, is not supported",
                    by.line
                );
                Err(source.error(token.place, found, allowed))
            }
            (Norm::None, Some(by)) => {
                let found = format!("the rule block has no {what}, which this needs");
                Err(source.error(by, found, allowed))
            }
        }
    }
}

/// Where rules first use AND and OR.
#[derive(Clone, Copy, Debug)]
pub struct Used {
    /// AND.
    pub and: Option<Place>,
    /// OR.
    pub or: Option<Place>,
}

impl Used {
    /// By rules.
    pub fn by(rules: &[WrittenRule<'_>]) -> Self {
        Self {
            and: rules.iter().find_map(|r| r.and).map(|t| t.place),
            or: rules.iter().find_map(|r| r.or).map(|t| t.place),
        }
    }
}

/// Where a rule first concludes a fuzzy set; an implication matters to these alone.
pub fn concludes_set(rules: &[Rule], outputs: &[Output]) -> Option<Place> {
    let set = |&(output, term): &(usize, usize)| {
        let term = outputs.get(output).and_then(|o| o.terms.get(term));
        term.is_some_and(|t| matches!(t.conclusion, Conclusion::Set(_)))
    };
    rules
        .iter()
        .find(|r| r.conclusions.iter().any(set))
        .map(|r| r.place)
}
