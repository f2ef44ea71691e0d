//! Fuzzy systems of any kind: one to four inputs, any terms and rules, any number of outputs.
//!
//! ```text
//! inputs ──Term──▶ degrees ──Rule: AND, OR, NOT, weight──▶ activations ──Defuzzifier──▶ outputs
//! ```
//!
//! Everything is borrowed tables, made while the program compiles or read from a file. [`System::new`] is for the first: what
//! is wrong with a table does not compile, and the [`Flaw`] is the message. [`System::checked`] is for the second: the flaw is
//! the error. A [`Controller`] adds the sizes to the type, and brings its own memory.
//!
//! # Numbers
//!
//! Inputs and outputs are `i32` in steps that each variable chooses for itself, up to [`LIMIT`] of them: `fixed`'s `I16F16`,
//! millimetres, whatever is wanted. Degrees have 24 bits ([`Degree`]), sampled sets 15 ([`Grade`](super::Grade)). With
//! triangles, trapezoids and singletons, an output whose conclusions lie in its range is within 1.2·10⁻⁴ of it where a rule fires
//! with a tenth at least, and 99 of 100 are within 1.3·10⁻⁵: so it was measured on hundreds of random systems, whose terms are
//! spread over their ranges; a flank of a hundredth of its range is ten times as far off. Linear conclusions
//! that reach far beyond the range multiply that (1.1·10⁻³ was the most, 99 of 100 were within 2·10⁻⁴); curves add the error that [`shape`] states (99 of 100 within 3·10⁻⁴). Where nothing but the far tails of curves
//! fires, a quotient of small degrees is less exact; below half a step of a degree nothing fires, and the output takes its
//! default.
//!
//! # Proofs
//!
//! | claim | proven by |
//! |---|---|
//! | every input has a term everywhere in its range, if it says that it is complete | [`Flaw::Gap`] |
//! | every combination of terms has a rule, if an output says that it is complete | [`Flaw::Hole`] |
//! | points ascend and pieces meet | [`Flaw::Pieces`] |
//! | rules ask for and conclude what there is | [`Flaw::UnknownTerm`] and its like |
//! | outputs stay in their ranges: what is concluded does, or the output is limited | [`Flaw::OutOfRange`], [`Flaw::SampleRange`], [`Flaw::Default`] |
//! | every set that a rule concludes is something at one of the samples | [`Flaw::EmptySet`] |
//! | sums cannot overflow, whatever fires | [`Flaw::Accumulator`] |
//! | division by zero cannot happen | by construction: where Σ w is zero the default holds |
//! | the work does not depend on the inputs | by construction; instructions are counted on three cores |
//!
//! # Example: a fan
//!
//! ```
//! use fixed::types::I16F16;
//! use fuzzypilot::fuzzy::system::shape::{ramp, triangle};
//! use fuzzypilot::fuzzy::system::{
//!     Block, Controller, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule, System,
//! };
//!
//! /// A number in steps of 2^-16.
//! const fn q(text: &str) -> i32 {
//!     I16F16::lit(text).to_bits()
//! }
//!
//! const TEMPERATURE: u8 = 0; // °C
//! const COLD: u8 = 0;
//! const MILD: u8 = 1;
//! const HOT: u8 = 2;
//!
//! const HUMIDITY: u8 = 1; // %
//! const DRY: u8 = 0;
//! const DAMP: u8 = 1;
//!
//! const FAN: u8 = 0; // % of its speed
//! const OFF: u8 = 0;
//! const SLOW: u8 = 1;
//! const FAST: u8 = 2;
//!
//! static FAN_CONTROL: Controller<2, 5, 4, 1> = Controller::new(System::new(
//!     &[
//!         Input::new([q("0"), q("50")], &[
//!             /* COLD */ &ramp(q("24"), q("18")),
//!             /* MILD */ &triangle(q("18"), q("24"), q("32")),
//!             /* HOT  */ &ramp(q("24"), q("32")),
//!         ]),
//!         Input::new([q("0"), q("100")], &[
//!             /* DRY  */ &ramp(q("80"), q("30")),
//!             /* DAMP */ &ramp(q("30"), q("80")),
//!         ]),
//!     ],
//!     &[Block::min(&[
//!         Rule::new(&[&[Is(TEMPERATURE, COLD)]], &[(FAN, OFF)]),
//!         Rule::new(&[&[Is(TEMPERATURE, MILD), Is(HUMIDITY, DRY)]], &[(FAN, OFF)]),
//!         Rule::new(&[&[Is(TEMPERATURE, MILD), Is(HUMIDITY, DAMP)]], &[(FAN, SLOW)]),
//!         Rule::new(&[&[Is(TEMPERATURE, HOT)]], &[(FAN, FAST)]),
//!     ])],
//!     &[Output {
//!         range: [q("0"), q("100")],
//!         clamp: false,
//!         default: q("0"),
//!         complete: true,
//!         defuzzifier: Defuzzifier::WeightedAverage {
//!             merge: Merge::Sum,
//!             terms: &[Constant(q("0")), Constant(q("40")), Constant(q("100"))],
//!         },
//!     }],
//! ));
//!
//! let now = FAN_CONTROL.evaluate([q("28"), q("80")]);
//! assert_eq!(now.outputs, [q("70")]);
//! assert_eq!(now.fired().map(|(rule, _)| rule).collect::<Vec<_>>(), [2, 3]);
//! ```

