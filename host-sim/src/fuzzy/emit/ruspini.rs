//! Finds designs for the fast route: two inputs, each divided between neighbouring peaks, and a rule for every pair of terms.

use super::words::count;
use crate::fuzzy::lower::{Defuzzifier, Lowered, Number};
use crate::fuzzy::model::System;
use fuzzypilot::fuzzy::system::{Degree, LIMIT, Literal, Merge, Norm, Piece};
use fuzzypilot::fuzzy::{MAX_TERMS, Twin};

/// Fractional bits that the route takes its inputs in.
pub const FRACTION: i32 = 16;

/// A rule base for the fast route.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleBase {
    /// The inputs: of the rows, and of the columns.
    pub axes: [Axis; 2],
    /// The outputs.
    pub tables: Vec<Table>,
    /// Each rule's row and column, in the design's order.
    pub rules: Vec<[usize; 2]>,
}

/// An input, divided between peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// In steps of 2⁻¹⁶, ascending.
    pub peaks: Vec<i32>,
    /// The terms that they are of.
    pub terms: Vec<usize>,
}

/// An output.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Fractional bits of its 16.
    pub fraction: i32,
    /// Its range in that format.
    pub range: [i32; 2],
    /// Different peaks in that format, ascending.
    pub peaks: Vec<i32>,
    /// Each of the output's terms' place among them.
    pub places: Vec<usize>,
    /// The term that each rule concludes, a row of the table a row.
    pub cells: Vec<Vec<usize>>,
    /// What an output may be off the design's own, in its unit, before the rounding of the output itself.
    pub error: f64,
}

impl RuleBase {
    /// Whether both axes have all neighbours equally far apart, and there are two outputs: what a `TwinTable` takes.
    pub fn is_twin(&self) -> bool {
        let even = |axis: &Axis| {
            let gaps: Vec<i64> = axis
                .peaks
                .windows(2)
                .map(|pair| i64::from(pair[1]) - i64::from(pair[0]))
                .collect();
            gaps.iter().all(|gap| *gap == gaps[0])
        };
        self.tables.len() == 2 && self.axes.iter().all(even)
    }

    /// Fractional bits of an output as it comes out.
    pub fn fraction(&self, table: &Table) -> i32 {
        match self.is_twin() {
            true => table.fraction + Twin::<2, 2>::EXTRA_BITS as i32,
            false => table.fraction,
        }
    }
}

impl Axis {
    /// What a grade may be off: half a step of 2⁻¹⁵, and the input and both peaks half a step each.
    fn error(&self) -> f64 {
        let gaps = self
            .peaks
            .windows(2)
            .map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
        0.5 / 32_768.0 + 1.5 / gaps.fold(f64::INFINITY, f64::min)
    }
}

impl Table {
    /// A step of its format.
    pub fn step(&self) -> f64 {
        f64::from(-self.fraction).exp2()
    }

    /// The most that Σ w·z / Σ w is off, before it is rounded.
    ///
    /// With f the grade of an upper neighbour, two of the four degrees at most follow it, each as fast; Σ w is one at least;
    /// and no z is farther from the mean than the four are from each other. So an error of f counts 2 · (greatest z − least z)
    /// times at most, and so does the other input's. Peaks are rounded to half a step.
    fn error(&self, axes: &[Axis; 2]) -> f64 {
        let mut spread = 0;
        for rows in self.cells.windows(2) {
            for column in 1..rows[0].len() {
                let four = rows
                    .iter()
                    .flat_map(|row| &row[column - 1..=column])
                    .map(|&term| self.peaks[self.places[term]]);
                let (least, most) =
                    four.fold((i32::MAX, i32::MIN), |(a, b), z| (a.min(z), b.max(z)));
                spread = spread.max(most - least);
            }
        }
        let grades = axes[0].error() + axes[1].error();
        (2.0 * f64::from(spread) * grades + 0.5) * self.step()
    }

    /// The greatest magnitude of a peak, in the output's unit.
    pub fn greatest(&self) -> f64 {
        let most = self.peaks.iter().map(|peak| peak.abs()).max();
        f64::from(most.unwrap_or(0)) * self.step()
    }
}

