//! Evaluates a rule set by definition: every formula is written a second time, independently of the engine, and every
//! integral is a plain sum over many samples. Slow.

use std::collections::BTreeMap;

use fuzzy::model::{
    Activation, Comparison, Defuzzifier, MembershipFunction, Model, NoRuleFires, Output, Rule,
    Term, Variable,
};
use fuzzy::rule::{Condition, Proposition};

use super::number::Dual;
use super::operators::{and, hedged, or};
use super::sets::{FiredTerm, Kinks, aggregated, crossings, highest, levels};
use super::shapes::{membership, parameters};

/// The aggregated set of an output, as the argument of a defuzzifier.
#[expect(missing_docs, reason = "each says what it is")]
pub struct Set<'a> {
    pub low: f64,
    pub high: f64,
    /// The ends of the range, and the parameters of shapes that are positions.
    pub cuts: Vec<f64>,
    /// The positions of singletons, if all terms are singletons; the degrees between them are ignored.
    pub places: Vec<f64>,
    pub defuzzifier: Defuzzifier,
    pub degree: &'a dyn Fn(f64) -> f64,
    pub slope: &'a dyn Fn(f64) -> f64,
    /// Functions that change their sign where the set has a kink or a step. The first list is about the implication of
    /// single terms, the second about the aggregation of several terms.
    pub kinks: [Kinks<'a>; 2],
}