mod arithmetic;
mod check;
mod controller;
mod curve;
mod degree;
mod evaluate;
mod exponential;
mod flaw;
mod input;
mod output;
mod piece;
mod rule;
pub mod shape;

pub use controller::{Controller, Evaluation};
pub use degree::Degree;
pub use evaluate::MAX_INPUTS;
pub use flaw::{Flaw, Text};
pub use input::Input;
pub use output::{Defuzzifier, Linear, Merge, Number, Output, Samples, Set};
pub use piece::{LIMIT, Piece, Term};
pub use rule::{Block, Literal, Norm, Rule};

use core::fmt;

/// A fuzzy system: checked tables.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    inputs: &'a [Input<'a>],
    blocks: &'a [Block<'a>],
    outputs: &'a [Output<'a>],
    /// Of each input, among the terms of all.
    first_terms: [u16; MAX_INPUTS],
    terms: usize,
    rules: usize,
}

impl<'a> System<'a> {
    /// From its tables, for a `const` or `static`: what has a [`Flaw`] does not compile, and the flaw is the message. (At
    /// run time it panics: see [`System::checked`].)
    pub const fn new(
        inputs: &'a [Input<'a>],
        blocks: &'a [Block<'a>],
        outputs: &'a [Output<'a>],
    ) -> Self {
        match Self::checked(inputs, blocks, outputs) {
            Ok(system) => system,
            Err(flaw) => {
                let text = flaw.text();
                panic!("{}", text.as_str())
            }
        }
    }

    /// From its tables: one to four inputs, rules in blocks that share their operators, outputs.
    ///
    /// # Errors
    ///
    /// The first [`Flaw`] that is found.
    pub const fn checked(
        inputs: &'a [Input<'a>],
        blocks: &'a [Block<'a>],
        outputs: &'a [Output<'a>],
    ) -> Result<Self, Flaw> {
        if let Err(flaw) = check::check(inputs, blocks, outputs) {
            return Err(flaw);
        }
        let mut first_terms = [0; MAX_INPUTS];
        let mut terms = 0;
        let mut i = 0;
        while i < inputs.len() && i < MAX_INPUTS {
            first_terms[i] = terms as u16;
            terms += inputs[i].terms.len();
            i += 1;
        }
        Ok(Self {
            inputs,
            blocks,
            outputs,
            first_terms,
            terms,
            rules: check::rule_count(blocks),
        })
    }

    /// The inputs.
    pub const fn inputs(&self) -> &'a [Input<'a>] {
        self.inputs
    }

    /// The rules, in blocks.
    pub const fn blocks(&self) -> &'a [Block<'a>] {
        self.blocks
    }

    /// The outputs.
    pub const fn outputs(&self) -> &'a [Output<'a>] {
        self.outputs
    }

    /// How many terms the inputs have in all.
    pub const fn term_count(&self) -> usize {
        self.terms
    }

    /// How many rules there are in all blocks.
    pub const fn rule_count(&self) -> usize {
        self.rules
    }

    /// Evaluates a system whose sizes are known at run time only, in memory that is given: a value for each input, a
    /// degree for each of the inputs' terms and for each rule, a value for each output. A [`Controller`] brings its own.
    ///
    /// # Errors
    ///
    /// [`WrongSize`] if one of them has another length; nothing is written then.
    pub fn evaluate(
        &self,
        inputs: &[i32],
        terms: &mut [Degree],
        rules: &mut [Degree],
        outputs: &mut [i32],
    ) -> Result<(), WrongSize> {
        if inputs.len() != self.inputs.len()
            || terms.len() != self.terms
            || rules.len() != self.rules
            || outputs.len() != self.outputs.len()
        {
            return Err(WrongSize);
        }
        self.run(inputs, terms, rules, outputs);
        Ok(())
    }
}

/// Memory or inputs of another size than the system's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongSize;

impl fmt::Display for WrongSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the system has another number of inputs, terms, rules or outputs")
    }
}

impl core::error::Error for WrongSize {}
