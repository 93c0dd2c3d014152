//! The points at which two rule sets are compared.

use fuzzy::{
    Model,
    model::{Term, Variable},
    rule::Condition,
};

use super::antecedent::parts;

/// The maximum number of grid points; if the grid has more, a sample of this size is drawn.
pub(crate) const MAX_ON_THE_GRID: usize = 50_000;

/// The number of random points between those of the grid.
pub(crate) const BETWEEN: usize = 40_000;

/// The number of points per rule at which the rule fires.
pub(crate) const FOR_EACH_RULE: usize = 50;

/// The points, in random order, as one column for each input: combinations of the corners of its terms and of the
/// midpoints between them (all, or a random choice if there are too many), random points between the corners, and
/// points at which each rule fires.
pub(crate) fn points(model: &Model, seed: u64) -> Vec<Vec<f64>> {
    let mut random = fastrand::Rng::with_seed(seed);
    let bends: Vec<Vec<f64>> = model.inputs.iter().map(bends).collect();
    let levels: Vec<Vec<f64>> = bends.iter().map(|bends| with_middles(bends)).collect();
    let combinations = levels
        .iter()
        .try_fold(1, |count: usize, levels| count.checked_mul(levels.len()))
        .filter(|count| *count <= MAX_ON_THE_GRID);
    let mut rows: Vec<Vec<f64>> = match combinations {
        Some(count) => (0..count)
            .map(|index| combination(&levels, index))
            .collect(),
        None => {
            let mut draw = || {
                let one = |levels: &Vec<f64>| random.choice(levels).copied().unwrap_or(0.0);
                levels.iter().map(one).collect()
            };
            (0..MAX_ON_THE_GRID).map(|_| draw()).collect()
        }
    };
    rows.extend((0..BETWEEN).map(|_| {
        bends
            .iter()
            .map(|bends| between(bends, &mut random))
            .collect()
    }));
    for rule in &model.rules {
        let near = firing(model, &rule.rule.condition, &bends);
        rows.extend((0..FOR_EACH_RULE).map(|_| {
            let one = |pieces: &Vec<[f64; 2]>| {
                let [from, to] = random.choice(pieces).copied().unwrap_or([0.0; 2]);
                from + random.f64() * (to - from)
            };
            near.iter().map(one).collect()
        }));
    }
    random.shuffle(&mut rows);
    let column = |input: usize| {
        rows.iter()
            .filter_map(|row| row.get(input).copied())
            .collect()
    };
    (0..model.inputs.len()).map(column).collect()
}

/// The corners of the terms within the range, and the ends of the range, ascending.
fn bends(input: &Variable) -> Vec<f64> {
    let of_term = |term: &Term| match term.membership_function.corners() {
        Some(corners) => corners.iter().map(|(x, _)| *x).collect::<Vec<f64>>(),
        // Curved shapes have no corners. Their parameters, and the sums and differences of two parameters, are used
        // instead: these include the highest point and points one width away from it.
        None => {
            let parameters = term.membership_function.parameters();
            let numbers = parameters.iter().map(|(.., value)| *value);
            let numbers: Vec<f64> = numbers.collect();
            let around = numbers
                .iter()
                .flat_map(|a| numbers.iter().map(move |b| a + b));
            let below = numbers
                .iter()
                .flat_map(|a| numbers.iter().map(move |b| a - b));
            numbers.iter().copied().chain(around).chain(below).collect()
        }
    };
    let mut bends: Vec<f64> = input.terms.iter().flat_map(of_term).collect();
    bends.retain(|x| (input.low..=input.high).contains(x));
    bends.extend([input.low, input.high]);
    bends.sort_by(f64::total_cmp);
    bends.dedup();
    bends
}

fn with_middles(bends: &[f64]) -> Vec<f64> {
    let middles = bends.windows(2).filter_map(|pair| match pair {
        [from, to] => Some(0.5 * (from + to)),
        _ => None,
    });
    bends.iter().copied().chain(middles).collect()
}

/// Returns the combination with the given number.
fn combination(levels: &[Vec<f64>], mut index: usize) -> Vec<f64> {
    let one = |levels: &Vec<f64>| {
        let value = levels.get(index % levels.len()).copied();
        index /= levels.len();
        value.unwrap_or(0.0)
    };
    levels.iter().map(one).collect()
}

/// A random value between two neighbours. All pairs are equally likely, so narrow terms get as many points as wide
/// ones.
fn between(bends: &[f64], random: &mut fastrand::Rng) -> f64 {
    let left = random.usize(..bends.len().saturating_sub(1).max(1));
    match bends.get(left..left + 2) {
        Some([from, to]) => from + random.f64() * (to - from),
        _ => bends.first().copied().unwrap_or(0.0),
    }
}

/// For each input, the intervals between corners in which a term of the antecedent has a degree above 0; all intervals
/// if the antecedent does not name the input.
fn firing(model: &Model, condition: &Condition, bends: &[Vec<f64>]) -> Vec<Vec<[f64; 2]>> {
    let parts = parts(model, condition).unwrap_or_default();
    let of_input = |(input, bends): (&Variable, &Vec<f64>)| {
        let named = parts.iter().find(|part| part.variable == input.name);
        let named = named.and_then(|part| part.terms.as_ref());
        let fires = |x: f64| {
            let mut terms = input.terms.iter().enumerate();
            named.is_none_or(|named| {
                terms.any(|(i, term)| named.contains(&i) && term.membership(x) > 0.0)
            })
        };
        let pieces = bends.windows(2).filter_map(|pair| match pair {
            [from, to] => Some([*from, *to]),
            _ => None,
        });
        let fitting = pieces.filter(|[from, to]| fires(0.5 * (from + to)));
        let fitting: Vec<[f64; 2]> = fitting.collect();
        match fitting.is_empty() {
            true => vec![[input.low, input.high]],
            false => fitting,
        }
    };
    model.inputs.iter().zip(bends).map(of_input).collect()
}
