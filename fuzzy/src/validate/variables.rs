//! Validation of inputs and outputs: ranges, membership functions, and the kinds of terms that an output supports.

use alloc::{collections::BTreeSet, format, string::String, vec::Vec};
use core::ops::Range;

use super::{MAX_FINDINGS, TERMS_HELP, Validator, or};
use crate::{
    defuzzify::is_empty,
    diagnostic::{all_of, nearest},
    foreign,
    model::{
        Defuzzifier, Formula, MembershipFunction, NoRuleFires, Output, Variable,
        document::{TermSpans, VariableSpans},
    },
    tree::percentage_advice,
};

/// The minimum width of a range. With narrower ranges, products of degrees and distances lose digits.
const NARROWEST_RANGE: f64 = 1e-250;

/// The maximum number of samples. More samples do not improve accuracy, and evaluation would take too long.
const MAX_SAMPLES: usize = 10_000_000;

impl Validator<'_> {
    /// Validates the range, the membership functions and the heights of an input or output; `what` names it in
    /// messages.
    pub(super) fn variable(&mut self, what: &str, variable: &Variable, spans: &VariableSpans) {
        if !spans.range_unread {
            self.range(what, variable, or(&spans.range, &spans.name));
        }
        let no_spans = TermSpans::default();
        for (i, term) in variable.terms.iter().enumerate() {
            let spans = spans.terms.get(i).unwrap_or(&no_spans);
            if spans.unread {
                continue;
            }
            let what = format!("term `{}` of {what}", term.name);
            self.function(&what, &term.membership_function, term.height, spans);
            if let Some(lower) = &term.lower {
                let what = format!("the lower membership function of {what}");
                let spans = spans.lower.as_deref().unwrap_or(&no_spans);
                self.function(&what, &lower.membership_function, lower.height, spans);
            }
        }
    }

    /// Validates the parameters of a membership function, and its height.
    fn function(
        &mut self,
        what: &str,
        function: &MembershipFunction,
        height: f64,
        spans: &TermSpans,
    ) {
        if let Err(error) = function.validate() {
            let blamed = error.parameter.and_then(|i| spans.parameters.get(i));
            let here = blamed.unwrap_or(&spans.name);
            let message = format!("{what}: {error}");
            self.error("wrong-parameter", here, message, error.help);
        }
        if !(height > 0.0 && height <= 1.0) {
            let here = or(&spans.height, &spans.name);
            let message = format!("the height {height} of {what} is outside (0, 1]");
            let help = percentage_advice(height).unwrap_or_else(|| {
                "the height is the largest degree of the membership function: write a number greater than 0 and at most 1".into()
            });
            self.error("wrong-parameter", here, message, &help);
        }
    }

    pub(super) fn range(&mut self, what: &str, variable: &Variable, here: &Range<usize>) {
        let Variable { low, high, .. } = *variable;
        if !low.is_finite() || !high.is_finite() {
            let message = format!("the range of {what} is [{low}, {high}], not finite");
            self.error("wrong-range", here, message, "write two finite numbers");
        } else if low >= high {
            let message = format!(
                "the maximum of the range of {what} must be greater than its minimum, but the range is [{low}, {high}]"
            );
            let help = match variable.low == variable.high {
                true => "write a greater maximum",
                false => "write the minimum first, then the maximum",
            };
            self.error("wrong-range", here, message, help);
        } else if !(2.0 * (high - low)).is_finite() {
            // Twice the width must be finite too, or distances within the range overflow.
            let message = format!("the range of {what} is too wide");
            self.error(
                "wrong-range",
                here,
                message,
                "write the smallest and the largest value that can occur",
            );
        } else if high - low < NARROWEST_RANGE {
            let message = format!("the range of {what} is too narrow");
            let help = "write it in a smaller unit";
            self.error("wrong-range", here, message, help);
        }
    }

    /// Requires that terms of an input are not linear functions, that their constants are degrees, and that their
    /// formulas read only this input.
    pub(super) fn terms_are_sets(&mut self, input: &Variable, spans: &VariableSpans) {
        for (i, term) in input.terms.iter().enumerate() {
            let no_spans = TermSpans::default();
            let spans = spans.terms.get(i).unwrap_or(&no_spans);
            let what = format!("term `{}` of input `{}`", term.name, input.name);
            self.function_is_set(&what, &term.membership_function, input, spans);
            if let Some(lower) = &term.lower {
                let what = format!("the lower membership function of {what}");
                let spans = spans.lower.as_deref().unwrap_or(&no_spans);
                self.function_is_set(&what, &lower.membership_function, input, spans);
            }
        }
    }

    fn function_is_set(
        &mut self,
        what: &str,
        function: &MembershipFunction,
        input: &Variable,
        spans: &TermSpans,
    ) {
        match function {
            MembershipFunction::Linear { .. } => {
                let message = format!(
                    "{what} is a linear function, but only outputs can have linear functions"
                );
                let help = "write a membership function such as `triangle`";
                self.error("wrong-term", &spans.name, message, help);
                return;
            }
            MembershipFunction::Function { formula } => {
                self.own_formula(what, input, formula, spans);
            }
            _ => {}
        }
        if let Some(number) = function.number()
            && !(0.0..=1.0).contains(&number)
            && !spans.unread
        {
            let here = spans.parameters.first().unwrap_or(&spans.name);
            let message = format!("the degree {number} of {what} is outside [0, 1]");
            let help = match function {
                MembershipFunction::Constant { .. } if (input.low..=input.high).contains(&number) => {
                    format!(
                        "in an input, `constant` is the degree of the term at every value; for values near {number}, write a membership function such as `triangle`; for exactly {number}, write `singleton: {number}`"
                    )
                }
                MembershipFunction::Constant { .. } => "in an input, `constant` is the degree of the term at every value: write a degree from 0 to 1".into(),
                _ => "change the formula so that its result stays within [0, 1]".into(),
            };
            self.error("wrong-parameter", here, message, &help);
        }
    }

    /// Requires that the formula of a fuzzy set reads only the variable of the set.
    pub(super) fn own_formula(
        &mut self,
        what: &str,
        variable: &Variable,
        formula: &Formula,
        spans: &TermSpans,
    ) {
        for (i, name) in formula.variables().enumerate() {
            if name != variable.name {
                let here = spans.parameters.get(i).unwrap_or(&spans.name);
                let message = format!(
                    "the formula of {what} uses `{name}`, but may use only `{}`",
                    variable.name
                );
                let own = &variable.name;
                let help = match name {
                    "e" => format!("for a power of e, write `exp({own})`"),
                    _ if name.strip_suffix('²') == Some(own) => format!("write `{own}^2`"),
                    _ if name.strip_suffix('³') == Some(own) => format!("write `{own}^3`"),
                    _ if nearest(name, [own.as_str()]).is_some() => {
                        format!("did you mean `{own}`?")
                    }
                    _ => "outputs with `weighted_average` or `weighted_sum` can have formulas that use several inputs".into(),
                };
                self.error("wrong-term", here, message, &help);
            }
        }
        self.has_a_value(what, variable, formula, spans);
    }

    /// Reports an error if a formula has no finite value at any of 101 points of the range, such as
    /// `1 / 0`.
    fn has_a_value(&mut self, what: &str, read: &Variable, formula: &Formula, spans: &TermSpans) {
        let width = read.high - read.low;
        let mut points = (0..=100).map(|i| read.low + width * f64::from(i) / 100.0);
        let other = |name: &str| name != read.name;
        if formula.variables().any(other) || points.any(|x| formula.evaluate(|_| x).is_finite()) {
            return;
        }
        let message = format!("the formula of {what} has no finite value");
        let help = "change the formula so that it does not divide by 0 or take roots or logarithms of negative numbers";
        self.error("wrong-parameter", &spans.name, message, help);
    }

    pub(super) fn output(&mut self, output: &Output, spans: &VariableSpans) {
        let variable = &output.variable;
        let what = format!("output `{}`", variable.name);
        let first = self.findings.len();
        self.variable(&what, variable, spans);
        if variable.terms.is_empty() && !spans.terms_unread {
            let message = format!("{what} has no terms");
            self.error("missing-key", &spans.name, message, TERMS_HELP);
        }
        if let Some(sampling) = output.samples {
            let here = or(&spans.samples, &spans.name);
            let samples = sampling.samples;
            if samples < 2 {
                let message = format!("{what} is integrated with {samples} samples");
                self.error("wrong-parameter", here, message, "write 2 samples or more");
            } else if samples > MAX_SAMPLES {
                let message = format!("{samples} samples are more than {MAX_SAMPLES}");
                let help = "remove `samples`: then the result is exact";
                self.error("wrong-parameter", here, message, help);
            }
        }
        if let NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) =
            output.when_no_rule_fires
            && !spans.range_unread
            && !(variable.low..=variable.high).contains(&value)
        {
            let message = format!("the value {value} is outside the range of {what}");
            let help = format!("write a value from {} to {}", variable.low, variable.high);
            let here = or(&spans.default, &spans.name);
            self.error("value-outside-range", here, message, &help);
        }
        self.consequents_fit(&what, output, spans);
        self.bounds_are_sets(&what, output, spans);
        let unread = spans.range_unread || spans.terms.iter().any(|term| term.unread);
        if self.findings.len() == first && !unread && !output.defuzzifier.is_weighted() {
            self.terms_have_area(&what, output, spans);
            self.bounds(&what, variable, spans);
        }
    }

    /// Requires that the terms of a Takagi-Sugeno output are numbers, linear functions or formulas, that those of a
    /// Tsukamoto output are monotone, and that those of a Mamdani output are fuzzy sets.
    pub(super) fn consequents_fit(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        let weighted = output.defuzzifier.takes_numbers();
        let tsukamoto = output.defuzzifier == Defuzzifier::Tsukamoto;
        let no_spans = TermSpans::default();
        if !output.defuzzifier.is_weighted() {
            self.terms_are_not_numbers(what, output, spans);
        }
        // The terms that are reported in a single error: fuzzy sets of a weighted output, or singletons of an output
        // with `bisector`.
        let mut misfits = Vec::new();
        let spans_of_terms = &spans.terms;
        for (i, term) in output.variable.terms.iter().enumerate() {
            let spans = spans_of_terms.get(i).unwrap_or(&no_spans);
            let here = &spans.name;
            let what = format!("term `{}` of {what}", term.name);
            match &term.membership_function {
                _ if spans.unread => {}
                MembershipFunction::Linear { coefficients, .. } => {
                    if !weighted {
                        let defuzzifier = output.defuzzifier.word();
                        let message = format!(
                            "{what} is a linear function, but the defuzzifier `{defuzzifier}` needs fuzzy sets"
                        );
                        let help = "write `defuzzifier: weighted_average`; every term of the output must then be a constant or a linear function";
                        self.error("wrong-term", here, message, help);
                    }
                    self.coefficients(&what, coefficients, spans);
                }
                MembershipFunction::Function { formula } if weighted => {
                    for (i, name) in formula.variables().enumerate() {
                        self.is_read(name, spans.parameters.get(i).unwrap_or(here));
                    }
                    self.has_a_value(&what, &output.variable, formula, spans);
                }
                MembershipFunction::Function { formula } if !tsukamoto => {
                    self.own_formula(&what, &output.variable, formula, spans);
                }
                shape if tsukamoto && !shape.is_monotone() => {
                    let message = format!("{what} is not monotone");
                    let help = "`tsukamoto` needs exactly one value for each degree: write a membership function that only rises or only falls, such as `right_shoulder` or `left_shoulder`";
                    self.error("wrong-term", here, message, help);
                }
                MembershipFunction::Singleton { .. } if !weighted && !output.is_discrete() => {
                    let message = format!(
                        "{what} is a singleton, which has no area, so it cannot be combined with fuzzy sets in other terms"
                    );
                    let help = "write singletons for all terms of the output, or a narrow fuzzy set such as `rectangle` for this term";
                    self.error("wrong-term", here, message, help);
                }
                MembershipFunction::Singleton { .. }
                    if output.defuzzifier == Defuzzifier::Bisector =>
                {
                    misfits.push(i);
                }
                MembershipFunction::Constant { .. } | MembershipFunction::Singleton { .. } => {}
                _ if weighted => misfits.push(i),
                _ => {}
            }
        }
        if let Some(first) = misfits.first() {
            let here = spans_of_terms.get(*first).unwrap_or(&no_spans).name.clone();
            self.misfits(what, output, &misfits, &here);
        }
    }

    /// Reports a single error for terms that the defuzzifier of the output does not support.
    fn misfits(&mut self, what: &str, output: &Output, misfits: &[usize], here: &Range<usize>) {
        let terms = misfits.iter().filter_map(|i| output.variable.terms.get(*i));
        let names: Vec<&str> = terms.clone().map(|term| term.name.as_str()).collect();
        let (subject, are, kind) = match names.as_slice() {
            [one] => (format!("term `{one}` of {what}"), "is a", ""),
            all => (format!("the terms {} of {what}", all_of(all)), "are", "s"),
        };
        if output.defuzzifier == Defuzzifier::Bisector {
            let message = format!(
                "{subject} {are} singleton{kind}, so the defuzzifier `bisector` has no area to divide"
            );
            let help = "write `defuzzifier: centroid`, which weights the position of each singleton by its degree";
            self.error("wrong-term", here, message, help);
            return;
        }
        let message = format!(
            "{subject} {are} fuzzy set{kind}, but the defuzzifier `{}` needs a number for each term",
            output.defuzzifier.word()
        );
        let is_monotone = terms
            .clone()
            .all(|term| term.membership_function.is_monotone());
        let defuzzifier = if is_monotone { "tsukamoto" } else { "centroid" };
        let variable = &output.variable;
        let numbers = terms.map(|term| {
            let peak = libm::round(1e6 * variable.peak(&term.membership_function)) / 1e6;
            format!("{}: {{constant: {peak}}}", term.name)
        });
        let numbers: Vec<String> = numbers.collect();
        let numbers = format!("`{}`", numbers.join(", "));
        let help = match misfits.len() == variable.terms.len() {
            true => format!(
                "write `defuzzifier: {defuzzifier}`, or define the terms as numbers, such as {numbers}"
            ),
            false => format!("make it a number, as the other terms are: {numbers}"),
        };
        self.error("wrong-term", here, message, &help);
    }

    /// Reports a single error for all constants of a fuzzy output. As fuzzy sets they would be flat, and the output
    /// would be the middle of its range whichever rule fires.
    fn terms_are_not_numbers(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        let terms = &output.variable.terms;
        let is_linear = |f: &MembershipFunction| matches!(f, MembershipFunction::Linear { .. });
        if terms
            .iter()
            .any(|term| is_linear(&term.membership_function))
        {
            // Nothing more is reported: the finding about linear functions has the same help.
            return;
        }
        let no_spans = TermSpans::default();
        let of = |i: usize| spans.terms.get(i).unwrap_or(&no_spans);
        let numbers = terms.iter().enumerate().filter(|(i, _)| !of(*i).unread);
        let numbers =
            numbers.filter_map(|(i, term)| Some((i, term, term.membership_function.number()?)));
        let Some((first, term, number)) = numbers.clone().next() else {
            return;
        };
        let message = format!(
            "term `{}` of {what} is the number {number}, but the defuzzifier `{}` needs fuzzy sets",
            term.name,
            output.defuzzifier.word()
        );
        let help = if numbers.count() == terms.len() {
            "write `defuzzifier: weighted_average`"
        } else {
            "replace the number by a fuzzy set such as `triangle`, or make all terms numbers and write `defuzzifier: weighted_average`"
        };
        let here = of(first).name.clone();
        self.error("wrong-term", &here, message, help);
    }

    /// Validates the inputs that a linear function names.
    pub(super) fn coefficients(
        &mut self,
        what: &str,
        coefficients: &[(String, f64)],
        spans: &TermSpans,
    ) {
        let mut seen = BTreeSet::new();
        for (i, (input, _)) in coefficients.iter().enumerate() {
            if self.findings.len() >= MAX_FINDINGS {
                return;
            }
            let here = spans.parameters.get(i).unwrap_or(&spans.name);
            if input == "constant" {
                // In a rule set this key is the constant part.
                let message = format!("{what} has a coefficient for an input called `constant`");
                self.error("wrong-term", here, message, "rename the input");
            } else if !self.inputs.contains_key(input.as_str())
                && !foreign::equivalents(input, ["constant"]).is_empty()
            {
                let message =
                    format!("{what} has a coefficient for `{input}`, which is not an input");
                self.error(
                    "unknown-variable",
                    here,
                    message,
                    "did you mean `constant`?",
                );
            } else {
                self.is_read(input, here);
            }
            if !seen.insert(input) {
                let message = format!("{what} has two coefficients for `{input}`");
                self.error("duplicate-key", here, message, "keep one of them");
            }
        }
    }

    /// Requires that `name`, which a consequent reads, is an input or an output.
    pub(super) fn is_read(&mut self, name: &str, here: &Range<usize>) {
        if !self.inputs.contains_key(name) && !self.outputs.contains_key(name) {
            let finding = self.unknown_input(name, here);
            self.findings.push(finding);
        }
    }

    /// Reports terms without an area within the range; with such a term an output would have no value.
    pub(super) fn terms_have_area(&mut self, what: &str, output: &Output, spans: &VariableSpans) {
        let variable = &output.variable;
        for (i, term) in variable.terms.iter().enumerate() {
            if is_empty(output, term) {
                let here = spans.terms.get(i).map_or(0..0, |term| term.name.clone());
                let fault = match output.is_discrete() {
                    true => "is outside",
                    false => "has no area within",
                };
                let message = format!(
                    "term `{}` of {what} {fault} the range [{}, {}]",
                    term.name, variable.low, variable.high
                );
                let help = "widen the range or move the term";
                self.error("term-outside-range", &here, message, help);
            }
        }
    }
}
