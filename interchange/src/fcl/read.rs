//! From FCL to a model.

use fuzzy::{
    diagnostic::nearest,
    format::{Document, RuleSpans, VariableSpans},
    model::{
        Aggregation, Block, Conjunction, Defuzzifier, Disjunction, MembershipFunction, NoRuleFires,
        Output, Rule, Term, Variable,
    },
};

use super::{extent::extent, lex, term};
use crate::{Format, Losses, blocks, conditions::dual, draft::Draft, rules, words};

pub(crate) fn read(text: &str, losses: Losses) -> Result<Document, fuzzy::Findings> {
    let words = lex::words(text);
    let mut reader = Reader {
        draft: Draft::new(text, losses),
        words: &words,
        next: 0,
        outputs: vec![],
        aggregations: vec![],
        common: None,
        blocks: vec![],
    };
    reader.file();
    reader.finish()
}

struct Reader<'r, 't> {
    draft: Draft<'t>,
    words: &'r [&'t str],
    next: usize,
    /// The names behind VAR_OUTPUT.
    outputs: Vec<&'t str>,
    /// Of each output.
    aggregations: Vec<Option<Aggregation>>,
    /// Of a rule block, which holds for outputs without one.
    common: Option<Aggregation>,
    blocks: Vec<Block>,
}

