//! Reads tables of two columns from NumPy's `.npy` (format versions 1 to 3, little endian `i4`, `i8`, `f4`, `f8`, C order).
//! The format is ten bytes and a Python dictionary; see NumPy's *NEP 1*.

/// Most rows that are read.
const MOST_ROWS: usize = 100_000;

/// Rows of a table, or what was found instead.
pub fn pairs(bytes: &[u8]) -> Result<Vec<[f64; 2]>, String> {
    let truncated = || format!("a file that ends after {} bytes", bytes.len());
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("a file of another kind".to_owned());
    }
    let (length, start) = match bytes.get(6) {
        Some(1) => (bytes.get(8..10), 10),
        Some(2 | 3) => (bytes.get(8..12), 12),
        Some(version) => return Err(format!("format version {version}")),
        None => return Err(truncated()),
    };
    let length = length
        .ok_or_else(truncated)?
        .iter()
        .rev()
        .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    let header = bytes
        .get(start..start + length)
        .ok_or_else(truncated)
        .map(String::from_utf8_lossy)?;
    let entry = |key: &str| {
        let (_, rest) = header.split_once(&format!("'{key}':"))?;
        Some(rest.trim_start())
    };
    if entry("fortran_order").is_none_or(|e| !e.starts_with("False")) {
        return Err("an array in Fortran order".to_owned());
    }
    let rows: usize = entry("shape")
        .and_then(|e| e.strip_prefix('(')?.split_once(')'))
        .and_then(|(shape, _)| shape.trim_end_matches(',').split_once(','))
        .and_then(|(rows, columns)| (columns.trim() == "2").then(|| rows.trim().parse().ok())?)
        .filter(|rows| *rows <= MOST_ROWS)
        .ok_or_else(|| format!("an array with the header {}", header.trim()))?;
    let kind = entry("descr")
        .and_then(|e| e.strip_prefix('\'')?.split_once('\''))
        .map_or("", |(kind, _)| kind);
    let data = &bytes[start + length..];
    let (size, numbers): (usize, Vec<f64>) = match kind {
        "<i4" => (4, read(data, |b| f64::from(i32::from_le_bytes(b)))),
        "<i8" => (8, read(data, |b| i64::from_le_bytes(b) as f64)),
        "<f4" => (4, read(data, |b| f64::from(f32::from_le_bytes(b)))),
        "<f8" => (8, read(data, f64::from_le_bytes)),
        other => return Err(format!("an array of `{other}`")),
    };
    if rows == 0 {
        return Err("an array without rows".to_owned());
    }
    if numbers.len() < 2 * rows {
        return Err(truncated());
    }
    let beyond = data.len() - 2 * rows * size;
    if beyond > 0 {
        return Err(format!("an array and {beyond} bytes behind it"));
    }
    Ok(numbers
        .chunks_exact(2)
        .map(|pair| [pair[0], pair[1]])
        .collect())
}

fn read<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    data.chunks_exact(N)
        .map(|bytes| {
            let mut whole = [0; N];
            whole.copy_from_slice(bytes);
            number(whole)
        })
        .collect()
}
