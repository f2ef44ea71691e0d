//! Files of text, plain or packed.

use super::error::WorldError;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest text that is read, bytes: several times all 300 of the benchmark's worlds.
const MOST_BYTES: u64 = 64 << 20;

/// What gzip files begin with (RFC 1952, section 2.3.1).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// A file's text, unpacked where its name ends in `.gz`. `allowed` is what it ought to be, for messages.
pub fn read(file: &Path, allowed: &str) -> Result<String, WorldError> {
    let name = file.display().to_string();
    let unreadable = |e: std::io::Error| WorldError::Unreadable {
        file: name.clone(),
        why: e.to_string(),
    };
    let mut bytes = Vec::new();
    File::open(file)
        .and_then(|f| f.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if file.extension().is_some_and(|end| end == "gz") {
        bytes = unpacked(&name, &bytes)?;
    }
    if bytes.len() as u64 > MOST_BYTES {
        let found = format!("more than {} MiB of text", MOST_BYTES >> 20);
        return Err(WorldError::wrong(name, found, "less"));
    }
    String::from_utf8(bytes).map_err(|e| {
        let before = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        let found = "bytes that are no text (UTF-8)";
        WorldError::wrong(format!("{name}:{line}"), found, allowed)
    })
}

fn unpacked(name: &str, bytes: &[u8]) -> Result<Vec<u8>, WorldError> {
    if !bytes.starts_with(&GZIP) {
        return Err(WorldError::wrong(
            name,
            "what is no gzip file",
            "a gzip file, or a name without .gz for one that is not packed",
        ));
    }
    let mut plain = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(MOST_BYTES + 1)
        .read_to_end(&mut plain)
        .map_err(|e| {
            let found = format!("a gzip file that is broken or cut short ({e})");
            WorldError::wrong(name, found, "a whole one")
        })?;
    Ok(plain)
}
