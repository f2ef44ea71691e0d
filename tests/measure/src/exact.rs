//! Byte by byte: the records of every machine against the desktop's.

use crate::machine::{Images, MACHINES, Time};
use crate::tape::{Tape, file};
use fuzzypilot::link::record::{RECORD_BYTES, decode};
use replica::tape::Mode;
use std::fmt;

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Ticks compared.
    pub ticks: usize,
    /// Bytes that differ, and those that are not there.
    pub differing: usize,
    /// The first difference.
    pub first: Option<Difference>,
    /// Why the image ended early.
    pub failure: Option<String>,
}

/// Where records part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The run.
    pub tape: String,
    /// The tick.
    pub tick: usize,
    /// The field, and what it is on the desktop and on the machine.
    pub field: String,
}

impl Comparison {
    /// Whether all is equal.
    pub fn is_equal(&self) -> bool {
        self.differing == 0 && self.failure.is_none()
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} ticks, {} differing bytes",
            self.ticks, self.differing
        )?;
        if let Some(Difference { tape, tick, field }) = &self.first {
            write!(f, "\n  first in {tape}, tick {tick}: {field}")?;
        }
        if let Some(failure) = &self.failure {
            write!(f, "\n  {failure}")?;
        }
        Ok(())
    }
}

/// The first field in which two records of a kind differ, and both values.
pub type Parting<const BYTES: usize> = fn(&[u8; BYTES], &[u8; BYTES]) -> String;

/// Plays the tapes on every machine and compares.
pub fn compare_all(images: &Images, tapes: &[Tape]) -> anyhow::Result<Vec<Comparison>> {
    compare_records(images, "replica", tapes, 0, parting)
}

/// Plays tapes on an image of every machine, leaves out the first `before` bytes of what it writes, and compares.
pub fn compare_records<const BYTES: usize>(
    images: &Images,
    image: &str,
    tapes: &[Tape<BYTES>],
    before: usize,
    parting: Parting<BYTES>,
) -> anyhow::Result<Vec<Comparison>> {
    let bytes = file(Mode::Records, tapes);
    std::thread::scope(|scope| {
        let runs = MACHINES.each_ref().map(|machine| {
            let bytes = &bytes;
            scope.spawn(move || {
                let folder = tempfile::tempdir()?;
                let image = images.of(machine, image);
                let outcome = machine.run(&image, folder.path(), bytes, Time::Free)?;
                let out = outcome.out.get(before..).unwrap_or_default();
                let mut comparison = compare_with(tapes, out, parting);
                comparison.failure = outcome.failure;
                Ok(comparison)
            })
        });
        runs.into_iter()
            .map(|run| {
                run.join()
                    .map_err(|_| anyhow::anyhow!("a comparison panicked"))?
            })
            .collect()
    })
}

/// Compares what an image wrote with the tapes' records.
pub fn compare(tapes: &[Tape], out: &[u8]) -> Comparison {
    compare_with(tapes, out, parting)
}

fn compare_with<const BYTES: usize>(
    tapes: &[Tape<BYTES>],
    out: &[u8],
    parting: Parting<BYTES>,
) -> Comparison {
    let (found, rest) = out.as_chunks::<BYTES>();
    let mut found = found.iter();
    let mut comparison = Comparison::default();
    for tape in tapes {
        for (tick, expected) in tape.records.as_chunks::<BYTES>().0.iter().enumerate() {
            let found = found.next();
            let differing = match found {
                Some(found) => expected.iter().zip(found).filter(|(a, b)| a != b).count(),
                None => BYTES,
            };
            comparison.ticks += usize::from(found.is_some());
            comparison.differing += differing;
            if differing > 0 && comparison.first.is_none() {
                comparison.first = Some(Difference {
                    tape: tape.name.clone(),
                    tick,
                    field: found.map_or_else(
                        || "there is no record".to_owned(),
                        |found| parting(expected, found),
                    ),
                });
            }
        }
    }
    comparison.differing += rest.len() + found.len() * BYTES;
    comparison
}

/// The first field in which two records differ, and both values.
fn parting(expected: &[u8; RECORD_BYTES], found: &[u8; RECORD_BYTES]) -> String {
    let (Some(expected), Some(found)) = (decode(expected), decode(found)) else {
        let byte = expected.iter().zip(found).position(|(a, b)| a != b);
        return format!("byte {}, and the bytes are no record's", byte.unwrap_or(0));
    };
    let (expected, found) = (format!("{expected:#?}"), format!("{found:#?}"));
    let mut above: Vec<&str> = Vec::new();
    for (expected, found) in expected.lines().zip(found.lines()) {
        let depth = expected.len() - expected.trim_start().len();
        above.truncate(depth / 4);
        if expected != found {
            let path: Vec<&str> = above.iter().skip(1).copied().collect();
            let path = path.join(".");
            let [expected, found] = [expected, found].map(|line| line.trim().trim_end_matches(','));
            return format!("{path}: desktop `{expected}`, machine `{found}`");
        }
        above.push(expected.trim().split([':', ' ', '(']).next().unwrap_or(""));
    }
    "one has more than the other".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::plain;

    #[test]
    fn a_difference_is_counted_and_named() {
        let tapes = plain(1).unwrap();
        let mut out: Vec<u8> = tapes.iter().flat_map(|t| t.records.clone()).collect();
        let equal = compare(&tapes, &out);
        assert!(equal.is_equal() && equal.ticks == out.len() / RECORD_BYTES);

        // Byte 44 of a record is the lowest of `guidance.cross_track`.
        let tick = 100;
        let before: usize = tapes[..2].iter().map(Tape::ticks).sum();
        out[(before + tick) * RECORD_BYTES + 44] ^= 1;
        out[(before + tick + 1) * RECORD_BYTES + 9] ^= 0xFF;
        let found = compare(&tapes, &out);
        assert_eq!(found.differing, 2);
        let first = found.first.unwrap();
        assert_eq!((first.tape, first.tick), (tapes[2].name.clone(), tick));
        assert!(
            first.field.starts_with("guidance.cross_track"),
            "{}",
            first.field
        );

        out.truncate(out.len() - 1);
        let short = compare(&tapes, &out);
        assert_eq!(short.differing, 2 + RECORD_BYTES + RECORD_BYTES - 1);
    }
}
