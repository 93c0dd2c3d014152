//! The evaluation of whole flights from a table with one row for each flight.

use flagred::{profile::CRITICAL_ERROR_DEG, source::Source};

use crate::{
    baseline::Baseline,
    estimators::Estimators,
    recipe::{Recipe, recipe},
    scores::Case,
};

/// The name of the column that must contain the attitude error of each flight.
pub const ERROR: &str = "att_rmse_deg";

/// A table with one row for each flight.
pub struct FlightTable<'a, E> {
    /// The names of the columns, in their order.
    pub columns: Vec<&'a str>,
    /// The number of rows.
    pub len: usize,
    /// Returns the number in a row and column, or an error.
    pub number: &'a dyn Fn(usize, usize) -> Result<f64, E>,
    /// Returns the text in a row and column.
    pub text: &'a dyn Fn(usize, usize) -> &'a str,
}

impl<E> FlightTable<'_, E> {
    fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| *column == name)
    }

    fn named_number(&self, row: usize, name: &str) -> Result<Option<f64>, E> {
        let column = self.column(name);
        column.map(|column| (self.number)(row, column)).transpose()
    }
}

/// The columns of a table that contain the value of an input.
enum Column {
    /// A separate column.
    Own(usize),
    /// Columns from which the value is computed.
    Of(Recipe),
    /// No column, because the rules do not read the input.
    Unread,
}

impl Column {
    /// Finds a column with one of the names, or columns from which the input can be computed.
    fn of<E>(table: &FlightTable<'_, E>, names: &[&str], source: &Source) -> Option<Column> {
        let mut own = names.iter().filter_map(|name| table.column(name));
        if let Some(column) = own.next() {
            return Some(Column::Own(column));
        }
        let recipe = recipe(source)?;
        let mut columns = recipe.columns.iter();
        let has_all = columns.all(|name| table.column(name).is_some());
        has_all.then_some(Column::Of(recipe))
    }

    fn value<E>(&self, table: &FlightTable<'_, E>, row: usize) -> Result<f64, E> {
        match self {
            Column::Own(column) => (table.number)(row, *column),
            Column::Of(recipe) => recipe.value(|name| table.named_number(row, name)),
            Column::Unread => Ok(f64::NAN),
        }
    }
}

/// Converts the rows of a table to cases, each a separate flight unless a column `file` groups them; also returns notes
/// for the user.
///
/// A row is critical if its attitude error (`att_rmse_deg`) is 5 degrees or more, or if the flight ended in a crash.
///
/// # Errors
/// If a cell does not contain the required number.
pub fn cases<E>(
    table: &FlightTable<'_, E>,
    estimators: &Estimators,
) -> Result<(Vec<Case>, Vec<String>), E> {
    let crashed = table.column("crashed");
    let vehicle = table.column("vehicle").or_else(|| table.column("frame"));
    let (kind, file) = (table.column("kind"), table.column("file"));
    let mut notes = Vec::new();
    let profiles: Vec<Option<Vec<Column>>> = estimators
        .profiles
        .iter()
        .map(|named| {
            let inputs = named.estimator.profile().inputs.iter();
            let columns = inputs.map(|input| {
                let mut known = named.estimator.engine().input_names();
                let column = if known.all(|name| name != input.name) {
                    Some(Column::Unread)
                } else if input.ratio.is_some() {
                    table.column(&input.name).map(Column::Own)
                } else {
                    Column::of(table, &[&input.name], &input.source)
                };
                if column.is_none() {
                    notes.push(format!(
                        "profile `{}` has no risk: the table has no column for its input `{}`",
                        named.name, input.name
                    ));
                }
                column
            });
            columns.collect()
        })
        .collect();
    let baselines: Vec<(&Baseline, Option<Column>)> = estimators
        .baselines
        .iter()
        .map(|baseline| {
            // Tables of `flagred dataset` use another name for the mean margin, and tables of
            // flights for the wind.
            let other = match baseline.name {
                "margin_mean" => "margin",
                "true_wind" => "wind_mean",
                name => name,
            };
            let names: &[&str] = match baseline.name {
                // A column `margin_mean` contains the margin on the full range, which has other values.
                "margin_mean" => &[other],
                name => &[name, other],
            };
            let column = match baseline.per_motor {
                // A row does not contain values of single motors.
                Some(_) => None,
                None => Column::of(table, names, &baseline.source),
            };
            (baseline, column)
        })
        .collect();

    let (mut group, mut last) = (0, "");
    let mut cases = Vec::with_capacity(table.len);
    for row in 0..table.len {
        let read = |column: &Column| column.value(table, row);
        let text = |column: Option<usize>| column.map_or("", |column| (table.text)(row, column));
        let error_deg = table.named_number(row, ERROR)?.unwrap_or(f64::NAN);
        let mut scores = Vec::new();
        for (named, columns) in estimators.profiles.iter().zip(&profiles) {
            let inputs = columns
                .iter()
                .flatten()
                .map(read)
                .collect::<Result<Vec<f64>, E>>()?;
            let risk = columns.as_ref().and_then(|_| named.estimator.at(&inputs));
            scores.push(risk.map_or(f64::NAN, |estimate| estimate.risk_pct));
        }
        for (baseline, column) in &baselines {
            let value = column.as_ref().map(read).transpose()?;
            scores.push(value.map_or(f64::NAN, |value| baseline.score(value)));
        }
        // Rows of a file are consecutive. A row without a file is a group of its own.
        let named = text(file);
        if named.is_empty() || named != last {
            group += 1;
        }
        last = named;
        cases.push(Case {
            group,
            t_s: None,
            vehicle: text(vehicle).to_owned(),
            kind: text(kind).to_owned(),
            is_critical: error_deg >= CRITICAL_ERROR_DEG || text(crashed) == "1",
            is_quiet: false,
            is_onset: false,
            scores,
        });
    }
    Ok((cases, notes))
}
