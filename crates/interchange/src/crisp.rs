//! Crisp limits: converts `steps` to rectangles of other programs, and back.

use fuzzy::{
    Diagnostic, Findings, Model,
    format::Document,
    model::{MembershipFunction, Term, Variable},
};

/// Notes about the variables whose steps are written as rectangles.
pub(crate) fn written(model: &Model) -> Vec<Diagnostic> {
    let noted = model.variables().filter_map(|variable| {
        let first = *variable.step_limits()?.first()?;
        let message = format!("the steps of `{}` are written as rectangles", variable.name);
        let help = format!(
            "a limit belongs to the term above it, so that the rectangle below {first} ends at {}, the next smaller number",
            first.next_down()
        );
        Some(Diagnostic::note("steps", 0..0, message).help(help))
    });
    noted.collect()
}

/// Converts rectangles back to steps, with notes about neighbouring rectangles that share a limit.
pub(crate) fn read(mut document: Document, text: &str) -> Document {
    let outputs = &mut document.model.outputs;
    let outputs = outputs.iter_mut().map(|output| &mut output.variable);
    let variables = document.model.inputs.iter_mut().chain(outputs);
    let spans = document.spans.inputs.iter().chain(&document.spans.outputs);
    let mut notes = Vec::new();
    for (variable, spans) in variables.zip(spans) {
        let Some(terms) = rectangles(variable) else {
            continue;
        };
        let crisp = Variable {
            terms,
            ..variable.clone()
        };
        if crisp.step_limits().is_some() {
            *variable = crisp;
        } else if let Some(mut note) = shared(&crisp) {
            note.span = spans.name.clone();
            notes.push(note);
        }
    }
    if !notes.is_empty() {
        notes.splice(0..0, std::mem::take(&mut document.warnings.0));
        document.warnings = Findings::locate(notes, text);
    }
    document
}

/// The terms of a variable as rectangles, if all of them have vertical sides.
fn rectangles(variable: &Variable) -> Option<Vec<Term>> {
    let rectangle = |term: &Term| {
        let corners = term.membership_function.corners()?;
        let [(left, 0.0), (left_top, 1.0), (right_top, 1.0), (right, 0.0)] = *corners.as_slice()
        else {
            return None;
        };
        let is_vertical = left == left_top && right_top == right && term.height == 1.0;
        is_vertical.then(|| Term {
            membership_function: MembershipFunction::Rectangle { left, right },
            ..term.clone()
        })
    };
    variable.terms.iter().map(rectangle).collect()
}

/// A note about the first two terms that both contain their shared limit.
fn shared(variable: &Variable) -> Option<Diagnostic> {
    let sides = |term: &Term| match term.membership_function {
        MembershipFunction::Rectangle { left, right } => Some((left, right)),
        _ => None,
    };
    let mut pairs = variable.terms.windows(2);
    pairs.find_map(|pair| {
        let [first, second] = pair else { return None };
        let (limit, left) = (sides(first)?.1, sides(second)?.0);
        let (first, second, name) = (&first.name, &second.name, &variable.name);
        let message = format!("`{first}` and `{second}` of `{name}` both contain {limit}");
        let help = format!(
            "for limits that belong to the term above them, write `steps: {{{first}: {limit}, ...}}` in place of `terms`"
        );
        (limit == left).then(|| Diagnostic::note("shared-limit", 0..0, message).help(help))
    })
}
