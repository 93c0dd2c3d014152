//! What fuzzylite does without a word in the file, whatever the format.

use fuzzy::{
    format::{TermSpans, VariableSpans},
    model::{Defuzzifier, NoRuleFires, Output, Term, Variable},
};

use crate::{draft::Draft, shapes};

/// A weighted average over fuzzy sets is Tsukamoto's: fuzzylite tells the kind from the terms.
pub(crate) fn tsukamoto(output: &mut Output) {
    if output.defuzzifier == Defuzzifier::WeightedAverage
        && !output.variable.terms.iter().any(shapes::is_computed)
    {
        output.defuzzifier = Defuzzifier::Tsukamoto;
    }
}

/// Where no rule fires, a defuzzifier of maxima gives the middle or an end of the range. `part` names the output in the text.
pub(crate) fn unfired(draft: &mut Draft<'_>, output: &mut Output, part: &str) {
    let (low, high) = (output.variable.low, output.variable.high);
    let value = match output.defuzzifier {
        Defuzzifier::SmallestOfMaxima => low,
        Defuzzifier::MeanOfMaxima => 0.5 * (low + high),
        Defuzzifier::LargestOfMaxima => high,
        _ => return,
    };
    if output.when_no_rule_fires != NoRuleFires::Undefined {
        return;
    }
    output.when_no_rule_fires = NoRuleFires::Value(value);
    let name = &output.variable.name;
    let message = format!("where no rule fires, fuzzylite gives `{name}` the value {value}");
    let help = "take `when_no_rule_fires` out of the rule set to leave it undefined";
    draft.note("no-rule-fires", part, message, help);
}

/// Adds a term to a variable, unless it has one of that name: rules find the first one.
pub(crate) fn add(
    draft: &mut Draft<'_>,
    (variable, spans): (&mut Variable, &mut VariableSpans),
    (term, span): (Term, TermSpans),
    part: &str,
) {
    if variable.terms.iter().any(|known| known.name == term.name) {
        let message = format!("`{}` has a term `{}` before", variable.name, term.name);
        let help = "no rule finds this one, and it is left out";
        draft.note("never-used", part, message, help);
        return;
    }
    variable.terms.push(term);
    spans.terms.push(span);
}
