//! Rule tables whose conclusions do not run in one direction: along a row or a column they rise and fall again. That may
//! be meant (a deflection that is greatest in the middle), or be a slip of one cell.

use super::accuracy::FAINTEST;
use crate::fuzzy::evaluate::{rules, samples};
use crate::fuzzy::model::{Antecedent, Conclusion, Input, Output, System};
use crate::fuzzy::picture;
use std::collections::BTreeMap;

/// Where the conclusions turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Index of the output.
    pub output: usize,
    /// Index of the input along which it was looked.
    pub along: usize,
    /// The other input's index and term, if there is one.
    pub held: Option<(usize, usize)>,
    /// Terms of `along` before, at and behind the turn, with what is concluded there.
    pub cells: [(usize, f64); 3],
}

/// Why an output has no table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoTable {
    /// No rule concludes anything about it.
    NoRule,
    /// More inputs than rows and columns.
    Inputs,
    /// A rule with an OR, by its index.
    Or(usize),
    /// A rule with a NOT.
    Not(usize),
    /// A rule that does not ask about each input once.
    Asks(usize),
    /// Two rules that ask the same: what they conclude together is not in either.
    Cell(usize, usize),
    /// A term that is no number for all inputs, by its index.
    Linear(usize),
    /// A term whose set is zero at every sample, or next to it.
    Unmet(usize),
}

/// The turns of every output that has a table: one or two inputs, each rule about it "a is x" or "a is x and b is y", no two of
/// them the same, its conclusions numbers or sets (a set counts as its centroid); rules of weight zero are none. In place of
/// an output without one: why.
///
/// A table that does not turn is no promise: where terms do not divide an input between neighbouring peaks, or weights differ,
/// an output may turn all the same.
pub fn turns(system: &System) -> Vec<Result<Vec<Turn>, NoTable>> {
    let orders: Vec<Vec<usize>> = system.inputs.iter().map(order).collect();
    (0..system.outputs.len())
        .map(|output| table(system, output).map(|table| of_table(&orders, output, &table)))
        .collect()
}

/// Rules and their conclusions by the terms of the first and the second input; with one input the second is 0.
type Table = BTreeMap<(usize, usize), (usize, f64)>;

fn table(system: &System, index: usize) -> Result<Table, NoTable> {
    let output = &system.outputs[index];
    let mut table = Table::new();
    let rules = rules(system).enumerate();
    for (number, (_, rule)) in rules.filter(|(_, (_, rule))| rule.weight > 0.0) {
        for &(_, term) in rule.conclusions.iter().filter(|c| c.0 == index) {
            let cell = cell(&rule.antecedent, system.inputs.len(), number)?;
            let conclusion = &output.terms[term].conclusion;
            let height = height(output, conclusion).ok_or(match conclusion {
                Conclusion::Set(_) => NoTable::Unmet(term),
                Conclusion::Constant(_) | Conclusion::Linear { .. } => NoTable::Linear(term),
            })?;
            if let Some((first, _)) = table.insert(cell, (number, height)) {
                return Err(NoTable::Cell(first, number));
            }
        }
    }
    match table.is_empty() {
        true => Err(NoTable::NoRule),
        false => Ok(table),
    }
}

fn cell(antecedent: &Antecedent, inputs: usize, rule: usize) -> Result<(usize, usize), NoTable> {
    if inputs > 2 {
        return Err(NoTable::Inputs);
    }
    let parts = match antecedent {
        Antecedent::And(parts) => parts.as_slice(),
        part => std::slice::from_ref(part),
    };
    let mut terms = [None; 2];
    for part in parts {
        match *part {
            Antecedent::Is { negated: true, .. } => return Err(NoTable::Not(rule)),
            Antecedent::Is { input, term, .. } if terms[input].is_none() => {
                terms[input] = Some(term);
            }
            Antecedent::Or(_) => return Err(NoTable::Or(rule)),
            Antecedent::Is { .. } | Antecedent::And(_) => return Err(NoTable::Asks(rule)),
        }
    }
    match (inputs, terms) {
        (1, [Some(term), None]) => Ok((term, 0)),
        (2, [Some(row), Some(col)]) => Ok((row, col)),
        _ => Err(NoTable::Asks(rule)),
    }
}

/// A conclusion as one number.
fn height(output: &Output, conclusion: &Conclusion) -> Option<f64> {
    match conclusion {
        Conclusion::Constant(value) => Some(*value),
        Conclusion::Linear { .. } => None,
        Conclusion::Set(shape) => {
            let at = samples(output);
            let weight: f64 = at.iter().map(|&x| shape.degree(x)).sum();
            let sum: f64 = at.iter().map(|&x| x * shape.degree(x)).sum();
            (weight >= FAINTEST).then(|| sum / weight)
        }
    }
}

