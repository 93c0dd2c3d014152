//! Files that are written.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use crate::failure::Failure;

/// Writes a file so that it is there whole or not at all: beside its place first, then renamed; `-` is standard output.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    if path == Path::new("-") {
        write!(std::io::stdout().lock(), "{text}")?;
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let draft = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = fs::write(&draft, text).and_then(|()| fs::rename(&draft, path));
    written.map_err(|error| {
        // What is left of it is of no use; that it cannot be removed either is no news.
        let _ = fs::remove_file(&draft);
        Failure::unreadable(format!("`{}` cannot be written: {error}", path.display()))
            .help("check that its folder exists and can be written to")
    })
}

/// A file for an SVG picture: another extension would lie about what is in it.
pub(crate) fn svg_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(other) if !other.eq_ignore_ascii_case("svg") => Err(format!(
            "the picture is SVG; write `{}`, and convert it with another program",
            path.with_extension("svg").display()
        )),
        _ => Ok(path),
    }
}
