//! Rules in the syntax of FLL and FCL: `if a is very x and (b is y or c is not z) then d is w with 0.5`.

use fuzzy::{
    model::Operators,
    rule::{Condition, Consequent, DEEPEST_NESTING, Hedge, Name, Proposition, Rule},
};

use crate::{conditions, model_draft::ModelDraft};

/// The maximum number of hedges of a conclusion, including those of the conclusions before it.
const MAX_HEDGES: usize = 64;

/// Reads a rule from words and brackets, which are parts of the text of `draft`; `None` with a finding if it is
/// invalid.
pub(crate) fn read(draft: &mut ModelDraft<'_>, words: &[&str]) -> Option<Rule> {
    let end = words.last().map_or("", |word| &word[word.len()..]);
    let mut reader = Reader {
        draft,
        words,
        next: 0,
        depth: 0,
        end,
    };
    reader.rule()
}

/// Splits a text into words and brackets.
pub(crate) fn words(text: &str) -> Vec<&str> {
    let mut words = vec![];
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '(' | ')' | ',' => 1,
            _ => rest
                .find(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | ','))
                .unwrap_or(rest.len()),
        };
        let (word, after) = rest.split_at(length);
        words.push(word);
        rest = after.trim_start();
    }
    words
}

struct Reader<'r, 't, 'd> {
    draft: &'d mut ModelDraft<'t>,
    words: &'r [&'r str],
    next: usize,
    depth: usize,
    /// The end of the rule, where missing words are reported.
    end: &'r str,
}

impl<'r> Reader<'r, '_, '_> {
    fn peek(&self) -> Option<&'r str> {
        self.words.get(self.next).copied()
    }

    fn is(&self, keyword: &str) -> bool {
        self.peek()
            .is_some_and(|word| word.eq_ignore_ascii_case(keyword))
    }

    /// Consumes a keyword if it is next.
    fn take(&mut self, keyword: &str) -> bool {
        let is = self.is(keyword);
        self.next += usize::from(is);
        is
    }

    fn expect(&mut self, keyword: &str) -> Option<()> {
        if self.take(keyword) {
            return Some(());
        }
        self.unexpected(&format!("`{keyword}`"))
    }

    fn unexpected<T>(&mut self, expected: &str) -> Option<T> {
        let (part, found) = match self.peek() {
            Some(word) => (word, format!("found `{word}`")),
            None => (self.end, "the rule ends".into()),
        };
        let message = format!("expected {expected}, {found}");
        let help = "a rule reads `if INPUT is TERM and INPUT is TERM then OUTPUT is TERM`";
        self.draft.error("rule-syntax", part, message, help);
        None
    }

    fn name(&mut self, what: &str) -> Option<Name> {
        match self.peek() {
            Some(word) if !is_keyword(word) => {
                self.next += 1;
                Some(Name {
                    text: word.to_owned(),
                    span: self.draft.span(word),
                })
            }
            _ => self.unexpected(what),
        }
    }

    fn rule(&mut self) -> Option<Rule> {
        self.expect("if")?;
        let condition = self.any_of()?;
        self.expect("then")?;
        let (mut consequents, mut hedges) = (vec![], vec![]);
        loop {
            let (output, own, term) = self.proposition("an output")?;
            let Some(term) = term else {
                return self.unexpected("a term");
            };
            // fuzzylite passes a hedged strength on to the following conclusions.
            hedges.splice(0..0, own);
            if hedges.len() > MAX_HEDGES {
                return self.unexpected(&format!("at most {MAX_HEDGES} hedges"));
            }
            consequents.push(Consequent {
                output,
                hedges: hedges.clone(),
                term,
            });
            if !self.take("and") && !self.take(",") {
                break;
            }
        }
        let mut weight = 1.0;
        if self.take("with") {
            let Some(word) = self.peek() else {
                return self.unexpected("a weight");
            };
            weight = self.draft.number(word)?;
            self.next += 1;
        }
        match self.peek() {
            Some(_) => self.unexpected("the end of the rule"),
            None => Some(Rule {
                condition,
                consequents,
                weight,
            }),
        }
    }

    fn any_of(&mut self) -> Option<Condition> {
        let mut parts = vec![self.all_of()?];
        while self.take("or") {
            parts.push(self.all_of()?);
        }
        Some(joined(parts, Condition::Or))
    }

    fn all_of(&mut self) -> Option<Condition> {
        let mut parts = vec![self.condition()?];
        while self.take("and") {
            parts.push(self.condition()?);
        }
        Some(joined(parts, Condition::And))
    }

    fn condition(&mut self) -> Option<Condition> {
        if self.depth > DEEPEST_NESTING {
            return self.too_deep();
        }
        self.depth += 1;
        let condition = if self.take("not") {
            self.negation()
        } else if self.take("(") {
            self.any_of().filter(|_| self.expect(")").is_some())
        } else {
            self.is_term()
        };
        self.depth -= 1;
        condition
    }

    // The recursive functions must have small stack frames, so the rest is in separate functions.
    fn too_deep<T>(&mut self) -> Option<T> {
        let part = self.peek().unwrap_or(self.end);
        let message =
            format!("the brackets of a condition are nested at most {DEEPEST_NESTING} deep");
        let help = "write it as several rules";
        self.draft.error("rule-too-deep", part, message, help);
        None
    }

    fn negation(&mut self) -> Option<Condition> {
        let inner = self.condition()?;
        Some(Condition::Not(Box::new(inner)))
    }

    fn is_term(&mut self) -> Option<Condition> {
        let (variable, hedges, term) = self.proposition("an input")?;
        Some(Condition::Is(Proposition {
            variable,
            hedges,
            term,
        }))
    }

    /// Reads `variable is hedge* term`. A hedge word without a term after it is the name of a term; only `any` needs no
    /// term.
    fn proposition(&mut self, what: &str) -> Option<(Name, Vec<Hedge>, Option<Name>)> {
        let variable = self.name(what)?;
        self.expect("is")?;
        let mut hedges = vec![];
        while let Some(word) = self.peek() {
            let hedge = Hedge::ALL
                .into_iter()
                .find(|hedge| hedge.word().eq_ignore_ascii_case(word));
            let last = self.words.get(self.next + 1);
            let ends = last.is_none_or(|word| is_keyword(word) || matches!(*word, ")" | ","));
            match hedge {
                Some(hedge) if !ends || hedge == Hedge::Any => hedges.push(hedge),
                _ => break,
            }
            self.next += 1;
            if hedge == Some(Hedge::Any) && ends {
                return Some((variable, hedges, None));
            }
        }
        let term = self.name("a term")?;
        Some((variable, hedges, Some(term)))
    }
}

