//! What the warnings of a profile are worth, over many flights.

use serde::Serialize;

use crate::{
    alarms::kinds,
    announced::Judged,
    flight::Record,
    scores::{APART, median},
};

/// An episode that starts within so many seconds after another one ended belongs to the same group.
const SAME_GROUP_S: f64 = 5.0;

/// The warnings of a profile over a number of flights.
#[derive(Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct Warnings {
    /// The number of flights.
    pub(crate) flights: usize,
    /// The judged time in hours.
    pub(crate) hours: f64,
    /// Times of critical error.
    pub(crate) episodes: usize,
    /// Episodes with a warning on that began before them.
    pub(crate) announced: usize,
    /// The median of how long before, in seconds, over those that were announced.
    pub(crate) lead_s_median: Option<f64>,
    /// Groups of episodes that follow each other within 5 s.
    pub(crate) groups: usize,
    /// Groups whose first episode was announced: a warning that stays on announces all the others.
    pub(crate) groups_announced: usize,
    /// The median of how long before these, in seconds.
    pub(crate) group_lead_s_median: Option<f64>,
    /// Episodes that were not announced, but answered by a warning before they were over.
    pub(crate) answered: usize,
    /// The median of how long that took from their start, in seconds.
    pub(crate) answer_s_median: Option<f64>,
    /// Times of WARN or FAIL.
    pub(crate) warnings: usize,
    /// Warnings without an episode.
    pub(crate) false_warnings: usize,
    /// The share of the time that a warning was on.
    pub(crate) share_of_time_on: Option<f64>,
}

impl Warnings {
    /// The false warnings per flight hour.
    pub(crate) fn false_per_hour(&self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.false_warnings as f64 / self.hours)
    }

    /// Of a profile over flights.
    pub(crate) fn of<'a>(profile: usize, records: impl Iterator<Item = &'a Record>) -> Warnings {
        let mut sum = Warnings::default();
        let (mut leads, mut group_leads, mut answers, mut on_s) = (vec![], vec![], vec![], 0.0);
        for record in records {
            let Some(said) = record.said.get(profile) else {
                continue;
            };
            let Judged {
                answers: of_flight,
                warnings,
            } = &said.judged;
            sum.flights += 1;
            sum.hours += record.judged_s / 3600.0;
            sum.warnings += warnings.len();
            sum.false_warnings += warnings.iter().filter(|w| w.is_false).count();
            on_s += warnings.iter().map(|w| w.span.length_s()).sum::<f64>();
            let mut group_until_s = f64::NEG_INFINITY;
            for answer in of_flight {
                sum.episodes += 1;
                let is_first = answer.episode.from_s > group_until_s + SAME_GROUP_S;
                group_until_s = answer.episode.to_s;
                sum.groups += usize::from(is_first);
                match answer.lead_s() {
                    Some(lead_s) if answer.is_announced() => {
                        leads.push(lead_s);
                        if is_first {
                            group_leads.push(lead_s);
                        }
                    }
                    Some(lead_s) => answers.push(-lead_s),
                    None => {}
                }
            }
        }
        sum.announced = leads.len();
        sum.groups_announced = group_leads.len();
        sum.answered = answers.len();
        sum.lead_s_median = median(leads);
        sum.group_lead_s_median = median(group_leads);
        sum.answer_s_median = median(answers);
        sum.share_of_time_on = (sum.hours > 0.0).then(|| on_s / (sum.hours * 3600.0));
        sum
    }

    /// Of a profile over all flights but the kind apart, and over each kind.
    pub(crate) fn by_kind(
        profile: usize,
        records: &[Record],
    ) -> (Warnings, Vec<(String, Warnings)>) {
        let main = records.iter().filter(|record| record.kind != APART);
        let of_kind = |kind: &str| {
            let records = records.iter().filter(|record| record.kind == kind);
            (kind.to_owned(), Warnings::of(profile, records))
        };
        (
            Warnings::of(profile, main),
            kinds(records).into_iter().map(of_kind).collect(),
        )
    }
}
