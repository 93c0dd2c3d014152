//! The simulated flights of the reference data, and the results of a profile for them.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use flagred::{
    estimator::Estimator,
    monitor::{Craft, Monitor, Sample},
    verdict::Level,
};
use flagred_evaluation::{ErrorRecord, Span};
use flagred_flightlog::{ATTITUDE, Flight};

/// The interval between steps, in seconds.
const STEP_S: f64 = 0.5;
/// The prediction horizon of a step, in seconds.
const HORIZON_S: f64 = 5.0;

/// A flight in changing conditions, with its outcome.
pub struct SimulatedFlight {
    /// The identifier, such as `f000`.
    pub id: String,
    /// The vehicle; a craft that has two names counts as one vehicle.
    pub vehicle: String,
    /// `gusts`, `rising`, `calm`, `fault` or `manoeuvre`.
    pub kind: String,
    /// The assessed time.
    pub judged: Span,
    /// The attitude error.
    pub errors: ErrorRecord,
    /// The time of the loss of control that ended the flight in the air, in seconds; `None` if
    /// control was not lost.
    pub lost_s: Option<f64>,
    /// The times of the steps, and for each step whether the error becomes critical within the prediction horizon.
    pub steps: Vec<(f64, bool)>,
    /// The events during the flight: time in seconds, event, time constant of the wind in seconds.
    pub events: Vec<(f64, String, f64)>,
    flight: Flight,
}

/// Settings of a replay.
#[derive(Clone, Copy)]
pub struct Replay {
    /// Use only every n-th motor sample.
    pub every: usize,
    /// The errors that are added to the lower and the upper limit of the effective range.
    pub wrong_by: (f64, f64),
}

/// The unchanged flight.
pub const AS_FLOWN: Replay = Replay {
    every: 1,
    wrong_by: (0.0, 0.0),
};

/// The results of a profile for a flight.
pub struct ProfileRun {
    /// At each step: the inputs, and the risk in %; NaN is unknown.
    pub steps: Vec<(Vec<f64>, f64)>,
    /// The known risk over time: seconds and %.
    pub risks: Vec<(f64, f64)>,
    /// The times of warnings.
    pub warnings: Vec<Span>,
}

/// Returns the vehicle with the given name. One craft has two names, which are mapped to the same vehicle.
pub fn vehicle(name: &str) -> String {
    name.replace("lin_tw125_z12", "lin_c80_z12")
}

/// Processes all items on all cores; the results have the order of the items.
pub fn on_all_cores<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((i, item)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    items.get(i).map(|item| (i, item))
                } {
                    let result = work(item);
                    done.lock().unwrap().push((i, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Reads every flight of `sitl2`.
pub fn flights(data: &Path) -> Vec<SimulatedFlight> {
    let mut events: HashMap<String, Vec<(f64, String, f64)>> = HashMap::new();
    for line in fs::read_to_string(data.join("sitl2/events.csv"))
        .unwrap()
        .lines()
        .skip(1)
    {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse().unwrap_or(f64::NAN);
        let event = (number(1), cells[2].to_owned(), number(7));
        events.entry(cells[0].to_owned()).or_default().push(event);
    }
    let folder = fs::read_dir(data.join("sitl2/timeseries")).unwrap();
    let mut paths: Vec<PathBuf> = folder.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let mut all = on_all_cores(&paths, |path| read(path));
    for simulated in &mut all {
        simulated.events = events.remove(&simulated.id).unwrap_or_default();
    }
    all
}

fn read(path: &Path) -> SimulatedFlight {
    let mut options = flagred_flightlog::Options::default();
    options.signals = Some(ATTITUDE.map(str::to_owned).to_vec());
    let flight = flagred_flightlog::open(path, &options).unwrap();
    let said = |key: &str| {
        let found = flight.header.iter().find(|(k, _)| k == key);
        found.map(|(_, value)| value.as_str()).unwrap()
    };
    let judged = Span {
        from_s: said("judged_from_s").parse().unwrap(),
        to_s: said("judged_to_s").parse().unwrap(),
    };
    let errors = ErrorRecord::new(flight.attitudes());
    let times = (0..).map(|i| judged.from_s + f64::from(i) * STEP_S);
    let steps = times
        .take_while(|t_s| *t_s <= judged.to_s + 1e-6)
        .filter_map(|t_s| Some((t_s, errors.critical_within(t_s, HORIZON_S)?)))
        .collect();
    let last_air = flight.in_air.as_ref().and_then(|air| air.spans.last());
    SimulatedFlight {
        id: path.file_name().unwrap().to_string_lossy()[..4].to_owned(),
        vehicle: vehicle(said("vehicle")),
        kind: said("kind").to_owned(),
        lost_s: last_air
            .filter(|air| air.ends_with_log)
            .map(|air| air.end_s),
        steps,
        events: Vec::new(),
        judged,
        errors,
        flight,
    }
}

impl SimulatedFlight {
    /// The largest error after a time, within the prediction horizon of a step, in degrees.
    pub fn error_ahead_deg(&self, t_s: f64) -> f64 {
        self.errors
            .largest_within(t_s, HORIZON_S)
            .unwrap_or(f64::NAN)
    }

    /// Passes the flight through a monitor.
    pub fn replay(&self, estimator: &Estimator, replay: Replay) -> ProfileRun {
        let flight = &self.flight;
        let (low, high) = (
            flight.effective_range.low + replay.wrong_by.0,
            flight.effective_range.high + replay.wrong_by.1,
        );
        let mut monitor = Monitor::new(estimator, Craft::new(flight.motors.len())).unwrap();
        let mut said = ProfileRun {
            steps: Vec::new(),
            risks: Vec::new(),
            warnings: Vec::new(),
        };
        let mut is_warning = false;
        let mut now = (vec![f64::NAN; estimator.profile().inputs.len()], f64::NAN);
        for (t_s, row) in flight.commands.rows().step_by(replay.every) {
            while self
                .steps
                .get(said.steps.len())
                .is_some_and(|(at_s, _)| *at_s < t_s - 1e-6)
            {
                said.steps.push(now.clone());
            }
            let effective = |raw: &f64| {
                let c = flight.command(*raw).unwrap_or(f64::NAN);
                ((c - low) / (high - low)).clamp(0.0, 1.0)
            };
            let motors: Vec<f64> = row.iter().map(effective).collect();
            let assessment = monitor.push(&Sample {
                t_s,
                motors: &motors,
                in_air: flagred::log::in_air(flight, t_s),
                signals: &[],
            });
            let risk = assessment.risk.map_or(f64::NAN, |risk| risk.risk_pct);
            if risk.is_finite() {
                said.risks.push((t_s, risk));
            }
            now = (monitor.inputs().to_vec(), risk);
            let warns = assessment.level > Some(Level::Good);
            Span::follow(&mut said.warnings, &mut is_warning, t_s, warns);
        }
        said.steps.resize(self.steps.len(), now);
        said
    }
}