/// An input's terms from left to right, by the middle of where they are highest.
fn order(input: &Input) -> Vec<usize> {
    let middle = |term: usize| {
        // One out of reach is in no order; it is nowhere in the table's ranges either.
        picture::middle(&input.terms[term].shape, &input.range).unwrap_or(f64::INFINITY)
    };
    let mut order: Vec<usize> = (0..input.terms.len()).collect();
    order.sort_by(|&a, &b| middle(a).total_cmp(&middle(b)));
    order
}

fn of_table(orders: &[Vec<usize>], output: usize, table: &Table) -> Vec<Turn> {
    let mut found = Vec::new();
    let lone = vec![0];
    let rows = &orders[0];
    let cols = orders.get(1).unwrap_or(&lone);
    for &col in cols {
        let line: Vec<(usize, f64)> = rows
            .iter()
            .filter_map(|&row| Some((row, table.get(&(row, col))?.1)))
            .collect();
        let held = (orders.len() > 1).then_some((1, col));
        found.extend(of_line(&line).map(|cells| Turn {
            output,
            along: 0,
            held,
            cells,
        }));
    }
    for &row in rows {
        let line: Vec<(usize, f64)> = cols
            .iter()
            .filter_map(|&col| Some((col, table.get(&(row, col))?.1)))
            .collect();
        found.extend(of_line(&line).map(|cells| Turn {
            output,
            along: 1,
            held: Some((0, row)),
            cells,
        }));
    }
    found
}

/// Cells around each change from rising to falling or back; equal neighbours are no direction.
fn of_line(line: &[(usize, f64)]) -> impl Iterator<Item = [(usize, f64); 3]> + use<> {
    let mut steps = line.to_vec();
    steps.dedup_by(|b, a| a.1 == b.1);
    let turned = |w: &&[(usize, f64)]| (w[0].1 < w[1].1) != (w[1].1 < w[2].1);
    let turns: Vec<_> = steps
        .windows(3)
        .filter(turned)
        .map(|w| [w[0], w[1], w[2]])
        .collect();
    turns.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    #[test]
    fn a_table_that_only_rises_has_none() {
        assert_eq!(turns(&fan()), [Ok(vec![])]);
    }

    #[test]
    fn one_wrong_cell_shows_in_its_row_and_its_column() {
        let mut fan = fan();
        // Temperature mid, humidity high: off instead of half; and mid, low: full instead of off.
        fan.blocks[0].rules[3].conclusions = vec![(0, 0)];
        fan.blocks[0].rules[2].conclusions = vec![(0, 2)];
        let found = turns(&fan)[0].clone().unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(
            found[0],
            Turn {
                output: 0,
                along: 0,
                held: Some((1, 0)),
                cells: [(0, 0.0), (1, 100.0), (2, 40.0)],
            }
        );
    }

    #[test]
    fn terms_are_taken_from_left_to_right_whatever_their_order_in_the_file() {
        let mut fan = fan();
        fan.inputs[0].terms.swap(0, 2);
        assert_eq!(order(&fan.inputs[0]), [2, 1, 0]);
    }

    #[test]
    fn what_is_no_table_is_said() {
        let mut fan = fan();
        fan.blocks[0].rules[0].antecedent = Antecedent::Is {
            input: 0,
            term: 0,
            negated: true,
        };
        assert_eq!(turns(&fan), [Err(NoTable::Not(0))]);
        let of = |term| Antecedent::Is {
            input: 0,
            term,
            negated: false,
        };
        fan.blocks[0].rules[0].antecedent = of(0);
        assert_eq!(turns(&fan), [Err(NoTable::Asks(0))]);
        let asked = fan.blocks[0].rules[1].antecedent.clone();
        fan.blocks[0].rules[0].antecedent = asked;
        assert_eq!(turns(&fan), [Err(NoTable::Cell(0, 1))]);
        fan.blocks[0].rules[1].weight = 0.0;
        assert_eq!(turns(&fan), [Ok(vec![])]);
        fan.blocks[0].rules[0].antecedent = Antecedent::Or(vec![of(0), of(1)]);
        assert_eq!(turns(&fan), [Err(NoTable::Or(0))]);
        fan.inputs.push(fan.inputs[0].clone());
        assert_eq!(turns(&fan), [Err(NoTable::Inputs)]);
        fan.blocks[0].rules.clear();
        assert_eq!(turns(&fan), [Err(NoTable::NoRule)]);
    }
}
