//! The points by which the membership functions of a text are dragged: where they are, how far they go, and the edits that move
//! one. An edit changes the numbers and nothing else, comments least of all.

use fuzzy::{
    format::{self, Partial, TermSpans, VariableSpans},
    model::{MembershipFunction, Role, Term, Variable},
    tree::{Node, Value},
};

use crate::{Document, Edit, edited};

/// A point by which a membership function is dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct Handle {
    /// The parameter that it moves: `peak`, `sd`; `point` of a piecewise function.
    pub name: &'static str,
    /// Where it is, in the unit of the variable.
    pub x: f64,
    /// The degree there.
    pub degree: f64,
    /// The least `x` it goes to.
    pub low: f64,
    /// The greatest `x` it goes to.
    pub high: f64,
    /// Whether it moves up and down too.
    pub moves_degree: bool,
}

/// What a handle moves.
#[derive(Debug, Clone, Copy)]
enum Grip {
    /// The peak in a partition.
    Peak,
    /// The parameter of this index, which is a place.
    Place(usize),
    /// The parameter of this index: a width, so many times smaller than the handle's distance from a place.
    Width {
        parameter: usize,
        place: usize,
        times: f64,
    },
    /// The point of this index.
    Point(usize),
}

/// The handles of a term. Variables are counted inputs first; there are none in a profile, of a formula, and where the range or
/// the term cannot be read.
pub fn of(document: &Document, variable: usize, term: usize) -> Vec<Handle> {
    let found = Place::find(document, variable, term);
    let handles = found.map(|place| place.handles()).unwrap_or_default();
    handles.into_iter().map(|(_, handle)| handle).collect()
}

/// The edits that move a handle to a place and a degree, as near as it goes there. Numbers are rounded to about a thousandth
/// of the range.
///
/// # Errors
/// Why it cannot be moved.
pub fn moved(
    document: &Document,
    (variable, term): (usize, usize),
    handle: usize,
    (x, degree): (f64, f64),
) -> Result<Vec<Edit>, String> {
    let place = Place::find(document, variable, term).ok_or("there is no such term")?;
    let handles = place.handles();
    let (grip, handle) = handles.get(handle).ok_or("there is no such point")?;
    if !(x.is_finite() && degree.is_finite()) {
        return Err("a point is moved to a finite number".into());
    }
    let decimals = place.decimals();
    let to = rounded(x, decimals).clamp(handle.low, handle.high);
    let terms = place.moved(*grip, to, rounded(degree, 2).clamp(0.0, 1.0))?;
    let edits = place.edits(*grip, &terms)?;
    place.verified(document, terms, edits)
}

/// A term in a text.
struct Place<'d> {
    rules: &'d Partial,
    text: &'d str,
    index: usize,
    variable: &'d Variable,
    spans: &'d VariableSpans,
    index_of_term: usize,
    term: &'d Term,
    term_spans: &'d TermSpans,
}

