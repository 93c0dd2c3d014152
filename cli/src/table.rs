//! A table of numbers from a CSV file, every bad cell with its place.

use std::{fs::File, io::Read, path::Path};

use crate::failure::Failure;

/// A CSV file with a header.
pub(crate) struct Table {
    pub(crate) file: String,
    pub(crate) header: Vec<String>,
    records: Vec<(u64, csv::StringRecord)>,
}

/// What to say of a table whose columns are separated by semicolons: spreadsheets with a decimal comma write them so.
pub(crate) fn semicolons(file: &str, header: &[String]) -> Option<Failure> {
    let [only] = header else { return None };
    let failure = Failure::unreadable(format!(
        "the columns of `{file}` are separated by `;`, not by `,`"
    ));
    only.contains(';').then(|| {
        failure.help("save the table with commas between the columns and points in the numbers")
    })
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
        if let Some(failure) = semicolons(&file, &header) {
            return Err(failure);
        }
        let mut records = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| broken(&file, &error))?;
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
