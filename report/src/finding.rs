//! Findings in words: one line a cause.

use flagred::{
    flight::{Cause, Finding},
    margin::Side,
    verdict::Measure,
};
use flightlog::Motor;
use fuzzy::{Model, drawing::number};

/// What a finding is told with.
#[derive(Clone, Copy)]
pub struct Teller<'a> {
    /// The rule set.
    pub model: &'a Model,
    /// The motors of the flight.
    pub motors: &'a [Motor],
}

/// The findings of one cause.
pub struct Line<'a> {
    /// The gravest of them.
    pub worst: &'a Finding,
    count: usize,
}

/// One line a cause, in the order of the findings: the gravest first.
pub fn lines(findings: &[Finding]) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    for finding in findings {
        match lines.iter_mut().find(|line| is_same(line.worst, finding)) {
            Some(line) => {
                line.count += 1;
                if (finding.level, gravity(finding)) > (line.worst.level, gravity(line.worst)) {
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

/// Whether two findings have one cause: an input of the rules, or what a notice is about.
fn is_same(a: &Finding, b: &Finding) -> bool {
    let motor = |finding: &Finding| finding.motor.map(|motor| motor.motor);
    match (is_of_risk(a), is_of_risk(b)) {
        (true, true) if a.risk != b.risk => false,
        (true, true) => match (&a.cause, &b.cause) {
            (Some(a), Some(b)) => a.input == b.input,
            (a, b) => a.is_none() && b.is_none(),
        },
        (false, false) => a.measure == b.measure && motor(a) == motor(b),
        _ => false,
    }
}

fn is_of_risk(finding: &Finding) -> bool {
    matches!(finding.measure, Measure::Risk | Measure::ElevatedRisk)
}

/// How bad its peak is: of a reserve, how small.
fn gravity(finding: &Finding) -> f64 {
    match finding.measure {
        Measure::Reserve => -finding.peak_pct,
        _ => finding.peak_pct,
    }
}

impl<'a> Teller<'a> {
    /// The findings of one cause: `3 times, worst 12.0 to 14.5 s: ...`. A notice holds until landing and has no span.
    pub fn line(&self, line: &Line<'_>) -> String {
        let Line { worst, count } = line;
        let what = self.what(worst);
        match (*count, is_of_risk(worst)) {
            (1, true) => format!("{}: {what}", span(worst)),
            (count, true) => format!("{count} times, worst {}: {what}", span(worst)),
            (1, false) => what,
            (count, false) => format!("{what}; {count} times"),
        }
    }

    /// One finding: when, what, and its cause.
    pub fn finding(&self, finding: &Finding) -> String {
        format!("{}: {}", span(finding), self.what(finding))
    }

    /// What stands behind a finding: threshold, when its levels were raised, the description of the input, the margin of
    /// the motor.
    pub fn details(&self, finding: &Finding) -> String {
        let mut text = format!(
            "threshold {:.0} %, raised at {:.1} s",
            finding.threshold_pct, finding.raised_s
        );
        if let Some(failed_s) = finding.failed_s {
            text += &format!(", FAIL at {failed_s:.1} s");
        }
        if is_of_risk(finding)
            && let Some(motor) = finding.motor
        {
            text += &format!(
                "; margin {:.2} on average, {:.2} at least",
                motor.mean_margin, motor.least_margin
            );
        }
        if let Some(cause) = &finding.cause
            && let Some(description) = self.description(cause)
            && description.len() > first_phrase(description).len()
        {
            text += &format!("; {}: {description}", cause.input);
        }
        text
    }

    /// The motor that a finding names.
    pub fn motor(&self, finding: &Finding) -> Option<&'a Motor> {
        finding.motor.and_then(|motor| self.motors.get(motor.motor))
    }

    /// What is wrong, its cause in the words of [`cause`], and what stands behind it.
    fn what(&self, finding: &Finding) -> String {
        let mut text = match finding.measure {
            Measure::WeakMotor => weak(finding, self.motors),
            Measure::IdleInAir => "motors idle in the air".to_owned(),
            _ => format!("{} {:.0} %", quantity(finding), finding.peak_pct),
        };
        // Its numbers are small: without the threshold 3 % reads like nothing.
        if finding.measure == Measure::ElevatedRisk {
            text += &format!(" (threshold {} %)", number(finding.threshold_pct, 2));
        }
        for word in cause(finding, self.motors) {
            text += &word;
        }
        let output = self.motor(finding).map(|motor| motor.output.as_str());
        let side = finding.motor.map_or("above", |motor| match motor.side {
            Side::Low => "below",
            Side::High => "above",
        });
        let behind = match finding.measure {
            Measure::Risk | Measure::ElevatedRisk => finding
                .cause
                .as_ref()
                .map(|cause| self.behind(finding, cause)),
            Measure::CommandNoise => Some("vibration, or gains too high?".to_owned()),
            Measure::Reserve => Some(format!(
                "what the mean command leaves below the limit; wanted {:.0} %",
                finding.threshold_pct
            )),
            Measure::Imbalance => Some(format!("{side} its part earlier in the flight")),
            Measure::WeakMotor => Some(
                "above its part earlier in the flight: it gives less thrust than it is commanded"
                    .to_owned(),
            ),
            Measure::PairImbalance => Some(format!("{side} the motor opposite")),
            Measure::IdleInAir => {
                Some("the autopilot reported that the vehicle was in the air".to_owned())
            }
        };
        let parts = [output.map(str::to_owned), behind];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        match parts.is_empty() {
            true => text,
            false => format!("{text} ({})", parts.join("; ")),
        }
    }

    /// `how much the motors differ: 0.041, rule 3`; where the words are about a motor, also the input and the term.
    fn behind(&self, finding: &Finding, cause: &Cause) -> String {
        let value = number(cause.value, 3);
        let told = match finding.motor {
            Some(_) => format!("{cause}: "),
            None => String::new(),
        };
        let value = match self.description(cause) {
            Some(description) => format!("{told}{} {value}", first_phrase(description)),
            None => format!("{told}{value}"),
        };
        format!("{value}, rule {}", cause.rule + 1)
    }

    fn description(&self, cause: &Cause) -> Option<&'a str> {
        let mut inputs = self.model.inputs.iter();
        let input = inputs.find(|input| input.name == cause.input)?;
        input.description.as_deref()
    }
}

/// The cause of a finding in a few words, after a comma: `, unsteady_now violent`, `, lower limit, motor 2`, `, motor 2`.
/// Texts to ground stations, lines and reports all have these words. Where there is no room for the last part, the first one
/// is true alone.
pub fn cause(finding: &Finding, motors: &[Motor]) -> [String; 2] {
    let motor = named(finding, motors).map_or(String::new(), |motor| format!(", {motor}"));
    match (&finding.cause, finding.motor) {
        _ if finding.measure == Measure::WeakMotor => [String::new(), String::new()],
        _ if !is_of_risk(finding) => [motor, String::new()],
        (None, _) => [", interpolated".to_owned(), String::new()],
        (Some(_), Some(named)) => [format!(", {} limit", limit(named.side)), motor],
        (Some(Cause { input, term, .. }), None) => [format!(", {input}"), format!(" {term}")],
    }
}

/// A motor that is weak, and by how much it is commanded more: `motor 3 weak: +24 %`, `motor 3 or 8 weak: +14 %`.
pub fn weak(finding: &Finding, motors: &[Motor]) -> String {
    let motor = named(finding, motors).unwrap_or_else(|| "motor".to_owned());
    format!("{motor} weak: +{:.0} %", finding.peak_pct)
}

/// The motor that a finding names, and the one that it may be as well.
fn named(finding: &Finding, motors: &[Motor]) -> Option<String> {
    let found = finding.motor?;
    let number = motors.get(found.motor)?.number;
    let or = found.or.and_then(|or| motors.get(or));
    let or = or.map_or(String::new(), |or| format!(" or {}", or.number));
    Some(format!("motor {number}{or}"))
}

/// What a finding is about, before its value.
fn quantity(finding: &Finding) -> String {
    match (is_of_risk(finding), &finding.risk) {
        (true, Some(risk)) => format!("{} of {risk} up to", finding.measure),
        (true, None) => format!("{} up to", finding.measure),
        (false, _) => finding.measure.to_string(),
    }
}

fn span(finding: &Finding) -> String {
    format!("{:.1} to {:.1} s", finding.from_s, finding.to_s)
}

/// The limit that a motor was nearest to.
fn limit(side: Side) -> &'static str {
    match side {
        Side::Low => "lower",
        Side::High => "upper",
    }
}

/// A description up to its first comma, in small letters as inside a sentence.
fn first_phrase(description: &str) -> String {
    let phrase = description
        .split([',', '.', ';'])
        .next()
        .unwrap_or(description);
    let mut letters = phrase.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if !second.is_uppercase() => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => phrase.to_owned(),
    }
}
