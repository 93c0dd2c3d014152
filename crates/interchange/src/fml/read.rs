//! Reads FML.

use fuzzy::{
    diagnostic::nearest,
    format::{Document, RuleSpans, VariableSpans},
    model::{Aggregation, Block, Defuzzifier, NoRuleFires, Output, Rule, Variable},
    rule::{self, Condition, Consequent, Hedge, Name, Proposition},
};
use quick_xml::events::Event;
use roxmltree::Node;

use super::term;
use crate::{
    Format, Losses, blocks,
    model_draft::{MAX_BLOCKS, MAX_VARIABLES, ModelDraft},
    words,
};

/// The namespace of the standard's schema.
pub(super) const NAMESPACE: &str = "http://www.ieee1855.org";

/// FML's hedges with the same meaning as those of a rule set.
pub(super) const HEDGES: [(&str, Hedge); 6] = [
    ("not", Hedge::Not),
    ("very", Hedge::Very),
    ("somewhat", Hedge::Somewhat),
    ("intensify", Hedge::Extremely),
    ("seldom", Hedge::Seldom),
    ("any", Hedge::Any),
];

pub(crate) fn read(text: &str, losses: Losses) -> Result<Document, fuzzy::Findings> {
    let mut draft = ModelDraft::new(text, losses);
    if let Some((part, message, help)) = too_large(text) {
        draft.error("too-large", part, message, help);
        return draft.finish();
    }
    let document = match roxmltree::Document::parse(text) {
        Ok(document) => document,
        Err(error) => {
            let at = error.pos();
            let line = text
                .lines()
                .nth(at.row.saturating_sub(1) as usize)
                .unwrap_or_default();
            let column = at.col.saturating_sub(1) as usize;
            let start = line
                .char_indices()
                .nth(column)
                .map_or(0, |(start, _)| start);
            let (before, rest) = line.split_at_checked(start).unwrap_or(("", line));
            let (message, help) = xml_mistake(&error, (before, rest));
            // The error for a text that ends too early has no position.
            let part = match error {
                roxmltree::Error::UnclosedRootNode => {
                    text.trim_end().lines().last().unwrap_or(line)
                }
                _ => rest.split_whitespace().next().unwrap_or(line),
            };
            draft.error("xml-syntax", part.trim(), message, &help);
            return draft.finish();
        }
    };
    let root = document.root_element();
    draft.model.name = attribute(root, "name").unwrap_or("unnamed").to_owned();
    let mut reader = Reader {
        // In the older form, `left` and `right` name the side of the slope; in the standard, they name the side on
        // which the degree is 1.
        right_is_high: root.tag_name().namespace() == Some(NAMESPACE),
        aggregations: vec![],
        blocks: vec![],
        draft,
    };
    for base in children(root, &["knowledgeBase"]) {
        reader.variables(base);
    }
    for base in root.children().filter(Node::is_element) {
        reader.rule_base(base);
    }
    blocks::aggregate(&mut reader.draft.model, &reader.aggregations);
    blocks::set_blocks(&mut reader.draft.model, reader.blocks);
    let help = "add a `fuzzyVariable` with `type=\"output\"` to the `knowledgeBase`";
    reader.draft.require_output(help);
    reader.draft.finish()
}

/// The message and the help for text that is not XML; `line` is the line before and after the position of the error.
fn xml_mistake(error: &roxmltree::Error, line: (&str, &str)) -> (String, String) {
    use roxmltree::Error;
    match error {
        Error::UnexpectedCloseTag(expected, found, _) => (
            format!("`<{expected}>` is not closed before `</{found}>`"),
            format!("write `</{expected}>` before it, or correct the spelling of the tag"),
        ),
        Error::UnclosedRootNode => (
            "the file ends before its first element is closed".into(),
            "it is cut off: look for the complete file".into(),
        ),
        Error::MalformedEntityReference(_) | Error::UnknownEntityReference(..) => (
            "`&` does not begin a reference here".into(),
            "write `&amp;` for the sign `&`".into(),
        ),
        Error::InvalidChar2("a quote", ..) | Error::InvalidAttributeValue(_) => {
            ("the value of an attribute is not in quotes".into(), {
                let name = line
                    .0
                    .trim_end_matches(['=', ' '])
                    .split_whitespace()
                    .next_back();
                let value = line.1.split([' ', '>', '/']).next().unwrap_or("value");
                format!("write `{}=\"{value}\"`", name.unwrap_or("name"))
            })
        }
        other => (
            format!("this is not valid XML: {other}"),
            "correct the XML at this line".into(),
        ),
    }
}

