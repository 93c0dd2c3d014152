//! Fits the consequents of a Takagi-Sugeno output by least squares. The output is linear in the numbers of its
//! consequents, with factors that depend on the firing strengths and the inputs, so there is a closed form (Jang's
//! hybrid learning, ANFIS, 1993).

use fuzzy::{
    Engine, Model,
    model::{Defuzzifier, MembershipFunction, Output, Variable},
};
use nalgebra::{DMatrix, DVector};

use crate::{
    TuneError,
    data::Data,
    parameters::{UNBOUNDED, bounds},
};

/// The ridge, as a share of the diagonal elements: see [`ridged`]. Because of the ridge, numbers that the rows do
/// not determine keep their current values.
const RIDGE: f64 = 1e-8;

/// The largest ridge. It shortens the steps of the numbers that the rows determine by about this share.
const LARGEST_RIDGE: f64 = 1e-4;

/// The number of rows whose firing strengths are in memory at a time.
const ROWS: usize = 4096;

/// Fits the numbers of the terms `fitted`, which belong to the only output: minimises the sum of squared errors, with
/// constants within their [`bounds`].
pub(crate) fn fit(
    model: &mut Model,
    fitted: &[usize],
    data: &Data,
    beyond_range: bool,
) -> Result<(), TuneError> {
    let Some((probe, terms)) = probe(model) else {
        return Ok(());
    };
    let engine = Engine::new(&probe)?;
    let Some(output) = model.outputs.first() else {
        return Ok(());
    };
    let is_mean = output.defuzzifier == Defuzzifier::WeightedAverage;
    let consequents: Vec<Consequent> = terms
        .iter()
        .map(|term| Consequent::new(model, output, *term, fitted))
        .collect();
    let numbers: usize = consequents.iter().map(Consequent::free).sum();
    if numbers == 0 {
        return Ok(());
    }
    let mut squares = DMatrix::<f64>::zeros(numbers, numbers);
    let mut products = DVector::<f64>::zeros(numbers);
    for first in (0..data.len()).step_by(ROWS) {
        let rows = first..(first + ROWS).min(data.len());
        let columns: Vec<&[f64]> = data.inputs.iter().map(|c| &c[rows.clone()]).collect();
        let strengths = engine.evaluate_batch(&columns)?;
        for (row, strengths) in rows.zip(strengths.chunks_exact(terms.len())) {
            let strength = |i: usize| strengths[i].value().unwrap_or(0.0);
            let sum: f64 = (0..terms.len()).map(strength).sum();
            if sum == 0.0 {
                continue;
            }
            let divisor = if is_mean { sum } else { 1.0 };
            let mut error = data.truths[row];
            let mut factors: Vec<(usize, f64)> = Vec::new();
            let mut place = 0;
            for (i, consequent) in consequents.iter().enumerate() {
                let share = strength(i) / divisor;
                if share != 0.0 {
                    let x = |input: usize| data.inputs[input][row];
                    error -= share * consequent.value(&x);
                    let own = consequent.factors(&x).enumerate();
                    factors.extend(own.map(|(k, factor)| (place + k, share * factor)));
                }
                place += consequent.free();
            }
            let weight = data.weight(row);
            for (i, &(p, a)) in factors.iter().enumerate() {
                products[p] += weight * a * error;
                for &(q, b) in &factors[..=i] {
                    squares[(p, q)] += weight * a * b;
                }
            }
        }
    }
    squares.fill_upper_triangle_with_lower_triangle();
    let variable = &output.variable;
    // The minimum and maximum of each step.
    let limits = |beyond_range: bool| -> Vec<(f64, f64)> {
        let limits = consequents.iter().flat_map(|consequent| {
            let term = variable.terms.get(consequent.term);
            let (low, high) = term.map_or(UNBOUNDED, |term| bounds(variable, term, beyond_range));
            let limits = (low - consequent.constant, high - consequent.constant);
            std::iter::repeat_n(limits, consequent.free())
        });
        limits.collect()
    };
    let (near, limits) = (limits(true), limits(beyond_range));
    let is_near = |(step, (low, high)): (&f64, &(f64, f64))| (*low..=*high).contains(step);
    // Rules that always fire together could get constants of any size, whose errors cancel only on
    // these rows. A larger ridge keeps them at most one width outside the range. If that does not
    // help, the rows require such values, and only the limits apply.
    let mut ridge = RIDGE;
    let mut steps = solve(squares.clone(), &products, ridge);
    while ridge < LARGEST_RIDGE
        && let Some(far) = &steps
        && !far.iter().zip(&near).all(is_near)
    {
        ridge *= 10.0;
        steps = solve(squares.clone(), &products, ridge);
    }
    let Some(steps) = steps else {
        return Ok(());
    };
    let steps = within(&limits, steps, &squares, &products, ridge);
    if !steps.iter().all(|step| step.is_finite()) {
        return Ok(());
    }
    let mut terms = variable.terms.clone();
    let mut rest = steps.iter();
    for consequent in &consequents {
        if let Some(term) = terms.get_mut(consequent.term) {
            let (low, high) = bounds(variable, term, beyond_range);
            consequent.move_by(&mut term.membership_function, &mut rest);
            // Rounding errors may exceed the limits slightly.
            if let MembershipFunction::Constant { value } = &mut term.membership_function {
                *value = value.clamp(low, high);
            }
        }
    }
    if let Some(output) = model.outputs.first_mut() {
        output.variable.terms = terms;
    }
    Ok(())
}

