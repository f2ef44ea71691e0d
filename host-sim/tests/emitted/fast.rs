//! What the library's tables give, and how far that is from `f64`.

use super::cases;
use super::systems::{Made, fast_systems};
use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::U0;
use fuzzypilot::fuzzy::{
    Antecedents, Consequents, Partition, Position, RuleTable, Term, TwinTable,
};
use host_sim::fuzzy::emit::rust::output_error;
use host_sim::fuzzy::emit::{Axis, RuleBase, Table};
use host_sim::fuzzy::evaluate::{Evaluator, Exact};

/// Raw numbers: what their format is does not change them.
type Raw = FixedI16<U0>;

/// The outputs at every input by the library itself, its tables made while this runs.
pub fn expected(made: &Made, inputs: &[Vec<i32>]) -> Vec<Vec<i32>> {
    let base = made.design("").rule_base().unwrap();
    macro_rules! sized {
        ($($r:literal)*) => {
            match base.axes[0].peaks.len() {
                $($r => sized!(@ $r; 2 3 4 5),)*
                other => panic!("{other} rows"),
            }
        };
        (@ $r:literal; $($c:literal)*) => {
            match base.axes[1].peaks.len() {
                $($c => evaluated::<$r, $c, { $r - 1 }>(&base, inputs),)*
                other => panic!("{other} columns"),
            }
        };
    }
    sized!(2 3 4 5)
}

fn evaluated<const R: usize, const C: usize, const GAPS: usize>(
    base: &RuleBase,
    inputs: &[Vec<i32>],
) -> Vec<Vec<i32>> {
    let antecedents = Antecedents::<R, C> {
        rows: partition(&base.axes[0]),
        cols: partition(&base.axes[1]),
    };
    let tables: Vec<RuleTable<R, C, Raw>> = base.tables.iter().map(table).collect();
    let twin = base
        .is_twin()
        .then(|| TwinTable::<R, C, GAPS>::new(&antecedents, &tables[0], &tables[1]));
    let one = |input: &Vec<i32>| {
        if let Some(twin) = &twin {
            let [row, column] = [0, 1].map(|i| position(&base.axes[i], input[i]));
            let both = twin.evaluate(row, column);
            return vec![both.first, both.second];
        }
        let [row, column] = [input[0], input[1]].map(I16F16::from_bits);
        let activation = antecedents.activate(row, column);
        tables
            .iter()
            .map(|table| table.defuzzify(&activation).to_bits().into())
            .collect()
    };
    inputs.iter().map(one).collect()
}

fn partition<const N: usize>(axis: &Axis) -> Partition<N> {
    Partition::new(std::array::from_fn(|i| I16F16::from_bits(axis.peaks[i])))
}

/// With as many terms as there may be: those that no rule names lie beside the others.
fn table<const R: usize, const C: usize>(table: &Table) -> RuleTable<R, C, Raw> {
    let (mut peaks, mut below) = (table.peaks.clone(), 0);
    while peaks.len() < 7 {
        match peaks[peaks.len() - 1] {
            last if last < i32::from(i16::MAX) => peaks.push(last + 1),
            _ => {
                peaks.insert(0, peaks[0] - 1);
                below += 1;
            }
        }
    }
    let raw = |peak: i32| Raw::from_bits(peak as i16);
    let terms = std::array::from_fn(|r| {
        std::array::from_fn(|c| Term((table.places[table.cells[r][c]] + below) as u8))
    });
    RuleTable::new(
        terms,
        Consequents::<7, Raw>::new(
            [raw(peaks[0]), raw(peaks[6])],
            std::array::from_fn(|i| raw(peaks[i])),
        ),
    )
}

/// Where an input lies on an axis; 2^−30 of it too low at most, as a product with a reciprocal of 31 bits is.
fn position(axis: &Axis, x: i32) -> Position {
    let (first, last) = (axis.peaks[0], axis.peaks[axis.peaks.len() - 1]);
    let span = (i64::from(last) - i64::from(first)) as u128;
    let distance = (i64::from(x.clamp(first, last)) - i64::from(first)) as u128;
    let shift = (span as u32).leading_zeros();
    let reciprocal = (1u128 << 62) / (span << shift);
    let exact = (distance << 32) / span;
    let found = (((distance << shift) * reciprocal) >> 30).min(u128::from(u32::MAX));
    assert!(exact.abs_diff(found) <= 5, "{x} on {axis:?}");
    Position::from_bits(found as u32)
}

#[test]
fn the_error_is_within_what_is_announced() {
    for made in fast_systems(60) {
        let base = made.design("").rule_base().unwrap();
        let inputs = cases::inputs(&made, 3000);
        let found = expected(&made, &inputs);
        let exact = Exact::new(&made.system);
        let mut worst = vec![0.0_f64; base.tables.len()];
        for (input, found) in inputs.iter().zip(&found) {
            let values: Vec<f64> = input.iter().map(|&x| f64::from(x) / 65_536.0).collect();
            let exact = exact.evaluate(&values).outputs;
            for (o, table) in base.tables.iter().enumerate() {
                let step = if base.is_twin() {
                    table.step() / 4096.0
                } else {
                    table.step()
                };
                let error = f64::from(found[o]) * step - exact[o].unwrap();
                worst[o] = worst[o].max(error.abs());
            }
        }
        for (o, worst) in worst.into_iter().enumerate() {
            let announced = output_error(&base, o);
            assert!(worst <= announced, "{}: {worst} of {announced}", made.name);
            // It is no idle number either.
            let constant = base.tables[o].peaks.len() == 1;
            assert!(
                constant || worst > announced / 100.0,
                "{}: {worst} of {announced}",
                made.name
            );
        }
    }
}
