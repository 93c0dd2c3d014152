//! A reference implementation of interval type-2 rule sets, independent of the engine: it computes the interval of
//! degrees of every operator, and the centroid for each of many switch points. Slow.

use fuzzy::model::{Defuzzifier, Model, Output, Term};
use fuzzy::rule::{Condition, Proposition};

use super::operators::{ROUNDING, aggregate, and, hedged, or};
use super::shapes::{membership, parameters};

/// A lower and an upper bound.
type Bounds = [f64; 2];

/// The interval of an output.
#[derive(Debug, Clone, Copy)]
#[expect(missing_docs, reason = "named by its fields")]
pub struct Interval {
    pub low: f64,
    pub high: f64,
    /// Nie and Tan: the centroid of the mean of the lower and the upper set.
    pub nie_tan: f64,
    /// Begian, Melek and Mendel: the mean of the centroids of both sets.
    pub begian_melek_mendel: f64,
    /// The area of the lower set divided by the area of the upper set; 1 for weighted numbers.
    pub lower_share: f64,
}

/// Returns the interval of an output at a point; `None` if no rule fires. The range is divided at all parameters of the terms,
/// and each part has `samples` samples.
pub fn interval(model: &Model, output: &Output, point: &[f64], samples: usize) -> Option<Interval> {
    let fired: Vec<(Bounds, &Term)> = model
        .rules
        .iter()
        .flat_map(|rule| {
            let degree = condition(model, point, &rule.rule.condition);
            let strength = degree.map(|degree| {
                let strength = rule.rule.weight * degree;
                if strength < ROUNDING { 0.0 } else { strength }
            });
            let concluded = rule.rule.consequents.iter();
            let concluded = concluded.filter(|it| it.output.text == output.variable.name);
            concluded.map(move |it| {
                let term = named(&output.variable.terms, &it.term.text);
                (strength.map(|strength| hedged(&it.hedges, strength)), term)
            })
        })
        .filter(|(strength, _)| strength[1] > 0.0)
        .collect();
    if fired.is_empty() {
        return None;
    }
    if output.defuzzifier != Defuzzifier::Centroid {
        return weighted(model, output, point, &fired);
    }
    centroids(model, output, &fired, samples)
}

fn named<'m>(terms: &'m [Term], name: &str) -> &'m Term {
    terms.iter().find(|term| term.name == name).unwrap()
}

fn bounds(term: &Term, x: f64) -> Bounds {
    let upper = term.height * membership(&term.membership_function, x);
    let lower = term.lower.as_ref().map_or(upper, |lower| {
        lower.height * membership(&lower.membership_function, x)
    });
    [lower, upper]
}

fn condition(model: &Model, point: &[f64], whole: &Condition) -> Bounds {
    let of = |part: &Condition| condition(model, point, part);
    let join = |parts: &[Condition], operator: &dyn Fn(f64, f64) -> f64| {
        let parts = parts.iter().map(of);
        let joined = parts.reduce(|a, b| [operator(a[0], b[0]), operator(a[1], b[1])]);
        joined.unwrap()
    };
    match whole {
        Condition::Is(proposition) => is(model, point, proposition),
        Condition::Not(inner) => {
            let [lower, upper] = of(inner);
            [1.0 - upper, 1.0 - lower]
        }
        Condition::And(parts) => join(parts, &|a, b| and(model.operators.and, a, b)),
        Condition::Or(parts) => join(parts, &|a, b| or(model.operators.or, a, b)),
    }
}

fn is(model: &Model, point: &[f64], proposition: &Proposition) -> Bounds {
    let mut inputs = model.inputs.iter().zip(point);
    let (input, x) = inputs
        .find(|(input, _)| input.name == proposition.variable.text)
        .unwrap();
    let degrees = match &proposition.term {
        None => [0.0, 0.0],
        Some(name) => bounds(named(&input.terms, &name.text), *x),
    };
    // Each hedge is monotone, so it maps the ends of an interval to the ends of the result.
    let mut ends = degrees.map(|degree| hedged(&proposition.hedges, degree));
    ends.sort_by(f64::total_cmp);
    ends
}

/// The Nie-Tan type reduction, from the areas and moments of the lower and the upper set.
fn nie_tan([lower, upper]: [(f64, f64); 2]) -> f64 {
    (lower.1 + upper.1) / (lower.0 + upper.0)
}

/// The Begian-Melek-Mendel type reduction, from the areas and moments of the lower and the upper set; if the lower set
/// is empty, the centroid of the upper set.
fn begian_melek_mendel([lower, upper]: [(f64, f64); 2]) -> f64 {
    let upper = upper.1 / upper.0;
    match lower.0 > 0.0 {
        true => 0.5 * (lower.1 / lower.0 + upper),
        false => upper,
    }
}

