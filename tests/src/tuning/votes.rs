//! The rules of a template as votes, and the conversion of tuned votes to a rule set.

use fuzzy::{
    Model,
    model::{MembershipFunction, Term},
    rule::{Condition, Proposition},
};

use super::rows::Row;

/// The rules of a template: those that are tuned, and those that are fixed.
///
/// A rule of two or more propositions, `input IS term AND other IS term`, is a vote of its first input and is tuned; the
/// propositions after the first are the same in all votes. Votes without an explicit weight, the terms of their input, and all
/// other rules are fixed.
#[derive(Debug, Clone)]
pub struct Votes {
    model: Model,
    /// The voting inputs.
    pub(super) inputs: Vec<Input>,
    /// The common condition of all votes, as pairs of an input and a term.
    given: Vec<(usize, usize)>,
    written: Vec<FixedRule>,
    /// The peaks of the output's terms.
    pub(super) consequents: Vec<f64>,
}

/// A voting input: a partition, and at most one vote for each of its terms.
#[derive(Debug, Clone)]
pub(super) struct Input {
    /// The index among the inputs of the model.
    pub(super) place: usize,
    /// The peaks of the terms of the input.
    pub(super) peaks: Vec<f64>,
    pub(super) votes: Vec<Option<Vote>>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Vote {
    pub(super) rule: usize,
    /// The term of the output.
    pub(super) consequent: usize,
    pub(super) weight: f64,
}

/// A fixed rule.
#[derive(Debug, Clone)]
struct FixedRule {
    condition: Vec<(usize, usize)>,
    consequent: usize,
    weight: f64,
}

/// A weighted sum of consequents, and the sum of the weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct WeightedSum {
    pub(super) values: f64,
    pub(super) weights: f64,
}

impl WeightedSum {
    pub(super) fn add(&mut self, weight: f64, value: f64) {
        self.values += weight * value;
        self.weights += weight;
    }
}

impl Input {
    /// The sum of the input's votes at a value.
    pub(super) fn sum(&self, x: f64, consequents: &[f64]) -> WeightedSum {
        let mut sum = WeightedSum::default();
        self.degrees(x, |term, degree| {
            if let Some(vote) = self.votes[term] {
                sum.add(degree * vote.weight, consequents[vote.consequent]);
            }
        });
        sum
    }

    /// Calls `take` with each term whose degree is above 0, and the degree.
    fn degrees(&self, x: f64, mut take: impl FnMut(usize, f64)) {
        let right = self.peaks.partition_point(|peak| *peak < x);
        if right == 0 || right == self.peaks.len() {
            take(right.saturating_sub(1), 1.0);
            return;
        }
        let (low, high) = (self.peaks[right - 1], self.peaks[right]);
        let part = (x - low) / (high - low);
        take(right - 1, 1.0 - part);
        take(right, part);
    }

    /// Whether the input is tuned: at least one of its votes has a weight below 1.
    pub(super) fn is_tuned(&self) -> bool {
        self.votes.iter().flatten().any(|vote| vote.weight < 1.0)
    }

    /// Whether the peaks rise, at least one vote has a weight, and the risk never falls as the input rises, whatever
    /// the other votes are. The last condition is met if, from each term to the next, the pull of the vote towards
    /// the highest consequent does not decrease, and its pull towards the lowest consequent does not increase.
    pub(super) fn is_sound(&self, consequents: &[f64]) -> bool {
        let low = consequents.iter().copied().fold(f64::INFINITY, f64::min);
        let high = consequents
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let pulls = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let pull = |vote: &Option<Vote>| {
                vote.map_or(0.0, |vote| vote.weight * of(consequents[vote.consequent]))
            };
            self.votes.iter().map(pull).collect()
        };
        self.peaks.is_sorted_by(|a, b| a < b)
            && pulls(&|peak| peak - low).is_sorted_by(|a, b| *a <= b + 1e-9)
            && pulls(&|peak| high - peak).is_sorted_by(|a, b| *a >= b - 1e-9)
            && self.votes.iter().flatten().any(|vote| vote.weight > 0.0)
    }
}

impl Votes {
    /// The votes of a template.
    ///
    /// # Errors
    ///
    /// A rule has another form, names an unknown input or term, or two rules are votes of one term.
    pub fn new(template: &Model) -> Result<Votes, String> {
        let output = template.outputs.first().ok_or("no output")?;
        let consequents = peaks(&output.variable.terms)?;
        let mut votes = Votes {
            model: template.clone(),
            inputs: Vec::new(),
            given: Vec::new(),
            written: Vec::new(),
            consequents,
        };
        for (rule, written) in template.rules.iter().enumerate() {
            let text = written.rule.to_string();
            let [said] = &written.rule.consequents[..] else {
                return Err(format!("more than one consequent: {text}"));
            };
            let terms = &output.variable.terms;
            let consequent = terms.iter().position(|term| term.name == said.term.text);
            let consequent = consequent.ok_or_else(|| format!("unknown term: {text}"))?;
            let weight = written.rule.weight;
            let condition = propositions(template, &written.rule.condition)
                .ok_or_else(|| format!("a rule is `IF input IS term AND ...`: {text}"))?;
            let [(place, term), given @ ..] = &condition[..] else {
                return Err(format!("no condition: {text}"));
            };
            if given.is_empty() {
                votes.written.push(FixedRule {
                    condition,
                    consequent,
                    weight,
                });
                continue;
            }
            if votes.inputs.is_empty() {
                votes.given = given.to_vec();
            }
            if votes.given != *given {
                return Err(format!("other conditions than the rules before: {text}"));
            }
            let vote = Vote {
                rule,
                consequent,
                weight,
            };
            let known = votes.inputs.iter().position(|input| input.place == *place);
            let known = match known {
                Some(known) => known,
                None => {
                    let terms = &template.inputs[*place].terms;
                    votes.inputs.push(Input {
                        place: *place,
                        peaks: peaks(terms)?,
                        votes: vec![None; terms.len()],
                    });
                    votes.inputs.len() - 1
                }
            };
            if votes.inputs[known].votes[*term].replace(vote).is_some() {
                return Err(format!("a second rule of this term: {text}"));
            }
        }
        let is_sound = |input: &Input| input.is_sound(&votes.consequents);
        match votes.inputs.iter().all(is_sound) {
            true => Ok(votes),
            false => {
                Err("the risk falls as an input rises, or its rules have no weight".to_owned())
            }
        }
    }

