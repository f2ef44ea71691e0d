//! Instructions an evaluation: this program runs itself in valgrind's callgrind, with two numbers of batches; the
//! difference is theirs alone.

use super::{Contest, INPUTS, Measure, time};
use std::process::Command;

/// What the child is called with: this, the contender's place, and a number of batches.
const FLAG: &str = "--count";

/// Contender and batches, if this is the child.
pub fn asked() -> Option<(usize, usize)> {
    let mut arguments = std::env::args().skip_while(|argument| argument != FLAG);
    arguments.next()?;
    Some((
        arguments.next()?.parse().ok()?,
        arguments.next()?.parse().ok()?,
    ))
}

/// The child's work.
pub fn evaluate(contest: &Contest, (place, batches): (usize, usize)) {
    contest.each(&mut Child {
        before: place,
        batches,
    });
}

struct Child {
    /// Contenders still to leave out.
    before: usize,
    batches: usize,
}

impl Measure for Child {
    fn measure<I: Copy>(
        &mut self,
        _: &'static str,
        inputs: &[I],
        evaluate: impl Fn(I) -> [u32; 2],
    ) {
        if self.before == 0 {
            for _ in 0..self.batches {
                time::independent(inputs, &evaluate);
            }
        }
        self.before = self.before.wrapping_sub(1);
    }
}

/// Every contender's mean over the inputs, loop and all.
///
/// # Errors
///
/// Why they cannot be counted.
pub fn instructions(contenders: usize) -> Result<Vec<u64>, String> {
    (0..contenders)
        .map(|place| {
            let (one, nine) = (collected(place, 1)?, collected(place, 9)?);
            Ok(nine.saturating_sub(one) / (8 * INPUTS as u64))
        })
        .collect()
}

fn collected(place: usize, batches: usize) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args([FLAG, &place.to_string(), &batches.to_string()])
        .output()
        .map_err(|error| format!("valgrind cannot be started ({error})"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let count = said
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    count
        .and_then(|(_, count)| count.trim().parse().ok())
        .ok_or_else(|| format!("valgrind was not understood: {said}"))
}
