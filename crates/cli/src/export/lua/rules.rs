//! Generates the rules as Lua expressions, stage by stage, and the values that fill the gaps of the rules.

use flagred::{
    board::{
        Plan,
        table::{Action, Chain, Output, Table},
    },
    estimator::Estimator,
};
use fuzzy::{Model, rule::Consequent};

use super::{
    UnsupportedFeature,
    cause::{Causes, propositions},
    comment,
    condition::{Expressions, corners},
    limits::Size,
    number,
    output::{Coefficients, defuzzify},
    template::TemplateValues,
};

/// Outputs that are computed in one pass, with their table.
struct Stage<'a> {
    table: Table<'a>,
    /// The indices of the outputs in the model.
    outputs: Vec<usize>,
    /// The indices of the rules in the model.
    rules: Vec<usize>,
}

/// Sets the parts of the template for the rules.
pub(super) fn fill(
    estimator: &Estimator,
    plan: &Plan<'_>,
    filling: &mut TemplateValues,
    size: &mut Size,
) -> Result<(), UnsupportedFeature> {
    let model = estimator.model();
    let risk = plan.output as usize;
    let needed = needed(model, risk);
    let name = |output: usize| match model.outputs.get(output) {
        None => "",
        Some(output) => output.variable.name.as_str(),
    };
    let mut expressions = Expressions::new(model);
    let mut coefficients = Coefficients::default();
    let mut terms = vec![
        "-- The corners of the terms that conditions name: value, degree, value, degree and so on."
            .to_owned(),
        "local TERMS = {".to_owned(),
    ];
    let mut code = vec!["  local d, area, moment = degrees".to_owned()];
    let (mut first, mut sums, mut maxima, mut known) = (0, false, false, 0);
    for stage in stages(model, plan) {
        let own = stage.outputs.iter().zip(stage.table.outputs);
        let own: Vec<(usize, &Output)> = own
            .filter(|(output, _)| needed.contains(output))
            .map(|(output, of)| (*output, of))
            .collect();
        if own.is_empty() {
            continue;
        }
        if !stage.table.blocks.is_empty() {
            return Err(UnsupportedFeature::new(
                "the rule set has activation methods or blocks with different operators, which the script does not support".into(),
                "remove the activation methods, and give all rules the same operators",
            ));
        }
        let (mut fires, mut values) = (Vec::new(), Vec::new());
        for (output, of) in own {
            let strengths = coefficients.add(&stage.table, (name(output), of), first)?;
            let place = (output != risk).then_some(model.inputs.len() + output + 1);
            if place.is_none() && first > 0 {
                fires.push("  coverage = 0.0".to_owned());
            }
            values.extend(defuzzify(of, (first, strengths), place));
            let all = fires_of(&stage, of, first, &mut expressions, size)?;
            for FiringCode { adds, lines } in all {
                sums |= adds;
                maxima |= !adds;
                fires.extend(lines);
            }
            // One more strength stays 0, because the last term of a partition has no neighbour.
            first += strengths + 1;
        }
        for place in expressions.used.iter().skip(known) {
            let (corners, name) = corners(model, *place)?;
            known += 1;
            terms.push(format!("  {{{}}}, -- {name}", corners.join(", ")));
            code.push(format!(
                "  d[{known}] = along(TERMS[{known}], x[{}]) -- {name}",
                place.0 + 1
            ));
        }
        code.append(&mut fires);
        code.append(&mut values);
    }
    terms.push("}".into());
    terms.push(format!("local OUTPUT_TERMS = {}", first.saturating_sub(1)));
    terms.extend(coefficients.lines());
    size.terms = known;
    size.filled = plan.filled.map_or(0, |knots| knots.values.len());
    let mut causes = Causes::default();
    for (rule, i) in model.rules.iter().zip(1..) {
        let about = |consequent: &Consequent| {
            let mut outputs = needed.iter();
            outputs.any(|output| name(*output) == consequent.output.text)
        };
        let is_used = model.is_enabled(rule) && rule.rule.consequents.iter().any(about);
        causes.add(estimator, &rule.rule, is_used.then_some(i));
    }
    causes.fill(filling);
    filling.set("sums", sums);
    filling.set("maxima", maxima);
    filling.put("terms", terms);
    filling.put("rules", code);
    filling.put("operators", expressions.functions());
    filling.put("point", point(plan));
    fill_gaps(plan, filling);
    Ok(())
}

/// The code that fires a rule for an output.
struct FiringCode {
    /// Whether the firing strengths are added; otherwise the largest one is kept.
    adds: bool,
    lines: [String; 2],
}

