//! From a design's model to the library's fixed point: every variable gets a number format, every shape its straight pieces,
//! every rule its literals.
//!
//! ```text
//! model::System ──lower──▶ Lowered (owned tables) ──open──▶ Fixed: fuzzypilot's System, evaluated
//! ```

mod antecedent;
mod firing;
mod format;
mod pieces;
mod set;
mod tables;

pub use format::Format;
pub use pieces::{ONE_FLANK, TWO_FLANKS, TWO_SIDES, width};
pub use tables::{Block, Claims, Defuzzifier, Input, Number, Output, Rule, Tables};

use super::evaluate::{Evaluation, Evaluator};
use super::model::{Place, Rule as ModelRule, System};
use fuzzypilot::fuzzy::system::{self, Degree, Flaw};

/// Why a model has no fixed-point form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LowerError {
    /// Something of the model is more than the engine takes.
    #[error("{}{what}: {limit}", at(*place))]
    TooMany {
        /// Where.
        place: Place,
        /// What, and how many.
        what: String,
        /// What is possible.
        limit: String,
    },
    /// A number has no place in its variable's format.
    #[error("{}{what} does not fit: {limit}", at(*place))]
    DoesNotFit {
        /// Where.
        place: Place,
        /// Whose number.
        what: String,
        /// What is possible.
        limit: String,
    },
    /// Rules conclude a set that is nothing at any sample: they would say nothing.
    #[error(
        "{}the set of the term `{term}` is zero at every one of the {samples} samples of the output `{output}`, and rules \
         conclude it",
        at(*place)
    )]
    EmptySet {
        /// Where.
        place: Place,
        /// The output.
        output: String,
        /// Its term.
        term: String,
        /// How many samples there are.
        samples: usize,
    },
    /// The tables are refused by the library's own checks.
    #[error("{0}")]
    Flawed(Flaw),
}

/// `line 3, column 7: `, or nothing for a model that no file holds.
fn at(place: Place) -> String {
    match place {
        Place { line: 0, .. } => String::new(),
        Place { line, column } => format!("line {line}, column {column}: "),
    }
}

/// A model in fixed point.
#[derive(Clone, Debug)]
pub struct Lowered {
    tables: Tables,
}

/// Lowers a model. An output whose weighted sums could overflow, of thousands of rules about large numbers, gets coarser steps.
///
/// # Errors
///
/// What does not fit, named with its place.
pub fn lower(model: &System) -> Result<Lowered, LowerError> {
    let mut coarser = vec![0; model.outputs.len()];
    loop {
        let tables = Tables::of(model, &coarser)?;
        match tables.borrowed(|system| system.map(|_| ())) {
            Ok(()) => return Ok(Lowered { tables }),
            Err(Flaw::Accumulator { output }) if may_be_coarser(&tables, model, output) => {
                coarser[output] += 1;
            }
            Err(Flaw::Accumulator { output }) => return Err(too_many_rules(model, output)),
            Err(flaw) => return Err(LowerError::Flawed(flaw)),
        }
    }
}

/// Whether coarser steps help an output's sums, and leave its range enough of them.
fn may_be_coarser(tables: &Tables, model: &System, output: usize) -> bool {
    let (table, range) = (&tables.outputs[output], &model.outputs[output].range);
    let helps = matches!(table.defuzzifier, Defuzzifier::WeightedAverage { .. });
    helps && table.format.steps(range.end() - range.start()) >= 2.0 * Format::LEAST_WIDTH
}

