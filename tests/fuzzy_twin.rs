//! The quick route of the engine, [`TwinTable`], over random tables and positions: what it gives is what the two
//! [`RuleTable`]s give. And the scales around it, at the ends of the number formats.

use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::{U8, U13};
use fuzzypilot::fuzzy::{
    Antecedents, Consequents, InputScale, MirroredTwin, OutputScale, Partition, Position,
    RuleTable, Term, Twin, TwinTable,
};
use proptest::prelude::*;
use std::sync::LazyLock;

const WIDE: f64 = (1 << Twin::<2, 2>::EXTRA_BITS) as f64;

/// A failure prints its smallest input; nothing is written beside the tests.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Peaks of both outputs, raw, and cells by their place among them: more than any shape needs.
#[derive(Clone, Debug)]
struct Base {
    peaks: [Vec<i16>; 2],
    cells: Vec<u8>,
    positions: Vec<(u32, u32)>,
}

/// The most negative raw value does not compile.
fn peaks() -> impl Strategy<Value = Vec<i16>> {
    prop_oneof![
        prop::collection::btree_set(-i16::MAX..=i16::MAX, 7),
        prop::collection::btree_set(-40..=40i16, 7),
        prop::collection::btree_set((i16::MAX - 40)..=i16::MAX, 7),
        prop::collection::btree_set(-i16::MAX..=(40 - i16::MAX), 7),
    ]
    .prop_map(|set| set.into_iter().collect())
}

/// Anything, and around the peaks of two to nine terms, where gaps begin.
fn position() -> impl Strategy<Value = u32> {
    let near = (1..9u64, 0..9u64, -2..=2i64).prop_map(|(gaps, peak, off)| {
        let at = (peak.min(gaps) << 32).div_ceil(gaps) as i64 + off;
        at.clamp(0, u32::MAX.into()) as u32
    });
    prop_oneof![any::<u32>(), near, Just(0), Just(u32::MAX)]
}

fn base() -> impl Strategy<Value = Base> {
    (
        [peaks(), peaks()],
        prop::collection::vec(0..7u8, 2 * 49),
        prop::collection::vec((position(), position()), 64),
    )
        .prop_map(|(peaks, cells, positions)| Base {
            peaks,
            cells,
            positions,
        })
}

/// Peaks a unit apart.
fn even<const N: usize>() -> Partition<N> {
    Partition::new(std::array::from_fn(|i| I16F16::from_num(i)))
}

type Speed = FixedI16<U13>;
type Degrees = FixedI16<U8>;

/// The inputs' terms and both outputs' tables.
type Rules<const R: usize, const C: usize> = (
    Antecedents<R, C>,
    RuleTable<R, C, Speed>,
    RuleTable<R, C, Degrees>,
);

fn rules<const R: usize, const C: usize>(base: &Base) -> Rules<R, C> {
    let cells = |output: usize| {
        std::array::from_fn(|row| {
            std::array::from_fn(|col| Term(base.cells[49 * output + 7 * row + col]))
        })
    };
    let peak = |output: usize, k: usize| base.peaks[output][k];
    let antecedents = Antecedents {
        rows: even(),
        cols: even(),
    };
    let first = RuleTable::new(
        cells(0),
        Consequents::new(
            [0, 6].map(|k| Speed::from_bits(peak(0, k))),
            std::array::from_fn::<_, 7, _>(|k| Speed::from_bits(peak(0, k))),
        ),
    );
    let second = RuleTable::new(
        cells(1),
        Consequents::new(
            [0, 6].map(|k| Degrees::from_bits(peak(1, k))),
            std::array::from_fn::<_, 7, _>(|k| Degrees::from_bits(peak(1, k))),
        ),
    );
    (antecedents, first, second)
}

/// Where a position lies between `N` terms: the lower one, and the exact degree of the upper one.
fn between<const N: usize>(bits: u32) -> (usize, f64) {
    let scaled = f64::from(bits) / 4_294_967_296.0 * (N - 1) as f64;
    let lower = (scaled as usize).min(N - 2);
    (lower, scaled - lower as f64)
}

/// How far an output, of the magnitude of its four peaks, is from the mean over the grades: it is nearer to zero than
/// that by `SHORT` of them at most, and below it by a step at most.
const SHORT: f64 = 1.53e-5;

/// The exact mean over the grades, raw units; the least and the greatest of the four peaks.
fn mean(degrees: [f64; 4], peaks: [i16; 4]) -> (f64, i16, i16) {
    let weighed: f64 = degrees
        .iter()
        .zip(peaks)
        .map(|(w, p)| w * f64::from(p))
        .sum();
    let weight: f64 = degrees.iter().sum();
    let least = *peaks.iter().min().unwrap();
    let most = *peaks.iter().max().unwrap();
    (weighed / weight, least, most)
}

