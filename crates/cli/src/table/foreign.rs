//! Files that are not tables, recognised by their first bytes.

use crate::{diagnostics::is_utf16, failure::Failure};

/// Returns the failure for a file that is not a table.
pub(super) fn not_a_table(start: &[u8], file: &str) -> Option<Failure> {
    let shown = if file == "-" { "standard input" } else { file };
    let is = |what, help: &str| {
        let failure = Failure::unreadable(format!("`{shown}` is {what}, not a table"));
        Some(failure.help(help))
    };
    if is_utf16(start) {
        return is("text in UTF-16", "save it as UTF-8");
    }
    match flagred_flightlog::kind_of(start) {
        Some(flagred_flightlog::FileKind::LOG) => {
            let help = format!(
                "`flagred dataset {file} --profile flagred -o rows.csv` makes a table of flights"
            );
            return is("a flight log", &help);
        }
        Some(kind) => {
            let other = "a table is CSV text with the column names in the first line";
            return is(kind.name, &kind.help.unwrap_or(other).replace("FILE", file));
        }
        None => {}
    }
    let mut lines = start.split(|byte| *byte == b'\n');
    if lines.any(|line| line.starts_with(b"fuzzy:") || line.starts_with(b"flagred:")) {
        return is(
            "a rule set or profile",
            "name the rule set first, then the tables: see `--help`",
        );
    }
    match start.trim_ascii_start().first() {
        Some(b'[' | b'{') => is(
            "JSON",
            "write the names of the columns in the first line, then a line for each object, with commas between the cells",
        ),
        _ => None,
    }
}
