//! Computing explanations: degrees of terms, rules that fired, and aggregated sets.

use alloc::{
    collections::BTreeMap,
    string::{String, ToString},
    vec,
    vec::Vec,
};

use super::{
    Degree, Engine, EvaluateError, ExplainedInput, ExplainedOutput, Explanation, FiredRule,
    Outcome, Share, State,
    operators::{larger, smaller},
};
use crate::model::{
    Activation, Aggregation, Defuzzifier, MembershipFunction, Model, Operators, Output, Rule, Term,
    Variable, concludes, type2::Bound,
};
use crate::rule::{Condition, Proposition};
use crate::table::{self, PartialConjunction};

/// The number of steps at which the aggregated set is sampled.
const STEPS: usize = 200;

impl Engine {
    /// Explains the outputs: returns the degrees of the inputs' terms, the rules that fired with their strengths and
    /// shares, and the aggregated sets.
    ///
    /// This allocates and is slow; use [`Engine::evaluate`] if only the values are needed.
    ///
    /// # Errors
    /// `inputs` does not have one finite value per input.
    ///
    /// # Example: the rules that fire and their firing strengths
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let explanation = Engine::new(&model)?.explain(&[30.0])?;
    /// let strongest = &explanation.rules[0];
    /// assert_eq!(strongest.text, "IF heat IS high THEN speed IS fast");
    /// assert_eq!(strongest.strength, 0.75);
    /// assert!(explanation.outputs[0].rules[0].share > 0.75);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn explain(&self, inputs: &[f64]) -> Result<Explanation, EvaluateError> {
        let model = self.model();
        let outcomes = self.outcomes_at(inputs)?;
        let explained: Vec<ExplainedInput> = model.inputs.iter().zip(inputs).map(input).collect();
        let context = ConditionContext {
            model,
            inputs: &explained,
            outcomes: &outcomes,
        };
        let rules = fired(&context);
        let outputs = model.outputs.iter().zip(&outcomes);
        let outputs =
            outputs.map(|(output, outcome)| explain_output(&context, output, outcome, &rules));
        Ok(Explanation {
            outputs: outputs.collect(),
            inputs: explained,
            rules,
        })
    }

    /// Returns the outcomes at a point. Unlike [`Engine::evaluate`], it does not fail if no rule fires, because an
    /// explanation reports that too.
    pub(super) fn outcomes_at(&self, inputs: &[f64]) -> Result<Vec<Outcome>, EvaluateError> {
        if inputs.len() != self.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: self.inputs.len(),
                got: inputs.len(),
            });
        }
        let mut outcomes = vec![Outcome::default(); self.outputs.len()];
        self.outcomes(&mut self.scratch(), inputs, &mut outcomes);
        match outcomes.first() {
            Some(outcome) if outcome.state == State::InputNotFinite => {
                Err(EvaluateError::InputNotFinite)
            }
            _ => Ok(outcomes),
        }
    }
}

fn input((variable, &given): (&Variable, &f64)) -> ExplainedInput {
    let value = clamped(variable, given);
    ExplainedInput {
        name: variable.name.clone(),
        given,
        value,
        terms: degrees(&variable.terms, value),
    }
}

fn degrees(terms: &[Term], value: f64) -> Vec<Degree> {
    let degree = |term: &Term| Degree {
        term: term.name.clone(),
        degree: term.membership(value),
        lower: term.lower.as_ref().map(|_| term.lower_membership(value)),
    };
    terms.iter().map(degree).collect()
}

/// The values that conditions can read.
pub(super) struct ConditionContext<'a> {
    pub(super) model: &'a Model,
    pub(super) inputs: &'a [ExplainedInput],
    pub(super) outcomes: &'a [Outcome],
}

impl<'a> ConditionContext<'a> {
    /// Returns the input or output with the given name, and its value.
    pub(super) fn variable(&self, name: &str) -> Option<(&'a Variable, Option<f64>)> {
        let inputs = self.model.inputs.iter().zip(self.inputs);
        let inputs = inputs.map(|(variable, input)| (variable, Some(input.value)));
        let outputs = self.model.outputs.iter().zip(self.outcomes);
        let outputs = outputs.map(|(output, outcome)| {
            let (variable, value) = (&output.variable, outcome.value());
            // The value is clamped to the range, as an input would be.
            (variable, value.map(|value| clamped(variable, value)))
        });
        inputs
            .chain(outputs)
            .find(|(variable, _)| variable.name == name)
    }

    /// Returns whether all outputs that an output reads have values. If not, none of its rules is evaluated.
    pub(super) fn is_evaluated(&self, output: &str) -> bool {
        let mut reads = self.model.reads(output).into_iter();
        reads.all(|read| {
            self.variable(read)
                .is_some_and(|(_, value)| value.is_some())
        })
    }
}

fn clamped(variable: &Variable, value: f64) -> f64 {
    larger(variable.low, smaller(variable.high, value))
}

