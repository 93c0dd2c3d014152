//! The rules as expressions, and the closed form of their output.

use flagred::{
    board::{
        Plan,
        table::{ClosedForm, Output},
    },
    estimator::Estimator,
    flight::Words,
    source::Signal,
};
use fuzzy::{
    Model,
    model::{Conjunction, Disjunction, Operators, Variable},
    rule::{Condition, Hedge, Proposition},
};

use super::{Unsupported, comment, limits::Size, number, quoted, template::Filling};

/// Fills in the template's parts for the rules.
pub(super) fn fill(
    estimator: &Estimator,
    plan: &Plan<'_>,
    filling: &mut Filling,
    size: &mut Size,
) -> Result<(), Unsupported> {
    let model = estimator.model();
    let output_name = &estimator.profile().output;
    let index = plan.output as usize;
    let (Some(output), Some(variable)) = (
        plan.rules.table.outputs.get(index),
        model.outputs.get(index),
    ) else {
        return Ok(());
    };
    if !plan.rules.table.blocks.is_empty() {
        return Err(Unsupported::new(
            "the rule set has activation methods or blocks with different operators, which the script does not have".into(),
            "the script has rules that all fire, with one AND and one OR",
        ));
    }
    let mut script = Script {
        model,
        operators: model.operators,
        used: Vec::new(),
        functions: Vec::new(),
    };
    let actions = plan.rules.table.actions.iter();
    let actions: Vec<_> = actions
        .filter(|action| action.output == plan.output && action.rule != u32::MAX)
        .collect();
    let sums = actions.iter().any(|action| action.sums != 0);
    filling.set("sums", sums);
    let (mut lines, mut causes) = (Vec::new(), Vec::new());
    let mut motor_cause = false;
    for (rule, i) in model.rules.iter().zip(1..) {
        let consequents = rule.rule.consequents.iter();
        let terms = consequents.filter(|consequent| consequent.output.text == *output_name);
        let mut cause = "false".to_owned();
        if !model.is_enabled(rule) {
            causes.push(format!("  {cause}, -- {i}"));
            continue;
        }
        script.operators = model.operators_of(rule);
        for consequent in terms {
            let term = &consequent.term.text;
            // In the table, rules with the same consequent update the same firing strength.
            let strength = actions.iter().find(|action| {
                let other = model.rules.get(action.rule as usize);
                other.is_some_and(|other| other.rule.consequents.contains(consequent))
            });
            let Some(strength) = strength else {
                continue;
            };
            let term_index = strength.strength.saturating_sub(output.first_strength) + 1;
            let degree = script.condition(&rule.rule.condition)?;
            lines.push(format!("  -- {}", comment(&rule.rule.to_string())));
            let weighted = match rule.rule.weight {
                1.0 => degree,
                weight => format!("{} * {degree}", number(weight)),
            };
            let weighted = match consequent.hedges.as_slice() {
                [] => weighted,
                hedges => script.hedged(hedges, format!("({weighted})")),
            };
            lines.push(format!("  fire({i}, {term_index}, {weighted})"));
            let conditions = propositions(&rule.rule.condition).len();
            size.conditions = size.conditions.max(conditions);
            size.rules += 1;
            let (told, is_motor) = about(estimator, &rule.rule.condition);
            motor_cause |= is_motor;
            let (area, centre) = area_and_centre(&variable.variable, term);
            cause = format!(
                "{{{}, {}, {told}, {is_motor}}}",
                number(area),
                number(centre)
            );
        }
        causes.push(format!("  {cause}, -- {i}"));
    }
    filling.set("motor_cause", motor_cause);
    size.terms = script.used.len();
    size.filled = plan.filled.map_or(0, |knots| knots.values.len());
    let mut degrees = Vec::new();
    let mut terms = vec![
        "-- The corners of the terms of inputs: value, degree, value, degree and so on.".to_owned(),
        "local TERMS = {".to_owned(),
    ];
    for ((input, term), i) in script.used.iter().zip(1..) {
        let (Some(variable), Some(from)) = (
            model.inputs.get(*input),
            model
                .inputs
                .get(*input)
                .and_then(|input| input.terms.get(*term)),
        ) else {
            continue;
        };
        let corners = corners(variable, *term)?;
        let told = comment(&format!("{} {}", variable.name, from.name));
        terms.push(format!("  {{{}}}, -- {told}", corners.join(", ")));
        degrees.push(format!(
            "  d[{i}] = along(TERMS[{i}], x[{}]) -- {told}",
            input + 1
        ));
    }
    terms.push("}".into());
    terms.extend(closed_form(plan, output)?);
    filling.put("terms", terms);
    filling.put("causes", causes);
    let mut rules = vec!["  local d = degrees".to_owned()];
    rules.append(&mut degrees);
    rules.append(&mut lines);
    filling.put("rules", rules);
    filling.put("operators", script.functions());
    filling.put("defuzzify", defuzzify(output));
    filling.put("point", point(plan));
    fill_gaps(plan, filling);
    Ok(())
}

