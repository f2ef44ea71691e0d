//! fuzzylite's grid of the printed fine tables, from the data folder. Both the library's test `oracle` and `cargo engine`
//! read it here; each has this file as a module.

use std::io::Read;
use std::path::PathBuf;

/// A point of the grid and what fuzzylite computes there: distance, angle, speed, deflection.
pub type Row = [f64; 4];

/// All rows, or `None` if the grid is not here. It is sought in `FUZZYPILOT_DATA`; without that, in `otherwise`.
///
/// # Errors
///
/// What cannot be read of it.
pub fn rows(otherwise: PathBuf) -> Result<Option<Vec<Row>>, String> {
    let root = std::env::var_os("FUZZYPILOT_DATA").map_or(otherwise, PathBuf::from);
    let file = root.join("oracle/fine-grid.csv.gz");
    let Ok(packed) = std::fs::File::open(&file) else {
        return Ok(None);
    };
    let bad = |what: String| format!("{}: {what}", file.display());
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed)
        .read_to_string(&mut text)
        .map_err(|error| bad(error.to_string()))?;
    let row = |line: &str| {
        let cells: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let cells = cells.map_err(|error| bad(format!("{error}: {line}")))?;
        Row::try_from(cells).map_err(|_| bad(format!("not four columns: {line}")))
    };
    let rows: Result<Vec<Row>, String> = text.lines().skip(1).map(row).collect();
    rows.map(Some)
}
