//! The checked-in designs say what they claim to say.

use super::{design, designs, read};
use fixed::types::I16F16;
use fuzzypilot::tables::coarse;
use fuzzypilot::tables::fine::{self, PRINTED};
use host_sim::fuzzy::files::{Format, adapt, fcl, fll, load};
use host_sim::fuzzy::model::{Antecedent, Conclusion, Input, Merge, Output, Shape, System};

#[test]
fn every_design_reads_and_survives_its_own_format_and_the_other() {
    let designs = designs();
    assert!(designs.len() >= 8, "{designs:?}");
    for file in designs {
        let system = load(&file, None).unwrap().without_places();
        let mut adapted = system.clone();
        adapt::to_fll(&mut adapted);
        let text = fll::write(&adapted).unwrap();
        assert_eq!(read(&text, Format::Fll).without_places(), adapted, "{text}");
        match fcl::write(&system) {
            Ok(text) => assert_eq!(
                read(&text, Format::Fcl).without_places(),
                system.without_descriptions(),
                "{text}"
            ),
            Err(error) => assert!(
                error.to_string().contains("linear"),
                "{}: {error}",
                file.display()
            ),
        }
    }
}

#[test]
fn the_fine_controller_is_the_same_in_three_formats() {
    let fll = design("fine.fll").without_places();
    assert_eq!(design("fine.fcl").without_places(), fll);
    assert_eq!(design("fine.fis").without_places(), fll);
}

/// Peaks of an input whose terms are a Ruspini partition: ramps at the ends, triangles between their neighbours.
fn peaks(input: &Input) -> Vec<f64> {
    let shapes: Vec<&Shape> = input.terms.iter().map(|t| &t.shape).collect();
    let mut peaks = Vec::new();
    for (i, shape) in shapes.iter().enumerate() {
        peaks.push(match **shape {
            Shape::Ramp { to, .. } if i == 0 || i + 1 == shapes.len() => to,
            Shape::Triangle { peak, .. } => peak,
            ref other => panic!("{other:?}"),
        });
    }
    for (i, shape) in shapes.iter().enumerate() {
        let neighbours = match **shape {
            Shape::Ramp { from, .. } if i == 0 => vec![(1, from)],
            Shape::Ramp { from, .. } => vec![(i - 1, from)],
            Shape::Triangle { left, right, .. } => vec![(i - 1, left), (i + 1, right)],
            _ => vec![],
        };
        for (neighbour, foot) in neighbours {
            assert_eq!(peaks[neighbour], foot, "{}", input.name);
        }
    }
    peaks
}

fn bits<const N: usize>(peaks: [I16F16; N]) -> Vec<f64> {
    peaks.iter().map(|p| p.to_num()).collect()
}

/// The term of `output` that the rule for terms `row` and `col` of the two inputs concludes.
fn cell(system: &System, output: usize, row: usize, col: usize) -> usize {
    let is = |input, term| Antecedent::Is {
        input,
        term,
        negated: false,
    };
    let condition = Antecedent::And(vec![is(0, row), is(1, col)]);
    let rules = &system.blocks[0].rules;
    let found: Vec<_> = rules.iter().filter(|r| r.antecedent == condition).collect();
    assert_eq!(found.len(), 1, "row {row}, column {col}");
    assert_eq!(found[0].weight, 1.0);
    let conclusion = found[0].conclusions.iter().find(|c| c.0 == output);
    conclusion.unwrap().1
}

fn constants(output: &Output) -> Vec<f64> {
    let constant = |c: &Conclusion| match c {
        Conclusion::Constant(x) => *x,
        other => panic!("{other:?}"),
    };
    output
        .terms
        .iter()
        .map(|t| constant(&t.conclusion))
        .collect()
}

#[test]
fn the_fine_controller_is_tables_7_1_and_7_2() {
    let system = design("fine.fll");
    let [phi, d] = &system.inputs[..] else {
        panic!("{:?}", system.inputs)
    };
    assert_eq!(peaks(phi), bits(PRINTED.antecedents.rows.peaks()));
    assert_eq!(peaks(d), bits(PRINTED.antecedents.cols.peaks()));
    let names: Vec<&str> = d.terms.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, fine::DISTANCE_TERMS);
    let [speed, deflection] = &system.outputs[..] else {
        panic!("{:?}", system.outputs)
    };
    let (speeds, deflections) = (constants(speed), constants(deflection));
    for output in [speed, deflection] {
        let names: Vec<&str> = output.terms.iter().map(|t| t.name.as_str()).collect();
        assert_eq!(names, fine::TERMS);
        assert_eq!(output.merge, Merge::Sum);
    }
    assert_eq!(system.blocks[0].rules.len(), 25);
    for row in 0..5 {
        for col in 0..5 {
            let term = cell(&system, 0, row, col);
            assert_eq!(term, usize::from(PRINTED.speed.terms()[row][col].0));
            let peak: f64 = PRINTED.speed.peak(row, col).to_num();
            // A step of the table's format is 1.22e-4.
            assert!((speeds[term] - peak).abs() < 1.22e-4, "{peak}");
            let term = cell(&system, 1, row, col);
            assert_eq!(term, usize::from(PRINTED.deflection.terms()[row][col].0));
            let peak: f64 = PRINTED.deflection.peak(row, col).to_num();
            assert_eq!(deflections[term], peak);
        }
    }
}

#[test]
fn the_coarse_deflection_is_table_7_3_corrected() {
    let system = design("coarse-deflection.fll");
    let tables = &coarse::CORRECTED;
    assert_eq!(
        peaks(&system.inputs[0]),
        bits(tables.antecedents.rows.peaks())
    );
    assert_eq!(
        peaks(&system.inputs[1]),
        bits(tables.antecedents.cols.peaks())
    );
    let constants = constants(&system.outputs[0]);
    assert_eq!(system.blocks[0].rules.len(), 9);
    for row in 0..3 {
        for col in 0..3 {
            let term = cell(&system, 0, row, col);
            assert_eq!(term, usize::from(tables.deflection.terms()[row][col].0));
            assert_eq!(
                constants[term],
                tables.deflection.peak(row, col).to_num::<f64>()
            );
        }
    }
}