/// Returns the best steps within limits. It starts from `steps`, the best steps without limits. It then repeatedly
/// sets each step to the value that minimises the error for the current values of the other steps, until no step
/// changes. The error is convex, so the result is its minimum.
fn within(
    limits: &[(f64, f64)],
    mut steps: DVector<f64>,
    squares: &DMatrix<f64>,
    products: &DVector<f64>,
    ridge: f64,
) -> DVector<f64> {
    const MAX_SWEEPS: u32 = 1000;
    let is_within = |(step, (low, high)): (&f64, &(f64, f64))| step >= low && step <= high;
    if steps.iter().zip(limits).all(is_within) {
        return steps;
    }
    let squares = ridged(squares.clone(), ridge);
    for (step, (low, high)) in steps.iter_mut().zip(limits) {
        *step = step.clamp(*low, *high);
    }
    for _ in 0..MAX_SWEEPS {
        let mut largest = 0.0_f64;
        for (i, (low, high)) in limits.iter().enumerate() {
            let curvature = squares[(i, i)];
            let slope = products[i] - squares.column(i).dot(&steps);
            if curvature > 0.0 {
                let step = (steps[i] + slope / curvature).clamp(*low, *high);
                largest = largest.max((step - steps[i]).abs());
                steps[i] = step;
            }
        }
        if largest <= 1e-12 * steps.amax() {
            break;
        }
    }
    steps
}

/// Solves `(squares + ridge) x = products`. The ridge is added by [`ridged`], and increased until the matrix is
/// positive definite.
pub(crate) fn solve(
    squares: DMatrix<f64>,
    products: &DVector<f64>,
    ridge: f64,
) -> Option<DVector<f64>> {
    let largest = squares.diagonal().max();
    if !largest.is_finite() || largest <= 0.0 {
        return None;
    }
    let mut ridge = ridge;
    while ridge <= 1.0 {
        if let Some(cholesky) = ridged(squares.clone(), ridge).cholesky() {
            return Some(cholesky.solve(products));
        }
        ridge *= 100.0;
    }
    None
}

/// Adds a ridge to a matrix: each diagonal element is increased by the share `ridge` of the sum of the element
/// and a thousandth of the largest diagonal element.
fn ridged(mut squares: DMatrix<f64>, ridge: f64) -> DMatrix<f64> {
    let largest = squares.diagonal().max();
    for i in 0..squares.nrows() {
        squares[(i, i)] += ridge * (squares[(i, i)] + 1e-3 * largest);
    }
    squares
}

