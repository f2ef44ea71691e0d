//! The shipped rule tables against an independent oracle in f64: every rule evaluated with explicit membership
//! functions, the tables typed in a second time as their printed term names. Where the data directory is present,
//! also against a grid that fuzzylite computed.

use fixed::types::I16F16;
use fuzzypilot::fuzzy::{Activation, Partition};
use fuzzypilot::tables::coarse::{self, SpeedInput};
use fuzzypilot::tables::fine;
use std::path::Path;

#[path = "oracle/grid.rs"]
mod fuzzylite;

const STEP_SPEED: f64 = 1.0 / 8192.0; // I3F13
const STEP_DEGREES: f64 = 1.0 / 256.0; // I8F8
const STEP_SHARE: f64 = 1.0 / 16384.0; // I2F14
const STEP_GRADE: f64 = 1.0 / 32768.0;

/// A term of an axis: its name and its peak.
type Axis = [(&'static str, f64)];

const PHI: &Axis = &[
    ("VS", 0.0),
    ("S", 45.0),
    ("N", 90.0),
    ("B", 135.0),
    ("VB", 180.0),
];
const D: &Axis = &[
    ("VN", 0.0),
    ("QN", 1.0),
    ("N", 2.0),
    ("QF", 3.0),
    ("VF", 4.0),
];
const SPEED: &Axis = &[
    ("VS", 0.4),
    ("S", 0.75),
    ("N", 1.5),
    ("B", 2.25),
    ("VB", 2.6),
];
const SPEED_TUNED: &Axis = &[("VS", 0.0), ("S", 0.3), ("N", 1.2), ("B", 2.4), ("VB", 3.0)];
const DEFLECTION: &Axis = &[
    ("VS", 0.0),
    ("S", 20.0),
    ("N", 45.0),
    ("B", 70.0),
    ("VB", 90.0),
];
const S: &Axis = &[("N", 0.0), ("M", 0.5), ("F", 1.0)];
const ANGLE: &Axis = &[("L", -90.0), ("Z", 0.0), ("R", 90.0)];
const SHARE: &Axis = &[("S", 1.0 / 3.0), ("N", 2.0 / 3.0), ("B", 1.0)];

/// Tables 7.1 to 7.4 and the tuned pair; rows φ or s, columns d or the angle.
const TABLE_7_1: &str = "S S N B VB / S S N N B / VS S S N N / VS VS S S N / VB VS VS S N";
const TABLE_7_2: &str = "VS VS VS VS VS / S N S S S / VS N N S S / N B B N N / B VB B B N";
const TABLE_7_2_PROSE: &str = "VS VS VS VS VS / S N S S S / VS N B S S / N B B N N / B VB B B N";
const TUNED_SPEED: &str =
    "VB VB VB VB VB / N N N N N / S S S S S / VS VS VS VS VS / VS VS VS VS VS";
const TUNED_DEFLECTION: &str =
    "VS VS VS VS VS / N N N N N / B B B B B / VB VB VB VB VB / VB VB VB VB VB";
const TABLE_7_3: &str = "L R R / Z R Z / Z R Z";
const TABLE_7_3_PRINTED: &str = "L R L / Z R Z / Z R Z";
const TABLE_7_4: &str = "S S S / N S N / B N B";

/// Membership of `x` in term `i`: a triangle to the neighbouring peaks, a shoulder where there is none.
fn membership(axis: &Axis, i: usize, x: f64) -> f64 {
    let peak = axis[i].1;
    let rising = match i.checked_sub(1) {
        Some(left) => (x - axis[left].1) / (peak - axis[left].1),
        None => 1.0,
    };
    let falling = match axis.get(i + 1) {
        Some((_, right)) => (right - x) / (right - peak),
        None => 1.0,
    };
    rising.min(falling).clamp(0.0, 1.0)
}

/// A rule that fired: row, column, degree.
type Fired = (usize, usize, f64);

/// Every rule of the base, min as AND; those above zero.
fn fire(rows: &Axis, cols: &Axis, row_input: f64, col_input: f64) -> Vec<Fired> {
    let mut fired = Vec::new();
    for row in 0..rows.len() {
        for col in 0..cols.len() {
            let degree = membership(rows, row, row_input).min(membership(cols, col, col_input));
            if degree > 0.0 {
                fired.push((row, col, degree));
            }
        }
    }
    fired
}

/// The peaks that a table's cells name.
fn peaks(table: &str, output: &Axis) -> Vec<Vec<f64>> {
    let peak = |name: &str| output.iter().find(|(n, _)| *n == name).unwrap().1;
    table
        .split('/')
        .map(|row| row.split_whitespace().map(peak).collect())
        .collect()
}

/// Height defuzzification.
fn height(fired: &[Fired], peaks: &[Vec<f64>]) -> f64 {
    let sum: f64 = fired.iter().map(|&(r, c, w)| w * peaks[r][c]).sum();
    let weight: f64 = fired.iter().map(|&(_, _, w)| w).sum();
    sum / weight
}

fn fx(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

/// From `low` to `high` in `n` steps, as the library's input format holds them.
fn grid(low: f64, high: f64, n: usize) -> Vec<I16F16> {
    (0..=n)
        .map(|i| fx(low + (high - low) * i as f64 / n as f64))
        .collect()
}

/// Asserts that `activation` names exactly the rules that the oracle fires. A rule weaker than the grade's rounding
/// may be missing on either side.
fn assert_fired<const R: usize, const C: usize>(activation: &Activation<R, C>, oracle: &[Fired]) {
    let fired = activation.fired();
    assert!(oracle.len() <= 4 && matches!(fired.len(), 1 | 2 | 4));
    for rule in &fired {
        let degree = f64::from(rule.degree.bits()) * STEP_GRADE;
        let expected = oracle
            .iter()
            .find(|&&(r, c, _)| (r, c) == (rule.row.into(), rule.col.into()))
            .map_or(0.0, |&(_, _, w)| w);
        assert!(
            (degree - expected).abs() <= 0.501 * STEP_GRADE,
            "{rule:?}: {expected}"
        );
    }
    for &(row, col, degree) in oracle {
        let listed = fired
            .iter()
            .any(|f| (usize::from(f.row), usize::from(f.col)) == (row, col));
        assert!(
            listed || degree <= 0.501 * STEP_GRADE,
            "({row}, {col}) {degree}"
        );
    }
}

#[test]
fn worked_example_of_the_chapter() {
    let out = fine::PRINTED.evaluate(fx(1.2), fx(100.0));
    let fired = out.activation.fired();
    // Rows φ, columns d: (QN, N) 0.778, (N, N) 0.2, (QN, B) 0.222, (N, B) 0.2.
    let expected = [
        (2, 1, 7.0 / 9.0),
        (2, 2, 0.2),
        (3, 1, 2.0 / 9.0),
        (3, 2, 0.2),
    ];
    assert_eq!(fired.len(), 4);
    for (rule, (row, col, degree)) in fired.iter().zip(expected) {
        assert_eq!((rule.row, rule.col), (row, col));
        assert!((f64::from(rule.degree.bits()) * STEP_GRADE - degree).abs() < STEP_GRADE);
    }
    assert!((out.speed.to_num::<f64>() - 0.694_444).abs() < STEP_SPEED);
    assert!((out.deflection.to_num::<f64>() - 52.539_683).abs() < STEP_DEGREES);

    // The prose's conclusion B for rule (N, N) contradicts the printed 52°.
    let prose = fine::PRINTED_PROSE.evaluate(fx(1.2), fx(100.0));
    assert!((prose.deflection.to_num::<f64>() - 56.111_111).abs() < STEP_DEGREES);
    assert_eq!(prose.speed, out.speed);
}

#[test]
fn fine_tables_on_a_dense_grid() {
    let sets = [
        (&fine::PRINTED, TABLE_7_1, SPEED, TABLE_7_2),
        (&fine::PRINTED_PROSE, TABLE_7_1, SPEED, TABLE_7_2_PROSE),
        (&fine::TUNED, TUNED_SPEED, SPEED_TUNED, TUNED_DEFLECTION),
    ];
    for (n, (tables, speed, speed_axis, deflection)) in sets.into_iter().enumerate() {
        let (speed, deflection) = (peaks(speed, speed_axis), peaks(deflection, DEFLECTION));
        let (mut worst_v, mut worst_d) = (0.0f64, 0.0f64);
        // Beyond both ends of both axes, in steps that share no factor with the peaks' spacing.
        for phi in grid(-7.3, 191.7, 397) {
            for d in grid(-0.37, 4.41, 283) {
                let out = tables.evaluate(d, phi);
                let fired = fire(PHI, D, phi.to_num(), d.to_num());
                assert_fired(&out.activation, &fired);
                let miss_v = out.speed.to_num::<f64>() - height(&fired, &speed);
                let miss_d = out.deflection.to_num::<f64>() - height(&fired, &deflection);
                worst_v = worst_v.max(miss_v.abs());
                worst_d = worst_d.max(miss_d.abs());
            }
        }
        println!("fine set {n}: v {worst_v:.6}, deflection {worst_d:.6}°");
        // No less than half an output step: were it zero, nothing would have been compared.
        assert!(worst_v > 0.49 * STEP_SPEED && worst_v < 0.000_2);
        assert!(worst_d > 0.49 * STEP_DEGREES && worst_d < 0.004_5);
    }
}

#[test]
fn coarse_tables_on_a_dense_grid() {
    let sets = [
        (&coarse::CORRECTED, TABLE_7_3),
        (&coarse::PRINTED, TABLE_7_3_PRINTED),
    ];
    let speed = peaks(TABLE_7_4, SHARE);
    for (tables, deflection) in sets {
        let deflection = peaks(deflection, ANGLE);
        for input in [SpeedInput::Deflection, SpeedInput::Bearing] {
            let (mut worst_v, mut worst_d) = (0.0f64, 0.0f64);
            for s in grid(-0.31, 1.29, 317) {
                for theta in grid(-181.0, 179.5, 443) {
                    let out = tables.evaluate(s, theta, input);
                    let fired = fire(S, ANGLE, s.to_num(), theta.to_num());
                    assert_fired(&out.deflection_rules, &fired);
                    let wanted = height(&fired, &deflection);
                    worst_d = worst_d.max((out.deflection.to_num::<f64>() - wanted).abs());
                    let angle = match input {
                        SpeedInput::Deflection => wanted,
                        SpeedInput::Bearing => theta.to_num(),
                    };
                    let fired = fire(S, ANGLE, s.to_num(), angle);
                    if input == SpeedInput::Bearing {
                        // Table 7.4 is symmetric: only its rules tell which sign it was fed.
                        assert_fired(&out.speed_rules, &fired);
                    }
                    let wanted = height(&fired, &speed);
                    worst_v = worst_v.max((out.speed.to_num::<f64>() - wanted).abs());
                }
            }
            println!("coarse {input:?}: share {worst_v:.6}, deflection {worst_d:.6}°");
            assert!(worst_v > 0.49 * STEP_SHARE && worst_v < 0.000_12);
            assert!(worst_d > 0.49 * STEP_DEGREES && worst_d < 0.007);
        }
    }
}

#[test]
fn the_errata_turn_as_described() {
    // Near an obstacle on the left (θ = 90°) the corrected table turns right, the printed one into it.
    let near_left = (fx(0.0), fx(90.0));
    let turn = |tables: &coarse::CoarseTables| {
        tables
            .evaluate(near_left.0, near_left.1, SpeedInput::Deflection)
            .deflection
            .to_num::<f64>()
    };
    assert_eq!(turn(&coarse::CORRECTED), 90.0);
    assert_eq!(turn(&coarse::PRINTED), -90.0);
}

/// The two memberships of every input sum to one, follow the triangles, and only grow towards the upper term.
fn assert_ruspini<const N: usize>(partition: &Partition<N>, axis: &Axis) {
    assert_eq!(partition.peaks().map(f64::from).to_vec(), {
        let peaks: Vec<f64> = axis.iter().map(|(_, p)| *p).collect();
        peaks
    });
    let (low, high) = (axis[0].1, axis[N - 1].1);
    let margin = 0.1 * (high - low);
    let mut before = 0;
    for x in grid(low - margin, high + margin, 40_009) {
        let m = partition.fuzzify(x);
        let (lower, upper) = (m.upper_grade.complement().bits(), m.upper_grade.bits());
        assert_eq!(lower + upper, 1 << 15);
        let everywhere: f64 = (0..N).map(|i| membership(axis, i, x.to_num())).sum();
        assert!((everywhere - 1.0).abs() < 1e-12);
        for (term, grade) in [(m.lower, lower), (m.lower + 1, upper)] {
            let exact = membership(axis, term.into(), x.to_num());
            assert!((f64::from(grade) * STEP_GRADE - exact).abs() <= 0.501 * STEP_GRADE);
        }
        let place = u32::from(m.lower) * (1 << 15) + u32::from(upper);
        assert!(place >= before, "falls at {x}");
        before = place;
    }
    assert_eq!(before, (N as u32 - 1) << 15);
}

#[test]
fn partitions_of_unity_and_monotone() {
    assert_ruspini(&fine::PRINTED.antecedents.rows, PHI);
    assert_ruspini(&fine::PRINTED.antecedents.cols, D);
    assert_ruspini(&coarse::CORRECTED.antecedents.rows, S);
    assert_ruspini(&coarse::CORRECTED.antecedents.cols, ANGLE);
}

#[test]
fn fuzzylite_grid() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let Some(grid) = fuzzylite::rows(data).unwrap() else {
        println!("skipped: fuzzylite's grid is absent");
        return;
    };
    let (mut worst_v, mut worst_d, mut rows) = (0.0f64, 0.0f64, 0);
    for [d, phi, v, deflection] in grid {
        let out = fine::PRINTED.evaluate(fx(d), fx(phi));
        worst_v = worst_v.max((out.speed.to_num::<f64>() - v).abs());
        worst_d = worst_d.max((out.deflection.to_num::<f64>() - deflection).abs());
        rows += 1;
    }
    println!("fuzzylite: {rows} rows, v {worst_v:.6}, deflection {worst_d:.6}°");
    assert_eq!(rows, 201 * 181);
    assert!(worst_v > 0.49 * STEP_SPEED && worst_v < 0.000_2);
    assert!(worst_d > 0.49 * STEP_DEGREES && worst_d < 0.004_5);
}