/// The maximum number of attributes of an element. The number is limited because each attribute is compared with the
/// others.
const MAX_ATTRIBUTES: usize = 1000;

/// The maximum number of namespace declarations. The number is limited because each element with a declaration
/// copies the declarations of all elements around it.
const MAX_NAMESPACES: usize = 100;

/// The maximum depth of nested elements.
const DEEPEST_ELEMENTS: usize = 256;

/// The position of the first element at which a document exceeds these limits, with the message and the help. The text
/// is examined before the XML library parses it.
fn too_large(text: &str) -> Option<(&str, String, &'static str)> {
    let mut reader = quick_xml::Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    let (mut namespaces, mut depth) = (0, 0_usize);
    loop {
        let start = usize::try_from(reader.buffer_position()).ok()?;
        // Invalid XML is reported by the parser afterwards.
        let (element, is_open) = match reader.read_event().ok()? {
            Event::Start(element) => (element, true),
            Event::Empty(element) => (element, false),
            Event::End(_) => {
                depth = depth.saturating_sub(1);
                continue;
            }
            Event::Eof => return None,
            _ => continue,
        };
        let mut attributes = 0;
        for attribute in element.attributes().with_checks(false) {
            attributes += 1;
            let is_namespace = |key: &[u8]| key == b"xmlns" || key.starts_with(b"xmlns:");
            namespaces += usize::from(attribute.is_ok_and(|one| is_namespace(one.key.as_ref())));
            if attributes > MAX_ATTRIBUTES {
                break;
            }
        }
        let (message, help) = if attributes > MAX_ATTRIBUTES {
            (
                format!("an element has more than {MAX_ATTRIBUTES} attributes"),
                "elements of FML have fewer than ten",
            )
        } else if namespaces > MAX_NAMESPACES {
            (
                format!("there are more than {MAX_NAMESPACES} declarations of namespaces"),
                "FML needs one, of its root element; remove the `xmlns` attributes of others",
            )
        } else if depth >= DEEPEST_ELEMENTS {
            (
                format!("elements are nested more than {DEEPEST_ELEMENTS} levels deep"),
                "elements of FML are nested about six deep",
            )
        } else {
            depth += usize::from(is_open);
            continue;
        };
        let part = text.get(start..)?.split_whitespace().next()?;
        return Some((part, message, help));
    }
}

struct Reader<'t> {
    draft: ModelDraft<'t>,
    right_is_high: bool,
    /// The aggregation of each output.
    aggregations: Vec<Option<Aggregation>>,
    blocks: Vec<Block>,
}

/// The value of an attribute; case is ignored.
pub(super) fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.attributes()
        .find(|attribute| attribute.name().eq_ignore_ascii_case(name))
        .map(|attribute| attribute.value())
}

/// The opening tag of an element in the text.
pub(super) fn tag<'t>(text: &'t str, node: Node<'_, '_>) -> &'t str {
    let element = text.get(node.range()).unwrap_or_default();
    element
        .find('>')
        .and_then(|end| element.get(..=end))
        .unwrap_or(element)
}

/// The child elements with any of the given names.
pub(super) fn children<'a, 'i>(
    node: Node<'a, 'i>,
    names: &'static [&'static str],
) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| {
        let name = child.tag_name().name();
        child.is_element() && names.iter().any(|known| known.eq_ignore_ascii_case(name))
    })
}

