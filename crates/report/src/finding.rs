//! Findings in words: one line for each cause.

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Cause, Finding, Peak, Step, Words},
    verdict::Measure,
};
use flagred_flightlog::{Flight, Motor};
use fuzzy::{drawing::number, model::Variable};

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
        let worst_at = clock.span(worst.from_s, worst.to_s);
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

    /// A line for all findings with one cause: `3 times, worst 12.0 to 14.5 s: ...`.
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
            let variable = self.input(cause);
            parts.push(format!(
                "{input} {}: {value}{}, rule {}",
                cause.term,
                variable.and_then(scale).unwrap_or_default(),
                cause.rule + 1
            ));
            parts.extend(variable.and_then(|variable| variable.description.clone()));
        }
        parts.push(format!(
            "{}, {}",
            passed(finding),
            raised(finding, |t_s| clock.at(t_s))
        ));
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

    fn input(&self, cause: &Cause) -> Option<&'a Variable> {
        let mut inputs = self.estimator.model().inputs.iter();
        inputs.find(|input| input.name == cause.input)
    }
}

/// The values at which an input belongs fully to each of its terms: ` (calm at 0.01, violent at 0.036)`.
fn scale(variable: &Variable) -> Option<String> {
    let peaks = variable.partition_peaks()?;
    let terms = variable.terms.iter().zip(peaks);
    let terms = terms.map(|(term, peak)| format!("{} at {}", term.name, number(peak, 4)));
    Some(format!(" ({})", terms.collect::<Vec<_>>().join(", ")))
}

/// The condition that raised a finding: `risk over 62 %`.
fn passed(finding: &Finding) -> String {
    let measure = match &finding.risk_output {
        Some(output) => finding
            .measure
            .to_string()
            .replace("risk", &format!("`{output}`")),
        None => finding.measure.to_string(),
    };
    let side = match finding.measure {
        Measure::IdleInAir => return measure,
        Measure::Reserve => "under",
        _ => "over",
    };
    format!("{measure} {side} {} %", number(finding.threshold_pct, 2))
}

/// The times at which the levels of a finding were raised.
fn raised(finding: &Finding, at: impl Fn(f64) -> String) -> String {
    match finding.failed_s {
        None => format!("raised at {}", at(finding.raised_s)),
        Some(failed_s) if failed_s > finding.raised_s => {
            format!("WARN at {}, FAIL at {}", at(finding.raised_s), at(failed_s))
        }
        Some(failed_s) => format!("FAIL at {}", at(failed_s)),
    }
}

/// The highest risk of a flight in the judged time, or the peak of a finding if it is higher.
pub(crate) fn highest(assessed: &Assessment) -> Option<Peak> {
    let risk_pct = |step: &Step| Some(step.estimate?.risk_pct);
    peak(assessed, None, assessed.summary.risk_max, risk_pct)
}

/// The highest value of another risk of the profile, by its index, at the steps or in a finding. `None` if the risk was
/// never known.
pub(crate) fn highest_other(assessed: &Assessment, risk: usize) -> Option<Peak> {
    let risk_pct = |step: &Step| {
        let value = step.other_risks_pct.get(risk).copied();
        value.filter(|value| value.is_finite())
    };
    let judged = assessed.steps.iter().filter(|step| step.judged);
    let of_steps = largest(judged, risk_pct);
    let output = assessed.other_risks.get(risk)?;
    peak(assessed, Some(output), of_steps, risk_pct)
}

/// The highest of the given peak and the peaks of the findings about a risk.
fn peak(
    assessed: &Assessment,
    output: Option<&str>,
    mut highest: Option<Peak>,
    risk_pct: impl Fn(&Step) -> Option<f64>,
) -> Option<Peak> {
    let of_risk = |finding: &&Finding| {
        finding.measure == Measure::Risk && finding.risk_output.as_deref() == output
    };
    for finding in assessed.findings.iter().filter(of_risk) {
        if highest.is_none_or(|peak| finding.value_pct > peak.value_pct) {
            let steps = assessed.steps.iter();
            let within = steps.filter(|step| (finding.from_s..=finding.to_s).contains(&step.t_s));
            highest = Some(Peak {
                t_s: largest(within, &risk_pct).map_or(finding.raised_s, |peak| peak.t_s),
                value_pct: finding.value_pct,
            });
        }
    }
    highest
}

fn largest<'s>(
    steps: impl Iterator<Item = &'s Step>,
    risk_pct: impl Fn(&Step) -> Option<f64>,
) -> Option<Peak> {
    let known = steps.filter_map(|step| {
        Some(Peak {
            t_s: step.t_s,
            value_pct: risk_pct(step)?,
        })
    });
    known.reduce(|highest, next| match next.value_pct > highest.value_pct {
        true => next,
        false => highest,
    })
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
