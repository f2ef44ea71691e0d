//! Properties of the fuzzy engine over random partitions, tables and outputs, against f64 and at the ends of the
//! number formats.

use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::{LeEqU16, U0, U8, U13, U16, Unsigned};
use fuzzypilot::fuzzy::{Antecedents, Consequents, Grade, Partition, RuleTable, Term};
use proptest::prelude::*;

/// A failure prints its smallest input; nothing is written beside the tests.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A random rule base: more than any shape needs; a shape takes the first of everything.
#[derive(Clone, Debug)]
struct Base {
    row_peaks: Vec<i32>,
    col_peaks: Vec<i32>,
    /// Peaks of the outputs, raw.
    outputs: [Vec<i16>; 3],
    /// Consequent of every cell of every output, by its place among seven.
    cells: Vec<u8>,
}

/// `n` different numbers of the whole of i32, ascending; narrow and wide gaps alike.
fn ascending(n: usize) -> impl Strategy<Value = Vec<i32>> {
    prop_oneof![
        prop::collection::btree_set(any::<i32>(), n),
        prop::collection::btree_set(-(4 << 16)..(4i32 << 16), n),
        prop::collection::btree_set(-20..20i32, n),
        prop::collection::btree_set(
            prop_oneof![Just(i32::MIN), Just(i32::MAX), any::<i32>(), -9..9i32],
            n
        ),
    ]
    .prop_map(|set| set.into_iter().collect())
}

/// The most negative raw value has no place in the accumulator and does not compile.
fn ascending16(n: usize) -> impl Strategy<Value = Vec<i16>> {
    prop_oneof![
        prop::collection::btree_set(-i16::MAX..=i16::MAX, n),
        prop::collection::btree_set(-40..=40i16, n),
        prop::collection::btree_set((i16::MAX - 40)..=i16::MAX, n),
    ]
    .prop_map(|set| set.into_iter().collect())
}

fn base() -> impl Strategy<Value = Base> {
    (
        ascending(7),
        ascending(7),
        [ascending16(7), ascending16(7), ascending16(7)],
        prop::collection::vec(0..7u8, 3 * 49),
    )
        .prop_map(|(row_peaks, col_peaks, outputs, cells)| Base {
            row_peaks,
            col_peaks,
            outputs,
            cells,
        })
}

/// Inputs: anything, the ends, and close to every peak.
fn inputs(base: &Base) -> Vec<(i32, i32)> {
    let near = |peaks: &[i32]| {
        let mut all = vec![i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
        for (i, &p) in peaks.iter().enumerate() {
            all.extend([p.saturating_sub(1), p, p.saturating_add(1)]);
            if let Some(&next) = peaks.get(i + 1) {
                let third = (i64::from(next) - i64::from(p)) / 3;
                all.push((i64::from(p) + third) as i32);
                all.push((i64::from(p) + (i64::from(next) - i64::from(p)) / 2) as i32);
            }
        }
        all
    };
    let (rows, cols) = (near(&base.row_peaks), near(&base.col_peaks));
    let mut pairs = Vec::new();
    for (i, &x) in rows.iter().enumerate() {
        for &y in cols.iter().skip(i % 3).step_by(3) {
            pairs.push((x, y));
        }
    }
    pairs
}

fn partition<const N: usize>(peaks: &[i32]) -> Partition<N> {
    Partition::new(std::array::from_fn(|i| I16F16::from_bits(peaks[i])))
}

fn table<const R: usize, const C: usize, const K: usize, Frac: Unsigned + LeEqU16 + Copy>(
    base: &Base,
    output: usize,
) -> RuleTable<R, C, FixedI16<Frac>> {
    let peaks = &base.outputs[output];
    RuleTable::new(
        std::array::from_fn(|row| {
            std::array::from_fn(|col| Term(base.cells[49 * output + 7 * row + col] % K as u8))
        }),
        Consequents::new(
            [
                FixedI16::from_bits(peaks[0]),
                FixedI16::from_bits(peaks[K - 1]),
            ],
            std::array::from_fn::<_, K, _>(|k| FixedI16::from_bits(peaks[k])),
        ),
    )
}

/// Membership in term `i`, shoulders at the ends; all raw units.
fn membership(peaks: &[i32], i: usize, x: i32) -> f64 {
    let (x, at) = (f64::from(x), |i: usize| f64::from(peaks[i]));
    let rising = if i > 0 {
        (x - at(i - 1)) / (at(i) - at(i - 1))
    } else {
        1.0
    };
    let falling = if i + 1 < peaks.len() {
        (at(i + 1) - x) / (at(i + 1) - at(i))
    } else {
        1.0
    };
    rising.min(falling).clamp(0.0, 1.0)
}

/// Σ w·peak / Σ w over all rules, raw output units.
fn oracle<const R: usize, const C: usize>(
    base: &Base,
    (x, y): (i32, i32),
    peak: impl Fn(usize, usize) -> i16,
) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for row in 0..R {
        for col in 0..C {
            let w = membership(&base.row_peaks[..R], row, x).min(membership(
                &base.col_peaks[..C],
                col,
                y,
            ));
            sum += w * f64::from(peak(row, col));
            weight += w;
        }
    }
    sum / weight
}

