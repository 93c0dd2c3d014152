//! A table in CSV, and the values of variables in its rows.

use fuzzy::{diagnostic::suggest, model::Variable};

/// The maximum number of cells of a table.
const MAX_CELLS: usize = 5_000_000;

/// A message, and advice on what to do.
type Refusal = (String, String);

/// The cells of a table as text.
pub(super) struct Table {
    names: Vec<String>,
    records: Vec<(u64, csv::StringRecord)>,
}

/// The rows that can be used, and the reasons why the others cannot.
pub(super) struct Rows {
    /// For each row, the values of the inputs, then the value of the output.
    pub(super) values: Vec<Vec<f64>>,
    pub(super) lines: Vec<u64>,
    pub(super) refused: Vec<String>,
}

impl Table {
    pub(super) fn read(text: &str) -> Result<Table, Refusal> {
        let is_content = |line: &&str| !line.starts_with('#') && !line.trim().is_empty();
        let header = text.lines().find(is_content).unwrap_or_default();
        let delimiter = match [';', '\t', ','].map(|c| header.contains(c)) {
            [_, _, true] => b',',
            [true, ..] => b';',
            [_, true, _] => b'\t',
            _ => b',',
        };
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let broken = |error: csv::Error| {
            (
                format!("cannot be read: {error}"),
                "the file must be CSV text that begins with a header".into(),
            )
        };
        let names: Vec<String> = reader
            .headers()
            .map_err(broken)?
            .iter()
            .map(str::to_owned)
            .collect();
        let mut records = Vec::new();
        let mut cells = 0;
        for record in reader.records() {
            let record = record.map_err(broken)?;
            cells += record.len();
            if cells > MAX_CELLS {
                return Err((
                    format!("more than {MAX_CELLS} cells"),
                    "use fewer rows or columns".into(),
                ));
            }
            let line = record.position().map_or(0, csv::Position::line);
            records.push((line, record));
        }
        match records.is_empty() {
            true => Err((
                "there are no rows".into(),
                "write the names of the columns in the first line, and the rows below it".into(),
            )),
            false => Ok(Table { names, records }),
        }
    }

    /// The values of variables in each row. The last variable is the output, whose values may be
    /// names of constants.
    pub(super) fn rows(&self, variables: &[&Variable]) -> Result<Rows, Refusal> {
        let column = |variable: &&Variable| {
            let found = self.names.iter().position(|name| *name == variable.name);
            found.ok_or_else(|| {
                let names = self.names.iter().map(String::as_str);
                let meant = suggest(&variable.name, names)
                    .map_or(String::new(), |meant| format!("{meant}; "));
                let help = format!(
                    "{meant}rename a column to the name of the variable; the columns are {}",
                    self.names.join(", ")
                );
                (format!("no column `{}`", variable.name), help)
            })
        };
        let columns: Vec<usize> = variables.iter().map(column).collect::<Result<_, _>>()?;
        let mut rows = Rows {
            values: Vec::new(),
            lines: Vec::new(),
            refused: Vec::new(),
        };
        for (line, record) in &self.records {
            let mut values = Vec::with_capacity(columns.len());
            for (column, variable) in columns.iter().zip(variables) {
                let text = record.get(*column).unwrap_or_default();
                let labelled = variable.terms.iter().find(|term| term.name == text);
                let number = labelled.and_then(|term| term.membership_function.number());
                match number
                    .or_else(|| text.parse().ok())
                    .filter(|value: &f64| value.is_finite())
                {
                    Some(value) => values.push(value),
                    None => {
                        let problem = problem(text);
                        rows.refused.push(format!(
                            "line {line}, column `{}`: {problem}",
                            variable.name
                        ));
                        break;
                    }
                }
            }
            if values.len() == columns.len() {
                rows.values.push(values);
                rows.lines.push(*line);
            }
        }
        Ok(rows)
    }
}

fn problem(text: &str) -> String {
    match text {
        "" | "NA" | "NaN" => "the value is unknown".into(),
        _ if text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            format!("`{text}` is not a number: write a decimal point instead of a comma")
        }
        _ => format!("`{text}` is not a finite number"),
    }
}