impl<'r, 't> Reader<'r, 't> {
    fn peek(&self) -> Option<&'t str> {
        self.words.get(self.next).copied()
    }

    fn is(&self, keyword: &str) -> bool {
        self.peek()
            .is_some_and(|word| word.eq_ignore_ascii_case(keyword))
    }

    fn take(&mut self, keyword: &str) -> bool {
        let is = self.is(keyword);
        self.next += usize::from(is);
        is
    }

    fn word(&mut self) -> Option<&'t str> {
        let word = self.peek()?;
        self.next += 1;
        Some(word)
    }

    /// The words up to the next `;`, which is stepped over, or up to one of the keywords.
    fn statement(&mut self, keywords: &[&str]) -> &'r [&'t str] {
        let words = self.words;
        let rest = words.get(self.next..).unwrap_or_default();
        let ends =
            |word: &&str| *word == ";" || keywords.iter().any(|k| k.eq_ignore_ascii_case(word));
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.next += length;
        self.take(";");
        rest.get(..length).unwrap_or_default()
    }

    /// Where something is missing: the next word, or the end of the text.
    fn here(&self) -> &'t str {
        let text = self.draft.text;
        self.peek()
            .unwrap_or(text.get(text.len()..).unwrap_or_default())
    }

    fn unexpected(&mut self, expected: &str) {
        let part = self.here();
        let found = match part {
            "" => "the text ends".to_owned(),
            word => format!("found `{word}`"),
        };
        let message = format!("expected {expected}, {found}");
        self.draft.error(
            "fcl-syntax",
            part,
            message,
            "see IEC 61131-7 for the form of a file",
        );
    }

    fn file(&mut self) {
        if self.take("FUNCTION_BLOCK") {
            let name = self.peek().filter(|word| !is_section(word));
            self.next += usize::from(name.is_some());
            self.draft.model.name = name.unwrap_or("unnamed").to_owned();
        } else {
            self.unexpected("`FUNCTION_BLOCK`");
            return;
        }
        while let Some(word) = self.word() {
            match word.to_ascii_uppercase().as_str() {
                "VAR_INPUT" => self.variables(false),
                "VAR_OUTPUT" => self.variables(true),
                "FUZZIFY" => self.fuzzify(),
                "DEFUZZIFY" => self.defuzzify(),
                "RULEBLOCK" => self.rules(),
                "OPTIONS" | "VAR" => self.skip(word),
                "END_FUNCTION_BLOCK" => break,
                _ => {
                    self.next -= 1;
                    self.unexpected("a section such as `FUZZIFY` or `RULEBLOCK`");
                    return;
                }
            }
        }
        if self.is("FUNCTION_BLOCK") {
            let part = self.here();
            let message = "the file has several function blocks".into();
            self.draft.loss(
                "two-blocks",
                part,
                message,
                "put each into a file of its own",
            );
        }
    }

    fn skip(&mut self, section: &str) {
        let end = format!("END_{}", section.to_ascii_uppercase());
        while self.peek().is_some() && !self.take(&end) {
            self.next += 1;
        }
    }

    /// `name : REAL;` up to END_VAR.
    fn variables(&mut self, outputs: bool) {
        while !self.take("END_VAR") {
            let statement = self.statement(&["END_VAR"]);
            let Some(&name) = statement.first() else {
                if self.peek().is_none() {
                    self.unexpected("`END_VAR`");
                    return;
                }
                continue;
            };
            if outputs {
                self.outputs.push(name);
            } else {
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

    fn fuzzify(&mut self) {
        let Some(name) = self.word() else {
            return self.unexpected("an input");
        };
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
            let message = format!("`{name}` is no input");
            self.draft.error("unknown-variable", name, message, &help);
            return self.skip("FUZZIFY");
        };
        let mut variable = Variable::new(name, f64::NAN, f64::NAN);
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(name);
        while !self.take("END_FUZZIFY") && self.peek().is_some() {
            if !self.part(&mut variable, &mut spans) {
                self.unexpected("`TERM`, `RANGE` or `END_FUZZIFY`");
                return self.skip("FUZZIFY");
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

    fn defuzzify(&mut self) {
        let Some(name) = self.word() else {
            return self.unexpected("an output");
        };
        let mut output = Output::new(Variable::new(name, f64::NAN, f64::NAN));
        let mut aggregation = None;
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(name);
        while !self.take("END_DEFUZZIFY") && self.peek().is_some() {
            if self.take("METHOD") {
                if let Some(method) = self.setting("METHOD", words::DEFUZZIFIERS) {
                    output.defuzzifier = method;
                }
            } else if self.take("ACCU") {
                aggregation = self.setting("ACCU", words::AGGREGATIONS);
            } else if self.take("DEFAULT") {
                self.default(&mut output, &mut spans);
            } else if !self.part(&mut output.variable, &mut spans) {
                self.unexpected("`TERM`, `METHOD`, `DEFAULT`, `RANGE` or `END_DEFUZZIFY`");
                return self.skip("DEFUZZIFY");
            }
        }
        let is_number = |term: &Term| {
            matches!(
                term.membership_function,
                MembershipFunction::Singleton { .. }
            )
        };
        if output.defuzzifier == Defuzzifier::WeightedAverage
            && output.variable.terms.iter().all(is_number)
        {
            // The centre of gravity for singletons: degrees are aggregated before they weigh the places.
            output.defuzzifier = Defuzzifier::Centroid;
        }
        let weighted = words::is_weighted(output.defuzzifier);
        if weighted {
            // The places of singletons are values here.
            for term in &mut output.variable.terms {
                if let MembershipFunction::Singleton { at } = term.membership_function {
                    term.membership_function = MembershipFunction::Constant { value: at };
                }
            }
        }
        self.universe(&mut output.variable, &mut spans, name);
        self.aggregations.push(aggregation.filter(|_| !weighted));
        self.draft.model.outputs.push(output);
        self.draft.spans.outputs.push(spans);
    }

    /// `DEFAULT := 0;`, `DEFAULT := NC;`: some files write `=`, and no semicolon.
    fn default(&mut self, output: &mut Output, spans: &mut VariableSpans) {
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

    /// `TERM name := ...;` or `RANGE := (low .. high);`
    fn part(&mut self, variable: &mut Variable, spans: &mut VariableSpans) -> bool {
        if self.take("TERM") {
            let statement = self.statement(&[
                "TERM",
                "END_FUZZIFY",
                "END_DEFUZZIFY",
                "METHOD",
                "RANGE",
                "DEFAULT",
            ]);
            let [name, ":=", shape @ ..] = statement else {
                self.unexpected("`NAME := SHAPE;` before this");
                return true;
            };
            if let Some((term, span)) = term::read(&mut self.draft, &variable.name, name, shape) {
                variable.terms.push(term);
                spans.terms.push(span);
            }
            return true;
        }
        if self.take("RANGE") {
            let (first, statement) = (self.here(), self.statement(&[]));
            let [":=", "(", low, "..", high, ")"] = *statement else {
                let message = "expected `RANGE := (LOW .. HIGH);`".into();
                self.draft
                    .error("no-range", first, message, "write both ends as numbers");
                return true;
            };
            spans.range = self.draft.span(low).start..self.draft.span(high).end;
            if let (Some(low), Some(high)) = (self.draft.number(low), self.draft.number(high)) {
                (variable.low, variable.high) = (low, high);
            }
            return true;
        }
        false
    }

    /// The range of a variable that names none: from the first to the last place where a term changes.
    fn universe(&mut self, variable: &mut Variable, spans: &mut VariableSpans, name: &str) {
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
        let (low, high) = match low < high {
            true => (low, high),
            false if low == high => (low - 0.5, low + 0.5),
            false => (0.0, 1.0),
        };
        (variable.low, variable.high) = (low, high);
        spans.range = spans.name.clone();
        let message = format!("`{name}` has no range");
        let help = format!(
            "its terms lie between {low} and {high}; write `RANGE := (LOW .. HIGH);` for another"
        );
        self.draft.note("guessed-range", name, message, &help);
    }

    /// `KEY : WORD;`
    fn setting<T: Copy>(&mut self, key: &str, known: &'static words::Words<T>) -> Option<T> {
        if !self.take(":") {
            self.unexpected("`:`");
            return None;
        }
        let word = self.word()?;
        self.take(";");
        if word.eq_ignore_ascii_case("none") {
            return None;
        }
        self.draft
            .word(Format::Fcl, known, &format!("`{key}`"), (word, word))
    }

    fn rules(&mut self) {
        const KEYS: [&str; 6] = ["AND", "OR", "ACT", "ACCU", "RULE", "END_RULEBLOCK"];
        let is_key = |word: &&str| KEYS.iter().any(|key| key.eq_ignore_ascii_case(word));
        let name = self.peek().filter(|word| !is_key(word));
        self.next += usize::from(name.is_some());
        let mut block = Block::new(name.unwrap_or_default());
        let (mut and, mut or) = (None, None);
        while !self.take("END_RULEBLOCK") && self.peek().is_some() {
            if self.take("AND") {
                and = self.setting("AND", words::CONJUNCTIONS);
            } else if self.take("OR") {
                or = self.setting("OR", words::DISJUNCTIONS);
            } else if self.take("ACT") {
                let implication = self.setting("ACT", words::CONJUNCTIONS);
                block.implication = implication.unwrap_or_default();
            } else if self.take("ACCU") {
                let aggregation = self.setting("ACCU", words::AGGREGATIONS);
                if self.common.is_some() && aggregation.is_some() && self.common != aggregation {
                    let part = self.here();
                    let message = "two rule blocks have a different `ACCU`".into();
                    let help = "write `ACCU` in the `DEFUZZIFY` of each output";
                    self.draft.loss("two-aggregations", part, message, help);
                }
                self.common = aggregation.or(self.common);
            } else if self.take("RULE") {
                self.rule();
            } else {
                self.unexpected("`RULE`, `AND`, `OR`, `ACT`, `ACCU` or `END_RULEBLOCK`");
                return self.skip("RULEBLOCK");
            }
        }
        // Where one of them is not named, it is the dual of the other.
        (block.and, block.or) = match (and, or) {
            (None, None) => (Conjunction::Minimum, Disjunction::Maximum),
            (Some(and), None) => (and, dual(and)),
            (None, Some(or)) => {
                let mut known = words::CONJUNCTIONS.iter().map(|entry| entry.0);
                (known.find(|&and| dual(and) == or).unwrap_or_default(), or)
            }
            (Some(and), Some(or)) => (and, or),
        };
        self.blocks.push(block);
    }

    /// `1 : IF ... THEN ...;`
    fn rule(&mut self) {
        while self.peek().is_some() && !self.is("IF") && !self.is(";") {
            self.next += 1;
        }
        let words = self.statement(&["RULE", "END_RULEBLOCK"]);
        let (Some(first), Some(last)) = (words.first(), words.last()) else {
            return self.unexpected("`IF`");
        };
        let span = self.draft.span(first).start..self.draft.span(last).end;
        if let Some(rule) = rules::read(&mut self.draft, words) {
            let mut spans = RuleSpans::default();
            spans.whole = span;
            self.draft.spans.rules.push(spans);
            self.draft.model.rules.push(Rule {
                block: self.blocks.len(),
                ..Rule::from(rule)
            });
        }
    }

    fn finish(mut self) -> Result<Document, fuzzy::Findings> {
        let common = self.common;
        let of_output = |(found, output): (&Option<Aggregation>, &Output)| match words::is_weighted(
            output.defuzzifier,
        ) {
            true => None,
            false => Some(found.or(common).unwrap_or_default()),
        };
        let found = self
            .aggregations
            .iter()
            .zip(&self.draft.model.outputs)
            .map(of_output);
        let found: Vec<Option<Aggregation>> = found.collect();
        blocks::aggregate(&mut self.draft.model, &found);
        blocks::settle(&mut self.draft.model, std::mem::take(&mut self.blocks));
        for name in &self.outputs {
            let has_terms = self
                .draft
                .model
                .outputs
                .iter()
                .any(|output| output.variable.name == *name);
            if !has_terms {
                let message = format!("the output `{name}` has no `DEFUZZIFY`");
                self.draft
                    .warning("no-terms", name, message, "it is left out");
            }
        }
        for input in &mut self.draft.model.inputs {
            // An input that is not fuzzified is there for formulas.
            if input.low.is_nan() {
                (input.low, input.high) = (0.0, 1.0);
            }
        }
        self.draft.finish()
    }
}

fn is_section(word: &str) -> bool {
    [
        "VAR_INPUT",
        "VAR_OUTPUT",
        "FUZZIFY",
        "DEFUZZIFY",
        "RULEBLOCK",
    ]
    .iter()
    .any(|section| section.eq_ignore_ascii_case(word))
}