/// Returns the code that fires the rules of an output, whose strengths begin at `first`.
fn fires_of(
    stage: &Stage<'_>,
    output: &Output,
    first: usize,
    expressions: &mut Expressions<'_>,
    size: &mut Size,
) -> Result<Vec<FiringCode>, UnsupportedFeature> {
    let model = expressions.model;
    let mut fires = Vec::new();
    for (rule, i) in model.rules.iter().zip(1..) {
        if !model.is_enabled(rule) {
            continue;
        }
        expressions.operators = model.operators_of(rule);
        for consequent in &rule.rule.consequents {
            let Some(action) = action_of(model, stage, output, consequent) else {
                continue;
            };
            let strength = first + (action.strength - output.first_strength) as usize + 1;
            let degree = expressions.condition(&rule.rule.condition)?;
            let weighted = match rule.rule.weight {
                1.0 => degree,
                weight => format!("{} * {degree}", number(weight)),
            };
            let weighted = match consequent.hedges.as_slice() {
                [] => weighted,
                hedges => expressions.hedged(hedges, format!("({weighted})")),
            };
            let adds = action.sums != 0;
            let fire = if adds { "add" } else { "fire" };
            fires.push(FiringCode {
                adds,
                lines: [
                    format!("  -- {}", comment(&rule.rule.to_string())),
                    format!("  {fire}({i}, {strength}, {weighted})"),
                ],
            });
            let conditions = propositions(&rule.rule.condition).len();
            size.conditions = size.conditions.max(conditions);
            size.rules += 1;
        }
    }
    Ok(fires)
}

/// Returns the indices of the risk and of all outputs that it depends on.
fn needed(model: &Model, risk: usize) -> Vec<usize> {
    let mut needed = vec![risk];
    let mut next = 0;
    while let Some(output) = needed
        .get(next)
        .and_then(|output| model.outputs.get(*output))
    {
        for name in model.reads(&output.variable.name) {
            let mut outputs = model.outputs.iter();
            let read = outputs.position(|output| output.variable.name == name);
            needed.extend(read.filter(|read| !needed.contains(read)));
        }
        next += 1;
    }
    needed
}

/// Returns the stages of the rule set in the order of evaluation.
fn stages<'a>(model: &Model, plan: &Plan<'a>) -> Vec<Stage<'a>> {
    if plan.rules.stages.is_empty() {
        return vec![Stage {
            table: plan.rules.table,
            outputs: (0..model.outputs.len()).collect(),
            rules: (0..model.rules.len()).collect(),
        }];
    }
    let chain = Chain {
        table: plan.rules.table,
        stages: plan.rules.stages,
        indices: plan.rules.indices,
    };
    let indices = |all: &[u32]| all.iter().map(|index| *index as usize).collect();
    let stages = chain.parts().map(|(table, place)| Stage {
        table,
        outputs: indices(place.outputs),
        rules: indices(place.rules),
    });
    stages.collect()
}

/// Returns an action that sets the firing strength of a consequent. Rules with the same consequent share one firing
/// strength.
fn action_of<'a>(
    model: &Model,
    stage: &Stage<'a>,
    output: &Output,
    consequent: &Consequent,
) -> Option<&'a Action> {
    let strengths = output.first_strength..output.end_strength;
    stage.table.actions.iter().find(|action| {
        let rule = stage.rules.get(action.rule as usize);
        let rule = rule.and_then(|rule| model.rules.get(*rule));
        strengths.contains(&action.strength)
            && rule.is_some_and(|rule| rule.rule.consequents.contains(consequent))
    })
}

/// Returns the code that clamps the inputs to their ranges, in the order of the rule set. Inputs that the risk does not
/// depend on may be unknown, so they are set to the lower end of their range.
fn point(plan: &Plan<'_>) -> Vec<String> {
    let inputs = plan.rules.table.inputs.iter().zip(plan.order).zip(1..);
    let line = |((input, from), i): ((&flagred::board::table::Input, &u32), u32)| {
        let (low, high) = (number(input.low), number(input.high));
        match plan.needs(*from as usize) {
            true => format!(
                "  point[{i}] = max({low}, min({high}, value[{}]))",
                from + 1
            ),
            false => format!("  point[{i}] = {low}"),
        }
    };
    inputs.map(line).collect()
}

fn fill_gaps(plan: &Plan<'_>, filling: &mut TemplateValues) {
    filling.set("filled", plan.filled.is_some());
    let Some(knots) = plan.filled else {
        return;
    };
    let axes = knots.starts.windows(2).map(|pair| match pair {
        [start, end] => knots
            .coordinates
            .get(*start as usize..*end as usize)
            .unwrap_or_default(),
        _ => &[],
    });
    let numbers = |numbers: &[f64]| numbers.iter().map(|x| number(*x)).collect::<Vec<String>>();
    let axis = |places: &[f64]| format!("  {{{}}},", numbers(places).join(", "));
    filling.put("knots", axes.map(axis).collect());
    // Values are rounded to 0.01 %.
    let values: Vec<String> = knots
        .values
        .iter()
        .map(|value| number((value * 100.0).round() / 100.0))
        .collect();
    let rows = crate::export::rows(&values);
    filling.put(
        "filled",
        rows.into_iter().map(|row| format!("  {row}")).collect(),
    );
}