/// Returns a model that computes firing strengths, and the indices of the terms that the rules conclude. The model
/// has one output for each of these terms. The value of the output is the firing strength of the rules that
/// conclude the term. The rules are those of the original model, but instead of a term they conclude the constant 1
/// of the term's output.
fn probe(model: &Model) -> Option<(Model, Vec<usize>)> {
    let output = model.outputs.first()?;
    let mut probe = model.clone();
    let mut terms = Vec::new();
    for rule in &mut probe.rules {
        for consequent in &mut rule.rule.consequents {
            let mut known = output.variable.terms.iter();
            let term = known.position(|term| term.name == consequent.term.text)?;
            if !terms.contains(&term) {
                terms.push(term);
            }
            consequent.output.text = strength_of(term);
            consequent.term.text = ONE.into();
        }
    }
    terms.sort_unstable();
    let one = MembershipFunction::Constant { value: 1.0 };
    let strengths = terms.iter().map(|term| Output {
        variable: Variable::new(strength_of(*term), 0.0, 1.0).term(ONE, one.clone()),
        defuzzifier: Defuzzifier::WeightedSum,
        clamp: false,
        type_reduction: fuzzy::model::TypeReduction::Exact,
        when_no_rule_fires: fuzzy::model::NoRuleFires::Value(0.0),
        ..output.clone()
    });
    probe.outputs = strengths.collect();
    (!terms.is_empty()).then_some((probe, terms))
}

const ONE: &str = "one";

/// Returns the name of the output that contains the firing strength of a term. No input can have
/// this name, because names in parsed rule sets have no trailing spaces.
fn strength_of(term: usize) -> String {
    format!("strength of {term} ")
}

/// A consequent of the output.
struct Consequent {
    term: usize,
    constant: f64,
    /// The coefficients of inputs, by the index of the input.
    coefficients: Vec<(usize, f64)>,
    /// Whether the numbers of this consequent may change.
    moves: bool,
}

impl Consequent {
    fn new(model: &Model, output: &Output, term: usize, fitted: &[usize]) -> Consequent {
        let function = output
            .variable
            .terms
            .get(term)
            .map(|term| &term.membership_function);
        let input = |name: &String| model.inputs.iter().position(|input| input.name == *name);
        let (constant, coefficients) = match function {
            Some(MembershipFunction::Constant { value }) => (*value, Vec::new()),
            Some(MembershipFunction::Linear {
                coefficients,
                constant,
            }) => {
                let known = coefficients
                    .iter()
                    .filter_map(|(name, c)| Some((input(name)?, *c)));
                (*constant, known.collect())
            }
            _ => (0.0, Vec::new()),
        };
        Consequent {
            term,
            constant,
            coefficients,
            moves: fitted.contains(&term),
        }
    }

    /// How many numbers may change: the coefficients and the constant, or 0 if the consequent is fixed.
    fn free(&self) -> usize {
        if self.moves {
            self.coefficients.len() + 1
        } else {
            0
        }
    }

    fn value(&self, x: &dyn Fn(usize) -> f64) -> f64 {
        let terms = self.coefficients.iter().map(|(input, c)| c * x(*input));
        self.constant + terms.sum::<f64>()
    }

    /// The factor of each number that may change: the value of the input for a coefficient, 1 for the constant.
    fn factors(&self, x: &dyn Fn(usize) -> f64) -> impl Iterator<Item = f64> {
        let inputs = self.coefficients.iter().map(|(input, _)| x(*input));
        inputs.chain([1.0]).take(self.free())
    }

    fn move_by<'s>(
        &self,
        function: &mut MembershipFunction,
        steps: &mut impl Iterator<Item = &'s f64>,
    ) {
        let mut steps = steps.take(self.free());
        match function {
            MembershipFunction::Constant { value } => *value += steps.next().unwrap_or(&0.0),
            MembershipFunction::Linear {
                coefficients,
                constant,
            } => {
                let numbers = coefficients.iter_mut().map(|(_, number)| number);
                for (number, step) in numbers.chain([constant]).zip(steps) {
                    *number += step;
                }
            }
            _ => {}
        }
    }
}
