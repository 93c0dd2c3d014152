//! Files that are not tables, recognised by their first bytes.

use crate::failure::Failure;

/// A file that is not a table.
pub(super) struct Foreign {
    is: &'static str,
    help: &'static str,
}

impl Foreign {
    pub(super) fn failure(&self, file: &str) -> Failure {
        let file = if file == "-" { "standard input" } else { file };
        Failure::unreadable(format!("`{file}` is {}, not a table", self.is)).help(self.help)
    }
}

/// Recognises other files by their first bytes.
pub(super) fn not_a_table(start: &[u8]) -> Option<Foreign> {
    let is = |is, help| Some(Foreign { is, help });
    if flagred_authoring::kind::is_utf16(start) {
        return is("text in UTF-16", "save it as UTF-8");
    }
    let kind = flagred_flightlog::kind_of(start);
    if let Some(kind) = kind {
        return is(
            kind,
            "a table is CSV text with the column names in the first line",
        );
    }
    let mut lines = start.split(|byte| *byte == b'\n');
    if lines.any(|line| line.starts_with(b"fuzzy:") || line.starts_with(b"flagred:")) {
        return is(
            "a rule set or profile",
            "name the rule set first, then the tables: see `--help`",
        );
    }
    None
}
