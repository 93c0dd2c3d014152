//! All output of a command: files, standard output, notes on standard error.
//!
//! A command declares its inputs and outputs before it starts ([`Files`]), computes the contents, and writes them: files first,
//! since standard output may block or close ([`write_all`]).

mod file;
mod stdout;

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

pub(crate) use flagred_report::table::{cell, number_or_cell};

pub(crate) use crate::path::{RULES, has_ending};

pub(crate) use self::{
    file::{Files, Output, Replace, can_replace, new_file, write_all},
    stdout::Stdout,
};
use crate::failure::Failure;

/// Parses the path of an SVG picture. Another extension is refused, since it would not match the contents.
pub(crate) fn svg_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the picture is SVG", &["svg"])
}

/// Parses the path of a rule set or a profile. Other extensions are refused, so that a table named by mistake is not replaced.
pub(crate) fn rules_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the file is YAML", &["yaml", "yml"])
}

/// Parses the path of a text or a table. Other extensions are refused, so that a rule set named by mistake is not replaced.
pub(crate) fn text_path(text: &str) -> Result<PathBuf, String> {
    let pictures = ["svg", "png", "pdf", "jpg", "jpeg", "gif", "eps"];
    if has_ending(Path::new(text), &pictures) {
        let picture = Path::new(text).with_extension("svg");
        return Err(format!(
            "the output is text; for a picture write `--svg {}`",
            picture.display()
        ));
    }
    path_of(
        text,
        "the output is text",
        &["txt", "csv", "tsv", "json", "md", "ansi"],
    )
}

/// Parses the path of a report. Other extensions are refused, so that a log named by mistake is not replaced.
pub(crate) fn html_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the report is HTML", &["html", "htm"])
}

/// Parses the path of a page. Other extensions are refused, so that a log named by mistake is not replaced.
pub(crate) fn page_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the page is HTML", &["html", "htm"])
}

/// Parses the path of a flight CSV. Other extensions are refused, so that a log named by mistake is not replaced.
pub(crate) fn csv_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the table is CSV", &["csv", "txt"])
}

/// Parses the path of a table with any delimiter. Other extensions are refused, so that a log named by mistake is not replaced.
pub(crate) fn table_path(text: &str) -> Result<PathBuf, String> {
    path_of(text, "the table is CSV", &["csv", "tsv", "txt"])
}

/// Parses a path whose extension, if any, must be one of these.
///
/// # Errors
///
/// If the path has another extension. The message contains `what` and the path with the first allowed extension.
pub(crate) fn path_of(text: &str, what: &str, extensions: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match extensions.first() {
        Some(first) if path.extension().is_some() && !has_ending(&path, extensions) => {
            let stem = path.with_extension("");
            let written = match has_ending(&stem, extensions) {
                true => stem,
                false => path.with_extension(first),
            };
            Err(format!("{what}; write `{}`", written.display()))
        }
        _ => Ok(path),
    }
}

/// Writes a text to a file or to standard output. Colours in the text are kept only on a terminal.
pub(crate) fn print(output: Option<&Output>, text: &str) -> Result<(), Failure> {
    if let Some(output) = output.filter(|output| !output.is_stdout()) {
        return output.write(&anstream::adapter::strip_str(text).to_string());
    }
    let mut out = Stdout::text();
    write!(out, "{text}")?;
    out.finish()?;
    Ok(())
}

/// Prints a note on standard error, in one line.
pub(crate) fn say(note: &str) {
    // If standard error is closed, there is no other way to report that.
    let _ = writeln!(anstream::stderr(), "{}", fuzzy::drawing::visible(note));
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}
