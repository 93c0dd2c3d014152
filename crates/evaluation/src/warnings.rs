//! The quality of the warnings of a profile, over many flights.

use serde::Serialize;

use crate::{
    alarms::kinds,
    flight::Record,
    scores::{SEPARATE_KIND, median},
    warning_matches::WarningMatches,
};

/// An episode that starts within this time after another one ended, in seconds, belongs to the same group.
const SAME_GROUP_S: f64 = 5.0;

/// The warnings of a profile over a number of flights.
#[derive(Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct Warnings {
    /// The number of flights.
    pub(crate) flights: usize,
    /// The judged time in hours.
    pub(crate) hours: f64,
    /// The number of episodes, that is, periods of critical error.
    pub(crate) episodes: usize,
    /// The number of episodes with a warning that began earlier and was still on at their start.
    pub(crate) announced: usize,
    /// The median lead time of announced episodes, in seconds.
    pub(crate) lead_s_median: Option<f64>,
    /// The number of groups of episodes that follow each other within 5 s.
    pub(crate) groups: usize,
    /// The number of groups whose first episode was announced. The other episodes of a group do not count, because a
    /// warning that stays on would announce them all.
    pub(crate) groups_announced: usize,
    /// The median lead time of announced groups, in seconds.
    pub(crate) group_lead_s_median: Option<f64>,
    /// The number of episodes that were not announced, but during which a warning began.
    #[serde(rename = "answered")]
    pub(crate) late: usize,
    /// The median time from the start of such an episode to the warning, in seconds.
    #[serde(rename = "answer_s_median")]
    pub(crate) delay_s_median: Option<f64>,
    /// The number of periods of WARN or FAIL.
    pub(crate) warnings: usize,
    /// The number of false warnings, which no episode followed.
    pub(crate) false_warnings: usize,
    /// The share of the time during which a warning was on.
    pub(crate) share_of_time_on: Option<f64>,
}

impl Warnings {
    /// The false warnings per flight hour.
    pub(crate) fn false_per_hour(&self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.false_warnings as f64 / self.hours)
    }

    /// Counts the warnings of a profile over flights.
    pub(crate) fn of<'a>(profile: usize, records: impl Iterator<Item = &'a Record>) -> Warnings {
        let mut sum = Warnings::default();
        let (mut leads, mut group_leads, mut delays, mut on_s) = (vec![], vec![], vec![], 0.0);
        for record in records {
            let Some(result) = record.results.get(profile) else {
                continue;
            };
            let WarningMatches {
                episodes: of_flight,
                warnings,
            } = &result.matches;
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
                    Some(lead_s) => delays.push(-lead_s),
                    None => {}
                }
            }
        }
        sum.announced = leads.len();
        sum.groups_announced = group_leads.len();
        sum.late = delays.len();
        sum.lead_s_median = median(leads);
        sum.group_lead_s_median = median(group_leads);
        sum.delay_s_median = median(delays);
        sum.share_of_time_on = (sum.hours > 0.0).then(|| on_s / (sum.hours * 3600.0));
        sum
    }

    /// Counts the warnings of a profile over all flights except the kind [`SEPARATE_KIND`], and over each kind.
    pub(crate) fn by_kind(
        profile: usize,
        records: &[Record],
    ) -> (Warnings, Vec<(String, Warnings)>) {
        let main = records.iter().filter(|record| record.kind != SEPARATE_KIND);
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
