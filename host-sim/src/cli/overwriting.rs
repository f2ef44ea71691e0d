//! No command writes over a file that it reads.

use super::BadInput;
use std::path::{Path, PathBuf};

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

/// The same for files of a folder.
pub fn none_of_what_is_read(
    option: &str,
    folder: &Path,
    files: &[&str],
    read: &[(&str, &Path)],
) -> Result<(), BadInput> {
    let mut files = files.iter().map(|file| folder.join(file));
    files.try_for_each(|file| not_what_is_read(option, &file, read))
}

/// The files that worlds are read from: the one that is named and, of JSON lines, what is read beside it, or all of a
/// folder; none where they are generated.
pub fn of_worlds(place: &str) -> Vec<PathBuf> {
    if place.starts_with("generated:") {
        return Vec::new();
    }
    let place = Path::new(place);
    let files = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        entries.filter_map(|entry| Some(entry.ok()?.path()))
    };
    if place.is_dir() {
        let own = files(place.to_owned());
        own.chain(files(place.join("path_files"))).collect()
    } else if place.extension().is_some_and(|end| end == "toml") {
        vec![place.to_owned()]
    } else {
        vec![place.to_owned(), place.with_file_name("common.json")]
    }
}

/// What a design file is to the user.
pub const DESIGN: &str = "the design";
