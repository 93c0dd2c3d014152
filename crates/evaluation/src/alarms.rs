//! Counts alarms in calm times, and alarms before upsets.
//!
//! An alarm is a WARN or FAIL. It lasts from the time it is raised to the last time its level was reached; the
//! time for which the level is held afterwards does not count. A WARN that is raised to FAIL counts as one alarm.

use std::collections::BTreeMap;

use flagred::verdict::Level;
use serde::Serialize;

use crate::{
    bootstrap::{Interval, bootstrap},
    flight::{ProfileResult, Record},
    scores::{RESAMPLES, SEED, SEPARATE_KIND, median},
    span::Span,
    upset::UpsetAlarm,
};

/// The alarms of a profile: over all flights except those of the kind [`SEPARATE_KIND`], and for each kind.
pub(crate) struct Alarms {
    /// Alarms in calm stretches, and in flights whose error never exceeds [`ORDINARY_DEG`].
    pub(crate) calm: NeedlessAlarms,
    pub(crate) ordinary: NeedlessAlarms,
    /// The upsets, classified by the alarms (WARN or FAIL) around them.
    pub(crate) upsets: Upsets,
    /// The upsets, classified by FAIL only.
    pub(crate) upsets_by_fail: Upsets,
    /// The alarms in calm stretches and the upsets, for each kind of flight.
    pub(crate) by_kind: Vec<(String, NeedlessAlarms, Upsets)>,
}

impl Alarms {
    /// Counts the alarms of a profile.
    pub(crate) fn of(profile: usize, records: &[Record]) -> Alarms {
        let main = || records.iter().filter(|record| record.kind != SEPARATE_KIND);
        let of_kind = |kind: &str| {
            let records = || records.iter().filter(|record| record.kind == kind);
            (
                kind.to_owned(),
                NeedlessAlarms::of(profile, calm, records()),
                Upsets::of(profile, |result| &result.alarms, records()),
            )
        };
        Alarms {
            calm: NeedlessAlarms::of(profile, calm, main()),
            ordinary: NeedlessAlarms::of(profile, ordinary, main()),
            upsets: Upsets::of(profile, |result| &result.alarms, main()),
            upsets_by_fail: Upsets::of(profile, |result| &result.fails, main()),
            by_kind: kinds(records).into_iter().map(of_kind).collect(),
        }
    }
}

/// The kinds of flights, sorted by name.
pub(crate) fn kinds(records: &[Record]) -> Vec<&str> {
    let mut kinds: Vec<&str> = records.iter().map(|r| r.kind.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds
}

/// The largest attitude error over a second, in degrees, that an ordinary flight may have.
const ORDINARY_DEG: f64 = 5.0;

/// A flight whose tilt reaches this, in degrees, is not ordinary.
const STEEP_DEG: f64 = 45.0;

/// The times in the air of an ordinary flight (without an upset, a large error or a steep tilt); empty for other
/// flights.
fn ordinary(record: &Record) -> &[Span] {
    let is_ordinary = record.upsets.is_empty()
        && record.largest_error_deg.is_some_and(|e| e <= ORDINARY_DEG)
        && record.largest_tilt_deg.is_some_and(|t| t < STEEP_DEG);
    if is_ordinary { &record.air } else { &[] }
}

fn calm(record: &Record) -> &[Span] {
    &record.calm
}

/// A figure with its confidence interval, which is computed by resampling vehicles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Figure {
    pub(crate) value: f64,
    pub(crate) interval: Option<Interval>,
}

/// The alarms of a profile in times without danger: calm stretches or ordinary flights.
pub(crate) struct NeedlessAlarms {
    /// The number of flights that contain such times and have a verdict.
    pub(crate) flights: usize,
    /// The number of flights that contain such times, but have no verdict.
    pub(crate) not_assessed: usize,
    pub(crate) hours: f64,
    /// Of `flights`, the numbers with the verdict GOOD, WARN and FAIL.
    pub(crate) verdicts: [usize; 3],
    pub(crate) alarms: usize,
    pub(crate) fails: usize,
    /// Alarms per hour of these times; `None` if there is no flight with a verdict.
    pub(crate) alarms_per_hour: Option<Figure>,
    pub(crate) fails_per_hour: Option<Figure>,
    /// The share of these times during which an alarm was on.
    pub(crate) share_of_time_on: Option<Figure>,
}

/// The counts of one vehicle.
#[derive(Default)]
struct VehicleCounts {
    length_s: f64,
    alarms: f64,
    fails: f64,
    on_s: f64,
}

/// The index of a verdict in counts of GOOD, WARN and FAIL.
fn column(level: Level) -> usize {
    match level {
        Level::Good | Level::Info => 0,
        Level::Warn => 1,
        Level::Fail => 2,
    }
}