/// Recognises one, or says what it is instead.
pub fn recognise(system: &System, lowered: &Lowered) -> Result<RuleBase, String> {
    let tables = lowered.tables();
    let [rows, columns] = tables.inputs.as_slice() else {
        return Err(format!(
            "it takes 2 inputs, and there {} {}",
            if tables.inputs.len() == 1 {
                "is"
            } else {
                "are"
            },
            tables.inputs.len()
        ));
    };
    let axes = [axis(rows)?, axis(columns)?];
    if let Some(block) = tables.blocks.iter().find(|block| block.and != Norm::Min) {
        return Err(format!(
            "AND is the minimum, and a product in the rules `{}`",
            block.name
        ));
    }
    let outputs = (0..tables.outputs.len()).map(|o| table(system, lowered, o, &axes));
    Ok(RuleBase {
        tables: outputs.collect::<Result<_, _>>()?,
        rules: tables
            .blocks
            .iter()
            .flat_map(|block| &block.rules)
            .filter_map(|rule| place(&axes, &rule.when))
            .collect(),
        axes,
    })
}

fn axis(input: &crate::fuzzy::lower::Input) -> Result<Axis, String> {
    let name = &input.name;
    if input.format.fraction != FRACTION {
        return Err(format!(
            "it takes inputs in steps of 2^-16, and `{name}` has steps of 2^{}",
            -input.format.fraction
        ));
    }
    let terms = input.terms.len();
    if !(2..=MAX_TERMS).contains(&terms) {
        return Err(format!(
            "an input has 2 to {MAX_TERMS} terms, and `{name}` has {terms}"
        ));
    }
    let peak = |term: &[Piece], last: bool| {
        let mut full = term.iter().filter(|piece| piece.start() == Degree::ONE);
        let piece = if last { full.next_back() } else { full.next() };
        piece.map(Piece::from)
    };
    let neither = |term: &str| {
        format!(
            "the terms of an input divide it between neighbouring peaks, and `{term}` of `{name}` does not"
        )
    };
    let mut order: Vec<(i32, usize)> = Vec::new();
    for (i, (term, pieces)) in input.terms.iter().enumerate() {
        order.push((peak(pieces, false).ok_or_else(|| neither(term))?, i));
    }
    order.sort_unstable();
    // The first term may hold fully from far left on.
    if let Some((at, i)) = order.first_mut() {
        *at = peak(&input.terms[*i].1, true).unwrap_or(*at);
    }
    let peaks: Vec<i32> = order.iter().map(|&(at, _)| at).collect();
    if let Some(place) = peaks.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(neither(&input.terms[order[place + 1].1].0));
    }
    let limits = if input.clamp {
        input.range
    } else {
        [-LIMIT, LIMIT]
    };
    if limits[0] > peaks[0] || limits[1] < peaks[terms - 1] {
        return Err(format!(
            "values count up to the last peak, and the range of `{name}` ends before it"
        ));
    }
    for (place, &(_, i)) in order.iter().enumerate() {
        let mut wanted = Vec::new();
        if place > 0 {
            wanted.push((peaks[place - 1], 0.0));
        }
        wanted.push((peaks[place], 1.0));
        if place + 1 < terms {
            wanted.push((peaks[place + 1], 0.0));
        }
        let found: Vec<(i32, f64)> = input.terms[i]
            .1
            .iter()
            .map(|piece| {
                (
                    piece.from(),
                    f64::from(piece.start().bits()) / f64::from(Degree::ONE.bits()),
                )
            })
            .collect();
        if !same(&found, &wanted, limits) {
            return Err(neither(&input.terms[i].0));
        }
    }
    Ok(Axis {
        peaks,
        terms: order.into_iter().map(|(_, i)| i).collect(),
    })
}

/// Whether two functions of straight pieces are the same between limits: at all corners, and beside them for steps.
fn same(a: &[(i32, f64)], b: &[(i32, f64)], [low, high]: [i32; 2]) -> bool {
    let corners = a.iter().chain(b).flat_map(|&(x, _)| [x - 1, x, x + 1]);
    corners
        .chain([low, high])
        .filter(|x| (low..=high).contains(x))
        .all(|x| (value(a, x) - value(b, x)).abs() < 1e-9)
}

fn value(points: &[(i32, f64)], x: i32) -> f64 {
    let behind = points.partition_point(|&(from, _)| from <= x);
    match (behind.checked_sub(1).map(|i| points[i]), points.get(behind)) {
        (None, next) => next.map_or(0.0, |&(_, degree)| degree),
        (Some((_, degree)), None) => degree,
        (Some((from, degree)), Some(&(to, then))) => {
            let share = (f64::from(x) - f64::from(from)) / (f64::from(to) - f64::from(from));
            degree + share * (then - degree)
        }
    }
}

