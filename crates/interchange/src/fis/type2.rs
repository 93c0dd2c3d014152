//! Interval type-2 systems in the form of the IT2-FLS toolbox for MATLAB (Taskin and Kumbasar: An open source
//! Matlab/Simulink toolbox for interval type-2 fuzzy logic systems, IEEE SSCI 2015): `.t2fis` files.
//!
//! Each term of an input is a pair of lines with the upper and the lower membership function, whose last parameter is
//! the height:
//!
//! ```text
//! MF1U='lowU':'trimf',[-1.8 -1 0 1]
//! MF1L='lowL':'trimf',[-1.6 -1 0 0.3]
//! ```
//!
//! The parameters of output terms are repeated, since the toolbox supports intervals of numbers:
//! `MF1='slow':'constant',[2 2]`. The toolbox has one output, always multiplies the degrees of a rule, and ignores weights.

use fuzzy::{
    format::TermSpans,
    model::{
        Conjunction, Defuzzifier, LowerFunction, MembershipFunction, Model, Rule, Term,
        TypeReduction, Variable,
    },
    rule::{Condition, Hedge},
};

use super::{
    read::unquoted,
    term::{self, ParameterForm},
};
use crate::{model_draft::ModelDraft, text_draft::TextDraft};

/// The words of the toolbox for methods of type reduction. The first six algorithms all give the exact interval.
const METHODS: [(&str, TypeReduction); 9] = [
    ("KM", TypeReduction::Exact),
    ("Karnik-Mendel", TypeReduction::Exact),
    ("EKM", TypeReduction::Exact),
    ("IASC", TypeReduction::Exact),
    ("EIASC", TypeReduction::Exact),
    ("EODS", TypeReduction::Exact),
    ("NT", TypeReduction::NieTan),
    ("BMM(0.5,0.5)", TypeReduction::BegianMelekMendel),
    ("WM", TypeReduction::WuMendel),
];

/// The shapes that the toolbox evaluates.
const SHAPES: [&str; 11] = [
    "gaussmf", "gauss2mf", "gbellmf", "trimf", "trapmf", "sigmf", "dsigmf", "psigmf", "pimf",
    "smf", "zmf",
];

const WU_MENDEL: &str = "the toolbox computes the right end of `WM` from the smaller instead of the larger centroid, so its values differ from those of the paper";

/// Returns the number of a term and the letter of its membership function: `(2, 'U')` for the key `MF2U`.
pub(super) fn bound(key: &str) -> Option<(usize, char)> {
    let key = key.to_ascii_uppercase();
    let letter = key.chars().last().filter(|c| matches!(c, 'U' | 'L'))?;
    let number = key.strip_prefix("MF")?.strip_suffix(letter)?;
    Some((number.parse().ok()?, letter))
}

/// Reads the term of an input from its upper and its lower membership function.
pub(super) fn term(
    draft: &mut ModelDraft<'_>,
    upper: &str,
    lower: &str,
) -> Option<(Term, TermSpans)> {
    let upper = term::read(draft, upper, &[], ParameterForm::WithHeight);
    let lower = term::read(draft, lower, &[], ParameterForm::WithHeight);
    let ((mut term, mut spans), (lower, lower_spans)) = (upper?, lower?);
    let stem = |name: &str, letters: [char; 2]| name.strip_suffix(letters).map(str::to_owned);
    if let Some(name) = stem(&term.name, ['U', 'u'])
        && !name.is_empty()
        && stem(&lower.name, ['L', 'l']).as_ref() == Some(&name)
    {
        term.name = name;
    }
    let lower = LowerFunction {
        membership_function: lower.membership_function,
        height: lower.height,
    };
    if lower.membership_function != term.membership_function || lower.height != term.height {
        spans.lower = Some(lower_spans.into());
        term.lower = Some(lower);
    }
    Some((term, spans))
}

/// Reads the settings of a type-2 system into the model, whose outputs have been read. `written` is the method of type
/// reduction, `and` the word for AND.
pub(super) fn settings(draft: &mut ModelDraft<'_>, written: Option<&str>, and: Option<&str>) {
    if draft.model.operators.and != Conjunction::Product {
        let part = and.unwrap_or_default();
        let message = format!("`AndMethod={part}` has no effect in a type-2 system");
        let help = "the IT2-FLS toolbox multiplies, and so does this rule set";
        draft.note("no-effect", part, message, help);
        draft.model.operators.and = Conjunction::Product;
    }
    let Some(written) = written else {
        return;
    };
    let word = unquoted(written);
    let compact: String = word.chars().filter(|c| !c.is_whitespace()).collect();
    let known = METHODS
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(&compact));
    let method = match known {
        Some((_, method)) => *method,
        None if compact.eq_ignore_ascii_case("BMM") => TypeReduction::BegianMelekMendel,
        None if compact
            .get(..3)
            .is_some_and(|it| it.eq_ignore_ascii_case("BMM")) =>
        {
            let message = format!("`{word}` weights both centroids differently");
            let help = "write `BMM(0.5,0.5)`: a rule set supports only the mean of both centroids";
            draft.loss("type-reduction", written, message, help);
            TypeReduction::BegianMelekMendel
        }
        None => {
            let known = METHODS.map(|(known, _)| known).join(", ");
            let message = format!("unknown `TypeRedMethod` `{word}`");
            draft.error(
                "unknown-word",
                written,
                message,
                &format!("known are {known}"),
            );
            return;
        }
    };
    if method == TypeReduction::WuMendel {
        let message = "the method `WM` of the toolbox is not that of Wu and Mendel".into();
        let help = format!("choose another method, such as `KM`: {WU_MENDEL}");
        draft.loss("type-reduction", written, message, &help);
    }
    // A file whose pairs are all equal has no type-2 terms, and therefore no type reduction.
    if draft.model.has_type2_terms() {
        for output in &mut draft.model.outputs {
            output.type_reduction = method;
        }
    }
}