/// Clamps the inputs to their ranges, in the order of the rules. Inputs that the risk does not depend on may be unknown.
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

fn fill_gaps(plan: &Plan<'_>, filling: &mut Filling) {
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

/// The coefficients of the closed form of an output.
fn closed_form(plan: &Plan<'_>, output: &Output) -> Result<Vec<String>, Unsupported> {
    let range = output.first as usize..output.end as usize;
    let strengths = output.end_strength - output.first_strength;
    // A partition has one more strength, which stays 0: the last term has no neighbour to its right.
    let strengths = match output.form() {
        ClosedForm::Partition => strengths.min(2 * (output.end - output.first)),
        _ => strengths,
    };
    let mut lines = vec![format!("local OUTPUT_TERMS = {strengths}")];
    match output.form() {
        ClosedForm::Moments => {
            let moments = plan.rules.table.moments.get(range).unwrap_or_default();
            let list = |of: fn(&flagred::board::table::Moment) -> f64| {
                moments
                    .iter()
                    .map(|m| number(of(m)))
                    .collect::<Vec<String>>()
                    .join(", ")
            };
            lines.push("-- The areas of the output's terms, and their moments about the middle of its range.".into());
            lines.push(format!("local AREAS = {{{}}}", list(|m| m.area)));
            // Rounding errors are set to 0.
            let moment = |m: &flagred::board::table::Moment| {
                if m.moment.abs() < 1e-9 { 0.0 } else { m.moment }
            };
            lines.push(format!("local MOMENTS = {{{}}}", list(moment)));
        }
        ClosedForm::Partition => {
            let pairs = plan.rules.table.pairs.get(range).unwrap_or_default();
            let sides = pairs.iter().flat_map(|pair| [(pair, 0), (pair, 1)]);
            lines.push("-- The output's terms: area = a h + b h^2, moment about the middle of the range = c h + d h^2 + e h^3 at".into());
            lines.push(
                "-- firing strength h; width and middle of the overlap with the next term.".into(),
            );
            lines.push("local PARTS = {".into());
            for (pair, side) in sides.take(strengths as usize) {
                let [a, b] = pair.area.map(|of| of[side]);
                let [c, d, e] = pair.moment.map(|of| of[side]);
                let all = [a, b, c, d, e, pair.width[side], pair.middle[side]].map(number);
                lines.push(format!("  {{{}}},", all.join(", ")));
            }
            lines.push("}".into());
        }
        ClosedForm::WeightedAverage | ClosedForm::WeightedSum => {
            return Err(Unsupported::new(
                "the output is a Takagi-Sugeno one, which the script does not have".into(),
                "the script has the centroid, with `implication: product` and `aggregation: sum` or over a `partition` with \
                 minimum and maximum",
            ));
        }
        _ => {
            return Err(Unsupported::new(
                "the output has neither the centroid of a sum of products nor that of minimum and maximum over a partition, which \
                 are all the script has"
                    .into(),
                "choose `implication: product` and `aggregation: sum`, or a `partition` with minimum and maximum, and the centroid",
            ));
        }
    }
    Ok(lines)
}

fn defuzzify(output: &Output) -> Vec<String> {
    let sum = match output.form() {
        ClosedForm::Partition => {
            "  local area, moment = 0.0, 0.0
  for term = 1, OUTPUT_TERMS do
    local part, h = PARTS[term], strengths[term]
    local v = min(h, strengths[term + 1] or 0.0, 0.5)
    local common = part[6] * (v * (1 - v))
    area = area + h * (part[1] + h * part[2]) - common
    moment = moment + h * (part[3] + h * (part[4] + h * part[5])) - part[7] * common
  end"
        }
        _ => {
            "  local area, moment = 0.0, 0.0
  for term = 1, OUTPUT_TERMS do
    area = area + strengths[term] * AREAS[term]
    moment = moment + strengths[term] * MOMENTS[term]
  end"
        }
    };
    let middle = output.low + 0.5 * (output.high - output.low);
    let mut lines: Vec<String> = sum.lines().map(str::to_owned).collect();
    lines.push("  if area > 0 then".into());
    lines.push(format!(
        "    return max({}, min({}, {} + moment / area))",
        number(output.low),
        number(output.high),
        number(middle)
    ));
    lines.push("  end".into());
    lines.push(format!(
        "  return {} -- no rule fires",
        number(output.default_value)
    ));
    lines
}

/// Converts conditions to expressions over the degrees of terms.
struct Script<'m> {
    model: &'m Model,
    /// The operators of the current rule.
    operators: Operators,
    /// The terms in use, by the index of the input and of the term.
    used: Vec<(usize, usize)>,
    functions: Vec<&'static str>,
}

