//! Nanoseconds an evaluation.

use super::{Contest, INPUTS, Measure};
use std::hint::black_box;
use std::time::Instant;

/// Batches, of which the best counts.
const BATCHES: usize = 1000;

/// One contender's.
pub struct Row {
    pub name: &'static str,
    pub independent: f64,
    pub in_a_row: f64,
}

/// Every contender's.
pub fn rows(contest: &Contest) -> Vec<Row> {
    let mut rows = Rows(Vec::new());
    contest.each(&mut rows);
    rows.0
}

struct Rows(Vec<Row>);

impl Measure for Rows {
    fn measure<I: Copy>(
        &mut self,
        name: &'static str,
        inputs: &[I],
        evaluate: impl Fn(I) -> [u32; 2],
    ) {
        self.0.push(Row {
            name,
            independent: best(|| independent(inputs, &evaluate)),
            in_a_row: best(|| in_a_row(inputs, &evaluate)),
        });
    }
}

fn best(batch: impl Fn()) -> f64 {
    let one = || {
        let begin = Instant::now();
        batch();
        begin.elapsed().as_secs_f64()
    };
    let shortest = (0..BATCHES).map(|_| one()).fold(f64::INFINITY, f64::min);
    shortest * 1e9 / INPUTS as f64
}

/// One batch; none waits for another.
pub fn independent<I: Copy>(inputs: &[I], evaluate: impl Fn(I) -> [u32; 2]) {
    for input in inputs {
        black_box(evaluate(black_box(*input)));
    }
}

/// One batch; where the next input lies is known when both outputs are.
pub fn in_a_row<I: Copy>(inputs: &[I], evaluate: impl Fn(I) -> [u32; 2]) {
    // Zero, which the compiler does not know.
    let none = black_box(0);
    let mut last = 0;
    for i in 0..inputs.len() {
        let [first, second] = evaluate(inputs[i ^ last]);
        last = ((first ^ second) & none) as usize;
    }
    black_box(last);
}