/// A function that defuzzifies a [`Set`]; it returns `None` if the set is 0 everywhere.
pub type Defuzzify<'a> = &'a dyn Fn(&Set<'_>) -> Option<f64>;

/// The value of each output at a point; `None` if no rule fires and there is no default. The range is divided at the
/// parameters of shapes that are positions, and integrals are sums over `samples` samples in each part.
pub fn evaluate(model: &Model, point: &[f64], samples: usize) -> Vec<Option<f64>> {
    evaluate_with(model, point, &|set| Some(sampled(set, samples)))
}

/// Works like [`evaluate`], with a defuzzifier provided by the caller.
pub fn evaluate_with(model: &Model, point: &[f64], defuzzify: Defuzzify<'_>) -> Vec<Option<f64>> {
    let mut values = Values::new();
    for (variable, x) in model.inputs.iter().zip(point) {
        values.insert(
            &variable.name,
            Some((variable, x.clamp(variable.low, variable.high))),
        );
    }
    // In a chain, each round adds the outputs that read only known outputs.
    let mut numbers = vec![None; model.outputs.len()];
    while values.len() < model.inputs.len() + model.outputs.len() {
        let before = values.clone();
        for (output, number) in model.outputs.iter().zip(&mut numbers) {
            let reads = reads(model, output);
            let variable = &output.variable;
            if before.contains_key(&*variable.name)
                || !reads.iter().all(|read| before.contains_key(read))
            {
                continue;
            }
            if reads.iter().all(|read| before[read].is_some()) {
                *number = value(model, output, &before, defuzzify);
            }
            let clamped = number.map(|x: f64| (variable, x.clamp(variable.low, variable.high)));
            values.insert(&variable.name, clamped);
        }
        assert!(values.len() > before.len(), "a circle");
    }
    numbers
}

/// The value of each input, and of each output that is known so far; `None` if it is unknown.
type Values<'m> = BTreeMap<&'m str, Option<(&'m Variable, f64)>>;

/// The names in the conditions of the rules of an output, and in its linear functions.
fn reads<'m>(model: &'m Model, output: &'m Output) -> Vec<&'m str> {
    let mut names = Vec::new();
    let concludes = |rule: &&Rule| {
        let mut consequents = rule.rule.consequents.iter();
        consequents.any(|c| c.output.text == output.variable.name)
    };
    let of_output: Vec<&Rule> = model.rules.iter().filter(concludes).collect();
    for rule in model.rules.iter().filter(|rule| model.is_enabled(rule)) {
        // An activation method reads all rules of its block.
        let requested = model.activation_of(rule) != Activation::General
            && of_output.iter().any(|one| one.block == rule.block);
        if requested || concludes(&rule) {
            rule.rule
                .condition
                .visit(&mut |proposition| names.push(&*proposition.variable.text));
        }
    }
    for term in &output.variable.terms {
        if let MembershipFunction::Linear { coefficients, .. } = &term.membership_function {
            names.extend(coefficients.iter().map(|(name, _)| &**name));
        }
        if let MembershipFunction::Function { formula } = &term.membership_function
            && matches!(
                output.defuzzifier,
                Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum
            )
        {
            names.extend(formula.variables());
        }
    }
    names
}

fn value(
    model: &Model,
    output: &Output,
    values: &Values<'_>,
    defuzzify: Defuzzify<'_>,
) -> Option<f64> {
    let mut fired: Vec<(f64, &Term)> = Vec::new();
    for (rule, strength) in model.rules.iter().zip(strengths(model, output, values)) {
        if strength < model.least_strength {
            continue;
        }
        for consequent in &rule.rule.consequents {
            if consequent.output.text != output.variable.name {
                continue;
            }
            fired.push((
                hedged(&consequent.hedges, strength),
                term(&output.variable.terms, &consequent.term.text),
            ));
        }
    }
    if fired.is_empty() {
        return match output.when_no_rule_fires {
            NoRuleFires::Value(value) | NoRuleFires::Previous(Some(value)) => Some(value),
            NoRuleFires::Undefined | NoRuleFires::Error | NoRuleFires::Previous(None) => None,
        };
    }
    let number = number(model, output, &fired, values, defuzzify)?;
    Some(match output.clamp {
        true => number.clamp(output.variable.low, output.variable.high),
        false => number,
    })
}

/// The firing strengths of the rules that concern an output: rules that conclude it, and rules of a block in which
/// another rule concludes it.
fn strengths(model: &Model, output: &Output, values: &Values<'_>) -> Vec<f64> {
    let concludes = |rule: &Rule| {
        let mut consequents = rule.rule.consequents.iter();
        consequents.any(|c| c.output.text == output.variable.name)
    };
    let in_its_blocks = |rule: &Rule| {
        let mut rules = model.rules.iter();
        rules.any(|other| other.block == rule.block && concludes(other))
    };
    let before: Vec<f64> = model
        .rules
        .iter()
        .map(|rule| {
            let selects = model.activation_of(rule) != Activation::General;
            if model.is_enabled(rule) && (concludes(rule) || selects && in_its_blocks(rule)) {
                rule.rule.weight * degree(model, rule, values, &rule.rule.condition)
            } else {
                0.0
            }
        })
        .collect();
    let after = |i: usize| {
        let (rule, strength) = (&model.rules[i], before[i]);
        let least = model.least_strength;
        let others = || {
            let all = model.rules.iter().zip(&before).enumerate();
            let all = all.filter(|(_, (other, _))| other.block == rule.block);
            all.map(|(j, (_, strength))| (j, *strength))
        };
        let fires = |strength: f64| strength >= least;
        let at_least = |strength: f64, bound: f64| strength > bound || near(strength, bound, least);
        // Whether fewer than `count` rules precede this one.
        let is_kept = |count: u32, before: &dyn Fn(usize, f64) -> bool| {
            let ahead = others().filter(|(j, strength)| *j != i && before(*j, *strength));
            fires(strength) && ahead.count() < count as usize
        };
        let kept = match model.activation_of(rule) {
            Activation::General => true,
            Activation::First {
                rules,
                at_least: bound,
            } => {
                let counts = |s: f64| fires(s) && at_least(s, bound);
                counts(strength) && is_kept(rules, &|j, s| j < i && counts(s))
            }
            Activation::Last {
                rules,
                at_least: bound,
            } => {
                let counts = |s: f64| fires(s) && at_least(s, bound);
                counts(strength) && is_kept(rules, &|j, s| j > i && counts(s))
            }
            Activation::Highest { rules } => {
                is_kept(rules, &|j, s| s > strength || s == strength && j < i)
            }
            Activation::Lowest { rules } => is_kept(rules, &|j, s| {
                fires(s) && (s < strength || s == strength && j < i)
            }),
            Activation::Proportional => {
                return strength / others().map(|(_, strength)| strength).sum::<f64>();
            }
            Activation::Threshold {
                comparison,
                strength: bound,
            } => {
                let equal = near(strength, bound, least);
                match comparison {
                    Comparison::Below => strength < bound && !equal,
                    Comparison::AtMost => strength < bound || equal,
                    Comparison::Equal => equal,
                    Comparison::NotEqual => !equal,
                    Comparison::AtLeast => strength > bound || equal,
                    Comparison::Above => strength > bound && !equal,
                }
            }
        };
        if kept { strength } else { 0.0 }
    };
    (0..before.len()).map(after).collect()
}

fn near(a: f64, b: f64, least: f64) -> bool {
    (a - b).abs() < least
}

fn term<'m>(terms: &'m [Term], name: &str) -> &'m Term {
    terms.iter().find(|term| term.name == name).unwrap()
}

