//! What a design should have answered: rows of a CSV file, a column a variable.

use crate::fuzzy::model::System;
use crate::scenario::shown;
use crate::search::Hash;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Rows to learn from or to be judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// The outputs that have a column: their indices.
    pub outputs: Vec<usize>,
    /// The rows, in the file's order.
    pub rows: Vec<Row>,
}

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// A value an input.
    pub inputs: Vec<f64>,
    /// A value for each of [`Data::outputs`].
    pub targets: Vec<f64>,
}

/// What is wrong with a data file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{place}: {found}; allowed is {allowed}")]
pub struct DataError {
    file: String,
    /// `:3`, or `:3: column 2 (speed)`.
    place: String,
    found: String,
    allowed: String,
}

/// Longest file, bytes.
const BYTES: u64 = 64 << 20;
/// Most rows.
const ROWS: usize = 1_000_000;
/// Largest number. Its square has to be one, too.
const LARGEST: f64 = 1e15;

impl Data {
    /// Reads a file. Columns named in `ignored` are not looked at.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with it, with line and column.
    pub fn load(
        path: &Path,
        system: &System,
        ignored: &[String],
    ) -> Result<(Self, Hash), DataError> {
        let file = path.display().to_string();
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|open| open.take(BYTES + 1).read_to_end(&mut bytes))
            .map_err(|e| DataError {
                file: file.clone(),
                place: String::new(),
                found: format!("cannot be read ({e})"),
                allowed: "a CSV file".to_owned(),
            })?;
        let data = Self::parse(&file, &bytes, system, ignored)?;
        Ok((data, Hash::default().and(&bytes)))
    }

    /// Reads a file's contents; `file` is what messages call it.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn parse(
        file: &str,
        bytes: &[u8],
        system: &System,
        ignored: &[String],
    ) -> Result<Self, DataError> {
        let wrong = |place: String, found: String, allowed: &str| DataError {
            file: file.to_owned(),
            place,
            found,
            allowed: allowed.to_owned(),
        };
        if bytes.len() as u64 > BYTES {
            let found = "the file is too large".to_owned();
            return Err(wrong(String::new(), found, "at most 64 MiB"));
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(bytes);
        let mut record = csv::ByteRecord::new();
        let mut next = |record: &mut csv::ByteRecord| {
            let found = reader.read_byte_record(record);
            found.map_err(|e| wrong(String::new(), e.to_string(), "a CSV file"))
        };
        if !next(&mut record)? {
            let found = "the file is empty".to_owned();
            return Err(wrong(
                String::new(),
                found,
                "a line of names, then rows of numbers",
            ));
        }
        let columns = Columns::read(&wrong, &record, system, ignored)?;
        let mut rows = Vec::new();
        while next(&mut record)? {
            if rows.len() == ROWS {
                let found = "there are too many rows".to_owned();
                return Err(wrong(line(&record), found, "at most 1000000"));
            }
            rows.push(columns.row(&wrong, &record)?);
        }
        if rows.is_empty() {
            let found = "there is no row behind the line of names".to_owned();
            return Err(wrong(String::new(), found, "one row or more"));
        }
        Ok(Self {
            outputs: columns.outputs,
            rows,
        })
    }

    /// How many rows have an input outside of its range: there the design is tuned at the range's end, or beyond its terms.
    pub fn outside(&self, system: &System) -> usize {
        let is_outside = |row: &&Row| {
            let mut inputs = system.inputs.iter().zip(&row.inputs);
            inputs.any(|(input, x)| !input.range.contains(x))
        };
        self.rows.iter().filter(is_outside).count()
    }

    /// Takes a share of the rows away, at random from a seed: what stays, and what was taken. Both keep the file's order.
    pub fn split(self, share: f64, seed: u64) -> (Self, Self) {
        let taken = (share * self.rows.len() as f64).round() as usize;
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut order: Vec<(u64, usize)> = (0..self.rows.len())
            .map(|index| (rng.random(), index))
            .collect();
        order.sort_unstable();
        let mut away = vec![false; self.rows.len()];
        for &(_, index) in order.iter().take(taken) {
            away[index] = true;
        }
        let rows = self.rows.into_iter().zip(away);
        let (taken, kept): (Vec<_>, Vec<_>) = rows.partition(|(_, away)| *away);
        let of = |rows: Vec<(Row, bool)>| Self {
            outputs: self.outputs.clone(),
            rows: rows.into_iter().map(|(row, _)| row).collect(),
        };
        (of(kept), of(taken))
    }
}

/// What each column is.
struct Columns {
    names: Vec<String>,
    /// The column of each input.
    inputs: Vec<usize>,
    /// Indices of outputs…
    outputs: Vec<usize>,
    /// …and their columns.
    targets: Vec<usize>,
}

