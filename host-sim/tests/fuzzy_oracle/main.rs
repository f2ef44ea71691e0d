//! Fuzzy systems evaluated here and by an independent program, pyfuzzylite: random ones and the checked-in designs.
//!
//! `tests/oracle/install` puts pyfuzzylite where this test looks for it; without it the test says so and passes, in CI it
//! fails.

use host_sim::fuzzy::check::{Bounds, Jumps, bounds, class, strength};
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::files::{Format, adapt, fll, load, parse};
use host_sim::fuzzy::lower::{Fixed, lower};
use host_sim::fuzzy::model::{Input, Output, System};
use host_sim::fuzzy::random;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
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

/// Random points in and a little around the ranges, and some whose every input is at a knot of one of its terms or between
/// two of them, however narrow the term is.
fn points(rng: &mut impl Rng, system: &System) -> Vec<Vec<f64>> {
    let mut anywhere = |input: &Input| {
        let (start, end) = (*input.range.start(), *input.range.end());
        let x = start + (end - start) * rng.random_range(-0.1..1.1);
        let term = &input.terms[rng.random_range(0..input.terms.len())];
        let knots = term.shape.knots();
        let knot = rng.random_range(0..knots.len());
        let next = knots[(knot + 1).min(knots.len() - 1)];
        let between = knots[knot] + (next - knots[knot]) * rng.random_range(0.0..1.0);
        [x, knots[knot], between]
    };
    let mut points = Vec::new();
    for _ in 0..POINTS {
        let of_inputs: Vec<[f64; 3]> = system.inputs.iter().map(&mut anywhere).collect();
        points.extend((0..3).map(|kind| of_inputs.iter().map(|of| of[kind]).collect()));
    }
    points
}

fn span(output: &Output) -> f64 {
    output.range.end() - output.range.start()
}

/// A system as fuzzylite can have it, as text and points.
fn case(rng: &mut impl Rng, system: &mut System) -> Case {
    // fuzzylite knows only one way to sample a set.
    adapt::to_fll(system);
    Case {
        fll: fll::write(system).unwrap_or_else(|refused| panic!("{refused}: {system:#?}")),
        points: points(rng, system),
    }
}

/// The listing of the chapter on fuzzy control: what a reader copies.
fn listing() -> &'static str {
    let chapter = include_str!("../../../docs/fuzzy.md");
    let rest = chapter.split_once("```text\n").expect("a listing").1;
    rest.split_once("```").expect("its end").0
}

/// What was compared, so that a test that compares nothing is seen.
#[derive(Debug, Default)]
struct Compared {
    /// Outputs in `f64`, outputs that have no value, and the greatest difference as a share of the range.
    values: usize,
    missing: usize,
    worst: f64,
    /// Outputs in fixed point, and the greatest share of what it may be off by.
    fixed: usize,
    used: f64,
}

/// Compares one system with fuzzylite at its points, or says where it disagrees.
fn compare(
    system: &System,
    case: &Case,
    answer: &Answer,
    seen: &mut Compared,
) -> Result<(), String> {
    let exact = Exact::new(system);
    let answers = answer.outputs.iter().zip(&answer.rules);
    for (point, (outputs, rules)) in case.points.iter().zip(answers) {
        let ours = exact.evaluate(point);
        let place = |what: String| format!("{what} at {point:?} of\n{}", case.fll);
        for (index, (a, b)) in ours.rules.iter().zip(rules).enumerate() {
            if (a - b).abs() > EXACT {
                return Err(place(format!("rule {index}: {a}, fuzzylite {b}")));
            }
        }
        for ((output, a), b) in system.outputs.iter().zip(&ours.outputs).zip(outputs) {
            match (a, b) {
                (Some(a), Some(b)) => {
                    let error = (a - b).abs() / span(output);
                    seen.values += 1;
                    seen.worst = seen.worst.max(error);
                    if error > EXACT {
                        return Err(place(format!("{}: {a}, fuzzylite {b}", output.name)));
                    }
                }
                (None, None) => seen.missing += 1,
                _ => {
                    return Err(place(format!("{}: {a:?}, fuzzylite {b:?}", output.name)));
                }
            }
        }
    }
    Ok(())
}

