//! No command writes over a file that it reads.

use super::BadInput;
use std::path::Path;

/// Refuses to write `out`, named by `option`, where it is one of the files that are read, by whatever name: a link to one,
/// too. Each comes with what it is to the user.
pub fn not_what_is_read(option: &str, out: &Path, read: &[(&str, &Path)]) -> Result<(), BadInput> {
    // What does not exist yet, or cannot be looked at, is another file; reading or writing it says what is wrong.
    let same = |file: &Path| same_file::is_same_file(out, file).unwrap_or(false);
    match read.iter().find(|(_, file)| same(file)) {
        None => Ok(()),
        Some((what, _)) => Err(BadInput(format!(
            "{option}: {} is {what} that is read, which would be lost; allowed is another file",
            out.display()
        ))),
    }
}

/// What a design file is to the user.
pub const DESIGN: &str = "the design";
