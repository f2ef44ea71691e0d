//! A system with its sizes in its type.

use super::{Degree, Flaw, System};

/// A [`System`] of `I` inputs with `T` terms in all, `R` rules and `O` outputs: it brings its own memory, so nothing can
/// have a wrong size.
#[derive(Clone, Copy, Debug)]
pub struct Controller<'a, const I: usize, const T: usize, const R: usize, const O: usize> {
    system: System<'a>,
}

impl<'a, const I: usize, const T: usize, const R: usize, const O: usize>
    Controller<'a, I, T, R, O>
{
    /// From a system of these sizes. Others do not compile in a `const` or `static` (at run time they panic, so keep it in
    /// one).
    pub const fn new(system: System<'a>) -> Self {
        if system.inputs().len() != I
            || system.term_count() != T
            || system.rule_count() != R
            || system.outputs().len() != O
        {
            let text = Flaw::Sizes.text();
            panic!("{}", text.as_str());
        }
        Self { system }
    }

    /// The system.
    pub const fn system(&self) -> &System<'a> {
        &self.system
    }

    /// From inputs to outputs, each in its variable's own steps. Every number is allowed; the work is the same for all.
    #[inline]
    pub fn evaluate(&self, inputs: [i32; I]) -> Evaluation<R, O> {
        let mut terms = [Degree::ZERO; T];
        let mut rules = [Degree::ZERO; R];
        let mut outputs = [0; O];
        self.system
            .run(&inputs, &mut terms, &mut rules, &mut outputs);
        Evaluation { outputs, rules }
    }
}

/// What came out, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evaluation<const R: usize, const O: usize> {
    /// The outputs, each within its range.
    pub outputs: [i32; O],
    /// Every rule's degree, through all blocks.
    pub rules: [Degree; R],
}

impl<const R: usize, const O: usize> Evaluation<R, O> {
    /// The rules with a degree above zero: their places, through all blocks.
    pub fn fired(&self) -> impl Iterator<Item = (usize, Degree)> + '_ {
        let rules = (0..R).zip(self.rules.iter().copied());
        rules.filter(|&(_, degree)| degree > Degree::ZERO)
    }
}
