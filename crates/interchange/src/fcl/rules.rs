//! Reads rule blocks of FCL, and the aggregation of their conclusions.

use fuzzy::{
    format::RuleSpans,
    model::{Aggregation, Block, Conjunction, Disjunction, Rule},
};

use super::{read::Reader, term::is_number};
use crate::{Format, blocks, conditions::dual, model_draft::MAX_BLOCKS, rules, words};

impl Reader<'_, '_> {
    /// Reads `KEY : WORD;`.
    pub(super) fn setting<T: Copy>(
        &mut self,
        key: &str,
        known: &'static words::Words<T>,
    ) -> Option<T> {
        let sign = self.here();
        let is_assignment = self.take(":=");
        if !is_assignment && !self.take(":") {
            self.unexpected("`:`");
            return None;
        }
        let word = self.word()?;
        self.take(";");
        if is_assignment {
            let message = format!("expected `:` after `{key}`, found `:=`");
            let help = format!("write `{key} : {word};`");
            self.draft.error("fcl-syntax", sign, message, &help);
            return None;
        }
        if word.eq_ignore_ascii_case("none") {
            return None;
        }
        self.draft
            .word(Format::Fcl, known, &format!("`{key}`"), (word, word))
    }

    pub(super) fn rules(&mut self) {
        const KEYS: [&str; 6] = ["AND", "OR", "ACT", "ACCU", "RULE", "END_RULEBLOCK"];
        let is_key = |word: &&str| KEYS.iter().any(|key| key.eq_ignore_ascii_case(word));
        let name = self.peek().filter(|word| !is_key(word));
        self.next += usize::from(name.is_some());
        let part = self.here();
        let count = self.blocks.len();
        if !self
            .draft
            .allows_another(count, MAX_BLOCKS, "rule blocks", part)
        {
            return self.skip("RULEBLOCK");
        }
        let mut block = Block::new(name.unwrap_or_default());
        let (mut and, mut or) = (None, None);
        while !self.ends("END_RULEBLOCK") {
            if self.take("AND") {
                and = self.setting("AND", words::CONJUNCTIONS);
            } else if self.take("OR") {
                or = self.setting("OR", words::DISJUNCTIONS);
            } else if self.take("ACT") {
                let implication = self.setting("ACT", words::CONJUNCTIONS);
                block.implication = implication.unwrap_or_default();
            } else if self.take("ACCU") {
                let accumulation = Some(self.setting("ACCU", words::AGGREGATIONS));
                if self.common.is_some() && self.common != accumulation {
                    let part = self.here();
                    let message = "two rule blocks have a different `ACCU`".into();
                    let help = "write `ACCU` in the `DEFUZZIFY` of each output";
                    self.draft.loss("two-aggregations", part, message, help);
                }
                self.common = accumulation;
            } else if self.take("RULE") {
                self.rule();
            } else {
                self.unexpected("`RULE`, `AND`, `OR`, `ACT`, `ACCU` or `END_RULEBLOCK`");
                return self.skip("RULEBLOCK");
            }
        }
        // If only one of AND and OR is specified, the other is its dual.
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

    /// Reads `1 : IF ... THEN ...;`.
    pub(super) fn rule(&mut self) {
        let start = self.next;
        while self.peek().is_some() && !self.is("IF") && !self.is(";") {
            self.next += 1;
        }
        if self.is(";") {
            // The condition begins after `1 :`.
            let words = self.words.get(start..self.next).unwrap_or_default();
            let colon = words
                .iter()
                .position(|word| *word == ":")
                .map_or(0, |at| at + 1);
            self.next = start + colon;
            let part = self.here();
            let message = format!("expected `IF`, found `{part}`");
            let help = "write `RULE 1 : IF ... THEN ...;`";
            self.draft.error("fcl-syntax", part, message, help);
            self.statement(&["RULE", "END_RULEBLOCK"]);
            return;
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

    /// The aggregation of an output; `None` if it computes its values, so that each rule has its own weight.
    pub(super) fn aggregation(&mut self, index: usize) -> Option<Aggregation> {
        let written = self.accumulations.get(index).copied().flatten();
        // The default is MAX; in fuzzylite's dialect it is NONE.
        let accumulation = match written.or(self.common) {
            Some(accumulation) => accumulation,
            None => (!self.is_fuzzylite).then_some(Aggregation::Maximum),
        };
        let output = self.draft.model.outputs.get(index)?;
        if !words::is_weighted(output.defuzzifier) {
            let numbers = output.variable.terms.iter().all(is_number);
            let none = match numbers {
                true => Aggregation::Sum,
                false => Aggregation::Maximum,
            };
            return Some(accumulation.unwrap_or(none));
        }
        if !matches!(accumulation, None | Some(Aggregation::Sum)) {
            let name = output.variable.name.clone();
            let spans = self.draft.spans.outputs.get(index);
            let span = spans.map(|spans| spans.name.clone()).unwrap_or_default();
            let part = self.draft.text.get(span).unwrap_or_default();
            let help = "write `ACCU : SUM;`, with which each rule counts";
            blocks::joined(&mut self.draft, &name, part, help);
        }
        None
    }
}
