//! The rule tables with names, for people: the replay's pages, `eval` and `surface`.

use crate::recording::TableView;
use fuzzypilot::fuzzy::{RuleTable, Term};
use fuzzypilot::tables::coarse::{self, CoarseSet};
use fuzzypilot::tables::fine::{self, FineSet};

/// Index of the fine speed table among [`views`].
pub const FINE_SPEED: usize = 0;
/// Index of the fine deflection table.
pub const FINE_DEFLECTION: usize = 1;
/// Index of the coarse deflection table.
pub const COARSE_DEFLECTION: usize = 2;
/// Index of the coarse speed table.
pub const COARSE_SPEED: usize = 3;

/// The four tables in use, in the order of the constants above.
pub fn views(fine_set: FineSet, coarse_set: CoarseSet) -> Vec<TableView> {
    let fine_tables = fine_set.tables();
    let coarse_tables = coarse_set.tables();
    let (speed, deflection) = match fine_set {
        FineSet::Tuned => ("tuned speed v", "tuned deflection Δφ"),
        _ => ("Table 7.1: speed v", "Table 7.2: deflection Δφ"),
    };
    let fine_view = |title: &str, terms: &[[Term; 5]; 5]| TableView {
        title: title.to_owned(),
        row_input: "φ".to_owned(),
        col_input: "d".to_owned(),
        row_terms: owned(&fine::TERMS),
        col_terms: owned(&fine::DISTANCE_TERMS),
        cells: cells(terms, &fine::TERMS),
    };
    let coarse_view =
        |title: &str, terms: &[[Term; 3]; 3], angle: &str, names: &[&str]| TableView {
            title: title.to_owned(),
            row_input: "s".to_owned(),
            col_input: angle.to_owned(),
            row_terms: owned(&coarse::DISTANCE_TERMS),
            col_terms: owned(&coarse::ANGLE_TERMS),
            cells: cells(terms, names),
        };
    vec![
        fine_view(speed, fine_tables.speed.terms()),
        fine_view(deflection, fine_tables.deflection.terms()),
        coarse_view(
            "Table 7.3: deflection Δθ",
            coarse_tables.deflection.terms(),
            "θ",
            &coarse::ANGLE_TERMS,
        ),
        coarse_view(
            "Table 7.4: speed v",
            coarse_tables.speed.terms(),
            "Δθ",
            &coarse::SPEED_TERMS,
        ),
    ]
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&n| n.to_owned()).collect()
}

fn cells<const R: usize, const C: usize>(
    terms: &[[Term; C]; R],
    names: &[&str],
) -> Vec<Vec<String>> {
    terms
        .iter()
        .map(|row| {
            row.iter()
                .map(|t| {
                    names
                        .get(usize::from(t.0))
                        .copied()
                        .unwrap_or("?")
                        .to_owned()
                })
                .collect()
        })
        .collect()
}

/// Height defuzzification in `f64`, over every rule of a table and without the fast route: what `eval` prints beside
/// the fixed-point result.
pub fn reference<const R: usize, const C: usize, O>(
    table: &RuleTable<R, C, O>,
    peaks: (&[f64], &[f64]),
    inputs: (f64, f64),
) -> f64
where
    O: fuzzypilot::fuzzy::FixedOutput + Into<f64>,
{
    let (mut sum, mut weight) = (0.0, 0.0);
    for row in 0..R {
        for col in 0..C {
            let w = membership(peaks.0, row, inputs.0).min(membership(peaks.1, col, inputs.1));
            sum += w * table.peak(row, col).into();
            weight += w;
        }
    }
    sum / weight
}

/// Degree of a triangular term among `peaks`, shoulders at both ends.
pub fn membership(peaks: &[f64], term: usize, x: f64) -> f64 {
    let last = peaks.len() - 1;
    let x = x.clamp(peaks[0], peaks[last]);
    let peak = peaks[term];
    if x == peak {
        1.0
    } else if x < peak {
        let left = if term == 0 {
            return 1.0;
        } else {
            peaks[term - 1]
        };
        ((x - left) / (peak - left)).max(0.0)
    } else {
        let right = if term == last {
            return 1.0;
        } else {
            peaks[term + 1]
        };
        ((right - x) / (right - peak)).max(0.0)
    }
}
