//! A table of numbers from a CSV file, every bad cell with its place.

use std::{
    cell::Cell,
    fs::File,
    io::{self, Read},
    path::Path,
    rc::Rc,
};

use crate::failure::Failure;

/// Bytes of a row, with the comments above it.
const LONGEST_ROW: usize = 1_000_000;
/// Cells of a table that is read whole.
const MOST_CELLS: usize = 20_000_000;

/// A source of rows of which each is bounded: a single one could fill the memory.
pub(crate) struct Bounded<R> {
    source: R,
    left: Left,
}

/// The bytes that are left for a row.
#[derive(Clone)]
pub(crate) struct Left(Rc<Cell<usize>>);

impl Left {
    /// A row begins.
    pub(crate) fn begin(&self) {
        self.0.set(LONGEST_ROW);
    }
}

impl<R: Read> Bounded<R> {
    pub(crate) fn new(source: R) -> (Bounded<R>, Left) {
        let left = Left(Rc::new(Cell::new(LONGEST_ROW)));
        let bounded = Bounded {
            source,
            left: left.clone(),
        };
        (bounded, left)
    }
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let Left(left) = &self.left;
        if left.get() == 0 {
            let message = format!("a row is longer than {LONGEST_ROW} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        let count = self.source.read(to)?;
        left.set(left.get().saturating_sub(count));
        Ok(count)
    }
}

/// A CSV file with a header.
pub(crate) struct Table {
    pub(crate) file: String,
    pub(crate) header: Vec<String>,
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
    pub(crate) fn read(path: &Path) -> Result<Table, Failure> {
        let file = path.display().to_string();
        let unreadable = |error: &dyn std::fmt::Display| {
            Failure::unreadable(format!("`{file}` cannot be read: {error}"))
        };
        let source: Box<dyn Read> = if path == Path::new("-") {
            Box::new(std::io::stdin())
        } else {
            Box::new(File::open(path).map_err(|e| unreadable(&e).help("check the path"))?)
        };
        let (source, left) = Bounded::new(source);
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(source);
        let header: Vec<String> = reader
            .headers()
            .map_err(|error| broken(&file, &error))?
            .iter()
            .map(str::to_owned)
            .collect();
        if header.iter().all(String::is_empty) {
            return Err(Failure::unreadable(format!("`{file}` is empty"))
                .help("the first line names the columns, the others hold the rows"));
        }
        let mut records = Vec::new();
        let mut cells = 0;
        for record in reader.records() {
            left.begin();
            let record = record.map_err(|error| broken(&file, &error))?;
            cells += record.len();
            if cells > MOST_CELLS {
                let message = format!("`{file}` has more than {MOST_CELLS} cells");
                return Err(Failure::unreadable(message).help("use fewer rows or columns"));
            }
            let line = record.position().map_or(0, csv::Position::line);
            records.push((line, record));
        }
        if records.is_empty() {
            return Err(
                Failure::unreadable(format!("`{file}` has a header, but no rows"))
                    .help("`flagred dataset` makes rows from flight logs"),
            );
        }
        Ok(Table {
            file,
            header,
            records,
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

    /// The place of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// The place of a column that must be there; `help` says what else could be done.
    pub(crate) fn require(&self, name: &str, help: &str) -> Result<usize, Failure> {
        if self.header.iter().filter(|column| *column == name).count() > 1 {
            let message = format!("`{}` has the column `{name}` more than once", self.file);
            return Err(Failure::unreadable(message).help("rename all but the one that is meant"));
        }
        self.column(name).ok_or_else(|| {
            let columns = self.header.iter().map(String::as_str);
            let meant = fuzzy::diagnostic::suggest(name, columns).unwrap_or_default();
            Failure::unreadable(format!("`{}` has no column `{name}`", self.file))
                .help(format!("{meant}; {help}"))
        })
    }

    /// The text of a cell.
    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        let record = self.records.get(row).map(|(_, record)| record);
        record.and_then(|record| record.get(column)).unwrap_or("")
    }

    /// The finite number in a cell.
    pub(crate) fn number(&self, row: usize, column: usize) -> Result<f64, BadCell> {
        let text = self.text(row, column);
        let problem = match text.parse::<f64>() {
            Ok(number) if number.is_finite() => return Ok(number),
            Ok(_) => format!("`{text}` is not a finite number"),
            Err(_) if text.is_empty() => "the cell is empty".to_owned(),
            Err(_) => format!("`{text}` is not a number"),
        };
        Err(self.bad(row, column, problem))
    }

    /// A finding about a cell.
    pub(crate) fn bad(&self, row: usize, column: usize, problem: String) -> BadCell {
        BadCell {
            line: self.line(row),
            column: self.header.get(column).cloned().unwrap_or_default(),
            problem,
        }
    }
}

/// What is wrong with the text of a table, and where.
fn broken(file: &str, error: &csv::Error) -> Failure {
    let line = error.position().map_or(1, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => Failure::unreadable(format!(
            "`{file}`, line {line}: {len} cells, but the header has {expected_len}"
        ))
        .help("every row has as many cells as the header"),
        csv::ErrorKind::Utf8 { .. } => {
            Failure::unreadable(format!("`{file}`, line {line}: invalid UTF-8"))
                .help("the file must be CSV text, a header first")
        }
        _ => Failure::unreadable(format!("`{file}` cannot be read: {error}")),
    }
}