/// Returns the text of the first element with the given name.
fn text_of<'a>(node: Node<'a, '_>, name: &'static str) -> Option<&'a str> {
    node.children()
        .find(|child| child.tag_name().name().eq_ignore_ascii_case(name))
        .and_then(|child| child.text())
        .map(str::trim)
}

impl Reader<'_> {
    fn variables(&mut self, base: Node<'_, '_>) {
        let all = ["fuzzyVariable", "tskVariable", "tsukamotoVariable"];
        let is_output = |node: &Node<'_, '_>| {
            attribute(*node, "type").is_some_and(|word| word.eq_ignore_ascii_case("output"))
        };
        for node in children(base, &["fuzzyVariable"]).filter(|node| !is_output(node)) {
            if let Some((variable, spans)) = self.variable(node) {
                self.draft.model.inputs.push(variable);
                self.draft.spans.inputs.push(spans);
            }
        }
        for node in base.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "fuzzyVariable" if is_output(&node) => self.output(node),
                "tskVariable" => self.tsk(node),
                "tsukamotoVariable" => self.tsukamoto(node),
                "fuzzyVariable" => {}
                other => {
                    let message = format!("variables of the kind `{other}` cannot be read");
                    let help = match nearest(other, all) {
                        Some(near) if near != other => format!("did you mean `{near}`?"),
                        _ => format!("{} can", all.join(", ")),
                    };
                    let part = tag(self.draft.text, node);
                    self.draft.error("unknown-element", part, message, &help);
                }
            }
        }
    }

    /// The number in an attribute; `None` if the attribute is missing, or if it is not a number, which is reported as
    /// an error.
    fn number(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        let written = attribute(node, name)?;
        let number = crate::model_draft::number(written.trim());
        if number.is_none() {
            let message = format!("`{name}` is `{written}`, which is not a number");
            let part = tag(self.draft.text, node);
            self.draft
                .error("not-a-number", part, message, "write digits");
        }
        number
    }

    fn variable(&mut self, node: Node<'_, '_>) -> Option<(Variable, VariableSpans)> {
        let part = tag(self.draft.text, node);
        let Some(name) = attribute(node, "name") else {
            self.draft.error(
                "no-name",
                part,
                "the variable has no name".into(),
                "add `name=\"...\"`",
            );
            return None;
        };
        let ends = (
            self.number(node, "domainleft"),
            self.number(node, "domainright"),
        );
        let (Some(low), Some(high)) = ends else {
            let message = format!("the variable `{name}` has no range");
            let help = "add `domainleft` and `domainright`";
            self.draft.error("no-range", part, message, help);
            return None;
        };
        let count = self.draft.model.inputs.len() + self.draft.model.outputs.len();
        let part = tag(self.draft.text, node);
        if !self
            .draft
            .allows_another(count, 2 * MAX_VARIABLES, "inputs and outputs", part)
        {
            return None;
        }
        let mut variable = Variable::new(name, low, high);
        variable.unit = attribute(node, "scale")
            .filter(|scale| !scale.is_empty() && *scale != "null")
            .map(str::to_owned);
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(part);
        spans.range = spans.name.clone();
        for node in children(node, &["fuzzyTerm", "tsukamotoTerm"]) {
            if let Some((term, span)) =
                term::read(&mut self.draft, node, self.right_is_high, (low, high))
            {
                variable.terms.push(term);
                spans.terms.push(span);
            }
        }
        Some((variable, spans))
    }

    fn output(&mut self, node: Node<'_, '_>) {
        let Some((variable, spans)) = self.variable(node) else {
            return;
        };
        let mut output = Output::new(variable);
        if let Some(defuzzifier) = self.word(node, "defuzzifier", words::DEFUZZIFIERS) {
            output.defuzzifier = defuzzifier;
        }
        if let Some(value) = self.number(node, "defaultValue") {
            output.when_no_rule_fires = NoRuleFires::Value(value);
        }
        let aggregation = self.word(node, "accumulation", words::AGGREGATIONS);
        self.aggregations
            .push(Some(aggregation.unwrap_or_default()));
        self.draft.model.outputs.push(output);
        self.draft.spans.outputs.push(spans);
    }

    /// Reads an output whose terms are monotone sets.
    fn tsukamoto(&mut self, node: Node<'_, '_>) {
        let Some((variable, spans)) = self.variable(node) else {
            return;
        };
        let output = Output::new(variable).defuzzifier(Defuzzifier::Tsukamoto);
        self.computed(node, output, spans);
    }

    /// Adds an output that computes a value for each rule.
    fn computed(&mut self, node: Node<'_, '_>, mut output: Output, spans: VariableSpans) {
        if let Some(value) = self.number(node, "defaultValue") {
            output.when_no_rule_fires = NoRuleFires::Value(value);
        }
        self.aggregations.push(None);
        self.draft.model.outputs.push(output);
        self.draft.spans.outputs.push(spans);
    }

    /// Reads a Takagi-Sugeno output: its terms have a constant, then a coefficient for each input.
    fn tsk(&mut self, node: Node<'_, '_>) {
        let part = tag(self.draft.text, node);
        let count = self.draft.model.outputs.len();
        if !self
            .draft
            .allows_another(count, MAX_VARIABLES, "outputs", part)
        {
            return;
        }
        let name = attribute(node, "name").unwrap_or_default();
        let low = self.number(node, "domainleft").unwrap_or(0.0);
        let high = self.number(node, "domainright").unwrap_or(1.0);
        let mut output =
            Output::new(Variable::new(name, low, high)).defuzzifier(Defuzzifier::WeightedAverage);
        let mut spans = VariableSpans::default();
        spans.name = self.draft.span(part);
        spans.range = spans.name.clone();
        let inputs = self
            .draft
            .model
            .inputs
            .iter()
            .map(|input| input.name.clone());
        let inputs: Vec<String> = inputs.collect();
        for term in children(node, &["tskTerm"]) {
            if let Some((term, span)) = term::tsk(&mut self.draft, term, &inputs) {
                output.variable.terms.push(term);
                spans.terms.push(span);
            }
        }
        self.computed(node, output, spans);
    }

    fn word<T: Copy>(
        &mut self,
        node: Node<'_, '_>,
        key: &str,
        known: &'static words::Words<T>,
    ) -> Option<T> {
        let word = attribute(node, key)?;
        let part = tag(self.draft.text, node);
        self.draft
            .word(Format::Fml, known, &format!("`{key}`"), (word, part))
    }

    /// The operators of a rule base or a rule; defaults are those of the base.
    fn operators(&mut self, node: Node<'_, '_>, base: &Block) -> Block {
        let and = self.word(node, "andMethod", words::CONJUNCTIONS);
        let or = self.word(node, "orMethod", words::DISJUNCTIONS);
        let implication = self.word(node, "activationMethod", words::CONJUNCTIONS);
        Block {
            and: and.unwrap_or(base.and),
            or: or.unwrap_or(base.or),
            implication: implication.unwrap_or(base.implication),
            ..base.clone()
        }
    }

    fn rule_base(&mut self, base: Node<'_, '_>) {
        match base.tag_name().name() {
            "mamdaniRuleBase" | "ruleBase" | "tskRuleBase" | "tsukamotoRuleBase" => {}
            "knowledgeBase" => return,
            other => {
                let message = format!("`{other}` cannot be read");
                let help = "mamdaniRuleBase, tskRuleBase and tsukamotoRuleBase can be read";
                let part = tag(self.draft.text, base);
                self.draft.loss("unknown-element", part, message, help);
                return;
            }
        }
        let part = tag(self.draft.text, base);
        let count = self.blocks.len();
        if !self
            .draft
            .allows_another(count, MAX_BLOCKS, "rule blocks", part)
        {
            return;
        }
        let block = self.operators(
            base,
            &Block::new(attribute(base, "name").unwrap_or_default()),
        );
        for node in children(base, &["rule", "tskRule"]) {
            let Some(rule) = self.rule(node) else {
                continue;
            };
            let own = self.operators(node, &block);
            let joins = matches!(rule.condition, Condition::And(_) | Condition::Or(_));
            if own.implication != block.implication || joins && own != block {
                let part = tag(self.draft.text, node);
                let message = "the rule has operators of its own".into();
                let help = "give it a rule base of its own";
                self.draft.loss("own-operators", part, message, help);
            }
            let mut spans = RuleSpans::default();
            spans.whole = node.range();
            self.draft.spans.rules.push(spans);
            self.draft.model.rules.push(Rule {
                block: self.blocks.len(),
                ..Rule::from(rule)
            });
        }
        self.blocks.push(block);
    }

    fn rule(&mut self, node: Node<'_, '_>) -> Option<rule::Rule> {
        let part = tag(self.draft.text, node);
        let mut conditions = vec![];
        for clause in children(node, &["antecedent"]).flat_map(|a| children(a, &["clause"])) {
            conditions.push(Condition::Is(self.clause(clause)?));
        }
        let mut consequents = vec![];
        for consequent in children(node, &["consequent", "tskConsequent"]) {
            if let Some(other) = children(consequent, &["else", "tskElse"]).next() {
                let part = tag(self.draft.text, other);
                let message = "the rule has a second conclusion, for inputs that do not satisfy its condition".into();
                self.draft
                    .loss("else", part, message, "write a rule of its own");
            }
            // The older form has no `then` element around its clauses.
            let then = children(consequent, &["then", "tskThen"])
                .next()
                .unwrap_or(consequent);
            for clause in children(then, &["clause", "tskClause"]) {
                let Proposition {
                    variable,
                    hedges,
                    term,
                } = self.clause(clause)?;
                if let Some(hedge) = hedges.first() {
                    let message = format!("the hedge `{}` is in a conclusion", hedge.word());
                    let part = tag(self.draft.text, clause);
                    self.draft.loss(
                        "hedge-in-conclusion",
                        part,
                        message,
                        "add a term with this meaning to the output, and conclude that",
                    );
                }
                consequents.push(Consequent {
                    output: variable,
                    hedges: vec![],
                    term: term?,
                });
            }
        }
        if conditions.is_empty() || consequents.is_empty() {
            let message = "the rule has no antecedent or no consequent".into();
            self.draft
                .error("rule-syntax", part, message, "give it a clause in each");
            return None;
        }
        let or = attribute(node, "connector").is_some_and(|word| word.eq_ignore_ascii_case("or"));
        let condition = match (conditions.len(), or) {
            (1, _) => conditions.remove(0),
            (_, true) => Condition::Or(conditions),
            (_, false) => Condition::And(conditions),
        };
        let weight = self.number(node, "weight").unwrap_or(1.0);
        Some(rule::Rule {
            condition,
            consequents,
            weight,
        })
    }

    /// Reads `<clause modifier="very"><variable>food</variable><term>rancid</term></clause>`.
    fn clause(&mut self, node: Node<'_, '_>) -> Option<Proposition> {
        let part = tag(self.draft.text, node);
        let span = self.draft.span(part);
        let (Some(variable), Some(term)) = (text_of(node, "variable"), text_of(node, "term"))
        else {
            let message = "the clause names no variable or no term".into();
            self.draft.error(
                "rule-syntax",
                part,
                message,
                "add `<variable>` and `<term>`",
            );
            return None;
        };
        let mut hedges = vec![];
        if let Some(word) = attribute(node, "modifier").filter(|word| !word.is_empty()) {
            match HEDGES
                .iter()
                .find(|(known, _)| known.eq_ignore_ascii_case(word))
            {
                Some(&(_, hedge)) => hedges.push(hedge),
                None => {
                    let message = format!("the modifier `{word}` is not supported");
                    let known = HEDGES.map(|(word, _)| word).join(", ");
                    self.draft.loss(
                        "unknown-hedge",
                        part,
                        message,
                        &format!("known are {known}"),
                    );
                }
            }
        }
        let name = |text: &str| Name {
            text: text.to_owned(),
            span: span.clone(),
        };
        Some(Proposition {
            variable: name(variable),
            hedges,
            term: Some(name(term)),
        })
    }
}