impl<'d> Place<'d> {
    fn find(document: &'d Document, index: usize, index_of_term: usize) -> Option<Place<'d>> {
        let rules = document.rules()?;
        let inputs = rules.model.inputs.iter().zip(&rules.spans.inputs);
        let outputs = rules.model.outputs.iter().map(|output| &output.variable);
        let mut all = inputs.chain(outputs.zip(&rules.spans.outputs));
        let (variable, spans) = all.nth(index)?;
        let has_range = variable.low < variable.high && (variable.high - variable.low).is_finite();
        has_range.then_some(())?;
        Some(Place {
            rules,
            text: document.text(),
            index,
            variable,
            spans,
            index_of_term,
            term: variable.terms.get(index_of_term)?,
            term_spans: spans.terms.get(index_of_term)?,
        })
    }

    fn is_partition(&self) -> bool {
        !self.spans.partition.is_empty()
    }

    /// Decimals of a number that is a place: a thousandth of the range, or a little finer.
    fn decimals(&self) -> usize {
        let width = self.variable.high - self.variable.low;
        (3.0 - width.log10().floor()).clamp(0.0, 17.0) as usize
    }

    fn step(&self) -> f64 {
        rounded(10f64.powf(-(self.decimals() as f64)), self.decimals())
    }

    fn handles(&self) -> Vec<(Grip, Handle)> {
        if self.is_partition() {
            return self.peak().into_iter().collect();
        }
        let shape = &self.term.membership_function;
        if let MembershipFunction::Piecewise { points } = shape {
            return (0..points.len())
                .filter_map(|i| self.point(points, i))
                .collect();
        }
        if matches!(shape, MembershipFunction::Constant { .. })
            && self.index < self.rules.model.inputs.len()
        {
            // It is a degree, not a place.
            return Vec::new();
        }
        let parameters = shape.parameters();
        (0..parameters.len())
            .filter_map(|i| self.parameter(&parameters, i))
            .collect()
    }

    /// The handle of a term of a partition: its peak, between the neighbours' peaks.
    fn peak(&self) -> Option<(Grip, Handle)> {
        let peaks = self.variable.partition_peaks()?;
        let at = self.index_of_term;
        let (x, step, decimals) = (*peaks.get(at)?, self.step(), self.decimals());
        let left = at.checked_sub(1).and_then(|i| peaks.get(i));
        let right = peaks.get(at + 1);
        Some((
            Grip::Peak,
            Handle {
                name: "peak",
                x,
                degree: 1.0,
                low: left.map_or(self.variable.low, |left| {
                    rounded(left + step, decimals).min(x)
                }),
                high: right.map_or(self.variable.high, |right| {
                    rounded(right - step, decimals).max(x)
                }),
                moves_degree: false,
            },
        ))
    }

    fn point(&self, points: &[(f64, f64)], i: usize) -> Option<(Grip, Handle)> {
        let (x, degree) = *points.get(i)?;
        let left = i.checked_sub(1).and_then(|i| points.get(i));
        let right = points.get(i + 1);
        Some((
            Grip::Point(i),
            Handle {
                name: "point",
                x,
                degree: degree * self.term.height,
                low: left.map_or(self.variable.low.min(x), |(left, _)| *left),
                high: right.map_or(self.variable.high.max(x), |(right, _)| *right),
                moves_degree: self.term.height > 0.0,
            },
        ))
    }

    fn parameter(
        &self,
        parameters: &[(&'static str, Role, f64)],
        i: usize,
    ) -> Option<(Grip, Handle)> {
        use MembershipFunction as Shape;
        let shape = &self.term.membership_function;
        let (name, role, value) = *parameters.get(i)?;
        let (low, high) = (self.variable.low, self.variable.high);
        let width = match (shape, name) {
            (Shape::Gaussian { .. }, "sd") | (Shape::Bell { .. }, "width") => Some((0, 1.0)),
            (Shape::Gaussian2 { .. }, "left_sd") => Some((0, -1.0)),
            (Shape::Gaussian2 { .. }, "right_sd") => Some((2, 1.0)),
            (Shape::Cosine { .. }, "width") => Some((0, 0.5)),
            // Where the degree is 0.5.
            (Shape::Spike { .. }, "width") => Some((0, std::f64::consts::LN_2 / 10.0)),
            (_, "slope" | "left_slope" | "right_slope") => return None,
            _ => None,
        };
        let (grip, x, low, high) = match width {
            Some((place, times)) => {
                let from = parameters.get(place)?.2;
                let x = from + times * value;
                let (near, far) = (
                    from + times * self.step(),
                    from + times.signum() * (high - low),
                );
                let grip = Grip::Width {
                    parameter: i,
                    place,
                    times,
                };
                (grip, x, near.min(far).min(x), near.max(far).max(x))
            }
            None => {
                let place = |i: Option<usize>| {
                    let (_, neighbour, value) = *parameters.get(i?)?;
                    (role == Role::Ascending && neighbour == Role::Ascending).then_some(value)
                };
                let left = place(i.checked_sub(1)).unwrap_or(low.min(value));
                let right = place(Some(i + 1)).unwrap_or(high.max(value));
                (Grip::Place(i), value, left, right)
            }
        };
        let degree = match name {
            _ if matches!(shape, Shape::Rectangle { .. }) => 1.0,
            "left" | "right" | "foot" | "start" => 0.0,
            "peak" | "top" | "left_top" | "right_top" | "end" | "at" | "value" => 1.0,
            _ => shape.membership(x),
        };
        let handle = Handle {
            name,
            x,
            degree: degree * self.term.height,
            low,
            high,
            moves_degree: false,
        };
        Some((grip, handle))
    }

    /// The terms of the variable after a handle has moved.
    fn moved(&self, grip: Grip, to: f64, degree: f64) -> Result<Vec<Term>, String> {
        let mut terms = self.variable.terms.clone();
        let shape = &self.term.membership_function;
        let changed = match grip {
            Grip::Peak => {
                let peaks = self.variable.partition_peaks().unwrap_or_default();
                let names = terms.iter().map(|term| term.name.as_str());
                let peaks = names.zip(peaks).enumerate();
                let peaks = peaks.map(|(i, (name, peak))| match i == self.index_of_term {
                    true => (name, to),
                    false => (name, peak),
                });
                let empty = Variable::new("", self.variable.low, self.variable.high);
                return Ok(empty.partition_at(peaks).terms);
            }
            Grip::Point(i) => {
                let MembershipFunction::Piecewise { points } = shape else {
                    return Err("there is no such point".into());
                };
                let mut points = points.clone();
                if let Some(point) = points.get_mut(i) {
                    *point = (to, rounded(degree / self.term.height, 2).clamp(0.0, 1.0));
                }
                MembershipFunction::Piecewise { points }
            }
            Grip::Place(parameter) | Grip::Width { parameter, .. } => {
                let values = shape.parameters().into_iter().map(|(_, _, value)| value);
                let mut values: Vec<f64> = values.collect();
                let value = match grip {
                    Grip::Width { place, times, .. } => {
                        let from = values.get(place).copied().unwrap_or(0.0);
                        let width = rounded(((to - from) / times).abs(), self.decimals());
                        width.max(self.step())
                    }
                    _ => to,
                };
                if let Some(number) = values.get_mut(parameter) {
                    *number = value;
                }
                let changed = shape.with_parameters(&values);
                changed.map_err(|error| error.to_string())?
            }
        };
        if let Some(term) = terms.get_mut(self.index_of_term) {
            term.membership_function = changed;
        }
        Ok(terms)
    }

    /// The edits of the numbers that a grip moves.
    fn edits(&self, grip: Grip, terms: &[Term]) -> Result<Vec<Edit>, String> {
        let shape = terms
            .get(self.index_of_term)
            .map(|term| &term.membership_function);
        let change = |number: usize, value: f64| {
            let span = self.term_spans.numbers.get(number)?.clone();
            let text = written(value);
            Some(Edit { span, text })
        };
        let edits = match (grip, shape) {
            (Grip::Peak, _) => {
                let changed = Variable {
                    terms: terms.to_vec(),
                    ..self.variable.clone()
                };
                let peaks = changed.partition_peaks();
                let peaks = peaks.ok_or("the peaks of a partition rise from left to right")?;
                let peak = peaks.get(self.index_of_term).copied().unwrap_or_default();
                match self.term_spans.numbers.is_empty() {
                    true => self.spelt_out(&peaks),
                    false => change(0, peak).map(|edit| vec![edit]),
                }
            }
            (Grip::Point(i), Some(MembershipFunction::Piecewise { points })) => {
                let point = points.get(i).copied().unwrap_or_default();
                let edits = [change(2 * i, point.0), change(2 * i + 1, point.1)];
                edits.into_iter().collect()
            }
            (Grip::Place(parameter) | Grip::Width { parameter, .. }, Some(shape)) => {
                let value = shape
                    .parameters()
                    .get(parameter)
                    .map(|(_, _, value)| *value);
                value.and_then(|value| Some(vec![change(parameter, value)?]))
            }
            _ => None,
        };
        edits.ok_or_else(|| "the number is not in the text".into())
    }

    /// An even partition `[low, high]` with its peaks: `{low: 0, high: 1}`.
    fn spelt_out(&self, peaks: &[f64]) -> Option<Vec<Edit>> {
        let list = self.spans.partition.clone();
        let is_flow = self.text.get(list.clone())?.starts_with('[');
        let mut edits = Vec::new();
        let bracket = |at: usize, text: &str| Edit {
            span: at..at + 1,
            text: text.into(),
        };
        if is_flow {
            edits.push(bracket(list.start, "{"));
        }
        for (term, peak) in self.spans.terms.iter().zip(peaks) {
            if !is_flow {
                let dash = self.text.get(..term.name.start)?.trim_end().len();
                let dash = dash.checked_sub(1)?..dash;
                (self.text.get(dash.clone())? == "-").then_some(())?;
                edits.push(Edit {
                    span: dash,
                    text: " ".into(),
                });
            }
            edits.push(Edit {
                span: term.name.end..term.name.end,
                text: format!(": {}", written(*peak)),
            });
        }
        if is_flow {
            edits.push(bracket(list.end.checked_sub(1)?, "}"));
        }
        Some(edits)
    }

    /// The edits, where the text then means what is wanted and nothing else.
    fn verified(
        &self,
        document: &Document,
        terms: Vec<Term>,
        edits: Vec<Edit>,
    ) -> Result<Vec<Edit>, String> {
        let mut wanted = self.rules.model.clone();
        let inputs = wanted.inputs.len();
        let variable = match self.index.checked_sub(inputs) {
            None => wanted.inputs.get_mut(self.index),
            Some(output) => wanted
                .outputs
                .get_mut(output)
                .map(|output| &mut output.variable),
        };
        if let Some(variable) = variable {
            variable.terms = terms;
        }
        let text = edited(document.text(), &edits);
        let read = fuzzy::yaml::read(&text).ok();
        let read = read.and_then(|tree| format::read_partly(&tree));
        // As documents: a range that cannot be read is no number, which equals nothing.
        let means = |model: &fuzzy::Model| serde_json::to_value(model).ok();
        match read.is_some_and(|read| means(&read.model) == means(&wanted)) {
            true => Ok(edits),
            false => Err("the number stands for others too, or is written in a way of its own; change it in the text".into()),
        }
    }
}

fn rounded(value: f64, decimals: usize) -> f64 {
    let text = format!("{value:.decimals$}");
    // A zero has no sign.
    text.parse().map_or(value, |rounded: f64| rounded + 0.0)
}

/// A number as rule sets write it.
fn written(number: f64) -> String {
    match Node::number(number).value {
        Value::Scalar(scalar) => scalar.text,
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: &str = "# My fan
fuzzy: 1
name: fan # short
inputs:
  heat:
    range: [0, 100]
    partition: {low: 10, # cold
      high: 90}
  haze: {range: [0, 1], partition: [thin, thick]} # even
  wind:
    range: [0, 20]
    partition:
    - calm # nothing
    - \"a gale\"
  load:
    range: [-5, 5]
    terms:
      small: {triangle: [-5, -2.50, 5], height: 0.5}
      near: {gaussian: {sd: 1, mean: 0}}
      wide: {cosine: {center: 0, width: 4}}
      odd: {piecewise: [[-5, 0], [0, 1], [0, 0.25]]}
outputs:
  speed: {range: [0, 9], terms: {slow: {constant: 2}, fast: {linear: {heat: 1}}}, defuzzifier: weighted_average}
rules:
  - IF heat IS low THEN speed IS slow # why
";

    fn document(text: &str) -> Document {
        Document::new(text, |_| None)
    }

    /// The text after a handle has moved.
    fn after(text: &str, term: (usize, usize), handle: usize, to: (f64, f64)) -> String {
        let document = document(text);
        edited(text, &moved(&document, term, handle, to).unwrap())
    }

    #[test]
    fn handles_stand_where_the_parameters_are() {
        let document = document(RULES);
        assert!(!document.findings().has_errors(), "{}", document.findings());
        let places = |variable, term| -> Vec<(&str, f64, f64, f64, f64)> {
            let handles = of(&document, variable, term).into_iter();
            handles
                .map(|h| (h.name, h.x, h.degree, h.low, h.high))
                .collect()
        };
        assert_eq!(places(0, 0), [("peak", 10.0, 1.0, 0.0, 89.9)]);
        assert_eq!(places(1, 1)[0].1, 1.0);
        assert_eq!(
            places(3, 0),
            [
                ("left", -5.0, 0.0, -5.0, -2.5),
                ("peak", -2.5, 0.5, -5.0, 5.0),
                ("right", 5.0, 0.0, -2.5, 5.0)
            ]
        );
        let sd = places(3, 1)[1];
        assert_eq!((sd.0, sd.1), ("sd", 1.0));
        assert!((sd.2 - (-0.5f64).exp()).abs() < 1e-12);
        assert_eq!(places(3, 2)[1].1, 2.0);
        assert_eq!(places(3, 3)[2], ("point", 0.0, 0.25, 0.0, 5.0));
        assert_eq!(places(4, 0), [("value", 2.0, 1.0, 0.0, 9.0)]);
        assert_eq!(places(4, 1), []);
        assert_eq!(places(9, 0), []);
    }

    #[test]
    fn a_number_changes_and_nothing_else() {
        for (term, handle, to, old, new) in [
            ((0, 0), 0, (33.333333, 0.0), "{low: 10,", "{low: 33.3,"),
            ((3, 0), 1, (-2.0, 0.0), "-2.50", "-2"),
            ((3, 0), 1, (99.0, 0.0), "-2.50", "5"),
            ((3, 1), 0, (0.5, 0.0), "mean: 0}", "mean: 0.5}"),
            ((3, 1), 1, (-2.0, 0.0), "sd: 1,", "sd: 0.01,"),
            ((3, 1), 1, (2.5, 0.0), "sd: 1,", "sd: 2.5,"),
            ((3, 2), 1, (1.5, 0.0), "width: 4", "width: 3"),
            ((3, 3), 2, (1.0, 0.5), "[0, 0.25]", "[1, 0.5]"),
            ((4, 0), 0, (2.5, 0.0), "constant: 2}", "constant: 2.5}"),
        ] {
            let expected = RULES.replacen(old, new, 1);
            assert_eq!(after(RULES, term, handle, to), expected, "{old}");
        }
    }

    #[test]
    fn an_even_partition_gets_its_peaks_and_keeps_its_comments() {
        let flow = RULES.replace("[thin, thick]", "{thin: 0.25, thick: 1}");
        assert_eq!(after(RULES, (1, 0), 0, (0.25, 0.0)), flow);
        let block = RULES
            .replace("    - calm # nothing", "      calm: 0 # nothing")
            .replace("    - \"a gale\"", "      \"a gale\": 12");
        assert_eq!(after(RULES, (2, 1), 0, (12.0, 0.0)), block);
    }

    #[test]
    fn every_handle_of_the_shipped_rule_sets_moves() {
        for known in flagred::shipped::RULE_SETS {
            let document = document(known.text);
            let model = document.model().unwrap();
            let variables = model.inputs.iter();
            let variables = variables.chain(model.outputs.iter().map(|o| &o.variable));
            let mut count = 0;
            for (v, variable) in variables.enumerate() {
                for t in 0..variable.terms.len() {
                    for (h, handle) in of(&document, v, t).into_iter().enumerate() {
                        let to = (handle.low + handle.high) / 2.0;
                        let edits = moved(&document, (v, t), h, (to, 0.5)).unwrap();
                        let text = edited(known.text, &edits);
                        assert!(text.parse::<fuzzy::Model>().is_ok(), "{}", handle.name);
                        let lines = |text: &str| text.lines().count();
                        assert_eq!(lines(&text), lines(known.text));
                        count += 1;
                    }
                }
            }
            assert!(count > 10);
        }
    }

    #[test]
    fn what_cannot_be_moved_says_why() {
        let shared = RULES
            .replace("near: {", "near: &n {")
            .replace("wide: {cosine: {center: 0, width: 4}}", "wide: *n");
        let refused = moved(&document(&shared), (3, 1), 0, (1.0, 0.0)).unwrap_err();
        assert!(refused.contains("stands for others"), "{refused}");
        assert!(moved(&document(RULES), (3, 0), 1, (f64::NAN, 0.0)).is_err());
        assert!(moved(&document(RULES), (3, 0), 7, (0.0, 0.0)).is_err());
        assert!(moved(&document("flagred: 1\n"), (0, 0), 0, (0.0, 0.0)).is_err());
    }

    #[test]
    fn a_mistake_elsewhere_is_no_hindrance() {
        let text = RULES
            .replace("range: [0, 1]", "range: 1")
            .replace("IF heat", "IF heatt");
        assert!(document(&text).findings().has_errors());
        let expected = text.replace("{low: 10,", "{low: 20,");
        assert_eq!(after(&text, (0, 0), 0, (20.0, 0.0)), expected);
    }
}
