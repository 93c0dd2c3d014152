//! Writes FML according to the schema of IEEE 1855.

use fuzzy::{
    Findings, Model,
    model::{
        Activation, Defuzzifier, MembershipFunction, NoRuleFires, Operators, Output, Rule, Term,
        Variable,
    },
    rule::{Condition, Hedge, Proposition},
};
use quick_xml::{
    Writer,
    events::{BytesDecl, BytesText, Event},
};

use super::read::{HEDGES, NAMESPACE};
use crate::{
    Format, Losses, WriteResult,
    blocks::{self, Rules},
    conditions,
    names::{self, NameRules},
    text_draft::{TextDraft, named, one_line},
    words,
};

/// An element with attributes and content.
struct Element {
    name: &'static str,
    attributes: Vec<(String, String)>,
    content: Content,
}

enum Content {
    Elements(Vec<Element>),
    Text(String),
}

impl Element {
    fn new(name: &'static str) -> Self {
        Element {
            name,
            attributes: vec![],
            content: Content::Elements(vec![]),
        }
    }

    fn text(name: &'static str, text: impl Into<String>) -> Self {
        Element {
            content: Content::Text(text.into()),
            ..Element::new(name)
        }
    }

    fn with(mut self, key: impl Into<String>, value: impl ToString) -> Self {
        self.attributes.push((key.into(), value.to_string()));
        self
    }

    fn push(&mut self, child: Element) {
        if let Content::Elements(children) = &mut self.content {
            children.push(child);
        }
    }

    fn of(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        children.into_iter().for_each(|child| self.push(child));
        self
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> std::io::Result<()> {
        let attributes = self
            .attributes
            .iter()
            .map(|(key, value)| (key.as_str(), value.as_str()));
        let element = writer.create_element(self.name).with_attributes(attributes);
        match &self.content {
            Content::Text(text) => element.write_text_content(BytesText::new(text))?,
            Content::Elements(children) if children.is_empty() => element.write_empty()?,
            Content::Elements(children) => element.write_inner_content(|writer| {
                children.iter().try_for_each(|child| child.write(writer))
            })?,
        };
        Ok(())
    }
}

const NAMES: NameRules = NameRules {
    is_letter: words::is_printable,
    is_first: words::is_printable,
    keywords: &[],
};

pub(crate) fn write(model: &Model, losses: Losses) -> Result<WriteResult, Findings> {
    let mut draft = TextDraft::new(Format::Fml, losses, model);
    let model = &names::plain(model, &NAMES, &mut draft);
    let mut base = Element::new("knowledgeBase");
    for input in &model.inputs {
        base.push(variable(
            &mut draft,
            input,
            ["fuzzyVariable", "fuzzyTerm", "input"],
        ));
    }
    for output in &model.outputs {
        base.push(self::output(&mut draft, output, model));
    }
    let mut kinds = model.outputs.iter().map(RuleBaseKind::of);
    let kind = kinds.next().unwrap_or(RuleBaseKind::Mamdani);
    if kinds.any(|other| other != kind) {
        let message =
            "the outputs are of different kinds, and the file names only one kind for all of them"
                .into();
        let help = "write one rule set each for the Mamdani, Takagi-Sugeno and Tsukamoto outputs";
        draft.loss("two-kinds", message, help);
    }
    let enabled = blocks::of(model).into_iter().filter(|block| block.enabled);
    let bases: Vec<Element> = enabled
        .map(|block| rule_base(&mut draft, &block, kind))
        .collect();
    let root = Element::new("fuzzySystem")
        .with("xmlns", NAMESPACE)
        .with("name", one_line(&model.name))
        .of([base].into_iter().chain(bases));
    let mut writer = Writer::new_with_indent(vec![], b' ', 2);
    let declaration = Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None));
    let written = writer
        .write_event(declaration)
        .and_then(|()| root.write(&mut writer));
    match written.map(|()| String::from_utf8(writer.into_inner())) {
        Ok(Ok(text)) => draft.line(text),
        _ => draft.loss(
            "xml",
            "the XML cannot be written".into(),
            "report it as a bug",
        ),
    }
    draft.finish()
}

/// The kind of the outputs of a rule base.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RuleBaseKind {
    Mamdani,
    Tsk,
    Tsukamoto,
}

impl RuleBaseKind {
    fn of(output: &Output) -> RuleBaseKind {
        match output.defuzzifier {
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => RuleBaseKind::Tsk,
            Defuzzifier::Tsukamoto => RuleBaseKind::Tsukamoto,
            _ => RuleBaseKind::Mamdani,
        }
    }
}

/// A variable without its terms.
fn variable_element(name: &'static str, variable: &Variable, kind: &str) -> Element {
    Element::new(name)
        .with("name", &variable.name)
        .with(
            "scale",
            one_line(variable.unit.as_deref().unwrap_or_default()),
        )
        .with("domainleft", variable.low)
        .with("domainright", variable.high)
        .with("type", kind)
}

