//! Findings in words: one line for each cause.

use flagred::{
    estimator::Estimator,
    flight::{Cause, Finding, Words},
    verdict::Measure,
};
use flagred_flightlog::{Flight, Motor};
use fuzzy::drawing::number;

use crate::{clock::Clock, names::words_of};

/// The context for describing findings in words.
#[derive(Clone, Copy)]
pub struct FindingContext<'a> {
    /// The profile and its rule set.
    pub estimator: &'a Estimator,
    /// The motors of the flight.
    pub motors: &'a [Motor],
}

/// All findings with the same cause.
pub struct Line<'a> {
    /// The most severe of these findings.
    pub worst: &'a Finding,
    count: usize,
}

/// Groups findings by cause, in the order of the findings: the most severe first.
pub fn lines(findings: &[Finding]) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    for finding in findings {
        match lines.iter_mut().find(|line| is_same(line.worst, finding)) {
            Some(line) => {
                line.count += 1;
                if (finding.severity, severity_value(finding))
                    > (line.worst.severity, severity_value(line.worst))
                {
                    line.worst = finding;
                }
            }
            None => lines.push(Line {
                worst: finding,
                count: 1,
            }),
        }
    }
    lines
}

/// Whether two findings have the same cause: an input of the rules, or the subject of a notice.
fn is_same(a: &Finding, b: &Finding) -> bool {
    let motor = |finding: &Finding| finding.motor.map(|motor| motor.number);
    match (a.is_of_risk(), b.is_of_risk()) {
        (true, true) if a.risk_output != b.risk_output => false,
        (true, true) => match (&a.cause, &b.cause) {
            (Some(a), Some(b)) => a.input == b.input,
            (a, b) => a.is_none() && b.is_none(),
        },
        (false, false) => a.measure == b.measure && motor(a) == motor(b),
        _ => false,
    }
}

/// The severity of the peak of a finding; for a reserve, smaller values are more severe.
fn severity_value(finding: &Finding) -> f64 {
    match finding.measure {
        Measure::Reserve => -finding.value_pct,
        _ => finding.value_pct,
    }
}

impl Line<'_> {
    /// The time of the finding, or of the worst of several.
    pub(crate) fn when(&self, clock: Clock) -> String {
        let Line { worst, count } = self;
        let worst_at = match worst.is_of_risk() {
            true => clock.span(worst.from_s, worst.to_s),
            false => format!("from {}", clock.at(worst.from_s)),
        };
        match count {
            1 => worst_at,
            count => format!("{count} times, worst {worst_at}"),
        }
    }
}

impl<'a> FindingContext<'a> {
    /// The words of a finding for the pilot.
    pub fn words(&self, finding: &Finding) -> Words {
        numbered(finding, self.motors).words(self.estimator)
    }

    /// A line for all findings with one cause: `3 times, worst 12.0 to 14.5 s: ...`. A finding that is not about the
    /// risk lasts until landing, so the line contains only its start.
    pub fn line(&self, line: &Line<'_>) -> String {
        format!("{}: {}", line.when(Clock::Log), self.words(line.worst).text)
    }

    /// A line for one finding: its time and its text.
    pub fn finding(&self, finding: &Finding) -> String {
        let span = Clock::Log.span(finding.from_s, finding.to_s);
        format!("{span}: {}", self.words(finding).text)
    }

    /// The details of a finding: the input and the rule that raised the risk, the threshold, the times at which its
    /// levels were raised, the motor's output and margin.
    pub fn details(&self, finding: &Finding) -> String {
        self.details_by(finding, Clock::Log)
    }

    pub(crate) fn details_by(&self, finding: &Finding, clock: Clock) -> String {
        let mut parts = Vec::new();
        if let Some(cause) = &finding.cause {
            let value = number(cause.value, 3);
            let input = words_of(&cause.input);
            parts.push(format!(
                "{input} {}: {value}, rule {}",
                cause.term,
                cause.rule + 1
            ));
            parts.extend(self.description(cause).map(str::to_owned));
        }
        let mut raised = format!(
            "{} over {} %, {} at {}",
            finding.measure,
            number(finding.threshold_pct, 2),
            finding.failed_s.map_or("raised", |_| "WARN"),
            clock.at(finding.raised_s)
        );
        if finding.measure == Measure::Reserve {
            raised = raised.replace("over", "under");
        }
        if let Some(failed_s) = finding.failed_s {
            raised += &format!(", FAIL at {}", clock.at(failed_s));
        }
        parts.push(raised);
        parts.extend(finding.uncertainty());
        if let (Some(motor), Some(found)) = (self.motor(finding), &finding.motor) {
            parts.push(match finding.is_of_risk() {
                true => format!(
                    "output {}, margin {:.2} on average, smallest {:.2}",
                    motor.output, found.margin_mean, found.margin_min
                ),
                false => format!("output {}", motor.output),
            });
        }
        parts.join("; ")
    }

    /// The motor that a finding names.
    pub fn motor(&self, finding: &Finding) -> Option<&'a Motor> {
        finding
            .motor
            .and_then(|motor| self.motors.get(motor.number.checked_sub(1)?))
    }

    fn description(&self, cause: &Cause) -> Option<&'a str> {
        let mut inputs = self.estimator.model().inputs.iter();
        let input = inputs.find(|input| input.name == cause.input)?;
        input.description.as_deref()
    }
}

/// The finding with the highest value of `output`, a risk other than the profile's own; `None` if no finding is about it.
pub(crate) fn highest_of<'f>(output: &str, findings: &'f [Finding]) -> Option<&'f Finding> {
    let of_risk = findings
        .iter()
        .filter(|finding| finding.risk_output.as_deref() == Some(output));
    of_risk.max_by(|a, b| a.value_pct.total_cmp(&b.value_pct))
}

/// The advice of a finding, and the positions of the motors that it names.
pub(crate) fn advice(context: FindingContext<'_>, finding: &Finding, flight: &Flight) -> String {
    let advice = context.words(finding).advice;
    match positions(finding, flight) {
        Some(positions) => format!("{advice} {positions}"),
        None => advice,
    }
}

/// The positions of the motors that a finding names: `Motor 3 is at the front left.` `None` if it names no motor or the
/// geometry is unknown.
fn positions(finding: &Finding, flight: &Flight) -> Option<String> {
    let (named, geometry) = (finding.motor?, flight.geometry.as_ref()?);
    let places = [Some(named.number), named.or_number].into_iter().flatten();
    let sentences = places.filter_map(|place| {
        let index = place.checked_sub(1)?;
        let (motor, position) = (flight.motors.get(index)?, geometry.position(index)?);
        Some(format!("Motor {} is at the {position}.", motor.number))
    });
    let sentences: Vec<String> = sentences.collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// Returns the finding with the autopilot's motor numbers. In `finding`, motors are numbered by their order in the
/// samples.
pub fn numbered(finding: &Finding, motors: &[Motor]) -> Finding {
    let mut finding = finding.clone();
    let number_of = |place: usize| {
        let motor = place.checked_sub(1).and_then(|index| motors.get(index));
        motor.map_or(place, |motor| usize::from(motor.number))
    };
    if let Some(named) = &mut finding.found.motor {
        named.number = number_of(named.number);
        named.or_number = named.or_number.map(number_of);
    }
    finding
}
