//! Tables of numbers from CSV files: one reader for all commands, which reports the position of every bad cell.

mod cell;
mod foreign;
mod header;
mod share;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, IsTerminal, Read},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

pub(crate) use cell::Cell;
use foreign::not_a_table;
use fuzzy::diagnostic::{nearest, quoted};
pub(crate) use header::Header;
pub(crate) use share::Extent;

use crate::{
    advice::in_shell,
    failure::{Failure, cannot_read},
    output::{has_ending, print_note},
};

/// Maximum number of bytes of a row, including the comments above it.
const LONGEST_ROW: usize = 1_000_000;
/// Maximum number of cells of a table that is read as a whole.
const MAX_CELLS: usize = 20_000_000;

/// A source with a limit on the length of each row, since a single row could exhaust memory.
struct BoundedReader {
    source: Box<dyn Read + Send>,
    /// Remaining bytes for the current row.
    left: Arc<AtomicUsize>,
}

impl Read for BoundedReader {
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

/// A table whose comment lines above the header are replaced by empty lines, so that line numbers do not change.
type UncommentedReader = io::Chain<Cursor<Vec<u8>>, BufReader<BoundedReader>>;

fn uncommented(mut source: BufReader<BoundedReader>) -> io::Result<UncommentedReader> {
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
    csv: csv::Reader<UncommentedReader>,
    left: Arc<AtomicUsize>,
}

impl Reader {
    /// Reads a row, and returns whether there was one.
    pub(crate) fn read_byte_record(&mut self, record: &mut csv::ByteRecord) -> csv::Result<bool> {
        self.left.store(LONGEST_ROW, Ordering::Relaxed);
        self.csv.read_byte_record(record)
    }

    /// Like [`Reader::read_byte_record`], for text.
    fn read_record(&mut self, record: &mut csv::StringRecord) -> csv::Result<bool> {
        self.left.store(LONGEST_ROW, Ordering::Relaxed);
        self.csv.read_record(record)
    }
}

/// The columns of a table, and the character between them.
#[derive(clap::Args)]
pub(crate) struct Layout {
    /// Read a variable from a column of another name: `margin=margin_mean`; may be repeated
    #[arg(long, value_name = "NAME=COLUMN", value_parser = pair)]
    column: Vec<(String, String)>,

    /// The character between cells, such as `;`, or `tab`
    #[arg(long, value_name = "CHARACTER", default_value = ",", value_parser = delimiter)]
    pub(crate) delimiter: u8,
}

/// Options for reading a table.
#[derive(clap::Args)]
pub(crate) struct Format {
    #[command(flatten)]
    pub(crate) layout: Layout,

    /// Skip rows that cannot be parsed. Commands that derive a rule set also skip rows whose values are unknown or outside
    /// their range
    #[arg(long)]
    pub(crate) skip_bad_rows: bool,
}

/// The suffix of columns that contain outputs.
#[derive(clap::Args)]
pub(crate) struct Suffix {
    /// Suffix of the columns of the outputs, such as `_model`; needed if a column of the table has the name of an output
    #[arg(
        long,
        value_name = "SUFFIX",
        default_value = "",
        hide_default_value = true
    )]
    pub(crate) suffix: String,
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

/// Returns whether a file has the extension of a table.
pub(crate) fn is_table(path: &Path) -> bool {
    has_ending(path, &["csv", "tsv"])
}

/// Refuses a table that is given in place of the rule set, if one of the `others` is a rule set.
pub(crate) fn rule_set_first(
    command: &str,
    model: &Path,
    others: &[PathBuf],
) -> Result<(), Failure> {
    let Some(rules) = others
        .iter()
        .find(|other| !is_table(other) && other.as_path() != Path::new("-"))
        .filter(|_| is_table(model))
    else {
        return Ok(());
    };
    let tables = others
        .iter()
        .filter(|other| *other != rules)
        .map(PathBuf::as_path);
    let line = [rules.as_path(), model].into_iter().chain(tables);
    let line: Vec<String> = line.map(|path| path.display().to_string()).collect();
    let message = format!(
        "`{}` is a table, but the rule set comes first",
        model.display()
    );
    Err(Failure::usage(message).help(format!("flagred {command} {}", line.join(" "))))
}

impl Format {
    /// Returns the name of the first of these options whose value differs from its default.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let skip = self.skip_bad_rows.then_some("--skip-bad-rows");
        self.layout.given().or(skip)
    }
}

impl Suffix {
    /// Returns the name of this option if its value differs from the default.
    pub(crate) fn given(&self) -> Option<&'static str> {
        (!self.suffix.is_empty()).then_some("--suffix")
    }
}

impl Layout {
    /// Returns the name of the first of these options whose value differs from its default.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let column = (!self.column.is_empty()).then_some("--column");
        let delimiter = (self.delimiter != b',').then_some("--delimiter");
        column.or(delimiter)
    }

    /// Whether a variable is read from a column of another name.
    pub(crate) fn renames(&self, variable: &str) -> bool {
        self.column.iter().any(|(name, _)| name == variable)
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
            return Err(
                match self
                    .column
                    .iter()
                    .find(|(_, column)| names.contains(&column.as_str()))
                {
                    Some((name, column)) => failure.help(format!(
                        "the variable comes first: `--column {column}={name}`"
                    )),
                    None => failure.help_if(meant),
                },
            );
        }
        let column = |name: &&str| {
            let named = self.column.iter().find(|(n, _)| n == name);
            let column = named.map_or(*name, |(_, column)| column.as_str());
            let near = nearest(name, header.names.iter().map(String::as_str));
            let near = near
                .filter(|near| !names.contains(near))
                .unwrap_or("COLUMN");
            let option =
                |column: &str| format!("--column {}", in_shell(&format!("{name}={column}")));
            let help = format!("name the column that contains it with `{}`", option(near));
            header.require_with(column, &help, |meant| {
                format!("did you mean `{meant}`? then add `{}`", option(meant))
            })
        };
        names.iter().map(column).collect()
    }
}

