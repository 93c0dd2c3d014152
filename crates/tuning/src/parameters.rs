//! The parameters of a model that may change, as free numbers. With any values of these numbers, the model satisfies
//! its constraints; if all of them are 0, it is the original model.

use fuzzy::{
    Model,
    model::{Defuzzifier, MembershipFunction, Output, Role, Term, Variable},
};

use crate::{TuneError, data::target, ordered::OrderedPositions, settings::Settings};

/// The parameters of a model that may change.
#[derive(Debug, Clone)]
pub(crate) struct Parameters {
    model: Model,
    beyond_range: bool,
    variables: Vec<(VariableIndex, FreeParameters)>,
    /// The indices of the rules whose weights may change.
    weights: Vec<usize>,
    /// The indices of the terms that are fitted in closed form. Only a model with one output has such terms: with a
    /// chain of outputs, the problem is not linear.
    pub(crate) fitted: Vec<usize>,
    /// The index of the output whose true values the rows contain.
    pub(crate) target: usize,
}

#[derive(Debug, Clone, Copy)]
enum VariableIndex {
    Input(usize),
    Output(usize),
}

/// The parameters of a variable that may change.
#[derive(Debug, Clone)]
enum FreeParameters {
    /// The peaks of a partition.
    Partition(OrderedPositions),
    /// Terms with separate shapes: their anchors in ascending order, and the parameters attached to each.
    Terms {
        anchors: OrderedPositions,
        anchored: Vec<AnchoredTerm>,
    },
    /// The consequents of a Takagi-Sugeno output: the index of each term, and how each of its numbers may change.
    Consequents(Vec<(usize, Vec<ConsequentParameter>)>),
}

/// A coefficient or constant of a consequent. Its value is `value + step * z`, limited to `bounds`, where `z` is its
/// free number.
#[derive(Debug, Clone, Copy)]
struct ConsequentParameter {
    step: f64,
    value: f64,
    bounds: (f64, f64),
}

/// A term whose parameters are attached to its anchor, the point where it is highest.
#[derive(Debug, Clone)]
struct AnchoredTerm {
    term: usize,
    parameters: Vec<ParameterLink>,
    /// The order in which the parameters are computed: the anchor first.
    outward: Vec<usize>,
}

/// How a parameter depends on its free number `z`.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ParameterLink {
    /// The anchor itself.
    Anchor,
    /// A position: the parameter with this index plus [`factor`] times this distance. A distance of 0 (a vertical
    /// edge) stays 0.
    Beyond(usize, f64),
    /// A width or a slope: this number times [`factor`]. A slope of 0 stays 0.
    Scale(f64),
    /// A constant.
    Fixed(f64),
}

/// The largest factor by which a width, a slope or a distance from an anchor grows or shrinks. It keeps terms
/// readable: no width vanishes.
pub(crate) const MAX_FACTOR: f64 = 5.0;

/// The factor of a free number: about `exp(z)`, between 1 / [`MAX_FACTOR`] and [`MAX_FACTOR`].
fn factor(z: f64) -> f64 {
    let most = MAX_FACTOR.ln();
    (most * (z / most).tanh()).exp()
}

/// The bounds of a number that may have any value.
pub(crate) const UNBOUNDED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The bounds of the constant of a term: the range of its output, extended to the current value if that is outside. With
/// `beyond_range`, the range is first widened by its own width on both sides. Terms that are not constants have no bounds.
pub(crate) fn bounds(variable: &Variable, term: &Term, beyond_range: bool) -> (f64, f64) {
    let MembershipFunction::Constant { value } = term.membership_function else {
        return UNBOUNDED;
    };
    let margin = match beyond_range {
        true => variable.high - variable.low,
        false => 0.0,
    };
    (
        value.min(variable.low - margin),
        value.max(variable.high + margin),
    )
}

/// The largest weight from which the search starts; the smallest one is 1 minus this. The search could not change a
/// weight of exactly 0 or 1.
const LARGEST_WEIGHT: f64 = 0.98;