/// Writes a variable. `names` contains the name of its element, the name of the elements of its terms, and its type.
fn variable(draft: &mut TextDraft, variable: &Variable, names: [&'static str; 3]) -> Element {
    let mut element = variable_element(names[0], variable, names[2]);
    for term in &variable.terms {
        if let Some(mut shape) = shape(draft, term, variable) {
            if names[1] == "tsukamotoTerm" && shape.name == "pointSetShape" {
                shape.name = "pointSetMonotonicShape";
            }
            let element_of_term = Element::new(names[1])
                .with("name", &term.name)
                .with("complement", false);
            element.push(element_of_term.of([shape]));
        }
    }
    element
}

fn output(draft: &mut TextDraft, output: &Output, model: &Model) -> Element {
    let name = &output.variable.name;
    if output.samples.is_some() {
        let message = format!("the output `{name}` is sampled, which FML cannot express");
        draft.note("sampled", message, "each program samples in its own way");
    }
    let mut element = match RuleBaseKind::of(output) {
        RuleBaseKind::Tsk => {
            if output.defuzzifier == Defuzzifier::WeightedSum {
                let message = format!("the output `{name}` is a weighted sum");
                draft.loss(
                    "no-method",
                    message,
                    "FML supports only the weighted average",
                );
            }
            tsk(draft, output, model)
        }
        RuleBaseKind::Tsukamoto => {
            let names = ["tsukamotoVariable", "tsukamotoTerm", "output"];
            variable(draft, &output.variable, names).with("combination", "WA")
        }
        RuleBaseKind::Mamdani => {
            let names = ["fuzzyVariable", "fuzzyTerm", "output"];
            let element = variable(draft, &output.variable, names);
            let accumulation = draft.word(
                words::AGGREGATIONS,
                output.aggregation.unwrap_or(model.operators.aggregation),
                "the aggregation",
            );
            let defuzzifier =
                draft.word(words::DEFUZZIFIERS, output.defuzzifier, "the defuzzifier");
            element
                .with("accumulation", accumulation)
                .with("defuzzifier", defuzzifier)
        }
    };
    match output.when_no_rule_fires {
        NoRuleFires::Value(value) => element = element.with("defaultValue", value),
        NoRuleFires::Previous(_) => {
            let message = format!("`{name}` keeps its value where no rule fires");
            draft.loss(
                "no-rule-fires",
                message,
                "FML supports only a default value",
            );
        }
        NoRuleFires::Undefined | NoRuleFires::Error => {}
    }
    if output.clamp {
        let message = format!("`{name}` is clamped to its range");
        draft.loss("clamp", message, "FML does not clamp");
    }
    element
}

/// Writes a Takagi-Sugeno output: the constant of each term, then a coefficient for each input.
fn tsk(draft: &mut TextDraft, output: &Output, model: &Model) -> Element {
    let variable = &output.variable;
    let mut element = variable_element("tskVariable", variable, "output").with("combination", "WA");
    for term in &variable.terms {
        let (values, order) = match &term.membership_function {
            MembershipFunction::Linear {
                coefficients,
                constant,
            } => {
                let mut each = draft.coefficients(&term.name, coefficients, model);
                each.insert(0, *constant);
                (each, 1)
            }
            MembershipFunction::Constant { value }
            | MembershipFunction::Singleton { at: value } => (vec![*value], 0),
            _ => {
                let message = format!("the term {} is a formula", named(term, variable));
                let help = "FML has constants and linear functions";
                draft.refuse("no-shape", message, help);
                continue;
            }
        };
        let values = values
            .iter()
            .map(|value: &f64| Element::text("tskValue", value.to_string()));
        let term = Element::new("tskTerm")
            .with("name", &term.name)
            .with("order", order);
        element.push(term.of(values));
    }
    element
}

fn shape(draft: &mut TextDraft, term: &Term, variable: &Variable) -> Option<Element> {
    use MembershipFunction as Of;
    let numbered = |name: &'static str, parameters: &[f64]| {
        let with = |element: Element, (index, value): (usize, &f64)| {
            element.with(format!("param{}", index + 1), value)
        };
        Some(parameters.iter().enumerate().fold(Element::new(name), with))
    };
    let name = named(term, variable);
    if term.height != 1.0 {
        let message = format!("the term {name} has the height {}", term.height);
        draft.loss("height", message, "terms of FML have the height 1");
    }
    let (low, high) = (variable.low, variable.high);
    let shape = match term.membership_function {
        Of::Triangle { left, peak, right } => numbered("triangularShape", &[left, peak, right]),
        Of::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => numbered("trapezoidShape", &[left, left_top, right_top, right]),
        Of::Gaussian { mean, sd } => numbered("gaussianShape", &[mean, sd]),
        Of::Gaussian2 {
            left_mean,
            right_mean,
            left_sd,
            ..
        } if right_mean >= high => numbered("rightGaussianShape", &[left_mean, left_sd]),
        Of::Gaussian2 {
            left_mean,
            right_mean,
            right_sd,
            ..
        } if left_mean <= low => numbered("leftGaussianShape", &[right_mean, right_sd]),
        Of::RightShoulder { foot, top } => numbered("rightLinearShape", &[foot, top]),
        Of::LeftShoulder { top, foot } => numbered("leftLinearShape", &[top, foot]),
        Of::Rectangle { left, right } => numbered("rectangularShape", &[left, right]),
        Of::Singleton { at } => numbered("singletonShape", &[at]),
        Of::SShape { foot, top } => numbered("sShape", &[foot, top]),
        Of::ZShape { top, foot } => numbered("zShape", &[top, foot]),
        Of::PiShape {
            left,
            left_top,
            right_top,
            right,
        } if left_top == right_top && right - right_top == left_top - left => {
            numbered("piShape", &[left, left_top])
        }
        Of::Piecewise { ref points } => {
            let points = points
                .iter()
                .map(|(x, y)| Element::new("point").with("x", x).with("y", y));
            Some(
                Element::new("pointSetShape")
                    .with("interpolationMethod", "linear")
                    .of(points),
            )
        }
        _ => None,
    };
    if shape.is_none() {
        let message = format!("the term {name} has a shape that FML does not support");
        draft.refuse("no-shape", message, "write it as points: `piecewise`");
    }
    shape
}