/// The degree of a condition.
fn degree(model: &Model, rule: &Rule, values: &Values<'_>, condition: &Condition) -> f64 {
    let of = |condition: &Condition| degree(model, rule, values, condition);
    let operators = model.operators_of(rule);
    match condition {
        Condition::Is(proposition) => proposed(values, proposition),
        Condition::Not(inner) => 1.0 - of(inner),
        Condition::And(all) => {
            let degrees = all.iter().map(of);
            degrees.reduce(|a, b| and(operators.and, a, b)).unwrap()
        }
        Condition::Or(any) => {
            let degrees = any.iter().map(of);
            degrees.reduce(|a, b| or(operators.or, a, b)).unwrap()
        }
    }
}

fn proposed(values: &Values<'_>, proposition: &Proposition) -> f64 {
    let (variable, value) = values[&*proposition.variable.text].unwrap();
    let x = match &proposition.term {
        Some(name) => {
            let term = term(&variable.terms, &name.text);
            term.height * membership(&term.membership_function, value)
        }
        None => 1.0,
    };
    hedged(&proposition.hedges, x)
}

fn number(
    model: &Model,
    output: &Output,
    fired: &[(f64, &Term)],
    values: &Values<'_>,
    defuzzify: Defuzzify<'_>,
) -> Option<f64> {
    if let Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum = output.defuzzifier {
        let total: f64 = fired.iter().map(|(weight, _)| weight).sum();
        let sum: f64 = fired
            .iter()
            .map(|(weight, term)| weight * consequent(&term.membership_function, values))
            .sum();
        return Some(match output.defuzzifier {
            Defuzzifier::WeightedSum => sum,
            _ => sum / total,
        });
    }
    if output.defuzzifier == Defuzzifier::Tsukamoto {
        let total: f64 = fired.iter().map(|(weight, _)| weight).sum();
        let sums = fired
            .iter()
            .map(|(weight, term)| weight * inverse(term, *weight, &output.variable));
        return Some(sums.sum::<f64>() / total);
    }
    let is_singleton = |term: &Term| {
        matches!(
            term.membership_function,
            MembershipFunction::Singleton { .. }
        )
    };
    let discrete = output.variable.terms.iter().all(is_singleton);
    let places = fired.iter().filter(|_| discrete);
    let mut places: Vec<f64> = places
        .map(|(_, term)| consequent(&term.membership_function, values))
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let operators = model.operators_of_output(output);
    let (low, high) = (output.variable.low, output.variable.high);
    let fired: Vec<FiredTerm<'_>> = fired
        .iter()
        .map(|(strength, term)| (*strength, highest(term, low, high), *term))
        .collect();
    let degree = |x: f64| aggregated(&fired, operators, x);
    let slope = |x: f64| {
        let x = Dual {
            value: x,
            slope: 1.0,
        };
        aggregated(&fired, operators, x).slope
    };
    // Steps must not fall inside the cell of a sample, so the range is cut at all parameters.
    let mut cuts: Vec<f64> = fired
        .iter()
        .flat_map(|(.., term)| parameters(&term.membership_function))
        .collect();
    cuts.retain(|x| low < *x && *x < high);
    cuts.extend([low, high]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    defuzzify(&Set {
        low,
        high,
        cuts,
        places,
        defuzzifier: output.defuzzifier,
        degree: &degree,
        slope: &slope,
        kinks: [levels(&fired, operators), crossings(&fired, operators)],
    })
}

fn sampled(set: &Set<'_>, samples: usize) -> f64 {
    let (high, cuts, aggregated, defuzzifier) = (set.high, &set.cuts, set.degree, set.defuzzifier);
    let places = &set.places;
    // (position, width of the cell, degree)
    let mut set = Vec::new();
    if !places.is_empty() {
        set.extend(places.iter().map(|x| (*x, 1.0, aggregated(*x))));
    } else {
        for ends in cuts.windows(2) {
            let width = (ends[1] - ends[0]) / samples as f64;
            for i in 0..samples {
                let x = ends[0] + (i as f64 + 0.5) * width;
                set.push((x, width, aggregated(x)));
            }
        }
    }
    let area: f64 = set.iter().map(|(_, width, y)| width * y).sum();
    let highest = set.iter().fold(0.0, |most: f64, (_, _, y)| most.max(*y));
    let top = set.iter().filter(|(_, _, y)| *y >= highest * (1.0 - 1e-9));
    match defuzzifier {
        Defuzzifier::Centroid => set.iter().map(|(x, width, y)| x * width * y).sum::<f64>() / area,
        Defuzzifier::Bisector => {
            let mut sum = 0.0;
            for (x, width, y) in &set {
                if sum + width * y >= 0.5 * area {
                    return x - 0.5 * width + (0.5 * area - sum) / y;
                }
                sum += width * y;
            }
            high
        }
        Defuzzifier::SmallestOfMaxima => top.clone().next().unwrap().0,
        Defuzzifier::LargestOfMaxima => top.clone().next_back().unwrap().0,
        _ => {
            let (sum, total) = top.fold((0.0, 0.0), |(sum, total), (x, width, _)| {
                (sum + x * width, total + width)
            });
            sum / total
        }
    }
}

/// The position at which a monotone term has the given degree, by bisection; the end of the range
/// if the position is farther away than 1e6 ranges.
fn inverse(term: &Term, degree: f64, variable: &Variable) -> f64 {
    let of = |x: f64| term.height * membership(&term.membership_function, x);
    let far = 1e6 * (variable.high - variable.low);
    let (mut left, mut right) = (variable.low - far, variable.high + far);
    let rises = of(left) < of(right);
    let degree = degree.min(of(left).max(of(right)));
    for _ in 0..200 {
        let middle = 0.5 * (left + right);
        // If the term has the degree on a plateau, this finds the plateau's end next to the slope: the left end of a rising
        // term, the right end of a falling one.
        if (of(middle) >= degree) == rises {
            right = middle;
        } else {
            left = middle;
        }
    }
    let place = 0.5 * (left + right);
    if (place - variable.low).abs() > 0.9 * far {
        return if place > variable.low {
            variable.high
        } else {
            variable.low
        };
    }
    place
}

fn consequent(shape: &MembershipFunction, values: &Values<'_>) -> f64 {
    match shape {
        MembershipFunction::Constant { value } | MembershipFunction::Singleton { at: value } => {
            *value
        }
        MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let mut z = *constant;
            for (name, coefficient) in coefficients {
                z += coefficient * values[&**name].unwrap().1;
            }
            z
        }
        MembershipFunction::Function { formula } => {
            formula.evaluate(|name| values[name].unwrap().1)
        }
        other => panic!("{other:?} is not a consequent"),
    }
}