impl Parameters {
    /// Determines the parameters of `model` that may change according to `settings`.
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Parameters, TuneError> {
        let names = || settings.only.iter().chain(&settings.fix);
        if let Some(name) = names().find(|name| !is_known(model, name)) {
            return Err(TuneError::Unknown { name: name.clone() });
        }
        let may_move = |variable: &str, term: &str| settings.may_move(variable, term);
        let mut parameters = Parameters {
            model: model.clone(),
            beyond_range: settings.beyond_range,
            variables: Vec::new(),
            weights: Vec::new(),
            fitted: Vec::new(),
            target: target(model)?,
        };
        let is_alone = model.outputs.len() == 1;
        for (i, variable) in model.inputs.iter().enumerate() {
            let moves = |term: &Term| may_move(&variable.name, &term.name);
            parameters.add(VariableIndex::Input(i), terms(variable, settings, &moves));
        }
        for (i, output) in model.outputs.iter().enumerate() {
            let moves = |term: &Term| may_move(&output.variable.name, &term.name);
            let movable = match is_takagi_sugeno(output) {
                false => terms(&output.variable, settings, &moves),
                true if is_alone && settings.fits_consequents() && is_linear_problem(output) => {
                    let terms = output.variable.terms.iter().enumerate();
                    let fitted = terms.filter(|(_, term)| is_linear(term) && moves(term));
                    parameters.fitted = fitted.map(|(term, _)| term).collect();
                    continue;
                }
                true => {
                    let beyond_range = settings.beyond_range;
                    FreeParameters::Consequents(consequents(model, output, beyond_range, &moves))
                }
            };
            parameters.add(VariableIndex::Output(i), movable);
        }
        if settings.weights {
            parameters.weights = (0..model.rules.len()).collect();
        }
        match parameters.free() + parameters.fitted.len() {
            0 => Err(TuneError::NothingMoves),
            _ => Ok(parameters),
        }
    }

    fn add(&mut self, place: VariableIndex, movable: FreeParameters) {
        if movable.free() > 0 {
            self.variables.push((place, movable));
        }
    }

    /// The number of free numbers.
    pub(crate) fn free(&self) -> usize {
        let variables = self.variables.iter().map(|(_, movable)| movable.free());
        variables.sum::<usize>() + self.weights.len()
    }

    /// The minimum and maximum of each free number.
    pub(crate) fn limits(&self) -> Vec<(f64, f64)> {
        let mut limits = Vec::with_capacity(self.free());
        for (_, movable) in &self.variables {
            match movable {
                FreeParameters::Consequents(terms) => {
                    let scales = terms.iter().flat_map(|(_, scales)| scales);
                    limits.extend(scales.map(|scale| {
                        let (low, high) = scale.bounds;
                        let free = |bound: f64| (bound - scale.value) / scale.step;
                        (free(low), free(high))
                    }));
                }
                _ => limits.resize(limits.len() + movable.free(), UNBOUNDED),
            }
        }
        limits.resize(self.free(), UNBOUNDED);
        limits
    }

    /// The constants that may change, by the indices of their output and their term, with their bounds.
    pub(crate) fn bounded(&self) -> Vec<((usize, usize), (f64, f64))> {
        let searched = self.variables.iter().flat_map(|of| match of {
            (VariableIndex::Output(output), FreeParameters::Consequents(terms)) => {
                terms.iter().map(|(term, _)| (*output, *term)).collect()
            }
            _ => Vec::new(),
        });
        let fitted = self.fitted.iter().map(|term| (self.target, *term));
        let bounded = fitted.chain(searched).filter_map(|(output, term)| {
            let variable = &self.model.outputs.get(output)?.variable;
            let limits = bounds(variable, variable.terms.get(term)?, self.beyond_range);
            Some(((output, term), limits))
        });
        let mut bounded: Vec<_> = bounded.collect();
        bounded.sort_by_key(|(place, _)| *place);
        bounded
    }

