//! Reads variables of FCL and their terms.

use fuzzy::{
    diagnostic::nearest,
    format::{TermSpans, VariableSpans},
    model::{Defuzzifier, MembershipFunction, NoRuleFires, Output, Term, Variable},
};

use super::{extent::extent, read::Reader, term};
use crate::{
    fll::{self, conventions},
    model_draft::MAX_VARIABLES,
    words,
};

impl<'t> Reader<'_, 't> {
    /// Reads `name : REAL;` up to END_VAR.
    pub(super) fn variables(&mut self, outputs: bool) {
        while !self.ends("END_VAR") {
            let statement = self.statement(&["END_VAR"]);
            let Some(&name) = statement.first() else {
                continue;
            };
            if outputs {
                if self
                    .draft
                    .allows_another(self.outputs.len(), MAX_VARIABLES, "outputs", name)
                {
                    self.outputs.push(name);
                }
            } else if self.draft.allows_another(
                self.draft.model.inputs.len(),
                MAX_VARIABLES,
                "inputs",
                name,
            ) {
                self.draft
                    .model
                    .inputs
                    .push(Variable::new(name, f64::NAN, f64::NAN));
                let mut spans = VariableSpans::default();
                spans.name = self.draft.span(name);
                self.draft.spans.inputs.push(spans);
            }
        }
    }

    pub(super) fn fuzzify(&mut self) {
        let Some(name) = self.word() else {
            return self.unexpected("an input");
        };
        self.computes = false;
        let Some(index) = self
            .draft
            .model
            .inputs
            .iter()
            .position(|input| input.name == name)
        else {
            let known = self
                .draft
                .model
                .inputs
                .iter()
                .map(|input| input.name.clone());
            let known: Vec<String> = known.collect();
            let help = match nearest(name, known.iter().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "name it between `VAR_INPUT` and `END_VAR`".into(),
            };
            let message = format!("`{name}` is not an input");
            self.draft.error("unknown-variable", name, message, &help);
            return self.skip("FUZZIFY");
        };
        let mut variable = Variable::new(name, f64::NAN, f64::NAN);
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(name);
        while !self.ends("END_FUZZIFY") {
            if !self.part(&mut variable, &mut spans) {
                self.unexpected("`TERM`, `RANGE` or `END_FUZZIFY`");
                return self.resume("FUZZIFY");
            }
        }
        self.universe(&mut variable, &mut spans, name);
        if let Some(input) = self.draft.model.inputs.get_mut(index) {
            *input = variable;
        }
        if let Some(input) = self.draft.spans.inputs.get_mut(index) {
            *input = spans;
        }
    }

    pub(super) fn defuzzify(&mut self) {
        let Some(name) = self.word() else {
            return self.unexpected("an output");
        };
        let section = self.words.get(self.next..).unwrap_or_default().iter();
        let mut section = section.take_while(|word| !word.eq_ignore_ascii_case("END_DEFUZZIFY"));
        self.computes = section.any(|word| {
            ["COGS", "COGSS"]
                .iter()
                .any(|m| m.eq_ignore_ascii_case(word))
        });
        let count = self.draft.model.outputs.len();
        if !self
            .draft
            .allows_another(count, MAX_VARIABLES, "outputs", name)
        {
            return self.skip("DEFUZZIFY");
        }
        let mut output = Output::new(Variable::new(name, f64::NAN, f64::NAN));
        let mut accumulation = None;
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(name);
        while !self.ends("END_DEFUZZIFY") {
            if self.take("METHOD") {
                if let Some(method) = self.setting("METHOD", words::DEFUZZIFIERS) {
                    output.defuzzifier = method;
                }
            } else if self.take("ACCU") {
                accumulation = Some(self.setting("ACCU", words::AGGREGATIONS));
            } else if self.take("DEFAULT") {
                self.default(&mut output, &mut spans);
            } else if !self.part(&mut output.variable, &mut spans) {
                self.unexpected("`TERM`, `METHOD`, `DEFAULT`, `RANGE` or `END_DEFUZZIFY`");
                return self.resume("DEFUZZIFY");
            }
        }
        if output.defuzzifier == Defuzzifier::WeightedAverage
            && !self.is_fuzzylite
            && output.variable.terms.iter().all(term::is_number)
        {
            // For singletons, FCL aggregates the degrees before they are used as weights of the positions.
            output.defuzzifier = Defuzzifier::Centroid;
        }
        let weighted = words::is_weighted(output.defuzzifier);
        if weighted {
            // Here the positions of singletons are values, so the singletons become constants.
            for term in &mut output.variable.terms {
                if let MembershipFunction::Singleton { at } = term.membership_function {
                    term.membership_function = MembershipFunction::Constant { value: at };
                }
            }
        }
        if self.is_fuzzylite {
            conventions::tsukamoto(&mut output);
        }
        self.universe(&mut output.variable, &mut spans, name);
        self.accumulations.push(accumulation);
        self.draft.model.outputs.push(output);
        self.draft.spans.outputs.push(spans);
    }

    /// Reads `DEFAULT := 0;` or `DEFAULT := NC;`. Some files use `=` and omit the semicolon.
    pub(super) fn default(&mut self, output: &mut Output, spans: &mut VariableSpans) {
        if !self.take(":=") && !self.take("=") && !self.take(":") {
            return self.unexpected("`:=`");
        }
        let Some(word) = self.word() else {
            return self.unexpected("a number or `NC`");
        };
        self.take(";");
        spans.default = self.draft.span(word);
        if word.eq_ignore_ascii_case("NC") {
            output.when_no_rule_fires = NoRuleFires::Previous(None);
        } else if let Some(value) = self.draft.number(word).filter(|value| !value.is_nan()) {
            output.when_no_rule_fires = NoRuleFires::Value(value);
        }
    }

    /// Reads `TERM name := ...;` or `RANGE := (low .. high);`.
    pub(super) fn part(&mut self, variable: &mut Variable, spans: &mut VariableSpans) -> bool {
        if self.take("TERM") {
            let statement = self.statement(&[
                "TERM",
                "END_FUZZIFY",
                "END_DEFUZZIFY",
                "METHOD",
                "RANGE",
                "DEFAULT",
            ]);
            let count = |sign: &str| statement.iter().filter(|word| **word == sign).count();
            if count("(") > count(")")
                && let Some(x) = statement.last()
                && self.ended()
            {
                // For example `(4; 0)`: the semicolon ends the statement.
                let rest = self.statement(&[]);
                let y = rest.first().copied().unwrap_or_default();
                let message = "a point contains a semicolon, which ends the statement".into();
                self.draft
                    .error("fcl-syntax", x, message, &format!("write `({x}, {y})`"));
                return true;
            }
            if let [name, sign @ ("=" | ":"), ..] = statement {
                let message = format!("expected `:=` after `{name}`, found `{sign}`");
                let help = format!("write `TERM {name} := ...;`");
                self.draft.error("fcl-syntax", sign, message, &help);
                return true;
            }
            let [name, ":=", shape @ ..] = statement else {
                self.unexpected("`NAME := SHAPE;` before this");
                return true;
            };
            let read = match self.is_fuzzylite && term::is_named(shape) {
                true => self.fuzzylite_term(variable, name, shape),
                false => term::read(&mut self.draft, &variable.name, name, shape),
            };
            match read {
                Some(read) if self.is_fuzzylite => {
                    conventions::add(&mut self.draft, (variable, spans), read, name);
                }
                Some((term, span)) if self.draft.allows_another_term(variable, name) => {
                    variable.terms.push(term);
                    spans.terms.push(span);
                }
                _ => {}
            }
            return true;
        }
        if self.take("RANGE") {
            const NEXT: [&str; 6] = [
                "TERM",
                "END_FUZZIFY",
                "END_DEFUZZIFY",
                "METHOD",
                "ACCU",
                "DEFAULT",
            ];
            let (first, statement) = (self.here(), self.statement(&NEXT));
            let [":=", "(", low, "..", high, ")"] = *statement else {
                let message = "expected `RANGE := (LOW .. HIGH);`".into();
                let help = match *statement {
                    [":=", "(", low, ".", high, ")"] => {
                        format!("write two points: `({low} .. {high})`")
                    }
                    _ => "write both ends as numbers: `(0 .. 10)`".into(),
                };
                self.draft.error("no-range", first, message, &help);
                // This range prevents a second error about a missing range.
                (variable.low, variable.high) = (0.0, 1.0);
                return true;
            };
            if NEXT.iter().any(|word| self.is(word)) && !self.ended() {
                let message = "expected `;` after the range".into();
                let part = statement.last().copied().unwrap_or(first);
                let help = format!("write `RANGE := ({low} .. {high});`");
                self.draft.error("fcl-syntax", part, message, &help);
            }
            spans.range = self.draft.span(low).start..self.draft.span(high).end;
            let ends = (self.draft.number(low), self.draft.number(high));
            if let (Some(low), Some(high)) = ends {
                let range = self.draft.range(first, (low, high), self.computes);
                (variable.low, variable.high) = range;
            }
            return true;
        }
        false
    }

    /// Reads a term in the syntax of FLL from the words after `:=`.
    pub(super) fn fuzzylite_term(
        &mut self,
        variable: &Variable,
        name: &str,
        words: &[&'t str],
    ) -> Option<(Term, TermSpans)> {
        let (first, last) = (words.first()?, words.last()?);
        let span = self.draft.span(first).start..self.draft.span(last).end;
        let written = self.draft.text.get(span)?;
        // In an output with computed values, a formula computes a value from the inputs; in other outputs, it
        // computes a degree from its own variable.
        let inputs = self.draft.model.inputs.iter();
        let inputs: Vec<String> = inputs.map(|input| input.name.clone()).collect();
        let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
        let own = (!self.computes).then_some(variable.name.as_str());
        fll::term::of_shape(&mut self.draft, name, written, &inputs, own)
    }

    /// Sets the range of a variable without one: from the first to the last point at which a term changes.
    pub(super) fn universe(
        &mut self,
        variable: &mut Variable,
        spans: &mut VariableSpans,
        name: &str,
    ) {
        if !variable.low.is_nan() {
            return;
        }
        let ends = variable
            .terms
            .iter()
            .map(|term| extent(&term.membership_function));
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
            (low.min(a), high.max(b))
        });
        let (found, (low, high)) = match low <= high {
            true if low < high => ("its terms lie between", (low, high)),
            true => ("its terms lie within", (low - 0.5, low + 0.5)),
            false => ("its terms have no limits, and it is between", (0.0, 1.0)),
        };
        (variable.low, variable.high) = (low, high);
        spans.range = spans.name.clone();
        let message = format!("`{name}` has no range");
        let help = format!("{found} {low} and {high}; write `RANGE := (LOW .. HIGH);` for another");
        self.draft.note("guessed-range", name, message, &help);
    }
}
