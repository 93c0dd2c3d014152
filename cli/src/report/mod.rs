//! Reports to look at: one HTML file that opens offline, and the picture of risk over time as SVG.

mod charts;
mod curve;
mod decision;
mod page;
mod panel;
mod text;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use crate::failure::Failure;

pub(crate) use charts::SIGNALS;
pub(crate) use page::{Subject, comparison, report, svg};
pub(crate) use text::number;

/// Writes a file so that it is there whole or not at all: beside it first, then renamed.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let draft: PathBuf = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = fs::File::create(&draft)
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .and_then(|()| fs::rename(&draft, path));
    written.map_err(|error| {
        // Where it could not be created there is nothing to remove.
        let _ = fs::remove_file(&draft);
        Failure::unreadable(format!("`{}` cannot be written: {error}", path.display()))
            .help("check that its folder exists and can be written to")
    })
}
