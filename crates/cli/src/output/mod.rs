//! All output of a command: files, standard output, notes on standard error.
//!
//! A command declares its inputs and outputs before it starts ([`Files`]), computes the contents, and writes them: files first,
//! since standard output may block or close ([`write_all`]).

mod file;
mod stdout;

use std::{
    borrow::Cow,
    io::{IsTerminal as _, Write as _},
    path::{Path, PathBuf},
};

pub(crate) use flagred_report::table::cell;
use fuzzy::drawing::visible;

pub(crate) use crate::path::{RULES, has_ending};

pub(crate) use self::{
    file::{Files, Output, Replace, can_replace, new_file, repeated, write_all},
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

/// Returns a cell copied from another table: the same text, with hidden characters made visible on a terminal. Bytes that are
/// not UTF-8 are replaced.
pub(crate) fn copied(text: &[u8], is_terminal: bool) -> Cow<'_, [u8]> {
    match (str::from_utf8(text), is_terminal) {
        (Ok(_), false) => Cow::Borrowed(text),
        (Err(_), false) => Cow::Owned(String::from_utf8_lossy(text).into_owned().into()),
        (_, true) => Cow::Owned(visible(&String::from_utf8_lossy(text)).into_owned().into()),
    }
}

/// Returns whether an output goes to a terminal; `None` stands for standard output.
pub(crate) fn is_terminal(output: Option<&Output>) -> bool {
    output.is_none_or(Output::is_stdout) && std::io::stdout().is_terminal()
}

/// Prints a note on standard error, on one line.
pub(crate) fn print_note(note: &str) {
    // A write fails if standard error is closed. That cannot be reported elsewhere.
    let _ = writeln!(anstream::stderr(), "{}", visible(note));
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

#[cfg(test)]
mod tests {
    use super::copied;

    #[test]
    fn copied_cells_do_not_act_on_a_terminal() {
        for (text, on_terminal) in [
            ("-", "-"),
            ("=A1+2", "=A1+2"),
            ("a\u{1b}[2J", "a\\u{1b}[2J"),
        ] {
            assert_eq!(&*copied(text.as_bytes(), false), text.as_bytes());
            assert_eq!(&*copied(text.as_bytes(), true), on_terminal.as_bytes());
        }
    }
}