impl NeedlessAlarms {
    /// Counts the alarms of a profile in the given times of each flight.
    pub(crate) fn of<'a>(
        profile: usize,
        times: fn(&Record) -> &[Span],
        records: impl Iterator<Item = &'a Record>,
    ) -> NeedlessAlarms {
        let (mut flights, mut not_assessed, mut verdicts) = (0, 0, [0; 3]);
        let mut vehicles: BTreeMap<&str, VehicleCounts> = BTreeMap::new();
        for record in records.filter(|record| !times(record).is_empty()) {
            let result = record.results.get(profile);
            let Some((result, verdict)) = result.and_then(|result| Some((result, result.verdict?)))
            else {
                not_assessed += 1;
                continue;
            };
            flights += 1;
            verdicts[column(verdict)] += 1;
            let vehicle = record.vehicle.as_ref().unwrap_or(&record.file);
            let counted = vehicles.entry(vehicle).or_default();
            for time in times(record) {
                let raised = |alarms: &[Span]| {
                    let inside = alarms.iter().filter(|alarm| time.contains(alarm.from_s));
                    inside.count() as f64
                };
                counted.length_s += time.length_s();
                counted.alarms += raised(&result.alarms);
                counted.fails += raised(&result.fails);
                let on_s = result.alarms.iter().map(|alarm| alarm.shared_s(time));
                counted.on_s += on_s.sum::<f64>().max(0.0);
            }
        }
        let counted: Vec<VehicleCounts> = vehicles.into_values().collect();
        let figures = |weights: &[u32]| {
            let sum = |of: fn(&VehicleCounts) -> f64| -> f64 {
                let all = counted.iter().zip(weights);
                all.map(|(vehicle, weight)| of(vehicle) * f64::from(*weight))
                    .sum()
            };
            let length_s = sum(|vehicle| vehicle.length_s);
            (length_s > 0.0).then(|| {
                [
                    sum(|vehicle| vehicle.alarms) / (length_s / 3600.0),
                    sum(|vehicle| vehicle.fails) / (length_s / 3600.0),
                    sum(|vehicle| vehicle.on_s) / length_s,
                ]
            })
        };
        let values = figures(&vec![1; counted.len()]);
        let intervals = bootstrap(counted.len(), RESAMPLES, SEED, figures);
        let figure = |i: usize| {
            let value = *values?.get(i)?;
            let interval = intervals.and_then(|intervals| intervals.get(i).copied());
            Some(Figure { value, interval })
        };
        let count = |of: fn(&VehicleCounts) -> f64| counted.iter().map(of).fold(0.0, |a, b| a + b);
        NeedlessAlarms {
            flights,
            not_assessed,
            hours: count(|vehicle| vehicle.length_s) / 3600.0,
            verdicts,
            alarms: count(|vehicle| vehicle.alarms) as usize,
            fails: count(|vehicle| vehicle.fails) as usize,
            alarms_per_hour: figure(0),
            fails_per_hour: figure(1),
            share_of_time_on: figure(2),
        }
    }
}

/// Counts of upsets by the alarms of a profile: upsets with an alarm before them, upsets with an alarm only shortly
/// afterwards, and upsets without an alarm.
#[derive(Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct Upsets {
    /// The number of upsets for which an alarm was on within the 10 s before them.
    pub(crate) before: usize,
    /// The number of upsets for which an alarm was raised only within 1 s after them.
    pub(crate) within_1_s: usize,
    /// The number of upsets for which no alarm was on or raised from 10 s before to 1 s after them.
    pub(crate) never: usize,
    /// The number of upsets in flights without a verdict.
    pub(crate) not_assessed: usize,
    /// The median time from the start of an alarm to the upset that follows, in seconds.
    pub(crate) lead_s_median: Option<f64>,
}

impl Upsets {
    /// Classifies the upsets by the alarms of a profile and counts them; `alarms` selects the alarms that count.
    pub(crate) fn of<'a>(
        profile: usize,
        alarms: fn(&ProfileResult) -> &[Span],
        records: impl Iterator<Item = &'a Record>,
    ) -> Upsets {
        let mut found = Upsets::default();
        let mut leads = Vec::new();
        for record in records {
            let result = record.results.get(profile);
            let result = result.filter(|result| result.verdict.is_some());
            for upset in &record.upsets {
                match result.map(|result| UpsetAlarm::of(upset.t_s, upset.air, alarms(result))) {
                    None => found.not_assessed += 1,
                    Some(UpsetAlarm::Before { lead_s }) => {
                        found.before += 1;
                        leads.push(lead_s);
                    }
                    Some(UpsetAlarm::After) => found.within_1_s += 1,
                    Some(UpsetAlarm::Never) => found.never += 1,
                }
            }
        }
        found.lead_s_median = median(leads);
        found
    }

    /// The number of upsets in flights with a verdict.
    pub(crate) fn assessed(&self) -> usize {
        self.before + self.within_1_s + self.never
    }
}

/// The verdicts of the flights of a vehicle.
#[derive(Default)]
pub(crate) struct Verdicts {
    pub(crate) flights: usize,
    pub(crate) hours: f64,
    /// For each profile, the numbers of the verdicts GOOD, WARN, FAIL and NA.
    pub(crate) counts: Vec<[usize; 4]>,
}

impl Verdicts {
    /// Adds a flight.
    pub(crate) fn add(&mut self, record: &Record) {
        self.flights += 1;
        self.hours += record.air_s() / 3600.0;
        self.counts.resize(record.results.len(), [0; 4]);
        for (counts, result) in self.counts.iter_mut().zip(&record.results) {
            counts[result.verdict.map_or(3, column)] += 1;
        }
    }
}