/// Reports a part of a rule that the toolbox evaluates differently.
pub(super) fn check_rule(draft: &mut ModelDraft<'_>, line: &str) {
    let rules = &draft.model.rules;
    let Some(what) = rules.last().and_then(|rule| unsupported(rule, None)) else {
        return;
    };
    let message = format!("the rule {what}");
    let help =
        "write the rule without it, or keep the rule set in YAML, where it has its usual meaning";
    draft.loss("rule", line, message, help);
}

/// Describes the part of a rule that the toolbox evaluates differently. `inputs` is the number of inputs that the rule must
/// read, if it is written for the toolbox.
pub(super) fn unsupported(rule: &Rule, inputs: Option<usize>) -> Option<&'static str> {
    let is_plain = |condition: &Condition| match condition {
        Condition::Is(proposition) => proposition.hedges.is_empty(),
        _ => false,
    };
    let omits = |read: usize| {
        let has_all = inputs.is_none_or(|inputs| read >= inputs);
        (!has_all).then_some("omits an input, which the IT2-FLS toolbox does not support")
    };
    match &rule.rule.condition {
        _ if rule.rule.weight != 1.0 => Some("has a weight, which the IT2-FLS toolbox ignores"),
        Condition::Or(_) => Some("has an OR, which the IT2-FLS toolbox ignores"),
        Condition::And(parts) if parts.iter().all(is_plain) => omits(parts.len()),
        one if is_plain(one) => omits(1),
        Condition::Is(proposition) if proposition.hedges != [Hedge::Not] => {
            Some("has a hedge, which the IT2-FLS toolbox does not support")
        }
        _ => Some("has a NOT or a hedge, which the IT2-FLS toolbox does not support"),
    }
}

/// Reports the parts of a model with type-2 terms that a `.t2fis` file cannot express, and returns the word for the
/// method of type reduction.
pub(super) fn method(draft: &mut TextDraft, model: &Model) -> &'static str {
    let mut outputs = model.outputs.iter();
    if let Some(output) = outputs.find(|output| output.defuzzifier != Defuzzifier::WeightedAverage)
    {
        let message = format!(
            "the output `{}` is not a weighted average of numbers, but the rule set has type-2 terms",
            output.variable.name
        );
        let help =
            "type-2 systems in FIS are those of the IT2-FLS toolbox, which has only Sugeno systems";
        draft.refuse("type-2-terms", message, help);
    }
    if model.outputs.len() > 1 {
        let message = format!(
            "the rule set has {} outputs and type-2 terms",
            model.outputs.len()
        );
        let help = "the IT2-FLS toolbox evaluates one output: write a rule set for each";
        draft.refuse("type-2-terms", message, help);
    }
    let joins = |rule: &Rule| matches!(rule.rule.condition, Condition::And(_));
    if model.operators.and != Conjunction::Product && model.rules.iter().any(joins) {
        let message = "the rules do not join their conditions by `and: product`".into();
        draft.loss(
            "no-word",
            message,
            "the IT2-FLS toolbox multiplies in all type-2 systems",
        );
    }
    let method = model.outputs.first().map(|output| output.type_reduction);
    if method == Some(TypeReduction::WuMendel) {
        let message = "the IT2-FLS toolbox does not compute `type_reduction: wu_mendel`".into();
        draft.loss("type-reduction", message, WU_MENDEL);
    }
    let word = METHODS.iter().find(|(_, known)| method == Some(*known));
    word.map_or("KM", |(word, _)| word)
}

/// Returns the two terms that a pair of lines contains.
pub(super) fn pair(term: &Term) -> [(char, Term); 2] {
    let upper = Term {
        lower: None,
        ..term.clone()
    };
    let lower = match &term.lower {
        None => upper.clone(),
        Some(lower) => Term {
            membership_function: lower.membership_function.clone(),
            height: lower.height,
            ..upper.clone()
        },
    };
    [('U', upper), ('L', lower)]
}

/// Reports a shape that the toolbox does not evaluate.
pub(super) fn check_shape(draft: &mut TextDraft, shape: &str, term: &Term, variable: &Variable) {
    if !SHAPES.contains(&shape) {
        let message = format!(
            "the IT2-FLS toolbox has no shape `{shape}`, of the term `{}` of `{}`",
            term.name, variable.name
        );
        let known = SHAPES.join(", ");
        draft.refuse("no-shape", message, &format!("it has {known}"));
    }
}

/// Returns whether a term is the number of a weighted output.
pub(super) fn is_number(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Constant { .. } | MembershipFunction::Linear { .. }
    )
}
