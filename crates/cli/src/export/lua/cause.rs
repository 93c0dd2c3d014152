//! The causes of a risk: the texts for the pilot about each rule.

use flagred::{estimator::Estimator, flight::Words, source::Signal};
use fuzzy::{
    model::Variable,
    rule::{Condition, Proposition, Rule},
};

use super::{number, quoted, template::TemplateValues};

/// For each rule, the cause that is reported to the pilot. If this cause is the value of another output, also the rules
/// that conclude that output.
#[derive(Default)]
pub(super) struct Causes {
    motor_cause: bool,
    lines: Vec<String>,
    leads: Vec<String>,
}

impl Causes {
    /// Adds the next rule: its consequent for the risk, and the input that distinguishes it. If the distinguishing
    /// proposition reads another output, the cause is the rule that contributes most to that proposition.
    /// `number_of_rule` is `None` if the rule has no effect on the risk.
    pub(super) fn add(
        &mut self,
        estimator: &Estimator,
        rule: &Rule,
        number_of_rule: Option<usize>,
    ) {
        let number_of_rule = match number_of_rule {
            Some(number_of_rule) => number_of_rule,
            None => return self.lines.push("  false,".into()),
        };
        let output = estimator.profile().output.as_str();
        let (area, centre) = consequent_of(estimator, rule, output).unwrap_or_default();
        let proposition = distinguishing(estimator, &rule.condition);
        let about = match proposition {
            Some(proposition) if output_named(estimator, &proposition.variable.text).is_some() => {
                self.leads.push(leads(estimator, proposition));
                format!("nil, nil, false, {}", self.leads.len())
            }
            proposition => {
                let (text, is_motor) = texts(estimator, proposition);
                self.motor_cause |= is_motor;
                format!("{text}, {is_motor}")
            }
        };
        self.lines.push(format!(
            "  {{{}, {}, {about}}}, -- {number_of_rule}",
            number(area),
            number(centre)
        ));
    }

    /// Sets the parts of the template for the causes.
    pub(super) fn fill(self, filling: &mut TemplateValues) {
        filling.set("motor_cause", self.motor_cause);
        filling.set("leads", !self.leads.is_empty());
        filling.put("leads", self.leads);
        filling.put("causes", self.lines);
    }
}

/// Returns the area and the centre of a rule's consequent for an output.
fn consequent_of(estimator: &Estimator, rule: &Rule, output: &str) -> Option<(f64, f64)> {
    let mut consequents = rule.consequents.iter().rev();
    let consequent = consequents.find(|consequent| consequent.output.text == output)?;
    let variable = output_named(estimator, output)?;
    Some(area_and_centre(variable, &consequent.term.text))
}

fn output_named<'e>(estimator: &'e Estimator, name: &str) -> Option<&'e Variable> {
    let mut outputs = estimator.model().outputs.iter();
    let output = outputs.find(|output| output.variable.name == name)?;
    Some(&output.variable)
}

/// Returns the rules that conclude the output of a proposition, each as its number and the degree that the proposition
/// has if only this rule fires.
fn leads(estimator: &Estimator, proposition: &Proposition) -> String {
    // A lower degree is replaced by this one. If the degree is 0 for all rules, the strongest rule is then chosen, as
    // in the monitor.
    const NOT_AT_ALL: f64 = 1e-9;
    let output = proposition.variable.text.as_str();
    let model = estimator.model();
    let variable = output_named(estimator, output);
    let degree = |x: f64| {
        let named = proposition.term.as_ref();
        let terms = variable.map(|output| &output.terms);
        let term = terms
            .zip(named)
            .and_then(|(terms, named)| terms.iter().find(|term| term.name == named.text));
        let degree = term.map_or(1.0, |term| term.membership(x));
        let hedges = proposition.hedges.iter().rev();
        hedges.fold(degree, |degree, hedge| hedge.of(degree))
    };
    let rules = model.rules.iter().zip(1..).filter_map(|(rule, i)| {
        let enabled = model.is_enabled(rule);
        let (_, centre) = consequent_of(estimator, &rule.rule, output).filter(|_| enabled)?;
        Some(format!("{i}, {}", number(degree(centre).max(NOT_AT_ALL))))
    });
    let rules: Vec<String> = rules.collect();
    format!("  {{{}}},", rules.join(", "))
}

/// Returns the area of an output's term and its centre, within the range.
fn area_and_centre(variable: &Variable, term: &str) -> (f64, f64) {
    const STEPS: u32 = 200;
    let Some(term) = variable.terms.iter().find(|known| known.name == term) else {
        return (0.0, 0.0);
    };
    let width = variable.high - variable.low;
    let (mut area, mut moment) = (0.0, 0.0);
    for i in 0..=STEPS {
        let x = variable.low + width * f64::from(i) / f64::from(STEPS);
        area += term.membership(x);
        moment += term.membership(x) * x;
    }
    if area > 0.0 {
        (area * width / f64::from(STEPS), moment / area)
    } else {
        (0.0, 0.0)
    }
}

/// Returns the proposition that distinguishes a rule. As in a finding, it is the one that occurs in the fewest rules.
fn distinguishing<'r>(estimator: &Estimator, condition: &'r Condition) -> Option<&'r Proposition> {
    let rules = estimator.model().rules.iter();
    let all: Vec<Vec<&Proposition>> = rules
        .map(|rule| propositions(&rule.rule.condition))
        .collect();
    let rules_with =
        |proposition: &&Proposition| all.iter().filter(|rule| rule.contains(proposition)).count();
    propositions(condition).into_iter().min_by_key(rules_with)
}

/// Returns the two texts for a pilot about the input of a proposition, as Lua strings, and whether this input measures
/// how near motors are to a limit.
fn texts(estimator: &Estimator, proposition: Option<&Proposition>) -> (String, bool) {
    let Some(proposition) = proposition else {
        return ("\"\", \"\"".into(), false);
    };
    let name = &proposition.variable.text;
    let hedges = proposition.hedges.iter().map(|hedge| hedge.word());
    let term = proposition.term.iter().map(|term| term.text.as_str());
    let term: Vec<&str> = hedges.chain(term).collect();
    let input = estimator
        .profile()
        .inputs
        .iter()
        .find(|input| input.name == *name);
    let is_motor = input.is_some_and(|input| {
        matches!(
            input.source.signal,
            Signal::MotorMargin | Signal::MotorMarginLowSide | Signal::MotorMarginHighSide
        )
    });
    let [first, second] = Words::of_cause(estimator, name, &term.join(" ")).brief;
    (format!("{}, {}", quoted(&first), quoted(&second)), is_motor)
}

/// Returns the propositions of a condition.
pub(super) fn propositions(condition: &Condition) -> Vec<&Proposition> {
    let mut all = Vec::new();
    condition.visit(&mut |proposition| all.push(proposition));
    all
}