    /// Whether a model keeps the order and minimum distances, the bounds of constants, and all fixed numbers.
    pub(crate) fn keeps(&self, model: &Model) -> bool {
        let outputs = self.model.outputs.iter().zip(&model.outputs);
        let keeps_constants = |(before, after): (&Output, &Output)| {
            let (before, after) = (&before.variable, &after.variable);
            let mut terms = before.terms.iter().zip(&after.terms);
            terms.all(|(term, moved)| match moved.membership_function {
                MembershipFunction::Constant { value } => {
                    let (low, high) = bounds(before, term, self.beyond_range);
                    (low..=high).contains(&value)
                }
                _ => true,
            })
        };
        let keeps_constants = outputs.into_iter().all(keeps_constants);
        keeps_constants
            && self.variables.iter().all(|(place, movable)| {
                let variable = match *place {
                    VariableIndex::Input(input) => model.inputs.get(input),
                    VariableIndex::Output(output) => model.outputs.get(output).map(|o| &o.variable),
                };
                variable.is_some_and(|variable| movable.keeps(variable))
            })
    }

    /// The model for given free numbers.
    pub(crate) fn model(&self, free: &[f64]) -> Model {
        let mut model = self.model.clone();
        let mut rest = free;
        for (place, movable) in &self.variables {
            let (own, behind) = rest.split_at(movable.free().min(rest.len()));
            rest = behind;
            let variable = match *place {
                VariableIndex::Input(input) => model.inputs.get_mut(input),
                VariableIndex::Output(output) => {
                    model.outputs.get_mut(output).map(|o| &mut o.variable)
                }
            };
            if let Some(variable) = variable {
                movable.apply(own, variable);
            }
        }
        for (rule, z) in self.weights.iter().zip(rest) {
            if let Some(rule) = model.rules.get_mut(*rule) {
                let weight = rule.rule.weight.clamp(1.0 - LARGEST_WEIGHT, LARGEST_WEIGHT);
                let logit = (weight / (1.0 - weight)).ln();
                if *z != 0.0 {
                    rule.rule.weight = 1.0 / (1.0 + (-(logit + z)).exp());
                }
            }
        }
        model
    }
}

/// Whether a name in [`Settings::only`] or [`Settings::fix`] is a variable or a term.
fn is_known(model: &Model, name: &str) -> bool {
    model.variables().any(|variable| {
        let is_term = |term: &Term| name.split_once('.') == Some((&variable.name, &term.name));
        variable.name == name || variable.terms.iter().any(is_term)
    })
}

fn is_takagi_sugeno(output: &Output) -> bool {
    matches!(
        output.defuzzifier,
        Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
    )
}

/// Whether the output is linear in the numbers of all its consequents.
fn is_linear_problem(output: &Output) -> bool {
    let mut terms = output.variable.terms.iter();
    !output.clamp && terms.all(|term| is_linear(term) && term.height == 1.0)
}

/// Whether a consequent is linear in its numbers.
fn is_linear(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Constant { .. } | MembershipFunction::Linear { .. }
    )
}

/// The parameters of a variable's membership functions that may change.
fn terms(
    variable: &Variable,
    settings: &Settings,
    moves: &dyn Fn(&Term) -> bool,
) -> FreeParameters {
    let apart = settings.min_distance * (variable.high - variable.low);
    if let Some(peaks) = variable.partition_peaks() {
        let fixed = variable.terms.iter().map(|term| !moves(term));
        let positions: Vec<(f64, bool)> = peaks.into_iter().zip(fixed).collect();
        let ordered = OrderedPositions::new(&positions, variable.low, variable.high, apart);
        return FreeParameters::Partition(ordered);
    }
    let mut anchored: Vec<(f64, bool, AnchoredTerm)> = Vec::new();
    // Limits are not tuned, because they are requirements of the author.
    let free_terms = match variable.step_limits() {
        Some(_) => &[],
        None => variable.terms.as_slice(),
    };
    for (index, term) in free_terms.iter().enumerate() {
        let parameters = term.membership_function.parameters();
        let is_constant = matches!(
            term.membership_function,
            MembershipFunction::Constant { .. }
        );
        if let Some(anchor) = anchor(&parameters).filter(|_| !is_constant) {
            let may_move = moves(term);
            let term = AnchoredTerm::new(index, &parameters, anchor, may_move);
            let position = parameters.get(anchor).map_or(0.0, |(_, _, value)| *value);
            anchored.push((position, !may_move, term));
        }
    }
    anchored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let positions: Vec<(f64, bool)> = anchored
        .iter()
        .map(|(at, fixed, _)| (*at, *fixed))
        .collect();
    let low = positions
        .first()
        .map_or(variable.low, |(at, _)| at.min(variable.low));
    let high = positions
        .last()
        .map_or(variable.high, |(at, _)| at.max(variable.high));
    FreeParameters::Terms {
        anchors: OrderedPositions::new(&positions, low, high, apart),
        anchored: anchored
            .into_iter()
            .map(|(.., anchored)| anchored)
            .collect(),
    }
}

