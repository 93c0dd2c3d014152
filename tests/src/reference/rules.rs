//! What a rule set means, by definition: every formula written out a second time, apart from the engine, and
//! every integral a plain sum over many samples. Slow, and nothing else.

use std::collections::BTreeMap;

use fuzzy::model::{
    Activation, Aggregation, Comparison, Conjunction, Defuzzifier, Disjunction, MembershipFunction,
    Model, NoRuleFires, Operators, Output, Rule, Term, Variable,
};
use fuzzy::rule::{Condition, Hedge, Proposition};

use super::number::{Dual, Number};
use super::shapes::{membership, parameters};

/// The aggregated set of an output, for a function that makes a number of it.
#[expect(missing_docs, reason = "each says what it is")]
pub struct Set<'a> {
    pub low: f64,
    pub high: f64,
    /// The ends of the range and all places at which a shape has a parameter.
    pub cuts: Vec<f64>,
    /// The places of singletons, where all terms are; the degrees between them count for nothing.
    pub places: Vec<f64>,
    pub defuzzifier: Defuzzifier,
    pub degree: &'a dyn Fn(f64) -> f64,
    pub slope: &'a dyn Fn(f64) -> f64,
    /// Functions that change their sign where the set has a kink or a step: those of single terms, and those of several.
    pub kinks: [Kinks<'a>; 2],
}

/// Functions of the place along the range of an output.
type Kinks<'a> = Vec<Box<dyn Fn(f64) -> f64 + 'a>>;