/// Opens a table and reads its header; `-` is standard input. Rows may have more or fewer cells than the header, and cells
/// may have spaces around them.
pub(crate) fn open(path: &Path, delimiter: u8) -> Result<(Header, Reader), Failure> {
    const BUFFER: usize = 1 << 18;
    let file = path.display().to_string();
    let source: Box<dyn Read + Send> = if path == Path::new("-") {
        if io::stdin().is_terminal() {
            print_note("note: the table is read from the terminal; Ctrl-D ends it");
        }
        Box::new(io::stdin())
    } else {
        if path.is_dir() {
            return Err(cannot_read(&file, &std::io::ErrorKind::IsADirectory.into()));
        }
        Box::new(File::open(path).map_err(|error| cannot_read(&file, &error))?)
    };
    let left = Arc::new(AtomicUsize::new(LONGEST_ROW));
    let mut source = BufReader::new(BoundedReader {
        source,
        left: Arc::clone(&left),
    });
    let unreadable = |error: io::Error| cannot_read(&file, &error);
    if let Some(failure) = not_a_table(source.fill_buf().map_err(unreadable)?, &file) {
        return Err(failure);
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

/// A whole table.
pub(crate) struct Table {
    pub(crate) header: Header,
    records: Vec<(u64, csv::StringRecord)>,
    /// The position and the problem of each row that was skipped because it has more or fewer cells than the header.
    pub(crate) skipped: Vec<String>,
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
        Table::read_rows(path, delimiter, None)
    }

    /// Reads a whole file; `-` is standard input. `--skip-bad-rows` also skips rows with too few or too many cells.
    pub(crate) fn read_with(path: &Path, format: &Format) -> Result<Table, Failure> {
        Table::read_rows(path, format.layout.delimiter, Some(format.skip_bad_rows))
    }

    /// Reads a whole table. `skip` is the value of `--skip-bad-rows`, if the command has this option.
    fn read_rows(path: &Path, delimiter: u8, skip: Option<bool>) -> Result<Table, Failure> {
        let (header, mut reader) = open(path, delimiter)?;
        let file = &header.file;
        let mut records = Vec::new();
        let mut record = csv::StringRecord::new();
        let mut cells = 0;
        let mut skipped = Vec::new();
        while reader
            .read_record(&mut record)
            .map_err(|error| broken(file, &error))?
        {
            cells += record.len();
            if cells > MAX_CELLS {
                let message = format!("`{file}` has more than {MAX_CELLS} cells");
                return Err(Failure::unreadable(message).help("use fewer rows or columns"));
            }
            let line = record.position().map_or(0, csv::Position::line);
            if let Some((misfit, is_count)) = header.misfit(record.as_byte_record()) {
                let text = format!("`{file}`, line {line}: {misfit}");
                if !is_count {
                    return Err(Failure::unreadable(text));
                }
                skipped.push(text);
                if skip == Some(true) {
                    continue;
                }
                break;
            }
            records.push((line, record.clone()));
        }
        if let Some(first) = skipped.first()
            && (skip != Some(true) || records.is_empty())
        {
            let help = header.misfit_help();
            return Err(Failure::unreadable(first).help(match skip {
                Some(false) if header.other_delimiter().is_none() => {
                    format!("{help}; or leave such rows out with `--skip-bad-rows`")
                }
                _ => help,
            }));
        }
        if records.is_empty() {
            return Err(
                Failure::unreadable(format!("`{file}` has a header, but no rows"))
                    .help("write the rows below the header"),
            );
        }
        Ok(Table {
            header,
            records,
            skipped,
        })
    }

    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.records.len()
    }

    /// The line of a row in the file.
    pub(crate) fn line(&self, row: usize) -> u64 {
        self.records.get(row).map_or(0, |(line, _)| *line)
    }

    /// The text of a cell, without surrounding spaces.
    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        self.cell(row, column).trim()
    }

    /// The text of a cell, unchanged.
    pub(crate) fn cell(&self, row: usize, column: usize) -> &str {
        let record = self.records.get(row).map(|(_, record)| record);
        record
            .and_then(|record| record.get(column))
            .unwrap_or_default()
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

    /// Refuses a column without any number; `help` is added if there is no advice about its first cell. A table with a
    /// single row is not refused here, because the message about its bad cell is more specific.
    pub(crate) fn has_numbers(&self, column: usize, help: &str) -> Result<(), Failure> {
        let cell = |row| self.text(row, column);
        let mut cells = (0..self.len()).map(|row| Cell::of(cell(row).as_bytes()));
        if self.len() == 1 || cells.any(|cell| matches!(cell, Cell::Number(_))) {
            return Ok(());
        }
        let (file, name) = (&self.header.file, self.header.name(column));
        let advice = fuzzy::tree::number_advice(cell(0));
        let example = match quoted(cell(0)) {
            empty if empty.is_empty() => format!("line {}: an empty cell", self.line(0)),
            text => format!("line {}: `{text}`", self.line(0)),
        };
        let message = format!("column `{name}` of `{file}` contains no number ({example})");
        Err(Failure::unreadable(message).help(advice.as_deref().unwrap_or(help)))
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