fn table(system: &System, lowered: &Lowered, o: usize, axes: &[Axis; 2]) -> Result<Table, String> {
    let output = &lowered.tables().outputs[o];
    let model = &system.outputs[o];
    let name = &output.name;
    let Defuzzifier::WeightedAverage { merge, terms } = &output.defuzzifier else {
        return Err(format!(
            "outputs are weighted averages, and `{name}` is a centroid"
        ));
    };
    if *merge != Merge::Sum {
        return Err(format!(
            "rules that conclude the same are added, and of `{name}` only the greatest counts"
        ));
    }
    let mut values = Vec::new();
    for (term, number) in terms {
        let Number::Constant(steps) = number else {
            return Err(format!(
                "terms are constants, and `{term}` of `{name}` is linear"
            ));
        };
        values.push(output.format.value(*steps));
    }
    let (start, end) = (*model.range.start(), *model.range.end());
    let mut range = [start, end];
    for (&value, (term, _)) in values.iter().zip(terms) {
        if model.clamp && !model.range.contains(&value) {
            return Err(format!(
                "no value is limited, and `{term}` of `{name}` lies beyond the range"
            ));
        }
        range = [range[0].min(value), range[1].max(value)];
    }
    let fits = |fraction: &i32| {
        let steps = |x: f64| (x * f64::from(*fraction).exp2()).round();
        range.iter().all(|&x| steps(x).abs() <= f64::from(i16::MAX))
    };
    let Some(fraction) = (0..=15).rev().find(fits) else {
        return Err(format!(
            "outputs have 16 bits, and `{name}` goes up to {}",
            range[1].max(-range[0])
        ));
    };
    let raw = |x: f64| (x * f64::from(fraction).exp2()).round() as i32;
    let mut peaks: Vec<i32> = values.iter().map(|&x| raw(x)).collect();
    let of_terms = peaks.clone();
    peaks.sort_unstable();
    peaks.dedup();
    if peaks.len() > MAX_TERMS {
        return Err(format!(
            "an output has {MAX_TERMS} different terms at most, and `{name}` has {}",
            peaks.len()
        ));
    }
    let places = of_terms
        .iter()
        .map(|peak| peaks.partition_point(|other| other < peak));
    let mut table = Table {
        fraction,
        range: range.map(raw),
        places: places.collect(),
        cells: cells(lowered, o, axes)?,
        peaks,
        error: 0.0,
    };
    table.error = table.error(axes);
    Ok(table)
}

/// The term that each pair of input terms concludes.
fn cells(lowered: &Lowered, o: usize, axes: &[Axis; 2]) -> Result<Vec<Vec<usize>>, String> {
    let tables = lowered.tables();
    let name = &tables.outputs[o].name;
    let mut cells = vec![vec![None; axes[1].terms.len()]; axes[0].terms.len()];
    for (number, rule) in tables
        .blocks
        .iter()
        .flat_map(|block| &block.rules)
        .enumerate()
    {
        let Some(&(_, term)) = rule
            .then
            .iter()
            .find(|(output, _)| usize::from(*output) == o)
        else {
            continue;
        };
        let this = format!("rule {}", number + 1);
        if rule.weight != Degree::ONE {
            return Err(format!("rules weigh 1, and {this} weighs less"));
        }
        let Some([row, column]) = place(axes, &rule.when) else {
            return Err(format!(
                "a rule asks both inputs for one term each, and {this} does not"
            ));
        };
        let cell = cells.get_mut(row).and_then(|cells| cells.get_mut(column));
        match cell {
            Some(cell @ None) => *cell = Some(usize::from(term)),
            _ => {
                return Err(format!(
                    "every pair of terms has one rule, and {this} about `{name}` is another"
                ));
            }
        }
    }
    let rows = cells
        .into_iter()
        .map(|row| row.into_iter().collect::<Option<Vec<usize>>>());
    rows.collect::<Option<_>>().ok_or_else(|| {
        let all = count(axes[0].terms.len() * axes[1].terms.len(), "pair");
        format!("every one of {all} of terms has a rule, and for `{name}` some are missing")
    })
}

/// A rule's row and column; `None` if it asks something else than both inputs for one term each.
fn place(axes: &[Axis; 2], when: &[Vec<Literal>]) -> Option<[usize; 2]> {
    let (Literal::Is(0, row), Literal::Is(1, column)) = pair(when) else {
        return None;
    };
    let place = |axis: &Axis, term: u8| axis.terms.iter().position(|&of| of == usize::from(term));
    Some([place(&axes[0], row)?, place(&axes[1], column)?])
}

/// What a rule asks, the first input first, if it asks twice.
fn pair(when: &[Vec<Literal>]) -> (Literal, Literal) {
    let nothing = Literal::IsNot(0, 0);
    match when {
        [all] => match all.as_slice() {
            &[a @ Literal::Is(0, _), b] | &[b, a @ Literal::Is(0, _)] => (a, b),
            _ => (nothing, nothing),
        },
        _ => (nothing, nothing),
    }
}