/// Defuzzifies a [`Set`]; `None` of one that is 0 everywhere.
pub type Defuzzify<'a> = &'a dyn Fn(&Set<'_>) -> Option<f64>;

/// The value of each output at a point; `None` where no rule fires and the author chose no value. The integrals are sums of so
/// many samples between every two places at which a shape has a parameter.
pub fn evaluate(model: &Model, point: &[f64], samples: usize) -> Vec<Option<f64>> {
    evaluate_with(model, point, &|set| Some(sampled(set, samples)))
}

/// [`evaluate`] with integrals of the caller.
pub fn evaluate_with(model: &Model, point: &[f64], defuzzify: Defuzzify<'_>) -> Vec<Option<f64>> {
    let mut values = Values::new();
    for (variable, x) in model.inputs.iter().zip(point) {
        values.insert(
            &variable.name,
            Some((variable, x.clamp(variable.low, variable.high))),
        );
    }
    // Of a chain, each round adds the outputs whose conditions read nothing that is still to come.
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

/// The value of each input, and of each output that is known so far; `None` where it has none.
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
        // An activation method asks all rules of its block.
        let asked = model.activation_of(rule) != Activation::General
            && of_output.iter().any(|one| one.block == rule.block);
        if asked || concludes(&rule) {
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

/// The strength with which each rule fires that has to do with an output: that concludes it, or stands in a block of which a
/// rule does.
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
        // Whether fewer than so many rules come before this one.
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

fn hedged(hedges: &[Hedge], mut x: f64) -> f64 {
    for hedge in hedges.iter().rev() {
        x = match hedge {
            Hedge::Not => 1.0 - x,
            Hedge::Very => x.powi(2),
            Hedge::Somewhat => x.sqrt(),
            Hedge::Extremely if x <= 0.5 => 2.0 * x.powi(2),
            Hedge::Extremely => 1.0 - 2.0 * (1.0 - x).powi(2),
            Hedge::Seldom if x <= 0.5 => (x / 2.0).sqrt(),
            Hedge::Seldom => 1.0 - ((1.0 - x) / 2.0).sqrt(),
            Hedge::Any => 1.0,
        };
    }
    x
}

/// Operators with a step take what is so close to it for it, and degrees so close to each other are equal.
pub(super) const ROUNDING: f64 = 1e-12;

fn and<T: Number>(operator: Conjunction, a: T, b: T) -> T {
    let (x, y, one) = (a.value(), b.value(), T::of(1.0));
    match operator {
        Conjunction::Minimum => a.min(b),
        Conjunction::Product => a * b,
        Conjunction::BoundedDifference => (a + b - one).max(T::of(0.0)),
        Conjunction::Drastic if x.max(y) >= 1.0 - ROUNDING => a.min(b),
        Conjunction::Drastic => T::of(0.0),
        Conjunction::Einstein => a * b / (T::of(2.0) - (a + b - a * b)),
        Conjunction::Hamacher if x + y == 0.0 => T::of(0.0),
        Conjunction::Hamacher => a * b / (a + b - a * b),
        Conjunction::NilpotentMinimum if x + y - 1.0 > ROUNDING || x.max(y) == 1.0 => a.min(b),
        Conjunction::NilpotentMinimum => T::of(0.0),
    }
}

fn or<T: Number>(operator: Disjunction, a: T, b: T) -> T {
    let (x, y, one) = (a.value(), b.value(), T::of(1.0));
    match operator {
        Disjunction::Maximum => a.max(b),
        Disjunction::ProbabilisticSum => a + b - a * b,
        Disjunction::BoundedSum => (a + b).min(one),
        Disjunction::Drastic if x.min(y) <= ROUNDING => a.max(b),
        Disjunction::Drastic => one,
        Disjunction::Einstein => (a + b) / (one + a * b),
        Disjunction::Hamacher if x == 1.0 || y == 1.0 => one,
        Disjunction::Hamacher => (a * (one - b) + b * (one - a)) / (one - a * b),
        Disjunction::NilpotentMaximum if 1.0 - x - y > ROUNDING || x.min(y) == 0.0 => a.max(b),
        Disjunction::NilpotentMaximum => one,
    }
}

/// Two activated degrees.
fn aggregate<T: Number>(aggregation: Aggregation, a: T, b: T) -> T {
    match aggregation {
        Aggregation::Maximum => a.max(b),
        Aggregation::ProbabilisticSum => or(Disjunction::ProbabilisticSum, a, b),
        Aggregation::BoundedSum => or(Disjunction::BoundedSum, a, b),
        Aggregation::Sum => a + b,
        Aggregation::Drastic => or(Disjunction::Drastic, a, b),
        Aggregation::Einstein => or(Disjunction::Einstein, a, b),
        Aggregation::Hamacher => or(Disjunction::Hamacher, a, b),
        Aggregation::NilpotentMaximum => or(Disjunction::NilpotentMaximum, a, b),
    }
}

/// Whether a strength cuts nothing off a term.
fn is_whole(strength: f64, highest: f64) -> bool {
    strength >= highest * (1.0 - ROUNDING)
}

/// A fired term at `x`. A strength that is its highest degree but for rounding cuts nothing off, and of what it cuts the drastic
/// operator leaves no single peak.
fn activate<T: Number>(implication: Conjunction, (strength, highest, term): Fired<'_>, x: T) -> T {
    let degree = T::of(term.height) * membership(&term.membership_function, x);
    let whole = is_whole(strength, highest);
    let activated = and(implication, T::of(strength), degree);
    match implication {
        Conjunction::Minimum if whole => degree,
        Conjunction::NilpotentMinimum if whole && activated.value() > 0.0 => degree,
        Conjunction::Drastic if strength >= 1.0 - ROUNDING => degree,
        Conjunction::Drastic => {
            let at = Dual {
                value: x.value(),
                slope: 1.0,
            };
            let slope = membership(&term.membership_function, at).slope;
            if slope == 0.0 { activated } else { T::of(0.0) }
        }
        _ => activated,
    }
}

/// The highest degree of a term within the range.
fn highest(term: &Term, low: f64, high: f64) -> f64 {
    const SAMPLES: usize = 500;
    let of = |x: f64| term.height * membership(&term.membership_function, x);
    let step = (high - low) / SAMPLES as f64;
    let even = (0..=SAMPLES).map(|i| low + step * i as f64);
    let places = parameters(&term.membership_function)
        .into_iter()
        .chain(even);
    let inside = places.filter(|x| low <= *x && *x <= high);
    let best = inside.reduce(|best, x| if of(x) > of(best) { x } else { best });
    let best = best.unwrap_or(low);
    // A top between two samples, by trisection.
    let (mut from, mut to) = ((best - step).max(low), (best + step).min(high));
    for _ in 0..80 {
        let third = (to - from) / 3.0;
        if of(from + third) < of(to - third) {
            from += third;
        } else {
            to -= third;
        }
    }
    of(best).max(of(0.5 * (from + to)))
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
            .map(|(weight, term)| weight * place(term, *weight, &output.variable));
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
    let fired: Vec<Fired<'_>> = fired
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
    // Steps must not fall inside a sample's cell, so the range is cut at all parameters.
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

/// A term with its strength and its highest degree.
type Fired<'m> = (f64, f64, &'m Term);

/// Functions that change their sign where the implication of a term has a kink or a step.
fn levels<'a>(fired: &'a [Fired<'a>], operators: Operators) -> Kinks<'a> {
    let mut kinks: Kinks<'a> = Vec::new();
    for (strength, highest, term) in fired {
        let mut levels = match operators.implication {
            Conjunction::Minimum => vec![*strength],
            Conjunction::BoundedDifference => vec![1.0 - strength],
            Conjunction::NilpotentMinimum => vec![*strength, 1.0 - strength + ROUNDING],
            _ => vec![],
        };
        levels.retain(|level| level != strength || !is_whole(*strength, *highest));
        for level in levels {
            let degree = |x: f64| term.height * membership(&term.membership_function, x);
            kinks.push(Box::new(move |x| degree(x) - level));
        }
    }
    kinks
}

/// Functions that change their sign where the aggregation has a kink or a step.
fn crossings<'a>(fired: &'a [Fired<'a>], operators: Operators) -> Kinks<'a> {
    let mut kinks: Kinks<'a> = Vec::new();
    for i in 0..fired.len() {
        let part = move |j: usize, x: f64| aggregated(&fired[j..=j], operators, x);
        let before = move |x: f64| aggregated(&fired[..i], operators, x);
        match operators.aggregation {
            Aggregation::Maximum | Aggregation::NilpotentMaximum => {
                for j in 0..i {
                    kinks.push(Box::new(move |x| part(i, x) - part(j, x)));
                }
            }
            Aggregation::BoundedSum => {
                kinks.push(Box::new(move |x| {
                    (0..=i).map(|j| part(j, x)).sum::<f64>() - 1.0
                }));
            }
            Aggregation::Drastic => {
                kinks.push(Box::new(move |x| part(i, x) - ROUNDING));
                kinks.push(Box::new(move |x| before(x) - ROUNDING));
            }
            _ => {}
        }
        if i > 0 && operators.aggregation == Aggregation::NilpotentMaximum {
            kinks.push(Box::new(move |x| {
                let (a, b) = (part(i, x), before(x));
                if a.min(b) > 0.0 {
                    1.0 - a - b - ROUNDING
                } else {
                    1.0
                }
            }));
        }
    }
    kinks
}

/// The degree of an aggregated set of terms with their strengths and their highest degrees.
fn aggregated<T: Number>(fired: &[Fired<'_>], operators: Operators, x: T) -> T {
    let parts = fired
        .iter()
        .map(|one| activate(operators.implication, *one, x));
    parts.fold(T::of(0.0), |y, part| {
        aggregate(operators.aggregation, y, part)
    })
}

fn sampled(set: &Set<'_>, samples: usize) -> f64 {
    let (high, cuts, aggregated, defuzzifier) = (set.high, &set.cuts, set.degree, set.defuzzifier);
    let places = &set.places;
    // (place, width of the cell, degree)
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

/// Where a monotone term has a degree, by bisection; the end of the range where that is farther away than 1e6 ranges.
fn place(term: &Term, degree: f64, variable: &Variable) -> f64 {
    let of = |x: f64| term.height * membership(&term.membership_function, x);
    let far = 1e6 * (variable.high - variable.low);
    let (mut left, mut right) = (variable.low - far, variable.high + far);
    let rises = of(left) < of(right);
    let degree = degree.min(of(left).max(of(right)));
    for _ in 0..200 {
        let middle = 0.5 * (left + right);
        // On a plateau towards the slope: a rising term first has a degree from the left, a falling one last.
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
        other => panic!("{other:?} is no consequent"),
    }
}