impl Script<'_> {
    fn condition(&mut self, condition: &Condition) -> Result<String, Unsupported> {
        match condition {
            Condition::Is(proposition) => Ok(self.proposition(proposition)),
            Condition::Not(inner) => Ok(format!("(1 - {})", self.condition(inner)?)),
            Condition::And(parts) => {
                let parts = self.conditions(parts)?;
                match self.operators.and {
                    Conjunction::Minimum => Ok(format!("min({})", parts.join(", "))),
                    Conjunction::Product => Ok(parts.join(" * ")),
                    _ => Err(operator("AND", "minimum and product")),
                }
            }
            Condition::Or(parts) => {
                let parts = self.conditions(parts)?;
                let fold = |function: &str| {
                    let mut parts = parts.iter();
                    let first = parts.next().cloned().unwrap_or_default();
                    parts.fold(first, |all, part| format!("{function}({all}, {part})"))
                };
                match self.operators.or {
                    Disjunction::Maximum => Ok(format!("max({})", parts.join(", "))),
                    Disjunction::BoundedSum => Ok(format!("min(1.0, {})", parts.join(" + "))),
                    Disjunction::ProbabilisticSum => {
                        let text = fold("either");
                        self.uses("either");
                        Ok(text)
                    }
                    _ => Err(operator("OR", "maximum, probabilistic_sum and bounded_sum")),
                }
            }
        }
    }

    fn conditions(&mut self, parts: &[Condition]) -> Result<Vec<String>, Unsupported> {
        parts.iter().map(|part| self.condition(part)).collect()
    }

    fn proposition(&mut self, proposition: &Proposition) -> String {
        let degree = match &proposition.term {
            None => "1.0".to_owned(),
            Some(term) => {
                let input = self
                    .model
                    .inputs
                    .iter()
                    .position(|input| input.name == proposition.variable.text);
                let terms = input
                    .and_then(|input| self.model.inputs.get(input))
                    .map(|input| &input.terms);
                let term =
                    terms.and_then(|terms| terms.iter().position(|known| known.name == term.text));
                // A model that compiles contains every input and term that its rules name.
                let place = (input.unwrap_or_default(), term.unwrap_or_default());
                let known = self.used.iter().position(|used| *used == place);
                let index = known.unwrap_or_else(|| {
                    self.used.push(place);
                    self.used.len() - 1
                });
                format!("d[{}]", index + 1)
            }
        };
        self.hedged(&proposition.hedges, degree)
    }

    fn hedged(&mut self, hedges: &[Hedge], mut degree: String) -> String {
        for hedge in hedges.iter().rev() {
            degree = match hedge {
                Hedge::Not => format!("(1 - {degree})"),
                Hedge::Very => format!("{degree} ^ 2"),
                Hedge::Somewhat => format!("sqrt({degree})"),
                Hedge::Extremely => {
                    self.uses("extremely");
                    format!("extremely({degree})")
                }
                Hedge::Seldom => {
                    self.uses("seldom");
                    format!("seldom({degree})")
                }
                Hedge::Any => "1.0".into(),
            };
        }
        // A power binds more tightly than a product, but does not chain with another power.
        match hedges.len() {
            0 | 1 => degree,
            _ => format!("({degree})"),
        }
    }

    fn uses(&mut self, function: &'static str) {
        if !self.functions.contains(&function) {
            self.functions.push(function);
        }
    }

    fn functions(&self) -> Vec<String> {
        let text = |name: &&str| match *name {
            "either" => "\nlocal function either(a, b)\n  return a + b * (1 - a)\nend",
            "extremely" => {
                "\nlocal function extremely(x)\n  return x <= 0.5 and 2 * x * x or 1 - 2 * (1 - x) * (1 - x)\nend"
            }
            _ => {
                "\nlocal function seldom(x)\n  return x <= 0.5 and sqrt(x / 2) or 1 - sqrt((1 - x) / 2)\nend"
            }
        };
        self.functions
            .iter()
            .flat_map(|name| text(name).lines())
            .map(str::to_owned)
            .collect()
    }
}

