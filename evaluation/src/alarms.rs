//! Alarms in flights where nothing happens, and before upsets.
//!
//! An alarm is a WARN or a FAIL, from when it is raised until its level is last reached; one that turns into the other is one.

use flagred::{
    evaluation::{Interval, Span, UpsetAlarm, bootstrap},
    verdict::Level,
};

use serde::Serialize;

use crate::{
    flight::{Record, Said},
    scores::{APART, RESAMPLES, SEED, median},
};

/// The alarms of a profile over all flights but the kind apart, and over each kind.
pub(crate) struct Alarms {
    pub(crate) ordinary: SmallErrors,
    pub(crate) mild: SmallErrors,
    /// Found by any alarm, and by FAIL alone.
    pub(crate) upsets: Upsets,
    pub(crate) upsets_by_fail: Upsets,
    /// Ordinary flights and upsets of each kind.
    pub(crate) by_kind: Vec<(String, SmallErrors, Upsets)>,
}

impl Alarms {
    /// Of a profile.
    pub(crate) fn of(profile: usize, records: &[Record]) -> Alarms {
        let main = || records.iter().filter(|record| record.kind != APART);
        let of_kind = |kind: &str| {
            let records = || records.iter().filter(|record| record.kind == kind);
            (
                kind.to_owned(),
                SmallErrors::of(profile, ORDINARY_DEG, records()),
                Upsets::of(profile, |said| &said.alarms, records()),
            )
        };
        Alarms {
            ordinary: SmallErrors::of(profile, ORDINARY_DEG, main()),
            mild: SmallErrors::of(profile, MILD_DEG, main()),
            upsets: Upsets::of(profile, |said| &said.alarms, main()),
            upsets_by_fail: Upsets::of(profile, |said| &said.fails, main()),
            by_kind: kinds(records).into_iter().map(of_kind).collect(),
        }
    }
}

/// The kinds of flights, in order of their names.
pub(crate) fn kinds(records: &[Record]) -> Vec<&str> {
    let mut kinds: Vec<&str> = records.iter().map(|r| r.kind.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds
}

/// A flight without an upset whose error over a second never passes this is ordinary ...
const ORDINARY_DEG: f64 = 5.0;

/// ... and mild up to this, if it tilts by less than [`STEEP_DEG`].
const MILD_DEG: f64 = 10.0;

const STEEP_DEG: f64 = 45.0;

/// A figure with its interval over flights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Figure {
    pub(crate) value: f64,
    pub(crate) interval: Option<Interval>,
}

/// The alarms of a profile in flights with small errors.
pub(crate) struct SmallErrors {
    /// The flights with a verdict, and those without.
    pub(crate) flights: usize,
    pub(crate) not_assessed: usize,
    pub(crate) hours: f64,
    /// GOOD, WARN, FAIL.
    pub(crate) verdicts: [usize; 3],
    pub(crate) alarms: usize,
    pub(crate) fails: usize,
    /// `None` without a flight.
    pub(crate) alarms_per_hour: Option<Figure>,
    pub(crate) fails_per_hour: Option<Figure>,
    /// The share of the time in the air with an alarm on.
    pub(crate) share_on: Option<Figure>,
}

/// What a flight adds.
struct Counted {
    air_s: f64,
    alarms: f64,
    fails: f64,
    on_s: f64,
}

/// The column of a verdict in counts of GOOD, WARN and FAIL.
fn column(level: Level) -> usize {
    match level {
        Level::Good | Level::Info => 0,
        Level::Warn => 1,
        Level::Fail => 2,
    }
}

