//! What the compiled code is asked, and what it has to answer: integers on standard input and output.

use super::systems::Made;
use fuzzypilot::fuzzy::system::Piece;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Inputs of one system: corners of the ranges and terms and the steps beside them, the ends of all numbers, and anything.
pub fn inputs(made: &Made, count: usize) -> Vec<Vec<i32>> {
    let mut rng = Pcg64Mcg::seed_from_u64(count as u64);
    let corners: Vec<Vec<i32>> = made
        .lowered
        .tables()
        .inputs
        .iter()
        .map(|input| {
            let pieces = input
                .terms
                .iter()
                .flat_map(|(_, pieces)| pieces)
                .map(Piece::from);
            let mut corners: Vec<i32> = pieces
                .chain(input.range)
                .flat_map(|x| [x.saturating_sub(1), x, x.saturating_add(1)])
                .collect();
            corners.extend([i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX]);
            corners
        })
        .collect();
    let mut all = vec![
        vec![i32::MIN; corners.len()],
        vec![i32::MAX; corners.len()],
        vec![0; corners.len()],
    ];
    while all.len() < count {
        let ranges = made.lowered.tables().inputs.iter().map(|input| input.range);
        let one = ranges
            .zip(&corners)
            .map(|([low, high], corners)| match rng.random_range(0..8) {
                0..4 => rng.random_range(low..=high),
                4..7 => corners[rng.random_range(0..corners.len())],
                _ => rng.next_u32() as i32,
            });
        all.push(one.collect());
    }
    all
}

/// The outputs and degrees of the simulator's fixed point, one behind another.
pub fn expected(made: &Made, inputs: &[Vec<i32>]) -> Vec<Vec<i32>> {
    made.lowered.open(|fixed| {
        let one = |input: &Vec<i32>| {
            let (mut numbers, degrees) = fixed.steps(input);
            numbers.extend(degrees.iter().map(|degree| degree.bits() as i32));
            numbers
        };
        inputs.iter().map(one).collect()
    })
}

/// A system, what it is asked, and what it has to answer.
pub type Asked<'a> = (&'a Made, Vec<Vec<i32>>, Vec<Vec<i32>>);

/// Runs a program that answers for one system after another, and compares.
pub fn compare(program: &Path, systems: &[Asked<'_>]) {
    let mut asked = Vec::new();
    for (_, inputs, _) in systems {
        asked.push(inputs.len() as i32);
        asked.extend(inputs.iter().flatten());
    }
    let asked: Vec<u8> = asked.into_iter().flat_map(i32::to_ne_bytes).collect();
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || pipe.write_all(&asked));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(
        output.status.success(),
        "{}: {}",
        program.display(),
        output.status
    );
    let mut found = output
        .stdout
        .chunks_exact(4)
        .map(|bytes| i32::from_ne_bytes(bytes.try_into().unwrap()));
    let mut compared = 0;
    for (made, inputs, expected) in systems {
        for (input, expected) in inputs.iter().zip(expected) {
            let found: Vec<i32> = found.by_ref().take(expected.len()).collect();
            assert_eq!(&found, expected, "{} at {input:?}", made.name);
            compared += expected.len();
        }
    }
    assert_eq!(found.next(), None);
    assert!(compared > 1000);
    println!(
        "{compared} integers of {} systems are the same",
        systems.len()
    );
}