/// The index of the parameter to which the others are attached.
fn anchor(parameters: &[(&str, Role, f64)]) -> Option<usize> {
    const TOPS: [&str; 6] = ["peak", "left_top", "top", "mean", "center", "at"];
    let place = |name: &str| parameters.iter().position(|(known, ..)| *known == name);
    let top = TOPS.iter().find_map(|top| place(top));
    top.or(parameters.first().map(|_| 0))
}

pub(crate) fn is_width(name: &str, role: Role) -> bool {
    role == Role::Positive || name.ends_with("slope")
}

/// The consequents that may change: the index of each term, and how each of its numbers may change.
fn consequents(
    model: &Model,
    output: &Output,
    beyond_range: bool,
    moves: &dyn Fn(&Term) -> bool,
) -> Vec<(usize, Vec<ConsequentParameter>)> {
    let height = output.variable.high - output.variable.low;
    let width = |name: &String| {
        let input = model.inputs.iter().find(|input| input.name == *name);
        input.map_or(1.0, |input| input.high - input.low)
    };
    let scales = |(index, term): (usize, &Term)| match &term.membership_function {
        _ if !moves(term) => None,
        MembershipFunction::Constant { value } => {
            let scale = ConsequentParameter {
                step: height,
                value: *value,
                bounds: bounds(&output.variable, term, beyond_range),
            };
            Some((index, vec![scale]))
        }
        MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let scale = |step: f64, value: f64| ConsequentParameter {
                step,
                value,
                bounds: UNBOUNDED,
            };
            let scales = coefficients.iter();
            let scales = scales.map(|(name, value)| scale(height / width(name), *value));
            Some((index, scales.chain([scale(height, *constant)]).collect()))
        }
        _ => None,
    };
    output
        .variable
        .terms
        .iter()
        .enumerate()
        .filter_map(scales)
        .collect()
}

impl FreeParameters {
    fn free(&self) -> usize {
        match self {
            FreeParameters::Partition(peaks) => peaks.free(),
            FreeParameters::Terms {
                anchors, anchored, ..
            } => anchors.free() + anchored.iter().map(AnchoredTerm::free).sum::<usize>(),
            FreeParameters::Consequents(terms) => {
                terms.iter().map(|(_, scales)| scales.len()).sum()
            }
        }
    }

    fn keeps(&self, variable: &Variable) -> bool {
        match self {
            FreeParameters::Partition(ordered) => variable
                .partition_peaks()
                .is_some_and(|peaks| ordered.contains(&peaks)),
            FreeParameters::Terms { anchors, anchored } => {
                let anchor = |anchored: &AnchoredTerm| {
                    let parameters = variable
                        .terms
                        .get(anchored.term)?
                        .membership_function
                        .parameters();
                    parameters
                        .get(*anchored.outward.first()?)
                        .map(|(.., value)| *value)
                };
                let positions: Option<Vec<f64>> = anchored.iter().map(anchor).collect();
                positions.is_some_and(|positions| anchors.contains(&positions))
            }
            FreeParameters::Consequents(_) => true,
        }
    }

