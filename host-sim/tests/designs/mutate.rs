//! Good files with something changed at random: whatever comes out, no reader panics, and what still reads survives being
//! written. Seeded; `FUZZYPILOT_FUZZ_SECONDS=600` makes a campaign of it.

use super::{designs, files, fuzz};
use host_sim::fuzzy::files::Format;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::fs;
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

/// Mutations of each format without a campaign.
const SHORT: usize = 10_000;

/// What may stand in a design file and what may not.
const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-0",
    "0",
    "1",
    "2",
    "1e308",
    "-1e308",
    "9007199254740993",
    "(",
    ")",
    "((((((((((((((((((",
    "[",
    "]",
    "'",
    ",",
    ";",
    ":",
    ":=",
    "..",
    "\n",
    "\r\n",
    "\r",
    "\t",
    " ",
    "\0",
    "\u{feff}",
    "é",
    "#",
    "%",
    "//",
    "(*",
    "*)",
    "/*",
    "if",
    "is",
    "not",
    "and",
    "or",
    "then",
    "with",
    "NOT",
    "Linear",
    "Constant",
    "Discrete",
    "Rectangle",
    "Trapezoid",
    "term:",
    "rule:",
    "RuleBlock:",
    "OutputVariable:",
    "enabled: false",
    "TERM x :=",
    "RULE 1 :",
    "END_VAR",
    "END_RULEBLOCK",
    "FUNCTION_BLOCK",
    "samples: 3 ends",
    "MF1='a':'trimf',[0 1 2]",
    "[Rules]",
    "[Input1]",
    "Name='a'",
];

fn mutate(good: &[Vec<u8>], random: &mut Pcg64Mcg) -> Vec<u8> {
    let mut bytes = good[random.random_range(0..good.len())].clone();
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..=bytes.len());
        let to = (at + random.random_range(0..40)).min(bytes.len());
        match random.random_range(0..8) {
            0 => bytes.truncate(at),
            1 => {
                bytes.drain(at..to);
            }
            2 => {
                let word = WORDS[random.random_range(0..WORDS.len())].bytes();
                bytes.splice(at..at, word);
            }
            3 => {
                let word = WORDS[random.random_range(0..WORDS.len())].bytes();
                bytes.splice(at..to, word);
            }
            4 => {
                let copy = bytes[at..to].to_vec();
                let at = random.random_range(0..=bytes.len());
                bytes.splice(at..at, copy);
            }
            5 => {
                let other = &good[random.random_range(0..good.len())];
                let from = random.random_range(0..other.len());
                let until = (from + random.random_range(0..200)).min(other.len());
                bytes.splice(at..at, other[from..until].iter().copied());
            }
            6 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = (random.next_u32() & 0xff) as u8;
                }
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.random_range(0..7);
                }
            }
        }
    }
    bytes
}

fn campaign(format: Format) {
    let is_one = |f: &std::path::PathBuf| Format::of(f) == Some(format);
    let all = designs().into_iter().chain(files("tests/designs/bad"));
    let good: Vec<Vec<u8>> = all
        .filter(is_one)
        .map(|f| fs::read(f).unwrap())
        .filter(|bytes| !bytes.is_empty())
        .collect();
    assert!(good.len() > 10, "seeds for {format:?}");
    let seconds = std::env::var("FUZZYPILOT_FUZZ_SECONDS")
        .ok()
        .and_then(|s| s.parse().ok());
    let limit = seconds.map(Duration::from_secs);
    let (start, mut random, mut count) = (Instant::now(), Pcg64Mcg::seed_from_u64(7), 0);
    while limit.map_or(count < SHORT, |limit| start.elapsed() < limit) {
        let bytes = mutate(&good, &mut random);
        if catch_unwind(|| fuzz::check(&bytes, format)).is_err() {
            panic!(
                "{format:?}, mutation {count}:\n{}",
                String::from_utf8_lossy(&bytes)
            );
        }
        count += 1;
    }
    if limit.is_some() {
        println!("{format:?}: {count} mutations, none of which panics");
    }
}

#[test]
fn mutated_fll_never_panics() {
    campaign(Format::Fll);
}

#[test]
fn mutated_fcl_never_panics() {
    campaign(Format::Fcl);
}

#[test]
fn mutated_fis_never_panics() {
    campaign(Format::Fis);
}
