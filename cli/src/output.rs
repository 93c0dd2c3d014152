//! Files that are written.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use crate::failure::Failure;

/// Writes a file beside its place first, so that there is never half of one; `-` is standard output.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    if path == Path::new("-") {
        write!(std::io::stdout().lock(), "{text}")?;
        return Ok(());
    }
    let mut beside = path.to_owned().into_os_string();
    beside.push(".partial");
    let beside = PathBuf::from(beside);
    fs::write(&beside, text)
        .and_then(|()| fs::rename(&beside, path))
        .map_err(|error| {
            // What is left of it is of no use; that it cannot be removed either is no news.
            let _ = fs::remove_file(&beside);
            let shown = path.display();
            Failure::unreadable(format!("`{shown}` cannot be written: {error}"))
                .help("check the folder and its permissions")
        })
}