/// The smallest and the largest weighted average, or sum, over all combinations of the ends of the weights.
fn weighted(
    model: &Model,
    output: &Output,
    point: &[f64],
    fired: &[(Bounds, &Term)],
) -> Option<Interval> {
    let number = |term: &Term| match &term.membership_function {
        fuzzy::model::MembershipFunction::Constant { value } => *value,
        fuzzy::model::MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let parts = coefficients.iter().map(|(name, factor)| {
                let index = model.inputs.iter().position(|input| input.name == *name);
                factor * point[index.unwrap()]
            });
            constant + parts.sum::<f64>()
        }
        other => panic!("{other:?}"),
    };
    let numbers: Vec<f64> = fired.iter().map(|(_, term)| number(term)).collect();
    let sums = [0, 1].map(|side| {
        let terms = fired.iter().zip(&numbers);
        let moment = terms.map(|((weights, _), number)| weights[side] * number);
        let area = fired.iter().map(|(weights, _)| weights[side]);
        (area.sum::<f64>(), moment.sum::<f64>())
    });
    let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in 0..1_usize << fired.len() {
        let weight = |i: usize| fired[i].0[corner >> i & 1];
        let total: f64 = (0..fired.len()).map(weight).sum();
        let sum: f64 = (0..fired.len()).map(|i| weight(i) * numbers[i]).sum();
        let value = match output.defuzzifier {
            Defuzzifier::WeightedSum => sum,
            _ if total == 0.0 => continue,
            _ => sum / total,
        };
        ends = (ends.0.min(value), ends.1.max(value));
    }
    Some(Interval {
        low: ends.0,
        high: ends.1,
        nie_tan: nie_tan(sums),
        begian_melek_mendel: begian_melek_mendel(sums),
        lower_share: 1.0,
    })
}

/// The smallest and the largest centroid of the sets that equal one bound up to a switch point, and the other bound
/// beyond it. The centroid of every set between the bounds is between these two.
fn centroids(
    model: &Model,
    output: &Output,
    fired: &[(Bounds, &Term)],
    samples: usize,
) -> Option<Interval> {
    let variable = &output.variable;
    let operators = model.operators;
    let mut cuts = vec![variable.low, variable.high];
    for term in &variable.terms {
        cuts.extend(parameters(&term.membership_function));
        let lower = term.lower.iter();
        cuts.extend(lower.flat_map(|lower| parameters(&lower.membership_function)));
    }
    cuts.retain(|x| (variable.low..=variable.high).contains(x));
    cuts.sort_by(f64::total_cmp);
    // The position of each sample with the areas of the lower and the upper set around it.
    let mut parts: Vec<(f64, Bounds)> = Vec::new();
    for pair in cuts.windows(2) {
        let step = (pair[1] - pair[0]) / samples as f64;
        for i in 0..samples {
            let x = pair[0] + (i as f64 + 0.5) * step;
            let mut degrees = [0.0, 0.0];
            for (strength, term) in fired {
                let degree = bounds(term, x);
                for side in 0..2 {
                    let implied = and(operators.implication, strength[side], degree[side]);
                    degrees[side] = aggregate(operators.aggregation, degrees[side], implied);
                }
            }
            parts.push((x, degrees.map(|degree| degree * step)));
        }
    }
    // First the sets that equal the upper set up to a switch point and the lower set beyond it; then the other way
    // round.
    let [mut area, mut moment] = [[0.0; 2]; 2];
    for (x, areas) in &parts {
        for side in 0..2 {
            area[side] += areas[side];
            moment[side] += areas[side] * x;
        }
    }
    if area[1] <= 0.0 {
        return None;
    }
    let centroid = |area: f64, moment: f64| (area > 0.0).then(|| moment / area);
    let (mut below, mut below_moment) = ([0.0; 2], [0.0; 2]);
    let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
    for (x, areas) in &parts {
        for side in 0..2 {
            below[side] += areas[side];
            below_moment[side] += areas[side] * x;
        }
        let switched = |first: usize, then: usize| {
            centroid(
                below[first] + (area[then] - below[then]),
                below_moment[first] + (moment[then] - below_moment[then]),
            )
        };
        ends.0 = switched(1, 0).map_or(ends.0, |value| ends.0.min(value));
        ends.1 = switched(0, 1).map_or(ends.1, |value| ends.1.max(value));
    }
    Some(Interval {
        low: ends.0,
        high: ends.1,
        nie_tan: nie_tan([0, 1].map(|side| (area[side], moment[side]))),
        begian_melek_mendel: begian_melek_mendel([0, 1].map(|side| (area[side], moment[side]))),
        lower_share: area[0] / area[1],
    })
}
