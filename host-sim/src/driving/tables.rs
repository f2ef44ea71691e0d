//! From a design to the follower's packed tables.

use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, Shape, System,
};
use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::{LeEqU16, Unsigned};
use fuzzypilot::fuzzy::{Consequents, MAX_TERMS, RuleTable, Term, TwinTable};
use fuzzypilot::tables::fine::{Deflection, FineTwin, PRINTED, SPEED_AXIS, Speed};

/// Why a design is none for the follower.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no design for the robot's follower: {0}")]
pub struct NotFine(String);

/// Rows φ, columns d.
type Cells = [[Term; 5]; 5];

/// The input whose peaks may be nearer to each other than one unit: the robot has a scale for it.
pub const SCALED: &str = "d";

/// Fine tables as a simulated robot takes them.
#[derive(Clone, Copy, Debug)]
pub struct Fine<'a> {
    /// Consequents.
    pub tables: &'a FineTwin,
    /// Units of d from one peak of it to the next: what the robot's units a metre are divided by. 1 in the chapter's tables.
    pub apart: f64,
}

/// The tables that a design says, and how far apart the peaks of d are: inputs `phi` (degrees, 0 to 180) with the follower's five
/// even terms, `d` (0 to 4) with five even terms from 0 on, not more than one unit apart, outputs `speed` (0 to 3) and `deflection` (degrees, 0 to 90), a rule for each of the 25 cells.
///
/// # Errors
///
/// What is otherwise.
pub fn tables(design: &System) -> Result<(FineTwin, f64), NotFine> {
    let (rows, _) = partitioned(design, "phi", PRINTED.antecedents.rows.peaks())?;
    let (cols, apart) = partitioned(design, SCALED, PRINTED.antecedents.cols.peaks())?;
    if design.inputs.len() != 2 || design.outputs.len() != 2 {
        return Err(NotFine(
            "allowed are the inputs phi and d and the outputs speed and deflection alone".into(),
        ));
    }
    let speed: RuleTable<5, 5, Speed> = table(design, "speed", (rows, cols), SPEED_AXIS)?;
    let axis = Deflection::lit("90");
    let deflection: RuleTable<5, 5, Deflection> = table(design, "deflection", (rows, cols), axis)?;

    Ok((
        TwinTable::new(&PRINTED.antecedents, &speed, &deflection),
        apart,
    ))
}

/// The index of an input that has this partition, and its share of the range: 1 but for [`SCALED`].
fn partitioned(design: &System, name: &str, peaks: [I16F16; 5]) -> Result<(usize, f64), NotFine> {
    let found = design.inputs.iter().position(|input| input.name == name);
    let index = found.ok_or_else(|| NotFine(format!("it has no input {name}")))?;
    let peaks = peaks.map(|peak| peak.to_num::<f64>());
    let Input { range, terms, .. } = &design.inputs[index];
    let share = match terms.first().map(|term| &term.shape) {
        Some(Shape::Ramp { from, .. }) if name == SCALED => from / peaks[1],
        _ => 1.0,
    };
    let even = range == &(peaks[0]..=peaks[4])
        && (LEAST_SHARE..=1.0).contains(&share)
        && terms.len() == peaks.len()
        && (terms.iter().zip(shapes(peaks.map(|peak| peak * share))))
            .all(|(term, wanted)| is_near(&term.shape, &wanted));
    if !even {
        let nearer = match name {
            SCALED => format!(", or all nearer by one factor, {LEAST_SHARE} at least"),
            _ => String::new(),
        };
        let peaks = peaks.map(|peak| peak.to_string()).join(", ");
        return Err(NotFine(format!(
            "the terms of {name} are others; allowed are triangles with ramps at both ends, their peaks {peaks}{nearer}"
        )));
    }
    Ok((index, share))
}

/// Whether they are the same but for how decimal digits are rounded.
fn is_near(shape: &Shape, wanted: &Shape) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    match (shape, wanted) {
        (Shape::Ramp { from, to }, Shape::Ramp { from: a, to: b }) => {
            near(*from, *a) && near(*to, *b)
        }
        (
            Shape::Triangle { left, peak, right },
            Shape::Triangle {
                left: a,
                peak: b,
                right: c,
            },
        ) => near(*left, *a) && near(*peak, *b) && near(*right, *c),
        _ => false,
    }
}

/// Nearer peaks would take the robot's scale too far.
const LEAST_SHARE: f64 = 0.25;

fn shapes([a, b, c, d, e]: [f64; 5]) -> [Shape; 5] {
    let triangle = |left, peak, right| Shape::Triangle { left, peak, right };
    [
        Shape::Ramp { from: b, to: a },
        triangle(a, b, c),
        triangle(b, c, d),
        triangle(c, d, e),
        Shape::Ramp { from: d, to: e },
    ]
}