fn rule_base(draft: &mut TextDraft, block: &Rules<'_>, outputs: RuleBaseKind) -> Element {
    let operators = block.operators;
    if block.activation != Activation::General {
        let message = format!(
            "the activation method of `{}` selects the rules that fire",
            block.name
        );
        draft.loss("activation", message, "FML has no activation methods");
    }
    let [and, or, implication] = draft.operators(operators);
    let name = match outputs {
        RuleBaseKind::Mamdani => "mamdaniRuleBase",
        RuleBaseKind::Tsk => "tskRuleBase",
        RuleBaseKind::Tsukamoto => "tsukamotoRuleBase",
    };
    let mut base = Element::new(name)
        .with("name", one_line(block.name))
        .with("activationMethod", implication)
        .with("andMethod", and)
        .with("orMethod", or);
    for (number, rule) in &block.rules {
        match self::rule(rule, *number, operators, outputs) {
            Ok(element) => base.push(element.with("andMethod", and).with("orMethod", or)),
            Err(what) => {
                let help = "a rule of FML joins its clauses either all by AND or all by OR";
                draft.leave_out(*number, what, help);
            }
        }
    }
    base
}

fn rule(
    rule: &Rule,
    number: usize,
    operators: Operators,
    outputs: RuleBaseKind,
) -> Result<Element, &'static str> {
    let rule = &rule.rule;
    let condition = conditions::without_not(&rule.condition, operators);
    let condition = condition.ok_or("has a NOT before brackets")?;
    let (parts, connector) = match &condition {
        Condition::And(parts) => (parts.as_slice(), "and"),
        Condition::Or(parts) => (parts.as_slice(), "or"),
        one => (std::slice::from_ref(one), "and"),
    };
    let mut antecedent = Element::new("antecedent");
    for part in parts {
        let Condition::Is(proposition) = part else {
            return Err("joins AND and OR");
        };
        antecedent.push(clause(proposition)?);
    }
    if rule
        .consequents
        .iter()
        .any(|consequent| !consequent.hedges.is_empty())
    {
        return Err("has a hedge in its conclusion");
    }
    let names = match outputs {
        RuleBaseKind::Tsk => ["tskRule", "tskConsequent", "tskThen", "tskClause"],
        RuleBaseKind::Mamdani | RuleBaseKind::Tsukamoto => ["rule", "consequent", "then", "clause"],
    };
    let then = Element::new(names[2]).of(rule.consequents.iter().map(|consequent| {
        Element::new(names[3]).of([
            Element::text("variable", &consequent.output.text),
            Element::text("term", &consequent.term.text),
        ])
    }));
    Ok(Element::new(names[0])
        .with("name", format!("rule{number}"))
        .with("connector", connector)
        .with("weight", rule.weight)
        .of([antecedent, Element::new(names[1]).of([then])]))
}

fn clause(proposition: &Proposition) -> Result<Element, &'static str> {
    let term = proposition.term.as_ref().ok_or("names no term")?;
    let clause = Element::new("clause");
    let clause = match proposition.hedges[..] {
        [] => clause,
        [hedge] => {
            let word = HEDGES
                .iter()
                .find(|(_, known): &&(_, Hedge)| *known == hedge);
            clause.with(
                "modifier",
                word.ok_or("has a hedge that FML does not support")?.0,
            )
        }
        _ => return Err("has two hedges before a term"),
    };
    Ok(clause.of([
        Element::text("variable", &proposition.variable.text),
        Element::text("term", &term.text),
    ]))
}