    /// Changes the terms of a variable.
    fn apply(&self, free: &[f64], variable: &mut Variable) {
        match self {
            FreeParameters::Partition(peaks) => {
                let names: Vec<String> = variable.terms.drain(..).map(|term| term.name).collect();
                let peaks = peaks.positions(free);
                let moved = names.iter().map(String::as_str).zip(peaks);
                *variable = variable.clone().partition_at(moved);
            }
            FreeParameters::Terms {
                anchors, anchored, ..
            } => {
                let (of_anchors, mut rest) = free.split_at(anchors.free().min(free.len()));
                for (anchor, anchored) in anchors.positions(of_anchors).into_iter().zip(anchored) {
                    let (own, behind) = rest.split_at(anchored.free().min(rest.len()));
                    rest = behind;
                    if let Some(term) = variable.terms.get_mut(anchored.term) {
                        let moved = term
                            .membership_function
                            .with_parameters(&anchored.moved(anchor, own));
                        if let Ok(moved) = moved {
                            term.membership_function = moved;
                        }
                    }
                }
            }
            FreeParameters::Consequents(terms) => {
                let mut z = free.iter();
                for (index, scales) in terms {
                    let mut moved = scales.iter().map(|scale| {
                        let moved = scale.value + scale.step * z.next().unwrap_or(&0.0);
                        moved.clamp(scale.bounds.0, scale.bounds.1)
                    });
                    match variable
                        .terms
                        .get_mut(*index)
                        .map(|t| &mut t.membership_function)
                    {
                        Some(MembershipFunction::Constant { value }) => {
                            *value = moved.next().unwrap_or(*value);
                        }
                        Some(MembershipFunction::Linear {
                            coefficients,
                            constant,
                        }) => {
                            let numbers = coefficients.iter_mut().map(|(_, number)| number);
                            for (number, moved) in numbers.chain([constant]).zip(moved) {
                                *number = moved;
                            }
                        }
                        _ => {}
                    }
                }
            }
        }
    }
}

impl AnchoredTerm {
    fn new(
        term: usize,
        parameters: &[(&str, Role, f64)],
        anchor: usize,
        may_move: bool,
    ) -> AnchoredTerm {
        let is_position = |i: usize| {
            parameters
                .get(i)
                .is_some_and(|(name, role, _)| !is_width(name, *role))
        };
        let link = |(i, (_, _, value)): (usize, &(&str, Role, f64))| {
            if i == anchor {
                return ParameterLink::Anchor;
            }
            if !may_move {
                return ParameterLink::Fixed(*value);
            }
            if !is_position(i) {
                return ParameterLink::Scale(*value);
            }
            let next = match i < anchor {
                true => (i + 1..=anchor).find(|next| is_position(*next)),
                false => (anchor..i).rev().find(|next| is_position(*next)),
            };
            let next = next.unwrap_or(anchor);
            let at = parameters.get(next).map_or(*value, |(_, _, at)| *at);
            ParameterLink::Beyond(next, value - at)
        };
        let links: Vec<ParameterLink> = parameters.iter().enumerate().map(link).collect();
        let mut outward: Vec<usize> = (0..links.len()).collect();
        outward.sort_by_key(|i| i.abs_diff(anchor));
        AnchoredTerm {
            term,
            parameters: links,
            outward,
        }
    }

    fn free(&self) -> usize {
        self.parameters.iter().filter(|link| link.is_free()).count()
    }

    /// Returns the parameters of the term for a given position of its anchor and given free numbers.
    fn moved(&self, anchor: f64, free: &[f64]) -> Vec<f64> {
        let mut z = free.iter();
        let of_link = |link: &ParameterLink| match link.is_free() {
            true => z.next().map_or(1.0, |z| factor(*z)),
            false => 1.0,
        };
        let factors: Vec<f64> = self.parameters.iter().map(of_link).collect();
        let mut moved = vec![0.0; factors.len()];
        for &i in &self.outward {
            moved[i] = match self.parameters[i] {
                ParameterLink::Anchor => anchor,
                ParameterLink::Beyond(next, distance) => moved[next] + distance * factors[i],
                ParameterLink::Scale(number) => number * factors[i],
                ParameterLink::Fixed(number) => number,
            };
        }
        moved
    }
}

impl ParameterLink {
    fn is_free(&self) -> bool {
        match self {
            ParameterLink::Beyond(_, number) | ParameterLink::Scale(number) => *number != 0.0,
            ParameterLink::Anchor | ParameterLink::Fixed(_) => false,
        }
    }
}

#[cfg(test)]
mod tests;
