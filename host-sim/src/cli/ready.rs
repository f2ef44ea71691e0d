//! Places for results are tried before the work: hours of it are not lost to a slip in a name.

use super::{BadInput, check_folder_of};
use host_sim::put::try_out;
use std::path::Path;

/// Makes the folders above `file`, named by `option`, and finds out whether it can be written.
pub fn ready_file(option: &str, file: &Path) -> Result<(), BadInput> {
    try_out(file).map_err(|why| {
        BadInput(format!(
            "{option} {}: cannot be written ({why}); allowed is a file, existing or new, where one can be written",
            file.display()
        ))
    })
}

/// The same for files of a folder.
pub fn ready_folder(option: &str, folder: &Path, files: &[&str]) -> Result<(), BadInput> {
    check_folder_of(option, folder)?;
    let mut files = files.iter().map(|file| folder.join(file));
    files.try_for_each(|file| ready_file(option, &file))
}
