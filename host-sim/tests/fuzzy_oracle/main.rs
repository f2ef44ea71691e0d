//! Fuzzy systems evaluated here and by an independent program, pyfuzzylite: random ones and the checked-in designs.
//!
//! `tests/oracle/install` puts pyfuzzylite where this test looks for it; without it the test says so and passes, in CI it
//! fails.

mod fll;

use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::model::{Defuzzifier, Output, Sampling, System};
use host_sim::fuzzy::random;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Random systems.
const SYSTEMS: usize = 240;
/// Points a system, random ones; its terms' knots are added.
const POINTS: usize = 60;
/// Agreement in `f64`, of an output's range and of a degree.
const EXACT: f64 = 1e-9;

#[derive(Serialize)]
struct Case {
    fll: String,
    points: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct Answer {
    outputs: Vec<Vec<Option<f64>>>,
    rules: Vec<Vec<f64>>,
}

/// Asks pyfuzzylite; `None` if it is not there.
fn ask(cases: &[Case]) -> Option<Vec<Answer>> {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("../oracle");
    if !home.join("installed.txt").is_file() {
        let missing = "pyfuzzylite is missing: run tests/oracle/install";
        assert!(std::env::var_os("CI").is_none(), "{missing}");
        eprintln!("skipped: {missing}");
        return None;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/oracle/evaluate.py");
    let mut child = Command::new(home.join("bin/python"))
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let input = child.stdin.take().unwrap();
    serde_json::to_writer(input, cases).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{script}: {}", output.status);
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// Random points in and a little around the ranges, and some whose every input is at a knot of one of its terms.
fn points(rng: &mut impl Rng, system: &System) -> Vec<Vec<f64>> {
    let mut anywhere = |input: &host_sim::fuzzy::model::Input| {
        let (start, end) = (*input.range.start(), *input.range.end());
        let x = start + (end - start) * rng.random_range(-0.1..1.1);
        let knots: Vec<f64> = input.terms.iter().flat_map(|t| t.shape.knots()).collect();
        let knot = knots[rng.random_range(0..knots.len())];
        (x, knot)
    };
    let mut points = Vec::new();
    for _ in 0..POINTS {
        let (free, at_knots) = system.inputs.iter().map(&mut anywhere).unzip();
        points.extend([free, at_knots]);
    }
    points
}

fn span(output: &Output) -> f64 {
    output.range.end() - output.range.start()
}

/// fuzzylite knows only one way to sample a set.
fn with_middles(mut system: System) -> System {
    for output in &mut system.outputs {
        if let Defuzzifier::Centroid { sampling, .. } = &mut output.defuzzifier {
            *sampling = Sampling::Middles;
        }
    }
    system
}

/// What was compared, so that a test that compares nothing is seen.
#[derive(Debug, Default)]
struct Compared {
    values: usize,
    missing: usize,
    worst: f64,
}

/// Compares one system at its points, or says where it disagrees.
fn compare(
    system: &System,
    case: &Case,
    answer: &Answer,
    seen: &mut Compared,
) -> Result<(), String> {
    let exact = Exact::new(system);
    for (point, (outputs, rules)) in case
        .points
        .iter()
        .zip(answer.outputs.iter().zip(&answer.rules))
    {
        let ours = exact.evaluate(point);
        let place = |what: &str| format!("{what} at {point:?} of\n{}", case.fll);
        for (index, (a, b)) in ours.rules.iter().zip(rules).enumerate() {
            if (a - b).abs() > EXACT {
                return Err(place(&format!("rule {index}: {a}, fuzzylite {b}")));
            }
        }
        for ((output, a), b) in system.outputs.iter().zip(&ours.outputs).zip(outputs) {
            match (a, b) {
                (Some(a), Some(b)) => {
                    let error = (a - b).abs() / span(output);
                    seen.values += 1;
                    seen.worst = seen.worst.max(error);
                    if error > EXACT {
                        return Err(place(&format!("{}: {a}, fuzzylite {b}", output.name)));
                    }
                }
                (None, None) => seen.missing += 1,
                _ => return Err(place(&format!("{}: {a:?}, fuzzylite {b:?}", output.name))),
            }
        }
    }
    Ok(())
}

#[test]
fn random_systems_agree_with_fuzzylite() {
    let mut rng = Pcg64Mcg::seed_from_u64(20_26);
    let systems: Vec<System> = (0..SYSTEMS)
        .map(|_| with_middles(random::system(&mut rng)))
        .collect();
    let cases: Vec<Case> = systems
        .iter()
        .map(|system| Case {
            fll: fll::write(system),
            points: points(&mut rng, system),
        })
        .collect();
    let Some(answers) = ask(&cases) else { return };
    assert_eq!(answers.len(), SYSTEMS);
    let mut seen = Compared::default();
    let mut wrong = Vec::new();
    for ((system, case), answer) in systems.iter().zip(&cases).zip(&answers) {
        assert_eq!(answer.outputs.len(), case.points.len());
        wrong.extend(compare(system, case, answer, &mut seen).err());
    }
    println!("{seen:?}");
    assert!(
        wrong.is_empty(),
        "{} systems disagree; the first: {}",
        wrong.len(),
        wrong[0]
    );
    assert!(
        seen.values > 100 * SYSTEMS && seen.missing > 100,
        "{seen:?}"
    );
}