/// One output's answer is bounded by its peaks and near the oracle's: each of the four degrees is off by at most half
/// a grade, 2^-16, so the answer by 4 · 2^-16 of the peaks' span, and by half an output step for the last rounding.
fn judge<const R: usize, const C: usize>(
    base: &Base,
    input: (i32, i32),
    answer: i16,
    peak: impl Fn(usize, usize) -> i16,
) -> Result<(), TestCaseError> {
    let cells = (0..R).flat_map(|r| (0..C).map(move |c| (r, c)));
    let all: Vec<i16> = cells.map(|(r, c)| peak(r, c)).collect();
    let (least, most) = (*all.iter().min().unwrap(), *all.iter().max().unwrap());
    prop_assert!((least..=most).contains(&answer));
    let exact = oracle::<R, C>(base, input, peak);
    let span = f64::from(most) - f64::from(least);
    let bound = 0.501 + span / 16_384.0;
    prop_assert!(
        (f64::from(answer) - exact).abs() <= bound,
        "{answer} for {exact} at {input:?}"
    );
    Ok(())
}

fn check<const R: usize, const C: usize>(base: &Base) -> Result<(), TestCaseError> {
    let antecedents = Antecedents {
        rows: partition::<R>(&base.row_peaks),
        cols: partition::<C>(&base.col_peaks),
    };
    // Three outputs of different formats and term counts share one activation.
    let wide = table::<R, C, 7, U8>(base, 0);
    let narrow = table::<R, C, 3, U13>(base, 1);
    let lone = table::<R, C, 1, U16>(base, 2);
    for (x, y) in inputs(base) {
        let activation = antecedents.activate(I16F16::from_bits(x), I16F16::from_bits(y));
        let weight = activation.weight().get();
        prop_assert!((1 << 15..=1 << 16).contains(&weight));
        prop_assert!(usize::from(activation.row()) <= R - 2);
        prop_assert!(usize::from(activation.col()) <= C - 2);
        prop_assert!(matches!(activation.fired().len(), 1 | 2 | 4));
        for rule in &activation.fired() {
            prop_assert!(usize::from(rule.row) < R && usize::from(rule.col) < C);
            prop_assert!(rule.degree > Grade::ZERO && rule.degree <= Grade::ONE);
        }
        judge::<R, C>(
            base,
            (x, y),
            wide.defuzzify(&activation).to_bits(),
            |r, c| wide.peak(r, c).to_bits(),
        )?;
        judge::<R, C>(
            base,
            (x, y),
            narrow.defuzzify(&activation).to_bits(),
            |r, c| narrow.peak(r, c).to_bits(),
        )?;
        prop_assert_eq!(lone.defuzzify(&activation).to_bits(), base.outputs[2][0]);
    }
    // Exact at every pair of peaks, and saturated beyond the outer ones.
    for (row, &x) in base.row_peaks[..R].iter().enumerate() {
        for (col, &y) in base.col_peaks[..C].iter().enumerate() {
            let at = |x, y| {
                wide.defuzzify(&antecedents.activate(I16F16::from_bits(x), I16F16::from_bits(y)))
            };
            prop_assert_eq!(at(x, y), wide.peak(row, col));
            let beyond = |i: usize, n: usize, v: i32| match i {
                0 => i32::MIN,
                i if i + 1 == n => i32::MAX,
                _ => v,
            };
            prop_assert_eq!(
                at(beyond(row, R, x), beyond(col, C, y)),
                wide.peak(row, col)
            );
        }
    }
    Ok(())
}

macro_rules! shapes {
    ($($name:ident: $($r:literal x $c:literal),+;)+) => {
        proptest! {
            #![proptest_config(config(64))]
            $(#[test]
            fn $name(base in base()) {
                $(check::<$r, $c>(&base)?;)+
            })+
        }
    };
}

shapes! {
    two_rows: 2 x 2, 2 x 3, 2 x 4, 2 x 5, 2 x 6, 2 x 7;
    three_rows: 3 x 2, 3 x 3, 3 x 4, 3 x 5, 3 x 6, 3 x 7;
    four_rows: 4 x 2, 4 x 3, 4 x 4, 4 x 5, 4 x 6, 4 x 7;
    five_rows: 5 x 2, 5 x 3, 5 x 4, 5 x 5, 5 x 6, 5 x 7;
    six_rows: 6 x 2, 6 x 3, 6 x 4, 6 x 5, 6 x 6, 6 x 7;
    seven_rows: 7 x 2, 7 x 3, 7 x 4, 7 x 5, 7 x 6, 7 x 7;
}

