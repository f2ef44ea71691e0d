//! What a module of the fast route computes: the same tables of the library, made while this runs, so the same integers.

use super::emit::{Axis, Design, RuleBase, Table};
use super::evaluate::{Evaluation, Evaluator};
use super::lower::{Format, Lowered};
use super::model::System;
use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::U0;
use fuzzypilot::fuzzy::{
    ActiveRules, Antecedents, Consequents, Grade, MAX_TERMS, Partition, Position, RuleTable, Term,
    Twin, TwinTable,
};
use std::collections::BTreeSet;

/// Raw numbers: what their format is does not change them.
type Raw = FixedI16<U0>;
/// Both inputs' steps to the outputs' steps, and the four rules around.
type Tables = Box<dyn Fn([i32; 2]) -> (Vec<i32>, ActiveRules) + Send + Sync>;

/// A rule base, evaluated as its module evaluates it.
pub struct Fast {
    base: RuleBase,
    tables: Tables,
    inputs: [Format; 2],
}

impl Fast {
    /// Of a design that takes the route.
    ///
    /// # Errors
    ///
    /// Why it does not.
    pub fn new(system: &System, lowered: &Lowered) -> Result<Self, String> {
        let design = Design {
            system,
            lowered,
            name: "",
            command: "",
            bounds: None,
        };
        let base = design.rule_base()?;
        let inputs = &lowered.tables().inputs;
        Ok(Self {
            tables: tables(&base),
            inputs: [0, 1].map(|i| inputs[i].format),
            base,
        })
    }

    /// What it is made of.
    pub fn base(&self) -> &RuleBase {
        &self.base
    }

    /// The outputs, in the steps of [`format`](Self::format), at inputs in steps of 2⁻¹⁶.
    pub fn steps(&self, inputs: [i32; 2]) -> Vec<i32> {
        (self.tables)(inputs).0
    }

    /// An output's format, as it comes out of the module; `None` if there is no such output.
    pub fn format(&self, output: usize) -> Option<Format> {
        let table = self.base.tables.get(output)?;
        Some(Format {
            fraction: self.base.fraction(table),
        })
    }
}

impl Evaluator for Fast {
    /// Inputs are rounded to 2⁻¹⁶; with one that is missing or NaN there is no value.
    fn evaluate(&self, inputs: &[f64]) -> Evaluation {
        let value = |i: usize| inputs.get(i).copied().unwrap_or(f64::NAN);
        let values = [value(0), value(1)];
        if values.iter().any(|value| value.is_nan()) {
            return Evaluation {
                outputs: vec![None; self.base.tables.len()],
                rules: vec![0.0; self.base.rules.len()],
            };
        }
        let (outputs, active) = (self.tables)([0, 1].map(|i| self.inputs[i].nearest(values[i])));
        let outputs = outputs.into_iter().enumerate();
        let fired = active.fired();
        let degree = |&[row, column]: &[usize; 2]| {
            let this = |rule: &&fuzzypilot::fuzzy::FiredRule| {
                [usize::from(rule.row), usize::from(rule.col)] == [row, column]
            };
            let bits = fired.iter().find(this).map_or(0, |rule| rule.degree.bits());
            f64::from(bits) / f64::from(Grade::ONE.bits())
        };
        Evaluation {
            outputs: outputs
                .map(|(o, steps)| Some(self.format(o)?.value(steps)))
                .collect(),
            rules: self.base.rules.iter().map(degree).collect(),
        }
    }
}

/// The library's tables of the right sizes.
fn tables(base: &RuleBase) -> Tables {
    macro_rules! sized {
        ($($r:literal)*) => {
            match base.axes[0].peaks.len() {
                $($r => sized!(@ $r; 2 3 4 5 6 7),)*
                other => unreachable!("{other} rows"),
            }
        };
        (@ $r:literal; $($c:literal)*) => {
            match base.axes[1].peaks.len() {
                $($c => of_size::<$r, $c, { $r - 1 }>(base),)*
                other => unreachable!("{other} columns"),
            }
        };
    }
    sized!(2 3 4 5 6 7)
}

fn of_size<const R: usize, const C: usize, const GAPS: usize>(base: &RuleBase) -> Tables {
    let antecedents = Antecedents::<R, C> {
        rows: partition(&base.axes[0]),
        cols: partition(&base.axes[1]),
    };
    let tables: Vec<RuleTable<R, C, Raw>> = base.tables.iter().map(table).collect();
    if base.is_twin() {
        let twin = TwinTable::<R, C, GAPS>::new(&antecedents, &tables[0], &tables[1]);
        let axes = base.axes.clone();
        return Box::new(move |inputs| {
            let [row, column] = [0, 1].map(|i| position(&axes[i], inputs[i]));
            let Twin {
                first,
                second,
                activation,
            } = twin.evaluate(row, column);
            (vec![first, second], activation.rules())
        });
    }
    Box::new(move |inputs| {
        let [row, column] = inputs.map(I16F16::from_bits);
        let activation = antecedents.activate(row, column);
        let outputs = tables.iter();
        let outputs = outputs.map(|table| table.defuzzify(&activation).to_bits().into());
        (outputs.collect(), activation.rules())
    })
}

fn partition<const N: usize>(axis: &Axis) -> Partition<N> {
    Partition::new(std::array::from_fn(|i| I16F16::from_bits(axis.peaks[i])))
}

/// With as many terms as there may be: numbers that no rule concludes are among them, so that all have one type.
fn table<const R: usize, const C: usize>(table: &Table) -> RuleTable<R, C, Raw> {
    let mut peaks: BTreeSet<i32> = table.peaks.iter().copied().collect();
    for unused in -i32::from(i16::MAX).. {
        if peaks.len() == MAX_TERMS {
            break;
        }
        peaks.insert(unused);
    }
    let peaks: Vec<i32> = peaks.into_iter().collect();
    let raw = |peak: i32| Raw::from_bits(peak as i16);
    let terms = std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let peak = table.peaks[table.places[table.cells[r][c]]];
            Term(peaks.partition_point(|&other| other < peak) as u8)
        })
    });
    RuleTable::new(
        terms,
        Consequents::<MAX_TERMS, Raw>::new(
            [raw(peaks[0]), raw(peaks[MAX_TERMS - 1])],
            std::array::from_fn(|i| raw(peaks[i])),
        ),
    )
}

/// Where an input lies on an axis, as a module of a twin table has it: 2⁻³⁰ of it too low at most, as a product with a reciprocal
/// of 31 bits is.
fn position(axis: &Axis, x: i32) -> Position {
    let (first, last) = (axis.peaks[0], axis.peaks[axis.peaks.len() - 1]);
    let span = (i64::from(last) - i64::from(first)) as u128;
    let distance = (i64::from(x.clamp(first, last)) - i64::from(first)) as u128;
    let shift = (span as u32).leading_zeros();
    let reciprocal = (1u128 << 62) / (span << shift);
    let found = ((distance << shift) * reciprocal) >> 30;
    Position::from_bits(found.min(u128::from(u32::MAX)) as u32)
}
