//! Tables of numbers from CSV files: one reader for all commands, which reports the position of every bad cell.

mod cell;
mod foreign;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, Read},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use fuzzy::diagnostic::quoted;

pub(crate) use cell::Cell;
use foreign::not_a_table;

use crate::{
    failure::{Failure, cannot_read},
    output::has_ending,
};

/// Maximum number of bytes of a row, including the comments above it.
const LONGEST_ROW: usize = 1_000_000;
/// Maximum number of cells of a table that is read as a whole.
const MOST_CELLS: usize = 20_000_000;

/// A source with a limit on the length of each row, since a single row could exhaust memory.
struct Bounded {
    source: Box<dyn Read + Send>,
    /// Remaining bytes for the current row.
    left: Arc<AtomicUsize>,
}

impl Read for Bounded {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let left = self.left.load(Ordering::Relaxed);
        if left == 0 {
            let message = format!("a row is longer than {LONGEST_ROW} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        let count = self.source.read(to)?;
        self.left
            .store(left.saturating_sub(count), Ordering::Relaxed);
        Ok(count)
    }
}

/// A table whose comment lines above the header are replaced by empty lines, so that line numbers stay right.
type Uncommented = io::Chain<Cursor<Vec<u8>>, BufReader<Bounded>>;

fn uncommented(mut source: BufReader<Bounded>) -> io::Result<Uncommented> {
    let mut empty_lines = Vec::new();
    let mut line = Vec::new();
    while matches!(
        source.fill_buf()?,
        [b'#' | b'\n', ..] | [0xef, 0xbb, 0xbf, b'#', ..]
    ) {
        line.clear();
        source.read_until(b'\n', &mut line)?;
        empty_lines.push(b'\n');
    }
    Ok(Cursor::new(empty_lines).chain(source))
}

/// Reads the rows of a table.
pub(crate) struct Reader {
    csv: csv::Reader<Uncommented>,
    left: Arc<AtomicUsize>,
}

impl Reader {
    /// Reads a row, and returns whether there was one.
    pub(crate) fn read_byte_record(&mut self, record: &mut csv::ByteRecord) -> csv::Result<bool> {
        self.left.store(LONGEST_ROW, Ordering::Relaxed);
        self.csv.read_byte_record(record)
    }

    /// As [`Reader::read_byte_record`], for text.
    fn read_record(&mut self, record: &mut csv::StringRecord) -> csv::Result<bool> {
        self.left.store(LONGEST_ROW, Ordering::Relaxed);
        self.csv.read_record(record)
    }
}

/// Options for reading a table.
#[derive(clap::Args)]
pub(crate) struct Format {
    /// Read a variable from a column of another name: `margin=margin_mean`; may be repeated
    #[arg(long, value_name = "NAME=COLUMN", value_parser = pair)]
    column: Vec<(String, String)>,

    /// The character between cells: `;`, `tab`
    #[arg(long, value_name = "CHARACTER", default_value = ",", value_parser = delimiter)]
    pub(crate) delimiter: u8,

    /// Skip rows that cannot be read
    #[arg(long)]
    pub(crate) skip_bad_rows: bool,
}

pub(crate) fn pair(text: &str) -> Result<(String, String), String> {
    let (name, column) = text
        .split_once('=')
        .ok_or("write a name and a value: `NAME=VALUE`")?;
    Ok((name.trim().to_owned(), column.trim().to_owned()))
}

fn delimiter(text: &str) -> Result<u8, String> {
    match text.as_bytes() {
        _ if text == "tab" || text == "\\t" => Ok(b'\t'),
        [byte]
            if byte.is_ascii()
                && !byte.is_ascii_alphanumeric()
                && !b"\"#\r\n.-+".contains(byte) =>
        {
            Ok(*byte)
        }
        _ => Err("write one character, such as `;`, or `tab`".into()),
    }
}

/// Returns whether the name of a file is that of a table.
pub(crate) fn is_table(path: &Path) -> bool {
    has_ending(path, &["csv", "tsv"])
}

impl Format {
    /// The first of these options that differs from its default.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let column = (!self.column.is_empty()).then_some("--column");
        let delimiter = (self.delimiter != b',').then_some("--delimiter");
        let skip = self.skip_bad_rows.then_some("--skip-bad-rows");
        column.or(delimiter).or(skip)
    }