    /// The names of the inputs of the rule set.
    pub fn names(&self) -> Vec<&str> {
        self.model
            .inputs
            .iter()
            .map(|input| input.name.as_str())
            .collect()
    }

    /// The range of a voting input.
    pub(super) fn range(&self, input: &Input) -> (f64, f64) {
        let variable = &self.model.inputs[input.place];
        (variable.low, variable.high)
    }

    /// The degree of the common condition of all votes at a row, and the weighted sum of the fixed rules.
    pub(super) fn given(&self, inputs: &[f64]) -> (f64, WeightedSum) {
        let degree = |condition: &[(usize, usize)]| {
            let degrees = condition.iter().map(|(place, term)| {
                self.model.inputs[*place].terms[*term].membership(inputs[*place])
            });
            degrees.product::<f64>()
        };
        let mut sum = WeightedSum::default();
        for rule in &self.written {
            let weight = degree(&rule.condition) * rule.weight;
            sum.add(weight, self.consequents[rule.consequent]);
        }
        (degree(&self.given), sum)
    }

    /// The risk at a row, in %.
    pub fn risk_pct(&self, inputs: &[f64]) -> f64 {
        let (given, mut sum) = self.given(inputs);
        for input in &self.inputs {
            let votes = input.sum(inputs[input.place], &self.consequents);
            sum.values += given * votes.values;
            sum.weights += given * votes.weights;
        }
        sum.values / sum.weights.max(1e-9)
    }

    /// The rule set, without votes of weight 0. The support of each vote is the sum of the degrees of its antecedent over the
    /// rows, and its note the share of rows that became critical.
    pub fn rule_set(&self, rows: &[Row]) -> Model {
        let mut model = self.model.clone();
        let mut dropped = Vec::new();
        for input in &self.inputs {
            let variable = &mut model.inputs[input.place];
            let terms = std::mem::take(&mut variable.terms);
            let names = terms.iter().map(|term| term.name.as_str());
            *variable = variable
                .clone()
                .partition_at(names.zip(input.peaks.iter().copied()));
            let mut support = vec![[0.0; 2]; input.votes.len()];
            for row in rows {
                let (given, _) = self.given(&row.inputs);
                input.degrees(row.inputs[input.place], |term, degree| {
                    support[term][0] += given * degree;
                    if row.is_critical {
                        support[term][1] += given * degree;
                    }
                });
            }
            for (vote, [all, critical]) in input.votes.iter().zip(support) {
                let Some(vote) = vote else { continue };
                if vote.weight == 0.0 {
                    dropped.push(vote.rule);
                    continue;
                }
                let rule = &mut model.rules[vote.rule];
                let terms = &model.outputs[0].variable.terms;
                rule.rule.consequents[0].term = terms[vote.consequent].name.as_str().into();
                rule.rule.weight = vote.weight;
                rule.support = Some(all.round() as u64);
                rule.note = Some(format!(
                    "{:.1} % of them became critical",
                    100.0 * critical / all
                ));
            }
        }
        let mut place = 0..;
        model
            .rules
            .retain(|_| place.next().is_none_or(|place| !dropped.contains(&place)));
        model
    }
}

/// The propositions of a conjunction, each as the indices of its input and its term.
fn propositions(model: &Model, condition: &Condition) -> Option<Vec<(usize, usize)>> {
    let find = |proposition: &Proposition| {
        let name = &proposition.variable.text;
        let place = model.inputs.iter().position(|input| input.name == *name)?;
        let term = &proposition.term.as_ref()?.text;
        let mut terms = model.inputs[place].terms.iter();
        let term = terms.position(|known| known.name == *term)?;
        proposition.hedges.is_empty().then_some((place, term))
    };
    match condition {
        Condition::Is(proposition) => Some(vec![find(proposition)?]),
        Condition::And(all) => {
            let each = all.iter().map(|part| match part {
                Condition::Is(proposition) => find(proposition),
                _ => None,
            });
            each.collect()
        }
        Condition::Not(_) | Condition::Or(_) => None,
    }
}

fn peaks(terms: &[Term]) -> Result<Vec<f64>, String> {
    let peak = |term: &Term| match term.membership_function {
        MembershipFunction::Triangle { peak, .. } => Ok(peak),
        MembershipFunction::LeftShoulder { top, .. }
        | MembershipFunction::RightShoulder { top, .. } => Ok(top),
        _ => Err(format!("term `{}` is not of a partition", term.name)),
    };
    terms.iter().map(peak).collect()
}
