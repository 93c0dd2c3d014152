//! Rows of flights, as `flagred dataset --horizon` writes them.

use std::{collections::HashMap, path::Path};

use flagred::profile::CRITICAL_ERROR_DEG;

use super::Failure;

/// The data set of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Set {
    /// Real flights.
    Real,
    /// More real flights, of other vehicles.
    Real2,
    /// Simulated flights in changing wind.
    Sitl2,
    /// Simulated flights with noise, yaw, other gains and faults.
    Sitl3,
}

impl Set {
    /// Whether the flights of the set are real.
    pub fn is_real(self) -> bool {
        matches!(self, Set::Real | Set::Real2)
    }
}

/// A moment of a flight and its outcome.
#[derive(Debug, Clone)]
pub struct Row {
    /// The data set of its flight.
    pub set: Set,
    /// The number of the flight.
    pub flight: u32,
    /// The name of the vehicle.
    pub vehicle: String,
    /// The kind of flight.
    pub kind: String,
    /// The values of the inputs.
    pub inputs: Vec<f64>,
    /// Whether the attitude error, over a second, becomes critical within the next 5 s.
    pub is_critical: bool,
    /// Whether the error was not critical in the last 5 s; unknown values count as not critical.
    pub is_quiet_5_s: bool,
    /// Whether the error was not critical in the last 10 s; unknown values count as not critical.
    pub is_quiet_10_s: bool,
}

/// The tables to read.
pub struct Data<'a> {
    /// Each data set, with the table of its rows.
    pub sets: [(Set, &'a Path); 4],
    /// Tables of real flights with columns `id` and `upsets` (`TIME=KIND;..`): rows after an upset, in the same time in the air,
    /// are excluded.
    pub upsets: [&'a Path; 2],
}

/// Reads the rows of all sets with the named inputs.
///
/// # Errors
///
/// A file cannot be read, or a column is missing.
pub fn read(data: &Data<'_>, inputs: &[&str]) -> Result<Vec<Row>, Failure> {
    let mut upsets = HashMap::new();
    for path in data.upsets {
        upsets.extend(upsets_of(path)?);
    }
    let mut rows = Vec::new();
    let mut flights: HashMap<String, u32> = HashMap::new();
    for (set, path) in data.sets {
        let mut table = csv::Reader::from_path(path)?;
        let header = table.headers()?.clone();
        let place = |name: &str| {
            let found = header.iter().position(|column| column == name);
            found.ok_or_else(|| format!("{}: no column `{name}`", path.display()))
        };
        let [file, vehicle, kind] = ["file", "vehicle", "kind"].map(place);
        let (file, vehicle, kind) = (file?, vehicle?, kind?);
        let [air, time, ahead, last_5, last_10] = [
            "from_s",
            "t_s",
            "att_rmse_deg",
            "error_last_5_s_deg",
            "error_last_10_s_deg",
        ]
        .map(place);
        let (air, time, ahead, last_5, last_10) = (air?, time?, ahead?, last_5?, last_10?);
        let columns: Vec<usize> = inputs
            .iter()
            .map(|name| place(name))
            .collect::<Result<_, _>>()?;
        for record in table.records() {
            let record = record?;
            let cell = |column: usize| record.get(column).unwrap_or_default();
            let number = |column: usize| cell(column).parse::<f64>();
            let (from_s, t_s) = (number(air)?, number(time)?);
            let id = flight_id(cell(file));
            if set.is_real()
                && upsets
                    .get(id)
                    .ok_or_else(|| format!("no table of real flights has `{id}`"))?
                    .iter()
                    .any(|upset_s| (from_s..=t_s).contains(upset_s))
            {
                continue;
            }
            let fresh = flights.len() as u32;
            let is_critical = |column: usize| {
                let error_deg = Some(cell(column)).filter(|text| !text.is_empty());
                let error_deg = error_deg.map(str::parse::<f64>).transpose();
                error_deg.map(|error_deg| error_deg.is_some_and(|deg| deg > CRITICAL_ERROR_DEG))
            };
            rows.push(Row {
                set,
                flight: *flights.entry(id.to_owned()).or_insert(fresh),
                vehicle: crate::simulated::vehicle(cell(vehicle)),
                kind: cell(kind).to_owned(),
                inputs: columns
                    .iter()
                    .map(|c| number(*c))
                    .collect::<Result<_, _>>()?,
                is_critical: is_critical(ahead)?,
                is_quiet_5_s: !is_critical(last_5)?,
                is_quiet_10_s: !is_critical(last_10)?,
            });
        }
    }
    Ok(rows)
}

fn flight_id(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.split('.').next().unwrap_or(name)
}

/// The times of the upsets of each flight, in seconds.
fn upsets_of(path: &Path) -> Result<HashMap<String, Vec<f64>>, Failure> {
    let mut table = csv::Reader::from_path(path)?;
    let mut upsets = HashMap::new();
    for record in table.deserialize::<HashMap<String, String>>() {
        let record = record?;
        let cell = |name: &str| {
            let found = record.get(name).map(String::as_str);
            found.ok_or_else(|| format!("{}: no column `{name}`", path.display()))
        };
        let all = cell("upsets")?.split(';').filter(|text| !text.is_empty());
        let times = all.map(|text| text.split('=').next().unwrap_or(text).parse::<f64>());
        upsets.insert(
            cell("id")?.to_owned(),
            times.collect::<Result<Vec<f64>, _>>()?,
        );
    }
    Ok(upsets)
}