    /// Returns the column index of each variable.
    pub(crate) fn columns(&self, names: &[&str], header: &Header) -> Result<Vec<usize>, Failure> {
        if let Some((stray, _)) = self
            .column
            .iter()
            .find(|(name, _)| !names.contains(&name.as_str()))
        {
            let failure = Failure::usage(format!("the rule set has no variable `{stray}`"));
            let meant = fuzzy::diagnostic::suggest(stray, names.iter().copied());
            return Err(failure.help_if(meant));
        }
        let column = |name: &&str| {
            let named = self.column.iter().find(|(n, _)| n == name);
            let column = named.map_or(*name, |(_, column)| column.as_str());
            let help = format!("or name the column that contains it with `--column {name}=COLUMN`");
            header.require(column, &help)
        };
        names.iter().map(column).collect()
    }
}

/// The first row of a table.
pub(crate) struct Header {
    /// The name of the table for messages.
    pub(crate) file: String,
    /// The names of the columns, without surrounding spaces.
    pub(crate) names: Vec<String>,
    delimiter: u8,
}

/// Opens a table and reads its header; `-` is standard input. Rows may have more or fewer cells than the header, and cells
/// may have spaces around them.
pub(crate) fn open(path: &Path, delimiter: u8) -> Result<(Header, Reader), Failure> {
    const BUFFER: usize = 1 << 18;
    let file = path.display().to_string();
    let source: Box<dyn Read + Send> = if path == Path::new("-") {
        Box::new(std::io::stdin())
    } else {
        if path.is_dir() {
            return Err(cannot_read(&file, &std::io::ErrorKind::IsADirectory.into()));
        }
        Box::new(File::open(path).map_err(|error| cannot_read(&file, &error))?)
    };
    let left = Arc::new(AtomicUsize::new(LONGEST_ROW));
    let mut source = BufReader::new(Bounded {
        source,
        left: Arc::clone(&left),
    });
    let unreadable = |error: io::Error| cannot_read(&file, &error);
    if let Some(kind) = not_a_table(source.fill_buf().map_err(unreadable)?) {
        return Err(kind.failure(&file));
    }
    let source = uncommented(source).map_err(unreadable)?;
    let mut csv = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .trim(csv::Trim::Headers)
        .flexible(true)
        .buffer_capacity(BUFFER)
        .from_reader(source);
    let names = csv.headers().map_err(|error| broken(&file, &error))?;
    let names: Vec<String> = names.iter().map(str::to_owned).collect();
    if names.iter().all(String::is_empty) {
        let message = match names.len() {
            0 if path == Path::new("-") => "standard input is empty".to_owned(),
            0 => format!("`{file}` is empty"),
            cells => format!("the header of `{file}` does not name its {cells} columns"),
        };
        return Err(Failure::unreadable(message)
            .help("the first line must name the columns, the other lines are the rows"));
    }
    let header = Header {
        file,
        names,
        delimiter,
    };
    Ok((header, Reader { csv, left }))
}

impl Header {
    /// Returns the index of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|column| column == name)
    }

    /// Returns the index of a required column; `help` is added to the message if it is missing.
    pub(crate) fn require(&self, name: &str, help: &str) -> Result<usize, Failure> {
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
            // Different capitals are the most frequent mistake.
            if let Some(column) = columns.clone().find(|it| it.eq_ignore_ascii_case(name)) {
                let column = quoted(column);
                return failure.help(format!("did you mean `{column}`? then add `--column {name}={column}`"));
            }
            if let [only] = self.names.as_slice()
                && only.contains(' ')
            {
                return failure.help("the first line must contain the names of the columns, separated as `--delimiter` says");
            }
            let meant = fuzzy::diagnostic::suggest(name, columns).unwrap_or_default();
            failure.help(format!("{meant}; {help}"))
        })
    }

    /// The probable delimiter, if it differs from the chosen one.
    fn other_delimiter(&self) -> Option<&'static str> {
        let [only] = self.names.as_slice() else {
            return None;
        };
        let all = [(b';', "';'"), (b'\t', "tab"), (b',', "','"), (b'|', "'|'")];
        let mut found = all
            .into_iter()
            .filter(|(byte, _)| *byte != self.delimiter && only.as_bytes().contains(byte));
        found.next().map(|(_, word)| word)
    }

    /// Advice for a row whose number of cells is not that of the header.
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

    /// Returns the problem of a row with `cells` cells, if any.
    pub(crate) fn misfit(&self, cells: usize) -> Option<String> {
        let expected = self.names.len();
        (cells != expected).then(|| {
            format!(
                "{cells} cell{}, but the header has {expected}",
                if cells == 1 { "" } else { "s" }
            )
        })
    }

    /// The name of a column.
    pub(crate) fn name(&self, column: usize) -> &str {
        self.names.get(column).map_or("", String::as_str)
    }
}

