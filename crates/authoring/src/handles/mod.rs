//! Handles for dragging the membership functions in a text: their positions, their limits, and the edits that move one.
//! An edit changes only numbers; comments are preserved.

mod moving;
#[cfg(test)]
mod tests;

use fuzzy::{
    format::{PartialModel, VariableSpans},
    model::{MembershipFunction, Role, Term, Variable},
};

use crate::{Document, Edit, numbers};

/// A handle for dragging a membership function.
#[derive(Debug, Clone, PartialEq)]
pub struct Handle {
    /// The name of the parameter that the handle changes, such as `peak` or `sd`; `point` for a
    /// piecewise function.
    pub name: &'static str,
    /// The position, in the unit of the variable.
    pub x: f64,
    /// The degree at that position.
    pub degree: f64,
    /// The smallest allowed `x`.
    pub low: f64,
    /// The largest allowed `x`.
    pub high: f64,
    /// Whether the handle can also be moved vertically.
    pub moves_degree: bool,
}

/// The parameter that a handle changes.
#[derive(Debug, Clone, Copy)]
enum Grip {
    /// The peak in a partition.
    Peak,
    /// The limit of a term in `steps`.
    Limit,
    /// The parameter with this index, which is a position.
    Place(usize),
    /// The parameter with this index, which is a width: a fixed fraction of the handle's distance from a position.
    Width {
        parameter: usize,
        place: usize,
        times: f64,
    },
    /// The point with this index.
    Point(usize),
}

/// Returns the handles of a term. Variables are counted with the inputs first. The result is empty for a profile, for
/// a formula, and for a term that cannot be read or whose range cannot be read.
pub fn of(document: &Document, variable: usize, term: usize) -> Vec<Handle> {
    let found = Place::find(document, variable, term);
    let handles = found.map(|place| place.handles()).unwrap_or_default();
    handles.into_iter().map(|(_, handle)| handle).collect()
}

/// Returns the edits that move a handle to a position and a degree, or as near as it can move. Numbers are rounded to
/// about a thousandth of the range.
///
/// # Errors
/// Returns the reason if the handle cannot be moved.
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
        return Err("a point can only be moved to a finite number".into());
    }
    let decimals = place.decimals();
    let to = rounded(x, decimals).clamp(handle.low, handle.high);
    let terms = place.moved(*grip, to, rounded(degree, 2).clamp(0.0, 1.0))?;
    let edits = numbers::of_terms(place.text, place.variable, place.spans, &terms);
    let edits = edits.ok_or("the number is not in the text")?;
    place.verified(document, terms, edits)
}

/// A term in a text.
struct Place<'d> {
    rules: &'d PartialModel,
    text: &'d str,
    index: usize,
    variable: &'d Variable,
    spans: &'d VariableSpans,
    index_of_term: usize,
    term: &'d Term,
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
        })
    }

    fn is_partition(&self) -> bool {
        !self.spans.partition.is_empty()
    }

    /// The number of decimals of a position: its last digit is worth a thousandth of the range or less.
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
        if !self.spans.steps.is_empty() {
            return self.limit().into_iter().collect();
        }
        let own = self.spans.terms.get(self.index_of_term);
        if self.term.lower.is_some() && own.is_none_or(|spans| spans.numbers.is_empty()) {
            // The term is written in a short form, whose numbers are not the parameters of its function.
            return Vec::new();
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
            // The number is a degree, not a position.
            return Vec::new();
        }
        let parameters = shape.parameters();
        (0..parameters.len())
            .filter_map(|i| self.parameter(&parameters, i))
            .collect()
    }

    /// The handle of a term in a partition: the peak of the term, which moves between the neighbouring peaks.
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

    /// The handle of a term that ends at a limit, which moves between the neighbouring limits; the last term has none.
    fn limit(&self) -> Option<(Grip, Handle)> {
        let limits = self.variable.step_limits()?;
        let at = self.index_of_term;
        let (x, step, decimals) = (*limits.get(at)?, self.step(), self.decimals());
        let left = at.checked_sub(1).and_then(|i| limits.get(i));
        let left = left.copied().unwrap_or(self.variable.low);
        let right = limits.get(at + 1);
        Some((
            Grip::Limit,
            Handle {
                name: "limit",
                x,
                degree: 1.0,
                low: rounded(left + step, decimals).min(x),
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
            // The handle is where the degree is 0.5.
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
}

fn rounded(value: f64, decimals: usize) -> f64 {
    let text = format!("{value:.decimals$}");
    // Adding 0 removes the sign of -0.
    text.parse().map_or(value, |rounded: f64| rounded + 0.0)
}