fn is_keyword(word: &str) -> bool {
    ["if", "is", "and", "or", "then", "with", "(", ")", ","]
        .iter()
        .any(|keyword| keyword.eq_ignore_ascii_case(word))
}

fn joined(mut parts: Vec<Condition>, join: fn(Vec<Condition>) -> Condition) -> Condition {
    match parts.len() {
        1 => parts.remove(0),
        _ => join(parts),
    }
}

/// Writes a rule that [`read`] can parse. The hedges of a conclusion also apply to the conclusions after it, so
/// several rules with the same condition are written if a later conclusion does not have these hedges. `None` if a
/// NOT before brackets cannot be moved inside.
pub(crate) fn write(rule: &Rule, operators: Operators, and: &str) -> Option<Vec<String>> {
    let condition = conditions::without_not(&rule.condition, operators)?;
    let mut start = String::from("if ");
    push(&mut start, &condition, false);
    let weight = match rule.weight == 1.0 {
        true => String::new(),
        false => format!(" with {}", rule.weight),
    };
    let mut rules: Vec<String> = vec![];
    let mut before: Option<&[Hedge]> = None;
    for consequent in &rule.consequents {
        let Consequent {
            output,
            hedges,
            term,
        } = consequent;
        // fuzzylite passes the hedges of a conclusion on to the following ones.
        let own = before.and_then(|before| hedges.strip_suffix(before));
        let mut text = format!("{} is", output.text);
        push_term(&mut text, own.unwrap_or(hedges), Some(term));
        match rules.last_mut().filter(|_| own.is_some()) {
            Some(rule) => *rule += &format!("{and}{text}"),
            None => rules.push(format!("{start} then {text}")),
        }
        before = Some(hedges);
    }
    rules.iter_mut().for_each(|rule| *rule += &weight);
    Some(rules)
}

fn push_term(text: &mut String, hedges: &[Hedge], term: Option<&Name>) {
    let hedges = hedges.iter().map(|hedge| hedge.word().to_ascii_lowercase());
    for word in hedges.chain(term.map(|term| term.text.clone())) {
        text.push(' ');
        text.push_str(&word);
    }
}

fn push(text: &mut String, condition: &Condition, inside: bool) {
    let (parts, word) = match condition {
        Condition::And(parts) => (parts, " and "),
        Condition::Or(parts) => (parts, " or "),
        Condition::Not(_) => return,
        Condition::Is(proposition) => {
            text.push_str(&format!("{} is", proposition.variable.text));
            push_term(text, &proposition.hedges, proposition.term.as_ref());
            return;
        }
    };
    if inside {
        text.push('(');
    }
    for (index, part) in parts.iter().enumerate() {
        if index > 0 {
            text.push_str(word);
        }
        push(text, part, true);
    }
    if inside {
        text.push(')');
    }
}