fn fired(context: &ConditionContext<'_>) -> Vec<FiredRule> {
    let mut fired: Vec<FiredRule> = Vec::new();
    let evaluated: Vec<bool> = context
        .model
        .outputs
        .iter()
        .map(|output| context.is_evaluated(&output.variable.name))
        .collect();
    let mut degrees = vec![0.0; context.model.rules.len()];
    let lower_strength = |rule: &Rule| {
        let operators = context.model.operators_of(rule);
        let degree = degree_of(&rule.rule.condition, operators, context, Bound::Lower);
        let strength = rule.rule.weight * degree;
        if strength >= context.model.least_strength {
            strength
        } else {
            0.0
        }
    };
    let mut blocks: BTreeMap<usize, (Activation, Vec<PartialConjunction>)> = BTreeMap::new();
    for ((rule, degree), index) in context.model.rules.iter().zip(&mut degrees).zip(0..) {
        let mut outputs = context.model.outputs.iter().zip(&evaluated);
        let is_evaluated = outputs.any(|(output, evaluated)| *evaluated && concludes(rule, output));
        if !is_evaluated || !context.model.is_enabled(rule) {
            continue;
        }
        let operators = context.model.operators_of(rule);
        *degree = degree_of(&rule.rule.condition, operators, context, Bound::Upper);
        let activation = context.model.activation_of(rule);
        let (_, strengths) = blocks.entry(rule.block).or_insert((activation, Vec::new()));
        strengths.push(PartialConjunction::new(rule.rule.weight * *degree, index));
    }
    let least = context.model.least_strength;
    for (activation, mut strengths) in blocks.into_values() {
        activation.activate(least, &mut strengths);
        for (strength, index) in strengths.iter().map(PartialConjunction::parts) {
            let index = index as usize;
            if strength >= least
                && let Some(rule) = context.model.rules.get(index)
            {
                fired.push(FiredRule {
                    rule: index,
                    text: rule.rule.to_string(),
                    degree: degrees[index],
                    strength,
                    lower: context
                        .model
                        .reads_type2(rule)
                        .then(|| lower_strength(rule)),
                });
            }
        }
    }
    // Rules of equal strength stay in the order of the file.
    fired.sort_by(|a, b| b.strength.total_cmp(&a.strength).then(a.rule.cmp(&b.rule)));
    fired
}

/// Returns a bound of the degree of a condition, computed from its syntax tree. Without type-2 terms both bounds equal
/// the degree.
pub(super) fn degree_of(
    condition: &Condition,
    operators: Operators,
    context: &ConditionContext<'_>,
    bound: Bound,
) -> f64 {
    let degree = |part: &Condition| degree_of(part, operators, context, bound);
    match condition {
        Condition::Is(proposition) => degree_of_proposition(proposition, context, bound),
        Condition::Not(inner) => 1.0 - degree_of(inner, operators, context, bound.opposite()),
        Condition::And(parts) => {
            let joined = parts
                .iter()
                .map(degree)
                .reduce(|a, b| operators.and.of(a, b));
            joined.unwrap_or(0.0)
        }
        Condition::Or(parts) => {
            let joined = parts
                .iter()
                .map(degree)
                .reduce(|a, b| operators.or.of(a, b));
            joined.unwrap_or(0.0)
        }
    }
}

fn degree_of_proposition(
    proposition: &Proposition,
    context: &ConditionContext<'_>,
    bound: Bound,
) -> f64 {
    let named = context.variable(&proposition.variable.text);
    let membership = named.and_then(|(variable, value)| {
        let name = &proposition.term.as_ref()?.text;
        let term = variable.terms.iter().find(|term| term.name == *name)?;
        Some(term.bound(bound.through(&proposition.hedges), value?))
    });
    let hedges = proposition.hedges.iter().rev();
    hedges.fold(membership.unwrap_or(0.0), |degree, hedge| hedge.of(degree))
}