fn table<F: Unsigned + LeEqU16 + Copy>(
    design: &System,
    name: &str,
    inputs: (usize, usize),
    axis: FixedI16<F>,
) -> Result<RuleTable<5, 5, FixedI16<F>>, NotFine> {
    let found = design.outputs.iter().position(|output| output.name == name);
    let index = found.ok_or_else(|| NotFine(format!("it has no output {name}")))?;
    let output = &design.outputs[index];
    let (peaks, places) = peaks(output, axis)?;
    let cells = cells(design, index, inputs, &places)?;
    Ok(match peaks.len() {
        1 => packed::<1, F>(cells, axis, &peaks),
        2 => packed::<2, F>(cells, axis, &peaks),
        3 => packed::<3, F>(cells, axis, &peaks),
        4 => packed::<4, F>(cells, axis, &peaks),
        5 => packed::<5, F>(cells, axis, &peaks),
        6 => packed::<6, F>(cells, axis, &peaks),
        _ => packed::<7, F>(cells, axis, &peaks),
    })
}

/// One to seven peaks, checked.
fn packed<const K: usize, F: Unsigned + LeEqU16 + Copy>(
    cells: Cells,
    axis: FixedI16<F>,
    peaks: &[FixedI16<F>],
) -> RuleTable<5, 5, FixedI16<F>> {
    let peaks = std::array::from_fn::<_, K, _>(|i| peaks[i]);
    RuleTable::new(cells, Consequents::new([FixedI16::ZERO, axis], peaks))
}

/// An output's peaks, ascending, and each term's place among them.
fn peaks<F: Unsigned + LeEqU16>(
    output: &Output,
    axis: FixedI16<F>,
) -> Result<(Vec<FixedI16<F>>, Vec<u8>), NotFine> {
    let name = &output.name;
    let top: f64 = f64::from(axis.to_bits()) / f64::from(F::I32).exp2();
    let plain = output.defuzzifier == Defuzzifier::WeightedAverage && output.merge == Merge::Sum;
    if !plain || output.range != (0.0..=top) || output.terms.len() > MAX_TERMS {
        return Err(NotFine(format!(
            "{name} is another output; allowed is a weighted average of sums, its range 0 to {top}, at most {MAX_TERMS} terms"
        )));
    }
    let mut order: Vec<(i16, usize)> = Vec::new();
    for (index, term) in output.terms.iter().enumerate() {
        match term.conclusion {
            Conclusion::Constant(value) if output.range.contains(&value) => {
                let steps = (value * f64::from(F::I32).exp2()).round();
                order.push((steps as i16, index));
            }
            _ => {
                return Err(NotFine(format!(
                    "{name} is {}: allowed is a constant from 0 to {top}",
                    term.name
                )));
            }
        }
    }
    order.sort_unstable();
    if let Some(two) = order.windows(2).find(|two| two[0].0 == two[1].0) {
        return Err(NotFine(format!(
            "{name} has the same number for {} and {}; allowed are different ones",
            output.terms[two[0].1].name, output.terms[two[1].1].name
        )));
    }
    let mut places = vec![0; order.len()];
    for (place, &(_, index)) in (0..).zip(&order) {
        places[index] = place;
    }
    let peaks = order.iter().map(|(bits, _)| FixedI16::from_bits(*bits));
    Ok((peaks.collect(), places))
}

/// What the rules conclude about an output, cell by cell.
fn cells(
    design: &System,
    output: usize,
    (rows, cols): (usize, usize),
    places: &[u8],
) -> Result<Cells, NotFine> {
    let mut cells = [[Term::HOLE; 5]; 5];
    for block in &design.blocks {
        for rule in &block.rules {
            let cell = cell(&rule.antecedent, rows, cols)
                .filter(|_| rule.weight == 1.0 && block.and == Conjunction::Min);
            let Some((row, col)) = cell else {
                return Err(NotFine(format!(
                    "the rule in line {} is another; allowed is `phi is … and d is …` by the minimum, without a weight",
                    rule.place.line
                )));
            };
            for &(_, term) in rule.conclusions.iter().filter(|c| c.0 == output) {
                if cells[row][col] != Term::HOLE {
                    return Err(NotFine(format!(
                        "the rule in line {} is a second one for its cell; allowed is one",
                        rule.place.line
                    )));
                }
                cells[row][col] = Term(places[term]);
            }
        }
    }
    let whole = cells.iter().flatten().all(|term| *term != Term::HOLE);
    whole.then_some(cells).ok_or_else(|| {
        NotFine(format!(
            "{} has no rule for some cell; allowed is one for each of the 25",
            design.outputs[output].name
        ))
    })
}

fn cell(antecedent: &Antecedent, rows: usize, cols: usize) -> Option<(usize, usize)> {
    let Antecedent::And(parts) = antecedent else {
        return None;
    };
    let term = |of: usize| {
        parts.iter().find_map(|part| match part {
            Antecedent::Is {
                input,
                term,
                negated: false,
            } if *input == of => Some(*term),
            _ => None,
        })
    };
    (parts.len() == 2).then_some(())?;
    Some((term(rows)?, term(cols)?))
}