impl SmallErrors {
    /// Of a profile over the flights whose error never passes `limit_deg`.
    pub(crate) fn of<'a>(
        profile: usize,
        limit_deg: f64,
        records: impl Iterator<Item = &'a Record>,
    ) -> SmallErrors {
        let small = |record: &&Record| {
            record.upsets.is_empty()
                && record.largest_error_deg.is_some_and(|e| e <= limit_deg)
                && record.largest_tilt_deg.is_some_and(|t| t < STEEP_DEG)
        };
        let (mut not_assessed, mut verdicts) = (0, [0; 3]);
        let mut counted = Vec::new();
        for record in records.filter(small) {
            let said = record.said.get(profile);
            let Some((said, verdict)) = said.and_then(|said| Some((said, said.verdict?))) else {
                not_assessed += 1;
                continue;
            };
            verdicts[column(verdict)] += 1;
            let on_s = record.air.iter().flat_map(|air| {
                let alarms = said.alarms.iter();
                alarms.map(|alarm| alarm.shared_s(air))
            });
            counted.push(Counted {
                air_s: record.air_s(),
                alarms: said.alarms.len() as f64,
                fails: said.fails.len() as f64,
                // The sum of nothing would be -0.
                on_s: on_s.fold(0.0, |sum, shared_s| sum + shared_s),
            });
        }
        let figures = |weights: &[u32]| {
            let sum = |of: fn(&Counted) -> f64| -> f64 {
                let all = counted.iter().zip(weights);
                all.map(|(flight, weight)| of(flight) * f64::from(*weight))
                    .sum()
            };
            let air_s = sum(|flight| flight.air_s);
            (air_s > 0.0).then(|| {
                [
                    sum(|flight| flight.alarms) / (air_s / 3600.0),
                    sum(|flight| flight.fails) / (air_s / 3600.0),
                    sum(|flight| flight.on_s) / air_s,
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
        let count = |of: fn(&Counted) -> f64| counted.iter().map(of).fold(0.0, |a, b| a + b);
        SmallErrors {
            flights: counted.len(),
            not_assessed,
            hours: count(|flight| flight.air_s) / 3600.0,
            verdicts,
            alarms: count(|flight| flight.alarms) as usize,
            fails: count(|flight| flight.fails) as usize,
            alarms_per_hour: figure(0),
            fails_per_hour: figure(1),
            share_on: figure(2),
        }
    }
}

/// The upsets of flights, and how the alarms of a profile found them.
#[derive(Default, Serialize)]
pub(crate) struct Upsets {
    pub(crate) before: usize,
    /// Within 1 s after.
    #[serde(rename = "within_1_s")]
    pub(crate) after: usize,
    pub(crate) never: usize,
    /// Those of flights without a verdict.
    pub(crate) not_assessed: usize,
    /// The median of the leads, in seconds.
    #[serde(rename = "lead_s_median")]
    pub(crate) lead_s: Option<f64>,
}

impl Upsets {
    /// Of a profile; `alarms` says which alarms count.
    pub(crate) fn of<'a>(
        profile: usize,
        alarms: fn(&Said) -> &[Span],
        records: impl Iterator<Item = &'a Record>,
    ) -> Upsets {
        let mut found = Upsets::default();
        let mut leads = Vec::new();
        for record in records {
            let said = record.said.get(profile);
            let said = said.filter(|said| said.verdict.is_some());
            for upset in &record.upsets {
                match said.map(|said| UpsetAlarm::of(upset.t_s, upset.air, alarms(said))) {
                    None => found.not_assessed += 1,
                    Some(UpsetAlarm::Before { lead_s }) => {
                        found.before += 1;
                        leads.push(lead_s);
                    }
                    Some(UpsetAlarm::After) => found.after += 1,
                    Some(UpsetAlarm::Never) => found.never += 1,
                }
            }
        }
        found.lead_s = median(leads);
        found
    }

    /// All that were assessed.
    pub(crate) fn assessed(&self) -> usize {
        self.before + self.after + self.never
    }
}

/// How the flights of a vehicle were judged.
#[derive(Default)]
pub(crate) struct Verdicts {
    pub(crate) flights: usize,
    pub(crate) hours: f64,
    /// For each profile: GOOD, WARN, FAIL, NA.
    pub(crate) counts: Vec<[usize; 4]>,
}

impl Verdicts {
    /// Takes in a flight.
    pub(crate) fn add(&mut self, record: &Record) {
        self.flights += 1;
        self.hours += record.air_s() / 3600.0;
        self.counts.resize(record.said.len(), [0; 4]);
        for (counts, said) in self.counts.iter_mut().zip(&record.said) {
            counts[said.verdict.map_or(3, column)] += 1;
        }
    }
}
