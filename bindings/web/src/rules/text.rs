//! An open text: findings, completion, names, layout, terms and the handles for dragging them.

use flagred::{loaded, profile::Profile};
use flagred_authoring::{Document, Edit, completion, handles, layout, names, slice};
use fuzzy::{
    diagnostic::{Diagnostic, Severity},
    model::{Defuzzifier, MembershipFunction, Variable},
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::{json, set::RuleSet};
use crate::failure::failure;

/// The number of points of a curve.
const SAMPLES: usize = 200;

/// A document, with the shipped rule set that a profile names.
pub(super) fn document(text: &str) -> Document {
    Document::new(text, shipped_rules)
}

fn shipped_rules(profile: &Profile) -> Option<String> {
    let found = loaded::rules(profile, None, |_| Err(())).ok();
    found.map(|(_, text)| text)
}

/// A rule set or a profile in an editor. Offsets are in UTF-16 code units, as in JavaScript strings.
#[wasm_bindgen(js_name = RuleText)]
pub struct RuleText {
    pub(super) document: Document,
}

#[wasm_bindgen(js_class = RuleText)]
impl RuleText {
    /// Reads a text, which may contain errors.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str) -> RuleText {
        RuleText {
            document: document(text),
        }
    }

    /// Whether the text is a profile.
    #[wasm_bindgen(getter, js_name = isProfile)]
    pub fn is_profile(&self) -> bool {
        self.document.is_profile()
    }

    /// The rule set, or the profile with its rule set, compiled.
    #[wasm_bindgen(js_name = ruleSet)]
    pub fn rule_set(&self) -> Result<RuleSet, JsError> {
        RuleSet::of(&self.document)
    }

    /// The findings of `flagred check`, as a JSON array.
    pub fn findings(&self) -> Result<String, JsError> {
        let text = self.document.text();
        let found = |finding| Found::new(text, finding);
        json(
            &self
                .document
                .findings()
                .0
                .iter()
                .map(found)
                .collect::<Vec<_>>(),
        )
    }

    /// The completions at an offset, as a JSON array.
    pub fn completions(&self, at: usize) -> Result<String, JsError> {
        let found = completion::at(&self.document, byte(self.document.text(), at));
        let found = found.into_iter().map(|found| Completion {
            kind: match found.kind {
                completion::Kind::Keyword => "keyword",
                completion::Kind::Variable => "variable",
                completion::Kind::Choice => "choice",
                completion::Kind::Key => "key",
                completion::Kind::Signal => "signal",
            },
            label: found.label,
            text: found.text,
            detail: found.detail,
        });
        json(&found.collect::<Vec<_>>())
    }

    /// The meaning of the name at an offset, as JSON with Markdown; `null` if there is no name.
    pub fn hover(&self, at: usize) -> Result<String, JsError> {
        let text = self.document.text();
        let meant = names::describe(&self.document, byte(text, at));
        json(&meant.map(|meant| Hover {
            from: utf16(text, meant.span.start),
            to: utf16(text, meant.span.end),
            markdown: meant.markdown,
        }))
    }

    /// The offset at which the name at `at` is defined; nothing if there is no name.
    pub fn definition(&self, at: usize) -> Option<usize> {
        let text = self.document.text();
        let span = names::definition(&self.document, byte(text, at))?;
        Some(utf16(text, span.start))
    }

    /// The edits that rename the name at an offset, as JSON.
    pub fn rename(&self, at: usize, name: &str) -> Result<String, JsError> {
        let text = self.document.text();
        let spans = names::rename(&self.document, byte(text, at), name);
        let spans = spans.map_err(|why| failure(why, None))?;
        let edit = |span| Edit {
            span,
            text: name.into(),
        };
        edits(text, spans.into_iter().map(edit).collect())
    }

    /// The text as formatted by `flagred fmt`.
    pub fn formatted(&self) -> Result<String, JsError> {
        layout::formatted(self.document.text()).map_err(|why| failure(why, None))
    }

    /// The variables and their terms as curves, with the handles for dragging them, as a JSON array with inputs first.
    /// Empty if nothing can be read.
    pub fn variables(&self) -> Result<String, JsError> {
        let Some(model) = self.document.model() else {
            return Ok("[]".into());
        };
        let takes_numbers = |kind| {
            use Defuzzifier::{WeightedAverage, WeightedSum};
            matches!(kind, WeightedAverage | WeightedSum)
        };
        let inputs = model.inputs.iter().map(|input| (input, None));
        let outputs = model.outputs.iter();
        let outputs =
            outputs.map(|output| (&output.variable, Some(takes_numbers(output.defuzzifier))));
        let drawn = inputs.chain(outputs).enumerate();
        let drawn = drawn
            .map(|(i, (variable, output))| DrawnVariable::new(&self.document, i, variable, output));
        json(&drawn.collect::<Vec<_>>())
    }

    /// The edits that move a handle of a term to a position and a degree, as JSON; they change only numbers.
    pub fn drag(
        &self,
        variable: usize,
        term: usize,
        handle: usize,
        x: f64,
        degree: f64,
    ) -> Result<String, JsError> {
        let moved = handles::moved(&self.document, (variable, term), handle, (x, degree));
        let moved = moved.map_err(|why| failure(why, None))?;
        edits(self.document.text(), moved)
    }
}

#[derive(Serialize)]
struct Found<'a> {
    severity: Severity,
    code: &'a str,
    message: &'a str,
    help: Option<&'a str>,
    from: usize,
    to: usize,
    line: usize,
    related: Vec<Related<'a>>,
}