proptest! {
    #![proptest_config(config(1000))]

    #[test]
    fn a_degree_is_right_to_half_a_step(peaks in ascending(5), x in any::<i32>()) {
        let partition = partition::<5>(&peaks);
        let m = partition.fuzzify(I16F16::from_bits(x));
        let exact = membership(&peaks, usize::from(m.lower) + 1, x);
        prop_assert!((f64::from(m.upper_grade.bits()) - exact * 32_768.0).abs() <= 0.5002);
    }

    #[test]
    fn fuzzify_is_monotone(peaks in ascending(4), mut xs in prop::collection::vec(any::<i32>(), 2..40)) {
        let partition = partition::<4>(&peaks);
        xs.extend(peaks.iter().flat_map(|&p| [p.saturating_sub(1), p, p.saturating_add(1)]));
        xs.sort_unstable();
        let place = |x: i32| {
            let m = partition.fuzzify(I16F16::from_bits(x));
            u32::from(m.lower) * (1 << 15) + u32::from(m.upper_grade.bits())
        };
        prop_assert!(xs.windows(2).all(|w| place(w[0]) <= place(w[1])));
    }

    #[test]
    fn scaled_peaks_round_to_the_output(axis in -30_000..30_000i32, gap in 1..30_000i32, scale in -200_000..200_000i32) {
        // Axis peaks below ±1, scale below ±3.1: they fit I3F13.
        let peaks = [I16F16::from_bits(axis), I16F16::from_bits(axis + gap)];
        let consequents = Consequents::<2, FixedI16<U13>>::scaled(peaks, peaks, I16F16::from_bits(scale));
        let table = RuleTable::<2, 2, _>::new([[Term(0), Term(1)], [Term(1), Term(0)]], consequents);
        for (col, peak) in peaks.into_iter().enumerate() {
            let exact = peak.to_num::<f64>() * f64::from(scale) / 65_536.0;
            let got = table.peak(0, col).to_num::<f64>();
            prop_assert!((got - exact).abs() <= 0.5001 / 8192.0);
        }
    }
}

#[test]
fn grades_saturate() {
    assert_eq!(Grade::from_bits(u16::MAX), Grade::ONE);
    assert_eq!(Grade::from_bits(32_769), Grade::ONE);
    assert_eq!(Grade::from_bits(32_768), Grade::ONE);
    assert_eq!(Grade::from_bits(1).complement().bits(), 32_767);
    assert_eq!(Grade::ZERO.complement(), Grade::ONE);
    assert_eq!(Grade::ONE.complement(), Grade::ZERO);
}

#[test]
fn the_largest_peaks_do_not_wrap() {
    // All four rules at ½: Σ w = 2, the accumulator's worst case at both ends of the format.
    for raw in [-i16::MAX, i16::MAX] {
        let peak = FixedI16::<U0>::from_bits(raw);
        let table = RuleTable::<2, 2, FixedI16<U0>>::new(
            [[Term(0); 2]; 2],
            Consequents::new([peak, peak], [peak]),
        );
        let antecedents = Antecedents {
            rows: partition::<2>(&[i32::MIN, i32::MAX]),
            cols: partition::<2>(&[i32::MIN, i32::MAX]),
        };
        for (x, y) in [(0, 0), (i32::MIN, i32::MAX), (-1, 1 << 30)] {
            let activation = antecedents.activate(I16F16::from_bits(x), I16F16::from_bits(y));
            assert_eq!(table.defuzzify(&activation), peak);
        }
        let middle = antecedents.activate(I16F16::ZERO, I16F16::ZERO);
        assert_eq!(middle.weight().get(), 1 << 16);
    }
}

#[test]
fn ties_round_away_from_zero() {
    let raw = FixedI16::<U0>::from_bits;
    let inputs = Antecedents {
        rows: partition::<2>(&[0, 2]),
        cols: partition::<2>(&[0, 2]),
    };
    let between = |a: i16, b: i16| {
        let table = RuleTable::<2, 2, FixedI16<U0>>::new(
            [[Term(0), Term(1)]; 2],
            Consequents::new([raw(a), raw(b)], [raw(a), raw(b)]),
        );
        let half = inputs.activate(I16F16::ZERO, I16F16::from_bits(1));
        table.defuzzify(&half).to_bits()
    };
    assert_eq!(between(0, 1), 1);
    assert_eq!(between(-1, 0), -1);
    assert_eq!(between(-3, 3), 0);
    assert_eq!(between(2, 3), 3);
    assert_eq!(between(-3, -2), -3);
}

#[test]
fn peaks_outside_the_table_count_as_the_last() {
    let base = Base {
        row_peaks: vec![0, 1, 2],
        col_peaks: vec![0, 1],
        outputs: [vec![-5, 0, 1, 2, 3, 4, 9], vec![0; 7], vec![0; 7]],
        cells: (0..7).cycle().take(147).collect(),
    };
    let table = table::<3, 2, 7, U8>(&base, 0);
    assert_eq!(table.peak(usize::MAX, usize::MAX), table.peak(2, 1));
    assert_eq!(table.peak(0, 5), table.peak(0, 1));
    assert_eq!(table.terms()[0], [Term(0), Term(1)]);
}