fn explain_output(
    context: &ConditionContext<'_>,
    output: &Output,
    outcome: &Outcome,
    fired: &[FiredRule],
) -> ExplainedOutput {
    let (model, variable) = (context.model, &output.variable);
    let fired = if context.is_evaluated(&variable.name) {
        fired
    } else {
        &[]
    };
    let weighted = output.defuzzifier.is_weighted();
    let operators = model.operators_of_output(output);
    let mut active: Vec<ActiveConsequent<'_>> = Vec::new();
    for rule in fired {
        let consequents = model
            .rules
            .get(rule.rule)
            .map(|r| r.rule.consequents.as_slice());
        for consequent in consequents.unwrap_or_default() {
            let named = |term: &&Term| term.name == consequent.term.text;
            if consequent.output.text == variable.name
                && let Some(term) = variable.terms.iter().find(named)
            {
                active.push(ActiveConsequent {
                    rule: rule.rule,
                    term,
                    strength: consequent.hedged(rule.strength),
                    lower: rule.lower.map(|lower| consequent.hedged(lower)),
                    part: 0.0,
                });
            }
        }
    }
    let mut set = Vec::new();
    let step = |i: f64| variable.low + (variable.high - variable.low) * i / STEPS as f64;
    let discrete = output.is_discrete();
    if weighted {
        active.iter_mut().for_each(|one| one.part = one.strength);
    } else if discrete {
        let terms = variable.terms.iter();
        let mut places: Vec<f64> = terms.filter_map(|t| t.membership_function.at()).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        for x in places {
            set.push((x, aggregated(&active, operators, x)));
            add_parts(&mut active, operators, x);
        }
    } else {
        set = (0..=STEPS)
            .map(|i| {
                (
                    step(i as f64),
                    aggregated(&active, operators, step(i as f64)),
                )
            })
            .collect();
        for i in 0..STEPS {
            add_parts(&mut active, operators, step(i as f64 + 0.5));
        }
    }
    let whole: f64 = active.iter().map(|one| one.part).sum();
    let mut rules: Vec<Share> = active
        .iter()
        .map(|one| Share {
            rule: one.rule,
            term: one.term.name.clone(),
            strength: one.strength,
            lower: one.lower,
            share: if whole > 0.0 { one.part / whole } else { 0.0 },
            value: (weighted || discrete)
                .then(|| number(output, one, context))
                .flatten(),
            implied: if weighted || discrete {
                Vec::new()
            } else {
                let at = |i: usize| step(i as f64);
                let implied = (0..=STEPS).map(|i| (at(i), one.degree(operators, at(i))));
                implied.collect()
            },
        })
        .collect();
    rules.sort_by(|a, b| b.share.total_cmp(&a.share));
    let value = outcome.value();
    let is_interval = matches!(outcome.state, State::Interval { .. });
    let numbers = output.defuzzifier.takes_numbers();
    let sets = variable
        .terms
        .iter()
        .all(|term| !matches!(term.membership_function, MembershipFunction::Linear { .. }));
    ExplainedOutput {
        name: variable.name.clone(),
        value,
        low: outcome.low().filter(|_| is_interval),
        high: outcome.high().filter(|_| is_interval),
        is_default: matches!(outcome.state, State::Default(_)),
        keeps_previous: output.keeps_previous(),
        coverage: outcome.coverage,
        reads: model
            .reads(&variable.name)
            .into_iter()
            .map(String::from)
            .collect(),
        rules,
        terms: match value {
            Some(value) if sets && !numbers => degrees(&variable.terms, value),
            _ => Vec::new(),
        },
        set,
    }
}

/// Returns the number that a rule yields for a Takagi-Sugeno or Tsukamoto output at the values of the inputs.
fn number(
    output: &Output,
    active: &ActiveConsequent<'_>,
    context: &ConditionContext<'_>,
) -> Option<f64> {
    let (variable, term) = (&output.variable, active.term);
    if output.defuzzifier == Defuzzifier::Tsukamoto {
        let place = term
            .membership_function
            .inverse(smaller(1.0, active.strength / term.height));
        return Some(table::finite(place, variable.low, variable.high));
    }
    match &term.membership_function {
        MembershipFunction::Constant { value } => Some(*value),
        MembershipFunction::Singleton { at } => Some(*at),
        MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let parts = coefficients.iter().map(|(name, factor)| {
                let (_, value) = context.variable(name)?;
                Some(factor * value?)
            });
            Some(parts.sum::<Option<f64>>()? + constant)
        }
        MembershipFunction::Function { formula } => {
            let value = |name: &str| context.variable(name).and_then(|(_, value)| value);
            let value = formula.evaluate(|name| value(name).unwrap_or(f64::NAN));
            value.is_finite().then_some(value)
        }
        _ => None,
    }
}

/// A consequent of a rule that fired.
struct ActiveConsequent<'m> {
    rule: usize,
    term: &'m Term,
    strength: f64,
    lower: Option<f64>,
    /// The contribution of the consequent to the result, accumulated so far.
    part: f64,
}

impl ActiveConsequent<'_> {
    fn degree(&self, operators: Operators, x: f64) -> f64 {
        operators
            .implication
            .of(self.strength, self.term.membership(x))
    }
}

fn aggregated(active: &[ActiveConsequent<'_>], operators: Operators, x: f64) -> f64 {
    let degrees = active.iter().map(|one| one.degree(operators, x));
    degrees.fold(0.0, |all, degree| operators.aggregation.of(all, degree))
}

/// Adds the contribution of each consequent at `x`. With maximum as aggregation, only the highest consequent
/// contributes.
fn add_parts(active: &mut [ActiveConsequent<'_>], operators: Operators, x: f64) {
    if operators.aggregation != Aggregation::Maximum {
        for one in active {
            one.part += one.degree(operators, x);
        }
        return;
    }
    let mut highest: Option<(usize, f64)> = None;
    for (i, one) in active.iter().enumerate() {
        let degree = one.degree(operators, x);
        if degree > highest.map_or(0.0, |(_, most)| most) {
            highest = Some((i, degree));
        }
    }
    if let Some((i, degree)) = highest
        && let Some(one) = active.get_mut(i)
    {
        one.part += degree;
    }
}