#[derive(Serialize)]
struct Related<'a> {
    from: usize,
    to: usize,
    message: &'a str,
}

impl<'a> Found<'a> {
    fn new(text: &str, finding: &'a Diagnostic) -> Found<'a> {
        let related = finding.related.iter().map(|related| Related {
            from: utf16(text, related.span.start),
            to: utf16(text, related.span.end),
            message: &related.message,
        });
        Found {
            severity: finding.severity,
            code: finding.code,
            message: &finding.message,
            help: finding.help.as_deref(),
            from: utf16(text, finding.span.start),
            to: utf16(text, finding.span.end.max(finding.span.start)),
            line: finding.position.map_or(1, |position| position.line),
            related: related.collect(),
        }
    }
}

#[derive(Serialize)]
struct Completion {
    label: String,
    text: String,
    kind: &'static str,
    detail: Option<String>,
}

#[derive(Serialize)]
struct Hover {
    from: usize,
    to: usize,
    markdown: String,
}

#[derive(Serialize)]
struct Change {
    from: usize,
    to: usize,
    insert: String,
}

pub(super) fn edits(text: &str, edits: Vec<Edit>) -> Result<String, JsError> {
    let change = |edit: Edit| Change {
        from: utf16(text, edit.span.start),
        to: utf16(text, edit.span.end),
        insert: edit.text,
    };
    json(&edits.into_iter().map(change).collect::<Vec<_>>())
}

/// A variable to draw.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct DrawnVariable<'a> {
    name: &'a str,
    description: Option<&'a str>,
    unit: Option<&'a str>,
    is_output: bool,
    low: Option<f64>,
    high: Option<f64>,
    /// The part of the range to show: the whole range, or only the part in which the terms' degrees change, with a
    /// margin, if that part is small.
    shown: [Option<f64>; 2],
    terms: Vec<DrawnTerm<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct DrawnTerm<'a> {
    name: &'a str,
    /// The shape in the syntax of rule sets: `triangle: [0, 2, 4]`.
    shape: String,
    /// The curve as alternating x and degree; empty for a number, which is not a fuzzy set.
    curve: Vec<f64>,
    /// The curve of the lower membership function of an interval type-2 term; otherwise empty.
    lower: Vec<f64>,
    handles: Vec<Handle>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Handle {
    name: &'static str,
    x: f64,
    degree: f64,
    low: f64,
    high: f64,
    moves_degree: bool,
}

impl<'a> DrawnVariable<'a> {
    /// Creates a variable to draw. `output` is `None` for an input; for an output, it is whether the terms are
    /// numbers.
    fn new(
        document: &Document,
        index: usize,
        variable: &'a Variable,
        output: Option<bool>,
    ) -> Self {
        let number = |value: f64| value.is_finite().then_some(value);
        let has_range = variable.low < variable.high && (variable.high - variable.low).is_finite();
        let shown = has_range.then(|| slice::shown(variable));
        let terms = variable.terms.iter().enumerate().map(|(t, term)| {
            let handles = handles::of(document, index, t).into_iter();
            let handles = handles.map(|handle| Handle {
                name: handle.name,
                x: handle.x,
                degree: handle.degree,
                low: handle.low,
                high: handle.high,
                moves_degree: handle.moves_degree,
            });
            let is_set = output != Some(true) && has_range;
            let drawn = |shape, height| match is_set {
                true => curve(variable, shape, height),
                false => Vec::new(),
            };
            let upper = &term.membership_function;
            let lower = term.lower.iter();
            let lower = lower.flat_map(|lower| drawn(&lower.membership_function, lower.height));
            DrawnTerm {
                name: &term.name,
                shape: fuzzy::format::shape_text(upper),
                curve: drawn(upper, term.height),
                lower: lower.collect(),
                handles: handles.collect(),
            }
        });
        DrawnVariable {
            name: &variable.name,
            description: variable.description.as_deref(),
            unit: variable.unit.as_deref(),
            is_output: output.is_some(),
            low: number(variable.low),
            high: number(variable.high),
            shown: [shown.map(|s| s.low), shown.map(|s| s.high)],
            terms: terms.collect(),
        }
    }
}

/// The curve of a membership function over the range of a variable; only the corners if the function is piecewise linear.
fn curve(variable: &Variable, shape: &MembershipFunction, height: f64) -> Vec<f64> {
    let (low, high) = (variable.low, variable.high);
    let at = |x: f64| [x, height * shape.membership(x)];
    if let Some(corners) = shape.corners() {
        let within = corners.into_iter().filter(|(x, _)| *x > low && *x < high);
        let within = within.flat_map(|(x, degree)| [x, degree * height]);
        return at(low).into_iter().chain(within).chain(at(high)).collect();
    }
    let scale = fuzzy::drawing::Scale::new(low, high);
    let share = |i: usize| i as f64 / (SAMPLES - 1) as f64;
    (0..SAMPLES)
        .flat_map(|i| at(scale.value(share(i))))
        .collect()
}

/// Converts an offset in bytes to UTF-16 code units.
pub(super) fn utf16(text: &str, byte: usize) -> usize {
    let before = text.char_indices().take_while(|(at, _)| *at < byte);
    before.map(|(_, letter)| letter.len_utf16()).sum()
}

/// Converts an offset in UTF-16 code units to bytes.
fn byte(text: &str, utf16: usize) -> usize {
    let mut units = 0;
    for (at, letter) in text.char_indices() {
        if units >= utf16 {
            return at;
        }
        units += letter.len_utf16();
    }
    text.len()
}
