//! Exports rule sets as plain data for monitors on board. The outputs must have closed forms.

use alloc::string::String;
use core::ops::Range;

use fuzzy::{Engine, table::ClosedForm};

use crate::board::Rules;

/// The reason why a rule set or a profile cannot be exported.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The risk has no closed form.
    #[error(
        "the value of output `{output}` has no closed form, so it cannot be written as a table"
    )]
    NoClosedForm {
        /// The output.
        output: String,
    },
    /// An output keeps its previous value.
    #[error(
        "output `{output}` keeps its previous value where no rule fires, so it depends on more than the inputs"
    )]
    KeepsPrevious {
        /// The output.
        output: String,
    },
    /// The output is an interval, and its interval has no closed form.
    #[error(
        "the interval of output `{output}` has no closed form, so it cannot be written as a table"
    )]
    Type2 {
        /// The output.
        output: String,
    },
    /// The profile has several risks.
    #[error(
        "the profile has the risks `{output}` and `{other}`, but exported code supports only one"
    )]
    SeveralRisks {
        /// The first risk.
        output: String,
        /// The second risk.
        other: String,
    },
}

impl PlanError {
    /// A hint about what can be exported.
    pub fn help(&self) -> &'static str {
        match self {
            PlanError::NoClosedForm { .. } => {
                "the defuzzifiers have a closed form with `implication: minimum` or `product` and `aggregation: maximum` or \
                 `sum` (maxima: `maximum` only), over terms that are not functions, without `samples`; Takagi-Sugeno and \
                 Tsukamoto outputs always have one"
            }
            PlanError::KeepsPrevious { .. } => {
                "set `when_no_rule_fires` to a number, such as 0, or leave that key out"
            }
            PlanError::Type2 { .. } => {
                "use `implication: minimum` or `product` and `aggregation: maximum` or `sum` over terms that are neither \
                 functions nor singletons nor Gaussians with an uncertain mean, or `weighted_average` of numbers; or remove the keys that make terms type-2, \
                 such as `blur` or `lower`"
            }
            PlanError::SeveralRisks { .. } => {
                "write a profile for each risk, and run a monitor for each: the findings are the same"
            }
        }
    }
}

/// A rule set as plain data, to be evaluated on board without a profile.
///
/// # Errors
///
/// If an output has no closed form, or keeps its previous value.
pub fn rules(engine: &Engine) -> Result<Rules<'_>, PlanError> {
    let mut outputs = engine.model().outputs.iter();
    if let Some(output) = outputs.find(|output| output.keeps_previous()) {
        return Err(PlanError::KeepsPrevious {
            output: output.variable.name.clone(),
        });
    }
    rules_for(engine, 0..engine.output_names().len())
}

/// The rule set as plain data, with the values of the given outputs only.
pub(crate) fn rules_for(
    engine: &Engine,
    mut outputs: Range<usize>,
) -> Result<Rules<'_>, PlanError> {
    let (chain, table) = (engine.chain(), engine.table());
    let open = match (chain, table) {
        (Some(chain), _) => {
            outputs.find_map(|output| chain.outputs_without_closed_form(output).next())
        }
        (None, table) => outputs.find(|output| {
            let of = table.and_then(|table| table.outputs.get(*output));
            of.is_none_or(|of| of.form() == ClosedForm::Integrated)
        }),
    };
    match (open, chain.map(|chain| chain.table).or(table)) {
        (None, Some(table)) => Ok(Rules {
            table,
            stages: chain.map_or(&[], |chain| chain.stages),
            indices: chain.map_or(&[], |chain| chain.indices),
        }),
        (open, _) => {
            let index = open.unwrap_or_default();
            let name = engine.output_names().nth(index).unwrap_or_default();
            let output = String::from(name);
            let model = engine.model();
            let is_interval = model
                .outputs
                .get(index)
                .is_some_and(|of| model.has_interval(of));
            Err(match is_interval {
                true => PlanError::Type2 { output },
                false => PlanError::NoClosedForm { output },
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{estimator::Estimator, shipped};
    use fuzzy::model::{Sampling, SamplingRule};

    const SAMPLED: Sampling = Sampling {
        samples: 100,
        rule: SamplingRule::Midpoint,
    };

    #[test]
    fn an_output_without_a_closed_form_has_no_plan() {
        let profile = shipped::flagred_paper().profile().clone();
        let mut rules = shipped::flagred_paper_rules();
        rules.outputs[0].samples = Some(SAMPLED);
        let estimator = Estimator::new(&profile, &rules).unwrap();
        assert!(estimator.at(&[0.3, 0.1]).is_some());
        let output = "risk".into();
        assert_eq!(
            estimator.plan().err(),
            Some(PlanError::NoClosedForm { output })
        );
    }

    /// The rules of the paper compute the output `strain` here. The output `risk` copies the value of `strain`, with one
    /// rule for each term.
    #[test]
    fn a_chain_has_a_plan_unless_it_reads_an_output_without_a_closed_form() {
        let profile = shipped::flagred_paper().profile().clone();
        let mut rules = shipped::flagred_paper_rules();
        let mut passed_on = rules.outputs[0].clone();
        rules.outputs[0].variable.name = "strain".into();
        for rule in &mut rules.rules {
            rule.rule.consequents[0].output = "strain".into();
        }
        for term in &passed_on.variable.terms {
            let rule = format!("IF strain IS '{0}' THEN risk IS '{0}'", term.name);
            let rule: fuzzy::rule::Rule = rule.parse().unwrap();
            rules.rules.push(rule.into());
        }
        passed_on.variable.name = "risk".into();
        rules.outputs.push(passed_on);
        let estimator = Estimator::new(&profile, &rules).unwrap();
        let direct = shipped::flagred_paper();
        for inputs in [[0.05, 0.2], [0.12, 0.31], [0.3, 0.1]] {
            let explained = estimator.engine().explain(&inputs).unwrap();
            let strain = direct.engine().explain(&inputs).unwrap().outputs[0].value;
            assert!(strain.is_some() && explained.outputs[0].value == strain);
            let risk = estimator.at(&inputs).unwrap();
            let is_filled = risk.filled_from.is_some();
            assert!(is_filled || explained.outputs[1].value == Some(risk.risk_pct));
        }
        assert_eq!(estimator.plan().unwrap().check(), Ok(()));
        rules.outputs[0].samples = Some(SAMPLED);
        let estimator = Estimator::new(&profile, &rules).unwrap();
        let output = "strain".into();
        assert_eq!(
            estimator.plan().err(),
            Some(PlanError::NoClosedForm { output })
        );
    }
}