fn check<const R: usize, const C: usize, const GAPS: usize>(
    base: &Base,
) -> Result<(), TestCaseError> {
    let (antecedents, first, second) = rules::<R, C>(base);
    let twins = TwinTable::<R, C, GAPS>::new(&antecedents, &first, &second);
    for &(x, y) in &base.positions {
        let twin = twins.evaluate(Position::from_bits(x), Position::from_bits(y));
        prop_assert_eq!(
            twin,
            twins.evaluate_plain(Position::from_bits(x), Position::from_bits(y))
        );
        // The rules: the right cell, and each degree right to a step of the grades (both memberships are to half of one).
        let activation = twin.activation;
        let ((row, f), (col, g)) = (between::<R>(x), between::<C>(y));
        prop_assert_eq!(
            (usize::from(activation.row()), usize::from(activation.col())),
            (row, col)
        );
        let degrees = activation
            .degrees()
            .map(|degree| f64::from(degree.bits()) / 32_768.0);
        let exact = [
            (1.0 - f).min(1.0 - g),
            (1.0 - f).min(g),
            f.min(1.0 - g),
            f.min(g),
        ];
        for (degree, exact) in degrees.iter().zip(exact) {
            prop_assert!(
                (degree - exact).abs() <= 0.501 / 32_768.0,
                "{degree} for {exact}"
            );
        }
        // The outputs: the mean over these degrees.
        let cell = [
            (row, col),
            (row, col + 1),
            (row + 1, col),
            (row + 1, col + 1),
        ];
        let outputs = [
            (
                twin.first,
                cell.map(|(row, col)| first.peak(row, col).to_bits()),
                first.defuzzify(&activation).to_bits(),
            ),
            (
                twin.second,
                cell.map(|(row, col)| second.peak(row, col).to_bits()),
                second.defuzzify(&activation).to_bits(),
            ),
        ];
        for ((wide, peaks, one), rounded) in outputs.into_iter().zip(twin.rounded()) {
            let (exact, least, most) = mean(degrees, peaks);
            let off = f64::from(wide) / WIDE - exact;
            let short = exact.abs() * SHORT;
            let (low, high) = match exact >= 0.0 {
                true => (-short, 0.0),
                false => (0.0, short),
            };
            prop_assert!(
                (low - 1.0 / WIDE..=high + 1e-9).contains(&off),
                "{off} off {exact}"
            );
            prop_assert!((least..=most).contains(&rounded));
            prop_assert!(rounded.abs_diff(one) <= 1, "{rounded} for {one}");
        }
    }
    // Exact where two peaks meet.
    for (row, col) in (0..R * C).map(|cell| (cell / C, cell % C)) {
        let at = |peak: usize, n: usize| match peak {
            last if last + 1 == n => Position::LAST,
            _ => Position::from_bits(((peak as u64) << 32).div_ceil(n as u64 - 1) as u32),
        };
        let twin = twins.evaluate(at(row, R), at(col, C));
        prop_assert_eq!(
            twin.rounded(),
            [
                first.peak(row, col).to_bits(),
                second.peak(row, col).to_bits()
            ]
        );
    }
    Ok(())
}

macro_rules! shapes {
    ($($name:ident: $($r:literal x $c:literal),+;)+) => {
        proptest! {
            #![proptest_config(config(64))]
            $(#[test]
            fn $name(base in base()) {
                $(check::<$r, $c, { $r - 1 }>(&base)?;)+
            })+
        }
    };
}

shapes! {
    two_rows: 2 x 2, 2 x 3, 2 x 5, 2 x 7;
    three_rows: 3 x 2, 3 x 3, 3 x 6;
    four_rows: 4 x 3, 4 x 4, 4 x 7;
    five_rows: 5 x 2, 5 x 5, 5 x 6;
    six_rows: 6 x 2, 6 x 4, 6 x 6;
    seven_rows: 7 x 3, 7 x 5, 7 x 7;
}

/// What is stated of the error is reached: a whole and another one of the same conclusion weigh two.
#[test]
fn an_output_falls_short_by_what_is_stated() {
    const HIGH: i16 = i16::MAX;
    let base = Base {
        peaks: [0, 1].map(|_| (0..7).map(|k| HIGH - 6 + k).collect()),
        cells: vec![6; 98],
        positions: Vec::new(),
    };
    let (antecedents, first, second) = rules::<2, 2>(&base);
    let twins = TwinTable::<2, 2, 1>::new(&antecedents, &first, &second);
    let worst = (0..=1024u32)
        .map(|i| {
            let at = Position::from_bits(i.saturating_mul(1 << 22));
            let twin = twins.evaluate(at, at);
            1.0 - f64::from(twin.first) / WIDE / f64::from(HIGH)
        })
        .fold(0.0, f64::max);
    assert!((0.9 * SHORT..=SHORT).contains(&worst), "{worst:e}");
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn an_input_scale_multiplies_and_saturates(raw in any::<i32>(), gain in any::<u32>()) {
        let exact = i64::from(raw).max(0) as u64 * u64::from(gain.max(1));
        let position = InputScale::new(gain).position(raw);
        prop_assert_eq!(u64::from(position.bits()), exact.min(u32::MAX.into()));
    }

    #[test]
    fn an_output_scale_keeps_sixteen_bits(
        wide in any::<i32>(),
        numerator in 1..1u64 << 40,
        shift in 1..17u32,
        part in 1.0..1.999f64,
    ) {
        // Between 2^-17 and just below a half.
        let denominator = (numerator as f64 * f64::from(1u32 << shift) * part) as u64;
        prop_assume!(denominator > 2 * numerator);
        let exact = f64::from(wide) * (numerator as f64 / denominator as f64);
        let off = f64::from(OutputScale::new(numerator, denominator).apply(wide)) - exact;
        // Of the factor half a step of sixteen bits; and a step down.
        let bound = exact.abs() / 65_536.0;
        prop_assert!((-bound - 1.0..=bound + 1e-6).contains(&off), "{off} off {exact}");
    }
}

