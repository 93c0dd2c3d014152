//! Findings in words: one line for each cause.

use flagred::{
    estimator::Estimator,
    flight::{Cause, Finding, Words},
    verdict::Measure,
};
use flagred_flightlog::Motor;
use fuzzy::drawing::number;

/// The context for describing findings in words.
#[derive(Clone, Copy)]
pub struct Teller<'a> {
    /// The profile and its rule set.
    pub estimator: &'a Estimator,
    /// The motors of the flight.
    pub motors: &'a [Motor],
}

/// All findings with the same cause.
pub struct Line<'a> {
    /// The gravest of them.
    pub worst: &'a Finding,
    count: usize,
}

/// Groups findings by cause, in the order of the findings: the gravest first.
pub fn lines(findings: &[Finding]) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    for finding in findings {
        match lines.iter_mut().find(|line| is_same(line.worst, finding)) {
            Some(line) => {
                line.count += 1;
                if (finding.severity, gravity(finding)) > (line.worst.severity, gravity(line.worst))
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

/// The severity of its peak; for a reserve, smaller is worse.
fn gravity(finding: &Finding) -> f64 {
    match finding.measure {
        Measure::Reserve => -finding.value_pct,
        _ => finding.value_pct,
    }
}

impl<'a> Teller<'a> {
    /// The words of a finding for the pilot.
    pub fn words(&self, finding: &Finding) -> Words {
        numbered(finding, self.motors).words(self.estimator)
    }

    /// A line for all findings with one cause: `3 times, worst 12.0 to 14.5 s: ...`. A finding that is not about the
    /// risk lasts until landing, so the line contains only its start.
    pub fn line(&self, line: &Line<'_>) -> String {
        let Line { worst, count } = line;
        let text = self.words(worst).text;
        match (*count, worst.is_of_risk()) {
            (1, true) => format!("{}: {text}", span(worst)),
            (count, true) => format!("{count} times, worst {}: {text}", span(worst)),
            (1, false) => format!("from {:.1} s: {text}", worst.from_s),
            (count, false) => format!("{count} times, worst from {:.1} s: {text}", worst.from_s),
        }
    }

    /// A line for one finding: its time and its text.
    pub fn finding(&self, finding: &Finding) -> String {
        format!("{}: {}", span(finding), self.words(finding).text)
    }

    /// The details of a finding: the input and the rule that raised the risk, the threshold, the times at which its
    /// levels were raised, the motor's output and margin.
    pub fn details(&self, finding: &Finding) -> String {
        let mut parts = Vec::new();
        if let Some(cause) = &finding.cause {
            let value = number(cause.value, 3);
            parts.push(format!("{cause}: {value}, rule {}", cause.rule + 1));
            parts.extend(self.description(cause).map(str::to_owned));
        }
        let mut raised = format!(
            "{} over {} %, raised at {:.1} s",
            finding.measure,
            number(finding.threshold_pct, 2),
            finding.raised_s
        );
        if finding.measure == Measure::Reserve {
            raised = raised.replace("over", "under");
        }
        if let Some(failed_s) = finding.failed_s {
            raised += &format!(", FAIL at {failed_s:.1} s");
        }
        parts.push(raised);
        if let (Some(motor), Some(found)) = (self.motor(finding), &finding.motor) {
            parts.push(match finding.is_of_risk() {
                true => format!(
                    "output {}, margin {:.2} on average, {:.2} at least",
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

/// The finding with the autopilot's motor numbers instead of the positions in the samples.
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

fn span(finding: &Finding) -> String {
    format!("{:.1} to {:.1} s", finding.from_s, finding.to_s)
}