/// Compares a system's fixed point with fuzzylite, within what `host-sim fuzzy check` says that it may be off by: in the
/// ranges, and not where a term jumps.
fn compare_fixed(
    system: &System,
    (fixed, jumps, bounds): (&Fixed<'_>, &Jumps, &Bounds),
    case: &Case,
    answer: &Answer,
    seen: &mut Compared,
) -> Result<(), String> {
    let exact = Exact::new(system);
    let inside = |point: &[f64]| {
        let mut each = system.inputs.iter().zip(point);
        each.all(|(input, x)| input.range.contains(x)) && !jumps.near(point)
    };
    for (point, outputs) in case.points.iter().zip(&answer.outputs) {
        if !inside(point) {
            continue;
        }
        let (degrees, ours) = (exact.evaluate(point), fixed.evaluate(point));
        for (index, (output, bounds)) in system.outputs.iter().zip(bounds).enumerate() {
            let strength = strength(system, index, &degrees);
            let (Some(a), Some(b)) = (ours.outputs[index], outputs[index]) else {
                continue;
            };
            if strength <= 0.0 {
                continue;
            }
            let bound = bounds[class(strength)];
            let error = (a - b).abs();
            seen.fixed += 1;
            seen.used = seen.used.max(error / bound);
            // Not a number is no agreement either.
            if !matches!(
                error.partial_cmp(&bound),
                Some(Ordering::Less | Ordering::Equal)
            ) {
                return Err(format!(
                    "{}: {a} in fixed point, fuzzylite {b}, allowed {bound}, at {point:?} of\n{}",
                    output.name, case.fll
                ));
            }
        }
    }
    Ok(())
}

/// Compares systems in `f64` and in fixed point; `None` without pyfuzzylite.
fn agree(systems: &mut [System], rng: &mut impl Rng) -> Option<Compared> {
    let cases: Vec<Case> = systems.iter_mut().map(|system| case(rng, system)).collect();
    agree_on(systems, &cases)
}

/// The same with the texts and points that fuzzylite gets.
fn agree_on(systems: &[System], cases: &[Case]) -> Option<Compared> {
    let answers = ask(cases)?;
    assert_eq!(answers.len(), cases.len());
    let mut seen = Compared::default();
    let mut wrong = Vec::new();
    for ((system, case), answer) in systems.iter().zip(cases).zip(&answers) {
        assert_eq!(answer.outputs.len(), case.points.len());
        wrong.extend(compare(system, case, answer, &mut seen).err());
        // What does not fit into fixed point says so; it is counted below.
        if let Ok(lowered) = lower(system) {
            let (bounds, jumps) = (bounds(system, &lowered), Jumps::of(system, &lowered));
            lowered.open(|fixed| {
                let with = (&fixed, &jumps, &bounds);
                wrong.extend(compare_fixed(system, with, case, answer, &mut seen).err());
            });
        }
    }
    println!("{seen:?}");
    assert!(
        wrong.is_empty(),
        "{} disagree; the first: {}",
        wrong.len(),
        wrong[0]
    );
    Some(seen)
}

#[test]
fn random_systems_agree_with_fuzzylite() {
    let mut rng = Pcg64Mcg::seed_from_u64(2026);
    let mut systems: Vec<System> = (0..SYSTEMS).map(|_| random::system(&mut rng)).collect();
    if let Some(seen) = agree(&mut systems, &mut rng) {
        assert!(
            seen.values > 100 * SYSTEMS && seen.missing > 100,
            "{seen:?}"
        );
        // Half of the points are outside of some range.
        assert!(seen.fixed > 30 * SYSTEMS && seen.used > 0.1, "{seen:?}");
    }
}

#[test]
fn random_steps_agree_with_fuzzylite() {
    let mut rng = Pcg64Mcg::seed_from_u64(41);
    let mut systems: Vec<System> = (0..80).map(|_| random::stepped(&mut rng)).collect();
    if let Some(seen) = agree(&mut systems, &mut rng) {
        assert!(seen.values > 100 * systems.len(), "{seen:?}");
        // A third of the points are at the jumps, where fixed point is not compared.
        assert!(seen.fixed > 10 * systems.len(), "{seen:?}");
    }
}

/// A curve on a part of 3e-6 to 5e-5 of its input's range, beside a weak rule that holds everywhere: what the curve is off in
/// fixed point, the output is off, and nothing else is.
fn steep(rng: &mut impl Rng) -> System {
    let range = 10.0_f64.powf(rng.random_range(0.0..6.0));
    let (at, width) = (
        range * rng.random_range(0.1..0.9),
        range * 10.0_f64.powf(rng.random_range(-5.5..-4.3)),
    );
    let curve = match rng.random_range(0..5) {
        0 => format!("SShape {at} {}", at + width),
        1 => format!("ZShape {at} {}", at + width),
        2 => format!("Gaussian {at} {width}"),
        3 => format!("Bell {at} {width} {}", rng.random_range(0.7..5.0)),
        _ => format!("Sigmoid {at} {}", 1.0 / width),
    };
    let text = format!(
        "Engine: steep\nInputVariable: x\n  range: 0 {range}\n  term: curve {curve}\n  term: all Ramp -2 -1\n\
         OutputVariable: y\n  range: 0 100\n  defuzzifier: WeightedAverage\n  term: p Constant 0\n  term: q Constant 100\n\
         RuleBlock: r\n  activation: General\n  rule: if x is curve then y is q\n  rule: if x is all then y is p with 0.05\n"
    );
    parse("steep.fll", text.as_bytes(), Format::Fll).unwrap()
}

#[test]
fn steep_curves_agree_with_fuzzylite() {
    let mut rng = Pcg64Mcg::seed_from_u64(40);
    let mut systems: Vec<System> = (0..40).map(|_| steep(&mut rng)).collect();
    if let Some(seen) = agree(&mut systems, &mut rng) {
        assert!(seen.fixed > 100 * systems.len(), "{seen:?}");
        // Near enough to see a bound that is too low.
        assert!(seen.used > 0.3, "{seen:?}");
    }
}

#[test]
fn the_checked_in_designs_agree_with_fuzzylite() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/designs");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e != "md"))
        .collect();
    files.sort();
    let mut systems: Vec<System> = files.iter().map(|file| load(file, None).unwrap()).collect();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    if let Some(seen) = agree(&mut systems, &mut rng) {
        assert!(
            seen.values > 100 * files.len() && seen.fixed > 50 * files.len(),
            "{seen:?}"
        );
    }
}

#[test]
fn the_listing_in_the_chapter_runs_in_fuzzylite_as_it_stands() {
    let system = parse("fan.fll", listing().as_bytes(), Format::Fll).unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(10);
    let case = Case {
        fll: listing().to_owned(),
        points: points(&mut rng, &system),
    };
    if let Some(seen) = agree_on(&[system], &[case]) {
        assert!(seen.values > 100 && seen.fixed > 50, "{seen:?}");
    }
}