#[test]
fn an_input_scale_at_its_ends() {
    // The last count on the axis, the first beyond it, and a last count that fills the axis.
    for gain in [2, 3, 16_384, 163_840, 1 << 31, u32::MAX] {
        let scale = InputScale::new(gain);
        let last = (u32::MAX / gain) as i32;
        assert_eq!(scale.position(last).bits(), last as u32 * gain, "{gain}");
        for beyond in [last.saturating_add(1), i32::MAX] {
            // With a gain of 2 the axis is longer than the format.
            let expected = match beyond > last {
                true => Position::LAST,
                false => Position::from_bits(beyond as u32 * gain),
            };
            assert_eq!(scale.position(beyond), expected, "{gain}");
        }
        for below in [i32::MIN, -1, 0] {
            assert_eq!(scale.position(below), Position::FIRST, "{gain}");
        }
    }
    // No gain is the least; with it no count leaves the axis.
    assert_eq!(InputScale::new(0), InputScale::new(1));
    assert_eq!(
        InputScale::new(1).position(i32::MAX).bits(),
        i32::MAX as u32
    );
}

#[test]
fn an_output_scale_at_its_ends() {
    let apply = |numerator, denominator, wide| OutputScale::new(numerator, denominator).apply(wide);
    // Just below a half, whatever is asked for above.
    let most = OutputScale::new(65_535, 131_072);
    for (numerator, denominator) in [(1, 2), (1, 1), (u64::MAX, 1), (1, 0), (0, 0), (u64::MAX, 0)] {
        assert_eq!(OutputScale::new(numerator, denominator), most);
    }
    assert_eq!(most.apply(i32::MAX), 1_073_725_439);
    assert_eq!(most.apply(i32::MIN), -1_073_725_440);
    // Nothing, and what counts as nothing: less than half of 2^-32.
    for denominator in [1, 2, u64::MAX] {
        assert_eq!(apply(0, denominator, i32::MAX), 0);
    }
    assert_eq!(apply(1, u64::MAX, i32::MAX), 0);
    assert_eq!(apply(1, 1 << 32, i32::MAX), 0);
    assert_eq!(apply(3, 1 << 34, i32::MIN), -1);
    assert_eq!(apply(1, 1 << 31, i32::MIN), -1);
    // Towards minus infinity.
    assert_eq!(
        [-5, -4, -1, 0, 3, 4, 7].map(|wide| apply(1, 4, wide)),
        [-2, -1, -1, 0, 0, 1, 1]
    );
}

/// A mirrored twin is its parts in a row: the magnitude on the rows' axis, the columns' scale, the tables, the outputs'
/// scales, and the sign again.
#[test]
fn a_mirrored_twin_is_odd_in_its_rows() {
    static TABLE: LazyLock<TwinTable<3, 4, 2>> = LazyLock::new(|| {
        let base = Base {
            peaks: [
                vec![-32_767, -9, 0, 1, 5, 77, 32_767],
                vec![-3, -2, -1, 4, 900, 8_000, 30_000],
            ],
            cells: (0..98u16)
                .map(|cell| ((cell * 5 + cell / 7) % 7) as u8)
                .collect(),
            positions: Vec::new(),
        };
        let (antecedents, first, second) = rules::<3, 4>(&base);
        TwinTable::new(&antecedents, &first, &second)
    });
    let (columns, scales) = (
        InputScale::new(163_840),
        [OutputScale::new(1, 3), OutputScale::new(1, 700)],
    );
    let mirrored = MirroredTwin::new(&*TABLE, columns, scales);
    let rows = (0..200).map(|i| i * 10_737_417).chain([0, 1, i32::MAX]);
    for row in rows {
        for column in (-2..30).map(|i| i * 1009).chain([i32::MIN, i32::MAX]) {
            let at = (
                Position::from_bits(row as u32 * 2),
                columns.position(column),
            );
            let twin = TABLE.evaluate(at.0, at.1);
            let [first, second] = [twin.first, twin.second];
            let (first, second) = (scales[0].apply(first), scales[1].apply(second));
            for (row, second) in [(row, second), (!row, -second)] {
                let got = mirrored.evaluate(row, column);
                assert_eq!(got, mirrored.evaluate_plain(row, column));
                assert_eq!((got.first, got.second), (first, second), "{row} {column}");
                assert_eq!((got.row, got.column, got.twin), (at.0, at.1, twin));
            }
        }
    }
}