fn too_many_rules(model: &System, output: usize) -> LowerError {
    let concludes = |rule: &&ModelRule| rule.conclusions.iter().any(|c| c.0 == output);
    let rules = model.blocks.iter().flat_map(|block| &block.rules);
    let count = rules.filter(concludes).count();
    let output = &model.outputs[output];
    let name = &output.name;
    let (what, limit) = if matches!(
        output.defuzzifier,
        super::model::Defuzzifier::WeightedAverage
    ) {
        (
            format!(
                "the conclusions of the output `{name}`'s {count} rules are too large for its range"
            ),
            "fewer rules, or conclusions nearer to the range, are possible",
        )
    } else {
        (
            format!("the output `{name}` is concluded by {count} rules whose sets are added"),
            "2047 are possible at one place, those of overlapping sets together, or any number where the largest counts",
        )
    };
    LowerError::TooMany {
        place: output.place,
        what,
        limit: limit.into(),
    }
}

impl Lowered {
    /// The tables, as a generator of code wants them.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Opens it for many evaluations.
    pub fn open<R>(&self, use_it: impl FnOnce(Fixed<'_>) -> R) -> R {
        self.tables.borrowed(|system| {
            let system = system.expect("it was checked when it was lowered");
            use_it(Fixed {
                tables: &self.tables,
                system,
            })
        })
    }
}

impl Evaluator for Lowered {
    fn evaluate(&self, inputs: &[f64]) -> Evaluation {
        self.open(|fixed| fixed.evaluate(inputs))
    }
}

/// A lowered model, opened.
#[derive(Clone, Copy, Debug)]
pub struct Fixed<'a> {
    tables: &'a Tables,
    system: system::System<'a>,
}

impl<'a> Fixed<'a> {
    /// The library's system.
    pub fn system(&self) -> &system::System<'a> {
        &self.system
    }

    /// Evaluates it in the variables' own steps: the outputs, and every rule's degree.
    ///
    /// # Panics
    ///
    /// With another number of inputs than the system's.
    pub fn steps(&self, inputs: &[i32]) -> (Vec<i32>, Vec<Degree>) {
        steps(&self.system, inputs)
    }

    /// Evaluates it in the variables' units, by `evaluate` in their steps. Inputs are rounded to their formats; one that is
    /// missing or NaN has no fixed-point form: then no rule fires.
    fn by(
        &self,
        inputs: &[f64],
        evaluate: impl FnOnce(&[i32]) -> (Vec<i32>, Vec<Degree>),
    ) -> Evaluation {
        let formats = self.tables.inputs.iter().map(|input| input.format);
        let steps: Option<Vec<i32>> = formats
            .enumerate()
            .map(|(i, format)| {
                let value = inputs.get(i).copied().filter(|value| !value.is_nan())?;
                Some(format.nearest(value))
            })
            .collect();
        let (outputs, rules) = match steps {
            Some(steps) => evaluate(&steps),
            None => (
                self.system.outputs().iter().map(|o| o.default).collect(),
                vec![Degree::ZERO; self.system.rule_count()],
            ),
        };
        let values = self.tables.outputs.iter().zip(outputs);
        Evaluation {
            outputs: values
                .map(|(output, value)| Some(output.format.value(value)))
                .collect(),
            rules: rules
                .into_iter()
                .map(|degree| f64::from(degree.bits()) / f64::from(Degree::ONE.bits()))
                .collect(),
        }
    }
}

impl Evaluator for Fixed<'_> {
    /// Inputs are rounded to their formats; one that is missing or NaN has no fixed-point form: then no rule fires.
    fn evaluate(&self, inputs: &[f64]) -> Evaluation {
        self.by(inputs, |inputs| self.steps(inputs))
    }
}

/// The library's evaluation in memory of the right sizes: the outputs, and every rule's degree.
fn steps(system: &system::System<'_>, inputs: &[i32]) -> (Vec<i32>, Vec<Degree>) {
    let mut terms = vec![Degree::ZERO; system.term_count()];
    let mut rules = vec![Degree::ZERO; system.rule_count()];
    let mut outputs = vec![0; system.outputs().len()];
    system
        .evaluate(inputs, &mut terms, &mut rules, &mut outputs)
        .expect("one value an input");
    (outputs, rules)
}

#[cfg(test)]
mod tests;
