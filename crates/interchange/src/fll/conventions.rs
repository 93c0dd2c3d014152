//! Implicit conventions of fuzzylite, which apply to FLL and to fuzzylite's dialect of FCL.

use fuzzy::{
    format::{TermSpans, VariableSpans},
    model::{Defuzzifier, Output, Term, Variable},
};

use crate::{model_draft::ModelDraft, shapes};

/// Replaces the weighted average by the Tsukamoto defuzzifier if all terms are fuzzy sets, because fuzzylite derives
/// the defuzzifier from the terms.
pub(crate) fn tsukamoto(output: &mut Output) {
    if output.defuzzifier == Defuzzifier::WeightedAverage
        && !output.variable.terms.iter().any(shapes::is_computed)
    {
        output.defuzzifier = Defuzzifier::Tsukamoto;
    }
}

/// Adds a term to a variable, unless the variable has a term with that name: rules refer to the first one.
pub(crate) fn add(
    draft: &mut ModelDraft<'_>,
    (variable, spans): (&mut Variable, &mut VariableSpans),
    (term, span): (Term, TermSpans),
    part: &str,
) {
    if !draft.allows_another_term(variable, part) {
        return;
    }
    if variable.terms.iter().any(|known| known.name == term.name) {
        let message = format!("`{}` already has a term `{}`", variable.name, term.name);
        let help = "rules refer to the first one; this one is left out";
        draft.note("never-used", part, message, help);
        return;
    }
    variable.terms.push(term);
    spans.terms.push(span);
}
