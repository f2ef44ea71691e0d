//! Design files: FuzzyLite's `.fll`, IEC 61131-7's `.fcl` and MATLAB's `.fis` read into a [`System`] and, the first two,
//! written again.
//!
//! Reading never guesses. What this project does not support is named with its line and refused, and so is what
//! contradicts itself; see [`error::ReadError`]. Nothing that a file holds can make a reader panic, recurse without
//! bound or need much memory: see [`limits`].

pub mod adapt;
mod checks;
mod conditions;
mod cursor;
pub mod error;
pub mod fcl;
mod fis;
pub mod fll;
mod lexer;
pub mod limits;
mod norms;
mod shapes;
pub mod writing;

use crate::fuzzy::model::{Place, System};
use error::{ReadError, Source, advance, one_of};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// FuzzyLite's language.
    Fll,
    /// IEC 61131-7's fuzzy control language.
    Fcl,
    /// MATLAB's fuzzy inference systems, as Octave has them, too.
    Fis,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Fll, Self::Fcl, Self::Fis];

    /// Its files' extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Fll => "fll",
            Self::Fcl => "fcl",
            Self::Fis => "fis",
        }
    }

    /// By a file's extension, in capitals or not.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        Self::ALL
            .into_iter()
            .find(|f| f.extension().eq_ignore_ascii_case(extension))
    }
}

/// Reads a design file; its extension says the format if `from` does not. Errors are [`ReadError`]s: of the file system,
/// of the size ([`limits::BYTES`]), of the text.
pub fn load(path: &Path, from: Option<Format>) -> anyhow::Result<System> {
    let file = path.display().to_string();
    let Some(format) = from.or_else(|| Format::of(path)) else {
        let allowed = one_of(Format::ALL.map(|f| format!(".{}", f.extension())));
        return Err(ReadError::of_file(&file, "the extension names no format", allowed).into());
    };
    let bytes = contents(path)
        .map_err(|e| ReadError::of_file(&file, format!("cannot be read ({e})"), ""))?;
    Ok(parse(&file, &bytes, format)?)
}

/// At most one byte more than is allowed: a device may have no end.
fn contents(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let most = limits::BYTES as u64 + 1;
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a design file's contents; `file` is what messages call it.
pub fn parse(file: &str, bytes: &[u8], format: Format) -> Result<System, ReadError> {
    if bytes.len() > limits::BYTES {
        let allowed = format!("at most {} bytes", limits::BYTES);
        return Err(ReadError::of_file(file, "the file is too large", allowed));
    }
    let source = Source {
        file,
        text: text(file, bytes)?,
    };
    match format {
        Format::Fll => fll::read(source),
        Format::Fcl => fcl::read(source),
        Format::Fis => fis::read(source),
    }
}

/// The text that bytes are, without a mark of its encoding.
fn text<'b>(file: &str, bytes: &'b [u8]) -> Result<&'b str, ReadError> {
    const ALLOWED: &str = "a text in UTF-8";
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(ReadError::of_file(file, "the file is in UTF-16", ALLOWED));
    }
    let (text, bad) = match std::str::from_utf8(bytes) {
        Ok(text) => (text, None),
        Err(e) => {
            let (good, rest) = bytes.split_at(e.valid_up_to());
            (std::str::from_utf8(good).unwrap_or_default(), rest.first())
        }
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source { file, text };
    let control = text.find(|c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t'));
    let at = control.or(bad.map(|_| text.len()));
    let Some(at) = at else {
        return Ok(text);
    };
    let mut place = Place { line: 1, column: 1 };
    advance(&mut place, &text[..at]);
    let found = match (text[at..].chars().next(), bad) {
        (Some(c), _) => format!("found the control character U+{:04X}", u32::from(c)),
        (None, Some(byte)) => format!("found the byte 0x{byte:02X}, which is not UTF-8"),
        (None, None) => "the file ends".to_owned(),
    };
    Err(source.error(place, found, ALLOWED))
}
