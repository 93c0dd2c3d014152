//! All that a command writes: files, standard output, notes on standard error.
//!
//! A command names what it reads and writes before it begins ([`Files`]), makes the contents, and writes them: files first,
//! since standard output may block or close ([`write_all`]).

mod file;
mod stdout;

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

pub(crate) use flagred_report::table::{cell, number_or_cell};

pub(crate) use self::{
    file::{Files, Output, Replace, can_replace, new_file, write_all},
    stdout::Stdout,
};
use crate::failure::Failure;

/// A file for an SVG picture: another extension would lie about what is in it.
pub(crate) fn svg_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the picture is SVG", &["svg"])
}

/// A file for a rule set or a profile. A table that stands here by mistake is not replaced.
pub(crate) fn rules_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the file is YAML", &["yaml", "yml"])
}

/// A file for text or a table. A rule set that stands here by mistake is not replaced.
pub(crate) fn text_path(text: &str) -> Result<PathBuf, String> {
    if has_ending(Path::new(text), &["svg"]) {
        return Err(format!(
            "this writes text; for a picture write `--svg {text}`"
        ));
    }
    path_of(
        text,
        "this writes text",
        &["txt", "csv", "tsv", "json", "md", "ansi"],
    )
}

/// A file for a report. A log that stands here by mistake is not replaced.
pub(crate) fn html_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the report is HTML", &["html", "htm"])
}

/// A file for a page. A log that stands here by mistake is not replaced.
pub(crate) fn page_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the page is HTML", &["html", "htm"])
}

/// A file for a flight CSV. A log that stands here by mistake is not replaced.
pub(crate) fn csv_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the table is CSV", &["csv", "txt"])
}

/// A file for a table with whatever between its cells. A log that stands here by mistake is not replaced.
pub(crate) fn table_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the table is CSV", &["csv", "tsv", "txt"])
}

/// A path whose ending is one of these, if it has one.
///
/// # Errors
///
/// What is written and the path with the first ending.
pub(crate) fn path_of(text: &str, what: &str, extensions: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match extensions.first() {
        Some(first) if path.extension().is_some() && !has_ending(&path, extensions) => Err(
            format!("{what}; write `{}`", path.with_extension(first).display()),
        ),
        _ => Ok(path),
    }
}

fn has_ending(path: &Path, extensions: &[&str]) -> bool {
    let ending = path.extension();
    ending.is_some_and(|ending| extensions.iter().any(|e| ending.eq_ignore_ascii_case(e)))
}

/// Writes a text to a file, or to standard output; on a terminal in its colours.
pub(crate) fn print(output: Option<&Output>, text: &str) -> Result<(), Failure> {
    if let Some(output) = output.filter(|output| !output.is_stdout()) {
        return output.write(&anstream::adapter::strip_str(text).to_string());
    }
    let mut out = Stdout::text();
    write!(out, "{text}")?;
    out.finish()?;
    Ok(())
}

/// A note on standard error, in one line.
pub(crate) fn say(note: &str) {
    // Nothing is left to tell a user whose standard error is closed.
    let _ = writeln!(anstream::stderr(), "{}", fuzzy::drawing::visible(note));
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}
