//! The first row of a table: the names of its columns.

use fuzzy::diagnostic::quoted;

use super::cell::Cell;
use crate::failure::Failure;

/// The first row of a table.
pub(crate) struct Header {
    /// The name of the table for messages.
    pub(crate) file: String,
    /// The names of the columns, without surrounding spaces.
    pub(crate) names: Vec<String>,
    pub(super) delimiter: u8,
}

impl Header {
    /// Returns the index of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|column| column == name)
    }

    /// Returns the index of a required column; `help` is added to the message if it is missing.
    pub(crate) fn require(&self, name: &str, help: &str) -> Result<usize, Failure> {
        self.require_with(name, help, |meant| format!("did you mean `{meant}`?"))
    }

    /// Returns the index of a required column. If it is missing and no other advice applies, `help` is added to the message.
    /// `for_case` returns the advice if a column differs from the name only in upper and lower case.
    pub(super) fn require_with(
        &self,
        name: &str,
        help: &str,
        for_case: impl Fn(&str) -> String,
    ) -> Result<usize, Failure> {
        if name.is_empty() {
            // A column without a name in the header cannot be requested.
            return Err(Failure::usage("a column must have a name").help(help));
        }
        if self.names.iter().filter(|column| *column == name).count() > 1 {
            let name = quoted(name);
            let message = format!("`{}` has the column `{name}` more than once", self.file);
            return Err(Failure::unreadable(message).help("rename all of them except one"));
        }
        self.column(name).ok_or_else(|| {
            let failure = Failure::unreadable(format!("`{}` has no column `{name}`", self.file));
            if self.names.first().is_some_and(|name| name.starts_with("sep=")) {
                return failure.help("delete the first line, and use `--delimiter` instead");
            }
            if let Some(other) = self.other_delimiter() {
                return failure.help(format!(
                    "its cells seem to be separated by another character: add `--delimiter {other}`"
                ));
            }
            if self.names.iter().all(|name| name.parse::<f64>().is_ok()) {
                return failure
                    .help("the first line contains numbers; it must contain the names of the columns");
            }
            let columns = self.names.iter().map(String::as_str);
            let columns = columns.filter(|name| !name.is_empty());
            // The most frequent mistake is a difference in upper and lower case.
            if let Some(column) = columns.clone().find(|it| it.eq_ignore_ascii_case(name)) {
                return failure.help(for_case(&quoted(column)));
            }
            // The table may have a line for each variable instead of a column, as in `temperature,5,24,35`.
            let is_number = |name: &String| name.parse::<f64>().is_ok();
            if let [first, values @ ..] = self.names.as_slice()
                && !is_number(first)
                && !values.is_empty()
                && values.iter().all(is_number)
            {
                return failure.help("a row is one point: write the names in the first line, and the values of each point in a line of their own");
            }
            if let [only] = self.names.as_slice()
                && only.contains(' ')
            {
                return failure.help("the first line must contain the names of the columns, separated by `,` or the character of `--delimiter`");
            }
            if self.column("t_s").is_some() && ["motor1", "pwm1"].iter().any(|it| self.column(it).is_some()) {
                let file = &self.file;
                return failure.help(format!("it is a flight; `flagred dataset {file} --profile flagred -o rows.csv` makes a table of flights"));
            }
            failure.help(match fuzzy::diagnostic::suggest(name, columns) {
                Some(meant) if meant.ends_with('?') => format!("{meant} If not: {help}"),
                Some(columns) => format!("{columns}; {help}"),
                None => help.to_owned(),
            })
        })
    }

    /// The probable delimiter, if it differs from the chosen one.
    pub(crate) fn other_delimiter(&self) -> Option<&'static str> {
        let [only] = self.names.as_slice() else {
            return None;
        };
        let all = [(b';', "';'"), (b'\t', "tab"), (b',', "','"), (b'|', "'|'")];
        let mut found = all
            .into_iter()
            .filter(|(byte, _)| *byte != self.delimiter && only.as_bytes().contains(byte));
        found.next().map(|(_, word)| word)
    }

    /// Advice for a row with more or fewer cells than the header.
    pub(crate) fn misfit_help(&self) -> String {
        match self.other_delimiter() {
            Some(other) => format!(
                "its cells seem to be separated by another character: add `--delimiter {other}`"
            ),
            None if self.delimiter == b',' => {
                "write as many cells in every row as in the header; a decimal comma splits a number, so write a point".to_owned()
            }
            None => "write as many cells in every row as in the header".to_owned(),
        }
    }

    /// Returns the problem of a row that does not fit the header, if any, and whether [`misfit_help`](Self::misfit_help)
    /// applies.
    pub(crate) fn misfit(&self, record: &csv::ByteRecord) -> Option<(String, bool)> {
        let (cells, expected) = (record.len(), self.names.len());
        let first = record.get(0);
        let last = cells.checked_sub(1).and_then(|last| record.get(last));
        let is_open = last.is_some_and(|cell| self.contains_rows(cell));
        if is_open || cells != expected && record.iter().any(|cell| cell.contains(&b'\n')) {
            let problem = "the quote is never closed, so the lines after it are read as one cell";
            return Some((problem.to_owned(), false));
        }
        let is_comment = cells < expected && first.is_some_and(|first| first.starts_with(b"#"));
        if is_comment {
            return Some((
                "comments are allowed only above the header".to_owned(),
                false,
            ));
        }
        (cells != expected).then(|| {
            let plural = if cells == 1 { "" } else { "s" };
            (
                format!("{cells} cell{plural}, but the header has {expected}"),
                true,
            )
        })
    }

    /// Whether a cell contains further rows, or the end of its own row, because its quote is not closed.
    fn contains_rows(&self, cell: &[u8]) -> bool {
        let mut lines = cell.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        let first = lines.next().unwrap_or_default();
        let rest: Vec<&[u8]> = lines.collect();
        let is_number = matches!(Cell::of(first), Cell::Number(_));
        let is_row = |line: &&[u8]| {
            let delimiters = line.iter().filter(|byte| **byte == self.delimiter).count();
            delimiters > 0 && delimiters + 1 == self.names.len()
        };
        let mut rows = rest.iter().filter(|line| !line.is_empty()).peekable();
        let has_rows = rows.peek().is_some();
        !rest.is_empty() && rows.all(is_row) && (has_rows || is_number)
    }

    /// The name of a column.
    pub(crate) fn name(&self, column: usize) -> &str {
        self.names.get(column).map_or("", String::as_str)
    }
}