fn line(record: &csv::ByteRecord) -> String {
    record
        .position()
        .map_or(String::new(), |at| format!(":{}", at.line()))
}

impl Columns {
    fn read(
        wrong: &impl Fn(String, String, &str) -> DataError,
        record: &csv::ByteRecord,
        system: &System,
        ignored: &[String],
    ) -> Result<Self, DataError> {
        let place = |column: usize| format!("{}: column {}", line(record), column + 1);
        let inputs = system.inputs.iter().map(|input| &input.name);
        let outputs = system.outputs.iter().map(|output| &output.name);
        let known: Vec<&str> = inputs.chain(outputs).map(String::as_str).collect();
        let mut names: Vec<String> = Vec::new();
        for (column, name) in record.iter().enumerate() {
            let Ok(name) = std::str::from_utf8(name) else {
                let found = "found a name that is no UTF-8".to_owned();
                return Err(wrong(place(column), found, "UTF-8 text"));
            };
            let skipped = ignored.iter().any(|i| i == name);
            if !skipped && !known.contains(&name) {
                let allowed = format!("one of {} (--ignore leaves a column out)", known.join(", "));
                let found = format!("found the name `{}`", shown(name));
                return Err(wrong(place(column), found, &allowed));
            }
            if !skipped && names.iter().any(|before| before == name) {
                let found = format!("found `{}` a second time", shown(name));
                return Err(wrong(place(column), found, "one column a variable"));
            }
            names.push(name.to_owned());
        }
        let of = |name: &str| {
            let mut columns = names.iter().map(String::as_str);
            columns.position(|n| n == name && !ignored.iter().any(|i| i == name))
        };
        let mut columns = Vec::new();
        for input in &system.inputs {
            let Some(column) = of(&input.name) else {
                let found = format!("the input `{}` has no column", input.name);
                return Err(wrong(line(record), found, "a column for every input"));
            };
            columns.push(column);
        }
        let outputs = system.outputs.iter().enumerate();
        let (outputs, targets): (Vec<usize>, Vec<usize>) = outputs
            .filter_map(|(index, output)| Some((index, of(&output.name)?)))
            .unzip();
        if outputs.is_empty() {
            let found = "no output has a column".to_owned();
            return Err(wrong(
                line(record),
                found,
                "a column for one output or more",
            ));
        }
        Ok(Self {
            names,
            inputs: columns,
            outputs,
            targets,
        })
    }

    fn row(
        &self,
        wrong: &impl Fn(String, String, &str) -> DataError,
        record: &csv::ByteRecord,
    ) -> Result<Row, DataError> {
        if record.len() != self.names.len() {
            let found = format!("the number of fields is {}", record.len());
            let allowed = format!("{}, as in the line of names", self.names.len());
            return Err(wrong(line(record), found, &allowed));
        }
        let number = |&column: &usize| {
            let bytes = record.get(column).unwrap_or_default();
            let text = String::from_utf8_lossy(bytes);
            let number = text.parse::<f64>().ok();
            number.filter(|x| x.abs() <= LARGEST).ok_or_else(|| {
                let place = format!(
                    "{}: column {} ({})",
                    line(record),
                    column + 1,
                    shown(&self.names[column])
                );
                let found = if text.is_empty() {
                    "found nothing".to_owned()
                } else {
                    format!("found `{}`", shown(&text))
                };
                wrong(place, found, "a number up to 1e15")
            })
        };
        Ok(Row {
            inputs: self.inputs.iter().map(number).collect::<Result<_, _>>()?,
            targets: self.targets.iter().map(number).collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    const GOOD: &str = "speed,temperature,humidity\n1,2,3\n4, 5 ,6e1\n";

    #[test]
    fn columns_are_found_by_their_names() {
        let data = Data::parse("d", GOOD.as_bytes(), &fan(), &[]).unwrap();
        assert_eq!(data.outputs, [0]);
        let last = Row {
            inputs: vec![5.0, 60.0],
            targets: vec![4.0],
        };
        assert_eq!(data.rows[1], last);
    }

    #[test]
    fn a_share_is_taken_once_and_the_same_for_a_seed() {
        let rows = (0..100).map(|i| Row {
            inputs: vec![f64::from(i)],
            targets: vec![],
        });
        let data = Data {
            outputs: vec![],
            rows: rows.collect(),
        };
        let (kept, taken) = data.clone().split(0.2, 7);
        assert_eq!((kept.rows.len(), taken.rows.len()), (80, 20));
        let mut all = [kept.rows.clone(), taken.rows.clone()].concat();
        all.sort_by(|a, b| a.inputs[0].total_cmp(&b.inputs[0]));
        assert_eq!(all, data.rows);
        assert_eq!(data.clone().split(0.2, 7), (kept, taken.clone()));
        assert_ne!(data.split(0.2, 8).1, taken);
    }
}
