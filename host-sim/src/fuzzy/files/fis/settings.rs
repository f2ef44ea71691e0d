//! What `[System]` says.

use super::{Section, key, text, whole};
use crate::fuzzy::files::error::{ReadError, Source, counted, quoted};
use crate::fuzzy::files::lexer::Token;
use crate::fuzzy::files::norms::Norm;
use crate::fuzzy::model::{Conjunction, Defuzzifier, Merge, Place, Sampling};

/// Samples of MATLAB's centroid.
const SAMPLES: usize = 101;

/// What `[System]` says.
pub(super) struct Settings<'s> {
    pub(super) place: Place,
    pub(super) name: String,
    pub(super) sugeno: bool,
    pub(super) inputs: Option<(usize, Place)>,
    pub(super) outputs: Option<(usize, Place)>,
    pub(super) rules: Option<(usize, Place)>,
    pub(super) and: Norm<'s, Conjunction>,
    pub(super) or: Norm<'s, ()>,
    pub(super) implication: Norm<'s, Conjunction>,
    pub(super) aggregation: Option<Token<'s>>,
    pub(super) defuzzifier: Option<Token<'s>>,
}

const SYSTEM_KEYS: [&str; 11] = [
    "Name",
    "Type",
    "Version",
    "NumInputs",
    "NumOutputs",
    "NumRules",
    "AndMethod",
    "OrMethod",
    "ImpMethod",
    "AggMethod",
    "DefuzzMethod",
];

impl<'s> Settings<'s> {
    pub(super) fn read(source: Source<'s>, section: &Section<'s>) -> Result<Self, ReadError> {
        let mut settings = Self {
            place: section.name.place,
            name: String::new(),
            sugeno: false,
            inputs: None,
            outputs: None,
            rules: None,
            and: Norm::None,
            or: Norm::None,
            implication: Norm::None,
            aggregation: None,
            defuzzifier: None,
        };
        let mut typed = false;
        let mut keys: Vec<Token<'s>> = Vec::new();
        for line in &section.lines {
            line.read(source, "the end of the line", |cursor| {
                let key = key(source, cursor, &mut keys, &SYSTEM_KEYS)?;
                match key {
                    "Name" => settings.name = text(cursor, "a name")?.text.to_owned(),
                    "Type" => {
                        let kind = text(cursor, "a type")?;
                        settings.sugeno = match kind.text.to_ascii_lowercase().as_str() {
                            "mamdani" => false,
                            "sugeno" | "takagi-sugeno" => true,
                            _ => {
                                let found =
                                    format!("the type {} is not supported", quoted(kind.text));
                                return Err(source.error(
                                    kind.place,
                                    found,
                                    "'mamdani' or 'sugeno'",
                                ));
                            }
                        };
                        typed = true;
                    }
                    "NumInputs" => settings.inputs = Some(whole(source, cursor)?),
                    "NumOutputs" => settings.outputs = Some(whole(source, cursor)?),
                    "NumRules" => settings.rules = Some(whole(source, cursor)?),
                    "AndMethod" => settings.and = conjunction(text(cursor, "a method")?),
                    "ImpMethod" => settings.implication = conjunction(text(cursor, "a method")?),
                    "OrMethod" => {
                        let method = text(cursor, "a method")?;
                        settings.or = match method.text {
                            "max" => Norm::Known(()),
                            _ => Norm::Other(method),
                        };
                    }
                    "AggMethod" => settings.aggregation = Some(text(cursor, "a method")?),
                    "DefuzzMethod" => settings.defuzzifier = Some(text(cursor, "a method")?),
                    // A version says nothing about the system.
                    _ => {
                        cursor.number("a number")?;
                    }
                }
                Ok(())
            })?;
        }
        if !typed {
            let found = "the system has no type";
            return Err(source.error(settings.place, found, "`Type='mamdani'` or `Type='sugeno'`"));
        }
        Ok(settings)
    }

    /// That there is as much of something as was said.
    pub(super) fn counted(
        &self,
        source: Source<'_>,
        key: &str,
        said: Option<(usize, Place)>,
        found: usize,
        what: &str,
    ) -> Result<(), ReadError> {
        match said {
            Some((number, place)) if number != found => {
                let message = format!(
                    "{key} is {number}, but the file has {}",
                    counted(found, what)
                );
                Err(source.error(place, message, "as many as there are"))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn defuzzifier(&self, source: Source<'_>) -> Result<Defuzzifier, ReadError> {
        let allowed = if self.sugeno { "wtaver" } else { "centroid" };
        let Some(method) = self.defuzzifier else {
            let found = "the system has no DefuzzMethod";
            return Err(source.error(self.place, found, format!("`DefuzzMethod='{allowed}'`")));
        };
        if method.text != allowed {
            let kind = if self.sugeno { "sugeno" } else { "mamdani" };
            let found = format!(
                "the DefuzzMethod {} is not supported in a {kind} system",
                quoted(method.text)
            );
            return Err(source.error(method.place, found, format!("'{allowed}'")));
        }
        Ok(match self.sugeno {
            true => Defuzzifier::WeightedAverage,
            false => Defuzzifier::Centroid {
                points: SAMPLES,
                sampling: Sampling::Ends,
            },
        })
    }

    pub(super) fn merge(&self, source: Source<'_>) -> Result<Merge, ReadError> {
        match self.aggregation {
            _ if self.sugeno => Ok(Merge::Sum),
            Some(method) => match method.text {
                "max" => Ok(Merge::Max),
                "sum" => Ok(Merge::Sum),
                other => {
                    let found = format!("the AggMethod {} is not supported", quoted(other));
                    Err(source.error(method.place, found, "'max' or 'sum'"))
                }
            },
            None => {
                let found = "the system has no AggMethod";
                Err(source.error(self.place, found, "`AggMethod='max'` or `AggMethod='sum'`"))
            }
        }
    }
}

fn conjunction(method: Token<'_>) -> Norm<'_, Conjunction> {
    match method.text {
        "min" => Norm::Known(Conjunction::Min),
        "prod" => Norm::Known(Conjunction::Product),
        _ => Norm::Other(method),
    }
}