fn operator(operator: &str, known: &'static str) -> Unsupported {
    let message = format!("the script does not have the rule set's operator for {operator}");
    match known {
        "minimum and product" => {
            Unsupported::new(message, "it has `and: minimum` and `and: product`")
        }
        _ => Unsupported::new(
            message,
            "it has `or: maximum`, `or: probabilistic_sum` and `or: bounded_sum`",
        ),
    }
}

/// Returns the corners of a term as numbers for the script.
fn corners(variable: &Variable, term: usize) -> Result<Vec<String>, Unsupported> {
    let Some(term) = variable.terms.get(term) else {
        return Ok(Vec::new());
    };
    let mut corners = term.membership_function.corners().ok_or_else(|| {
        Unsupported::new(
            format!(
                "term `{}` of input `{}` is curved, which the script does not have",
                term.name, variable.name
            ),
            "the script has terms made of straight lines; `piecewise` can come near to a curve",
        )
    })?;
    // At a vertical side the script uses the degree to its right, but to the right of the range there is none.
    if let [.., (left, _), (right, _)] = *corners.as_slice()
        && left == right
        && right >= variable.high
    {
        corners.pop();
    }
    let numbers = corners.iter().filter(|(x, _)| x.is_finite());
    Ok(numbers
        .flat_map(|(x, degree)| [number(*x), number(degree * term.height)])
        .collect())
}

/// Returns the area of an output's term and its centre, within the range.
fn area_and_centre(variable: &Variable, term: &str) -> (f64, f64) {
    const STEPS: u32 = 200;
    let Some(term) = variable.terms.iter().find(|known| known.name == term) else {
        return (0.0, 0.0);
    };
    let width = variable.high - variable.low;
    let (mut area, mut moment) = (0.0, 0.0);
    for i in 0..=STEPS {
        let x = variable.low + width * f64::from(i) / f64::from(STEPS);
        area += term.membership(x);
        moment += term.membership(x) * x;
    }
    if area > 0.0 {
        (area * width / f64::from(STEPS), moment / area)
    } else {
        (0.0, 0.0)
    }
}

/// Returns the texts for a pilot about the input that distinguishes a rule, as two Lua strings, and whether this input measures how near
/// motors are to a limit. As in a finding, it is the input of the proposition that occurs in the fewest rules.
fn about(estimator: &Estimator, condition: &Condition) -> (String, bool) {
    let rules = estimator.model().rules.iter();
    let all: Vec<Vec<&Proposition>> = rules
        .map(|rule| propositions(&rule.rule.condition))
        .collect();
    let rules_with =
        |proposition: &&Proposition| all.iter().filter(|rule| rule.contains(proposition)).count();
    let Some(proposition) = propositions(condition).into_iter().min_by_key(rules_with) else {
        return ("\"\", \"\"".into(), false);
    };
    let name = &proposition.variable.text;
    let hedges = proposition.hedges.iter().map(|hedge| hedge.word());
    let term = proposition.term.iter().map(|term| term.text.as_str());
    let term: Vec<&str> = hedges.chain(term).collect();
    let input = estimator
        .profile()
        .inputs
        .iter()
        .find(|input| input.name == *name);
    let is_motor = input.is_some_and(|input| {
        matches!(
            input.source.signal,
            Signal::MotorMargin | Signal::MotorMarginLowSide | Signal::MotorMarginHighSide
        )
    });
    let [first, second] = Words::of_cause(estimator, name, &term.join(" ")).brief;
    (format!("{}, {}", quoted(&first), quoted(&second)), is_motor)
}

fn propositions(condition: &Condition) -> Vec<&Proposition> {
    let mut all = Vec::new();
    condition.visit(&mut |proposition| all.push(proposition));
    all
}