/// A whole table.
pub(crate) struct Table {
    pub(crate) header: Header,
    records: Vec<(u64, csv::StringRecord)>,
}

/// A cell that is not a finite number.
pub(crate) struct BadCell {
    pub(crate) line: u64,
    pub(crate) column: String,
    pub(crate) problem: String,
}

impl Table {
    /// Reads a whole file; `-` is standard input.
    pub(crate) fn read(path: &Path, delimiter: u8) -> Result<Table, Failure> {
        let (header, mut reader) = open(path, delimiter)?;
        let file = &header.file;
        let mut records = Vec::new();
        let mut record = csv::StringRecord::new();
        let mut cells = 0;
        while reader
            .read_record(&mut record)
            .map_err(|error| broken(file, &error))?
        {
            cells += record.len();
            if cells > MOST_CELLS {
                let message = format!("`{file}` has more than {MOST_CELLS} cells");
                return Err(Failure::unreadable(message).help("use fewer rows or columns"));
            }
            let line = record.position().map_or(0, csv::Position::line);
            if let Some(misfit) = header.misfit(record.len()) {
                return Err(
                    Failure::unreadable(format!("`{file}`, line {line}: {misfit}"))
                        .help(header.misfit_help()),
                );
            }
            records.push((line, record.clone()));
        }
        if records.is_empty() {
            return Err(
                Failure::unreadable(format!("`{file}` has a header, but no rows"))
                    .help("write the rows below the header"),
            );
        }
        Ok(Table { header, records })
    }

    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.records.len()
    }

    /// The line of a row in the file.
    pub(crate) fn line(&self, row: usize) -> u64 {
        self.records.get(row).map_or(0, |(line, _)| *line)
    }

    /// The text of a cell.
    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        let record = self.records.get(row).map(|(_, record)| record);
        record
            .and_then(|record| record.get(column))
            .unwrap_or("")
            .trim()
    }

    /// Returns the finite number in a cell.
    pub(crate) fn number(&self, row: usize, column: usize) -> Result<f64, BadCell> {
        let text = self.text(row, column).as_bytes();
        match Cell::of(text) {
            Cell::Number(number) => Ok(number),
            Cell::Unknown if text == b"NA" => {
                Err(self.bad(row, column, "the value is unknown (`NA`)".to_owned()))
            }
            Cell::Unknown | Cell::Bad => Err(self.bad(row, column, Cell::problem(text))),
        }
    }

    /// Returns the finite number in the column with the given name; `None` if there is no such
    /// column.
    pub(crate) fn named_number(&self, row: usize, name: &str) -> Result<Option<f64>, BadCell> {
        let column = self.header.column(name);
        column.map(|column| self.number(row, column)).transpose()
    }

    /// Reports a problem with a cell.
    pub(crate) fn bad(&self, row: usize, column: usize, problem: String) -> BadCell {
        BadCell {
            line: self.line(row),
            column: self.header.name(column).to_owned(),
            problem,
        }
    }
}

/// Reports a malformed table, with the line.
pub(crate) fn broken(file: &str, error: &csv::Error) -> Failure {
    let line = error.position().map_or(1, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::Utf8 { .. } => {
            Failure::unreadable(format!("`{file}`, line {line}: not UTF-8"))
                .help("save the table as UTF-8")
        }
        _ => Failure::unreadable(format!("`{file}` cannot be read: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delimiter_is_one_character() {
        assert_eq!(delimiter(";"), Ok(b';'));
        assert_eq!(delimiter("tab"), Ok(b'\t'));
        assert_eq!(delimiter("\t"), Ok(b'\t'));
        for wrong in ["", ";;", "x", "\"", "#", ".", "§", "1"] {
            assert!(delimiter(wrong).is_err(), "{wrong}");
        }
    }
}
