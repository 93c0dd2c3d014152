//! Conversion of a report to diagnostics with positions.

use alloc::{
    collections::BTreeMap,
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::ops::Range;

use super::{
    AgainstTrend, Antecedent, Contradiction, Coordinate, Counterexample, Direction, EqualTerms,
    Jump, Reach, Report, TermGap, TermOf, UncoveredRegion, effects,
    gaps::{Gap, gaps, is_missing},
    outer, shown,
    terms::is_zero_on_range,
};
use crate::{
    diagnostic::{Diagnostic, listed},
    model::{
        MembershipFunction, Model, NoRuleFires, Variable,
        document::{Spans, VariableSpans},
    },
    rule::{Condition, Consequent, Rule},
};

/// The maximum number of gaps with a finding of their own; one more finding counts the other gaps.
const MAX_LISTED_BOXES: usize = 10;

/// Returns all diagnostics of a report, including those that the author accepts. `spans` contains the positions of the
/// parts of the model.
pub(super) fn of(report: &Report, model: &Model, spans: &Spans) -> Vec<Diagnostic> {
    let at = ModelPositions { model, spans };
    let mut found = Vec::new();
    duplicate_rules(model, &at, &mut found);
    let mut gaps = gaps(report);
    gaps.retain(|gap| !at.is_of_never_firing_rules(gap.region, report));
    for gap in gaps.iter().take(MAX_LISTED_BOXES) {
        found.push(at.uncovered(gap));
    }
    if let Some(more) = gaps.len().checked_sub(MAX_LISTED_BOXES)
        && more > 0
    {
        found.push(at.more_uncovered(more, report.uncovered_complete));
    } else if model.negates_type2() {
        let message =
            "regions without a rule were not searched for, because NOT is applied to a type-2 term";
        let help =
            "to have them searched, write the rules without NOT, with a term for the opposite";
        let place = spans.rules_key.clone();
        found.push(Diagnostic::note("examined-in-part", place, message).help(help));
    } else if !report.uncovered_complete {
        let message = "only a part of the input space was searched for regions without a rule";
        found.push(
            Diagnostic::note("examined-in-part", spans.rules_key.clone(), message)
                .help("there are too many rules, terms or outputs to search it all"),
        );
    }
    for one in &report.contradictions {
        if one.first == one.second {
            found.push(at.contradicts_itself(one));
            continue;
        }
        let message = format!(
            "rule {} concludes `{}` IS `{}` where rule {} concludes `{}`",
            one.second + 1,
            one.output,
            one.second_term,
            one.first + 1,
            one.first_term
        );
        found.push(
            Diagnostic::warning("contradiction", at.rule(one.second), message)
                .related(at.rule(one.first), "the other rule")
                .help("keep one of them, or distinguish them by another input"),
        );
    }
    for one in &report.subsumed {
        let message = format!("rule {} adds nothing to rule {}", one.rule + 1, one.by + 1);
        found.push(
            Diagnostic::warning("subsumed-rule", at.rule(one.rule), message)
                .related(
                    at.rule(one.by),
                    "this rule fires wherever the other does, with the same conclusion",
                )
                .help("remove the narrower rule, or change its conclusion"),
        );
    }
    for &rule in &report.never_firing {
        found.extend(at.never_fires(rule, report));
    }
    found.extend(
        report
            .unused
            .iter()
            .filter(|one| !is_missing(one, &gaps))
            .map(|one| at.unused(one)),
    );
    // Output terms that no rule reaches are reported together with the rules that never fire.
    let outside = report.unreachable.iter();
    found.extend(outside.filter_map(|one| at.outside_range(one)));
    found.extend(report.equal_terms.iter().map(|one| at.equal_terms(one)));
    // A hole of an input with a term outside the range follows from that term.
    let holes = report.holes.iter().filter(|hole| {
        let mut outside = report
            .unreachable
            .iter()
            .filter(|one| at.outside_range(one).is_some());
        outside.all(|one| one.variable != hole.input)
    });
    found.extend(holes.map(|one| at.hole(one)));
    found.extend(report.reach.iter().filter_map(|one| at.reach(one, report)));
    found.extend(report.against_trend.iter().map(|one| at.against_trend(one)));
    found.extend(
        report
            .counterexamples
            .iter()
            .map(|one| at.counterexample(one)),
    );
    found.extend(report.jumps.iter().map(|one| at.jump(one)));
    let without_value = effects::of(model, &at, &mut found);
    // Near a pole of its formula, an output takes values that were not evaluated, so its reach is not reported as
    // narrow.
    found.retain(|finding| {
        let is_about = |name: &String| finding.message.starts_with(&format!("`{name}` "));
        finding.code != "narrow-reach" || !without_value.iter().any(is_about)
    });
    found.extend(at.unexamined(report));
    found
}

/// Reports rules that are equal except for their weights.
fn duplicate_rules(model: &Model, at: &ModelPositions<'_>, findings: &mut Vec<Diagnostic>) {
    let mut seen: BTreeMap<String, Range<usize>> = BTreeMap::new();
    for (i, rule) in model.rules.iter().enumerate() {
        let mut bare = rule.rule.clone();
        bare.weight = 1.0;
        let here = at.rule(i);
        let text = format!("{bare}");
        if let Some(first) = seen.get(&text) {
            let message = format!("rule {} duplicates an earlier rule", i + 1);
            findings.push(
                Diagnostic::warning("duplicate-rule", here, message)
                    .related(first.clone(), "the earlier rule")
                    .help("remove one of them"),
            );
        } else {
            seen.insert(text, here);
        }
    }
}

/// The positions of the parts of a model.
pub(super) struct ModelPositions<'a> {
    model: &'a Model,
    spans: &'a Spans,
}

impl ModelPositions<'_> {
    pub(super) fn rule(&self, index: usize) -> Range<usize> {
        let rule = self.spans.rules.get(index);
        rule.map_or(0..0, |rule| rule.whole.clone())
    }

    fn variable(&self, name: &str) -> Option<(&VariableSpans, &Variable)> {
        let inputs = self.model.inputs.iter().zip(&self.spans.inputs);
        let outputs = self.model.outputs.iter().map(|output| &output.variable);
        let mut all = inputs.chain(outputs.zip(&self.spans.outputs));
        all.find(|(variable, _)| variable.name == name)
            .map(|(variable, spans)| (spans, variable))
    }

    pub(super) fn name(&self, variable: &str) -> Range<usize> {
        self.variable(variable)
            .map_or(0..0, |(spans, _)| spans.name.clone())
    }

    fn term(&self, one: &TermOf) -> Range<usize> {
        let term = self.variable(&one.variable).and_then(|(spans, variable)| {
            let index = variable
                .terms
                .iter()
                .position(|t| Some(&t.name) == one.term.as_ref())?;
            Some(spans.terms.get(index)?.name.clone())
        });
        term.unwrap_or_else(|| self.name(&one.variable))
    }

    pub(super) fn term_of(&self, variable: &str, term: &str) -> Range<usize> {
        self.term(&TermOf {
            variable: variable.into(),
            term: Some(term.into()),
        })
    }

    fn place(&self, one: &UncoveredRegion) -> String {
        match one.sides.as_slice() {
            [] => String::from("anywhere"),
            sides => {
                let sides = sides.iter().map(|side| self.side(side));
                format!("where {}", sides.collect::<Vec<_>>().join(" and "))
            }
        }
    }

    fn uncovered(&self, gap: &Gap<'_>) -> Diagnostic {
        let one = gap.region;
        let output = &one.output;
        let place = self.place(one);
        let share = match one.share {
            0.0 => String::new(),
            share => format!(
                ": {} % of the input space",
                shown(libm::round(1000.0 * share) / 10.0)
            ),
        };
        let place_of_rules = self.spans.rules_key.clone();
        let mut finding = if one.silent {
            let message = format!("no rule for `{output}` fires {place}{share}");
            let chosen = self.model.outputs.iter().any(|o| {
                let value = matches!(
                    o.when_no_rule_fires,
                    NoRuleFires::Value(_) | NoRuleFires::Previous(_)
                );
                o.variable.name == *output && value
            });
            if chosen {
                Diagnostic::note("no-rule-fires", place_of_rules, message)
            } else {
                Diagnostic::warning("no-rule-fires", place_of_rules, message)
            }
        } else {
            let level = shown(one.coverage);
            let mut message = format!("no rule for `{output}` reaches {level} {place}{share}");
            let silent: Vec<String> = gap.silent.iter().map(|one| self.place(one)).collect();
            if !silent.is_empty() {
                message += &format!("; none fires {}", silent.join(" and "));
            }
            Diagnostic::warning("uncovered", place_of_rules, message)
        };
        let rules: Vec<String> = one
            .missing
            .iter()
            .map(|all| missing_rule(all, output))
            .collect();
        let more = match one.more_missing {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let weak: Vec<&str> = one.weak.iter().map(String::as_str).collect();
        finding.help = match rules.as_slice() {
            [] if weak.is_empty() => self.disabled_blocks(),
            [] => Some(format!(
                "no term of {} reaches that degree there; let the terms overlap more",
                listed(&weak)
            )),
            [one] => Some(format!("the rule is missing: {one}{more}")),
            several => Some(format!(
                "the rules are missing: {}{more}",
                several.join(", ")
            )),
        };
        finding
    }

    /// Returns a suggestion that names the disabled blocks.
    fn disabled_blocks(&self) -> Option<String> {
        let disabled = self.model.blocks.iter().filter(|block| !block.enabled);
        let names: Vec<&str> = disabled.map(|block| block.name.as_str()).collect();
        let (subject, are) = match names.as_slice() {
            [] => return None,
            [_] => ("block", "is"),
            _ => ("blocks", "are"),
        };
        let names = listed(&names);
        Some(format!(
            "the {subject} {names} {are} disabled: remove `enabled: false`"
        ))
    }

    fn side(&self, side: &super::BoxSide) -> String {
        // An output that rules read is an input of these rules.
        let mut variables = self.model.variables();
        let input = variables.find(|input| input.name == side.input);
        let (low, high) = input.map_or((f64::NAN, f64::NAN), |input| (input.low, input.high));
        let name = &side.input;
        // An interval that ends just inside the range is displayed as ending at the end of the
        // range.
        let at_end = |x: f64| {
            [low, high]
                .into_iter()
                .find(|end| (x - end).abs() < 1e-12 * (high - low))
        };
        let (from, to) = (
            at_end(side.low).unwrap_or(side.low),
            at_end(side.high).unwrap_or(side.high),
        );
        if from == to {
            format!("{name} = {}", shown(from))
        } else if from == low {
            format!("{name} < {}", shown(to))
        } else if to == high {
            format!("{name} > {}", shown(from))
        } else {
            format!("{} < {name} < {}", shown(from), shown(to))
        }
    }

    fn more_uncovered(&self, more: usize, complete: bool) -> Diagnostic {
        let least = if complete { "" } else { "at least " };
        let message =
            format!("{least}{more} more regions have no rule; only the largest are listed");
        Diagnostic::warning("uncovered", self.spans.rules_key.clone(), message)
            .help("first add the rules that the other findings name")
    }

    /// Returns whether the rules that would cover a region exist but never fire. Such rules are reported separately.
    fn is_of_never_firing_rules(&self, region: &UncoveredRegion, report: &Report) -> bool {
        let is_of = |rule: &usize, antecedents: &[Antecedent]| {
            let Some(rule) = self.model.rules.get(*rule).map(|rule| &rule.rule) else {
                return false;
            };
            let mut is_of = matches!(rule.condition, Condition::Is(_) | Condition::And(_))
                && rule
                    .consequents
                    .iter()
                    .any(|c| c.output.text == region.output);
            rule.condition.visit(&mut |proposition| {
                let term = proposition.term.as_ref().map(|term| &term.text);
                is_of &= proposition.hedges.is_empty()
                    && antecedents.iter().any(|one| {
                        one.input == proposition.variable.text && Some(&one.term) == term
                    });
            });
            is_of
        };
        region.more_missing == 0
            && !region.missing.is_empty()
            && region.missing.iter().all(|all| {
                let mut rules = report.never_firing.iter();
                rules.any(|rule| is_of(rule, all))
            })
    }

    fn unused(&self, one: &TermOf) -> Diagnostic {
        let message = match &one.term {
            Some(term) => format!("no rule uses the term `{term}` of `{}`", one.variable),
            None => format!("no rule uses `{}`", one.variable),
        };
        let keyword = one.term.as_deref().filter(|term| Rule::is_keyword(term));
        let help = match keyword {
            Some(term) => {
                format!("`{term}` is a keyword: a rule names the term in quotes, `IS \"{term}\"`")
            }
            None => "write a rule for it, or remove it".into(),
        };
        Diagnostic::warning("unused", self.term(one), message).help(help)
    }

    fn contradicts_itself(&self, one: &Contradiction) -> Diagnostic {
        let (first, second, output) = (&one.first_term, &one.second_term, &one.output);
        let message = format!(
            "rule {} concludes both `{output}` IS `{first}` and `{output}` IS `{second}`",
            one.first + 1
        );
        Diagnostic::warning("contradiction", self.rule(one.first), message)
            .help("keep one of them; for a value between two terms, add a term")
    }

    /// Reports a rule that never fires, unless a term of its condition is 0 on the whole range, which is reported on
    /// its own.
    fn never_fires(&self, index: usize, report: &Report) -> Option<Diagnostic> {
        let rule = &self.model.rules.get(index)?.rule;
        let mut is_reported = false;
        if let Condition::Is(_) | Condition::And(_) = rule.condition {
            rule.condition.visit(&mut |proposition| {
                let term = proposition.term.as_ref().map(|term| &term.text);
                let of = |one: &TermOf| {
                    one.variable == proposition.variable.text && one.term.as_ref() == term
                };
                is_reported |= proposition.hedges.is_empty() && report.unreachable.iter().any(of);
            });
        }
        if is_reported {
            return None;
        }
        let mut help = String::from(match rule.weight {
            0.0 => "its weight is 0: write a larger weight, or remove the rule",
            _ => "no inputs satisfy its condition: correct the condition, or remove the rule",
        });
        for consequent in &rule.consequents {
            let (output, term) = (&consequent.output.text, &consequent.term.text);
            let of = |one: &TermOf| one.variable == *output && one.term.as_ref() == Some(term);
            if report.unreachable.iter().any(of) {
                help += &format!("; the term `{term}` of `{output}` is never reached");
            }
        }
        let message = format!("rule {} never fires", index + 1);
        Some(Diagnostic::warning("never-fires", self.rule(index), message).help(help))
    }

    /// Reports a term that is 0 on the whole range; `None` for an output's term that no rule reaches.
    fn outside_range(&self, one: &TermOf) -> Option<Diagnostic> {
        let term = one.term.as_deref()?;
        let mut inputs = self.model.inputs.iter();
        let input = inputs.find(|input| input.name == one.variable)?;
        if !is_zero_on_range(input, term) {
            return None;
        }
        let Variable {
            name, low, high, ..
        } = input;
        let message =
            format!("term `{term}` of input `{name}` is 0 on the whole range [{low}, {high}]");
        let finding = Diagnostic::warning("term-outside-range", self.term(one), message);
        let shape = input.terms.iter().find(|one| one.name == term);
        let shape = shape.map(|term| crate::format::shape_text(&term.membership_function));
        Some(finding.help(format!(
            "widen the range or move the term, which is `{}`",
            shape.unwrap_or_default()
        )))
    }

    fn equal_terms(&self, one: &EqualTerms) -> Diagnostic {
        let of = |term: &String| TermOf {
            variable: one.variable.clone(),
            term: Some(term.clone()),
        };
        let EqualTerms {
            variable,
            first,
            second,
        } = one;
        let message = format!("the terms `{first}` and `{second}` of `{variable}` are the same");
        Diagnostic::warning("equal-terms", self.term(&of(second)), message)
            .related(self.term(&of(first)), "the other term")
            .help("move one of them, or use one term in all rules")
    }

    fn hole(&self, one: &TermGap) -> Diagnostic {
        let input = &one.input;
        let ends = self.variable(input);
        let at_end = ends.is_some_and(|(_, v)| one.low == v.low || one.high == v.high);
        let place = if one.low == one.high {
            format!("at {}", shown(one.low))
        } else {
            format!("from {} to {}", shown(one.low), shown(one.high))
        };
        Diagnostic::warning(
            "hole",
            self.name(input),
            format!("`{input}` has no term {place}"),
        )
        .help(if at_end {
            "let the outermost term begin beyond the range, or make it a shoulder"
        } else {
            "let the neighbouring terms overlap, or add a term between them"
        })
    }

    /// Reports an output that leaves its range or does not come near an end of it.
    fn reach(&self, one: &Reach, report: &Report) -> Option<Diagnostic> {
        const BEYOND: f64 = 1e-9;
        let [low, high] = one.range;
        let beyond = BEYOND * (high - low);
        if one.low < low - beyond || one.high > high + beyond {
            return Some(self.outside(one));
        }
        if !report.reach_complete {
            // The output may take other values at points that were not evaluated.
            return None;
        }
        let mut outputs = self.model.outputs.iter();
        let output = outputs.find(|output| output.variable.name == one.output)?;
        let here = self.name(&one.output);
        let stays = format!("[{}, {}]", shown(one.low), shown(one.high));
        let name = &one.output;
        if !one.unreached.is_empty() {
            let names: Vec<&str> = one.unreached.iter().map(|u| u.term.as_str()).collect();
            let peaks: Vec<String> = one.unreached.iter().map(|u| shown(u.peak)).collect();
            let peaks = match peaks.as_slice() {
                [peak] => format!("its peak is at {peak}"),
                peaks => format!("their peaks are at {}", peaks.join(" and ")),
            };
            let message = format!(
                "`{name}` never reaches {}: {peaks}, and it stays within {stays}",
                listed(&names)
            );
            let help = outer::remedies(self.model, output, &one.unreached);
            return Some(Diagnostic::warning("narrow-reach", here, message).help(help));
        }
        if outer::covers_range(output, (one.low, one.high))
            || self.has_ineffective_rules(name, report)
        {
            return None;
        }
        let message = format!(
            "`{name}` stays within {stays} of its range [{}, {}]",
            shown(low),
            shown(high)
        );
        let is_weighted = output.defuzzifier.is_weighted();
        let help = match outer::concludes_beyond(self.model, output, (one.low, one.high)) {
            true => String::from(
                "where a rule concludes other values, rules with different conclusions fire as well; if you need these values, change the conditions",
            ),
            false if is_weighted => format!(
                "its rules conclude no other values: write `range: {stays}`, or add terms and rules for the others"
            ),
            false => String::from(
                "its rules conclude no other values; if you need them, move the outer terms outwards or add rules",
            ),
        };
        Some(Diagnostic::note("narrow-reach", here, message).help(help))
    }

    /// Returns whether rules for an output never fire, contradict each other, or leave out a term. Each of these has a
    /// finding of its own.
    fn has_ineffective_rules(&self, output: &str, report: &Report) -> bool {
        let concludes = |rule: &usize| {
            let rule = self.model.rules.get(*rule);
            rule.is_some_and(|rule| {
                let mut consequents = rule.rule.consequents.iter();
                consequents.any(|consequent| consequent.output.text == output)
            })
        };
        let is_unused = |one: &TermOf| one.variable == output && one.term.is_some();
        report.never_firing.iter().any(concludes)
            || report.unused.iter().any(is_unused)
            || report.contradictions.iter().any(|one| one.output == output)
    }

    /// Reports a Takagi-Sugeno or Tsukamoto output that takes values outside its range.
    fn outside(&self, one: &Reach) -> Diagnostic {
        let [low, high] = one.range;
        let message = format!(
            "`{}` takes values from {} to {}, outside its range [{}, {}]",
            one.output,
            shown(one.low),
            shown(one.high),
            shown(low),
            shown(high)
        );
        Diagnostic::warning("output-outside-range", self.name(&one.output), message)
            .help("widen the range, or change the terms of the output")
    }

    fn against_trend(&self, one: &AgainstTrend) -> Diagnostic {
        let (rises, falls) = match one.trend {
            Direction::Increasing => ("raises", "lowers"),
            Direction::Decreasing => ("lowers", "raises"),
        };
        let message = format!(
            "more `{}` {falls} `{}` from `{}` (rule {}) to `{}` (rule {})",
            one.input,
            one.output,
            one.from_term,
            one.from_rule + 1,
            one.to_term,
            one.to_rule + 1
        );
        let steps = if one.following == 1 { "step" } else { "steps" };
        let trend = format!(
            "in {} other {steps} between neighbouring rules, more `{}` {rises} it; check that this one is intended",
            one.following, one.input
        );
        Diagnostic::warning("against-trend", self.rule(one.to_rule), message)
            .related(self.rule(one.from_rule), "the rule at the next lower term")
            .help(trend)
    }

    fn counterexample(&self, one: &Counterexample) -> Diagnostic {
        let claim = &one.claim;
        let output = claim.output.as_deref().unwrap_or("");
        let does = claim.direction.contradicted();
        Diagnostic::warning("not-monotone", self.name(output), one.to_string()).help(format!(
            "the claim is that the output never {does}; look at the rules that fire there"
        ))
    }

    /// Reports the analyses that were stopped early because they would have taken too long.
    fn unexamined(&self, report: &Report) -> Option<Diagnostic> {
        let parts = [
            (report.reach_complete, "the values that outputs reach"),
            (report.counterexamples_complete, "claims"),
            (report.jumps_complete, "jumps"),
        ];
        let parts = parts.into_iter().filter(|(is_complete, _)| !is_complete);
        let parts: Vec<&str> = parts.map(|(_, part)| part).collect();
        let message = format!(
            "evaluating this rule set takes so long that only some points were examined for {}",
            match parts.as_slice() {
                [] => return None,
                [first, second, third] => format!("{first}, {second} and {third}"),
                others => others.join(" and "),
            }
        );
        let place = self.spans.rules_key.clone();
        let finding = Diagnostic::note("examined-in-part", place, message);
        Some(finding.help("terms with straight sides, or fewer terms and rules, are faster"))
    }

    fn jump(&self, one: &Jump) -> Diagnostic {
        // Inputs that the output does not depend on would distract from the cause.
        let needed = self.model.inputs_of(&one.output);
        let is_other = |name: &str| {
            let mut inputs = self.model.inputs.iter();
            !needed.contains(&name) && inputs.any(|input| input.name == name)
        };
        let mut at = one.at.clone();
        at.retain(|place| !is_other(&place.input));
        let message = format!(
            "`{}` jumps from {} to {} along `{}` at {}",
            one.output,
            shown(one.below),
            shown(one.above),
            one.input,
            coordinates(&at)
        );
        let crisp = self
            .variable(&one.input)
            .and_then(|(_, input)| crisp_limits(input));
        let help = match crisp {
            Some(crisp) => format!(
                "{crisp}; accept intended jumps with `allow`; smaller jumps along the same input are not listed"
            ),
            None => "a vertical edge of a term, or a switch from one rule to another, causes it; let terms overlap, or accept intended jumps with `allow`; smaller jumps along the same input are not listed".into(),
        };
        Diagnostic::warning("jump", self.name(&one.output), message).help(help)
    }
}

/// Returns a suggestion for an input whose terms are rectangles that meet at their limits: both terms have the degree 1
/// there.
fn crisp_limits(input: &Variable) -> Option<String> {
    let edges = input
        .terms
        .iter()
        .map(|term| match term.membership_function {
            MembershipFunction::Rectangle { left, right } if term.lower.is_none() => {
                Some((term.name.as_str(), left, right))
            }
            _ => None,
        });
    let mut edges: Vec<(&str, f64, f64)> = edges.collect::<Option<_>>()?;
    edges.sort_by(|(_, a, _), (_, b, _)| a.total_cmp(b));
    let meets =
        |pair: &[(&str, f64, f64)]| matches!(pair, [(.., right), (_, left, _)] if left == right);
    if edges.len() < 2 || !edges.windows(2).all(meets) {
        return None;
    }
    let ((last, ..), below) = edges.split_last()?;
    let steps = below
        .iter()
        .map(|(name, _, right)| format!("{name}: {}", shown(*right)));
    let steps: Vec<String> = steps.collect();
    let (first, _, limit) = below.first()?;
    let second = edges.get(1).map_or("", |(name, ..)| name);
    Some(format!(
        "`{first}` and `{second}` of `{}` are both 1 at {}: for crisp limits write `steps: {{{}, {last}: }}`",
        input.name,
        shown(*limit),
        steps.join(", ")
    ))
}

pub(super) fn coordinates(at: &[Coordinate]) -> String {
    /// The maximum number of inputs that are listed.
    const MAX_INPUTS: usize = 6;
    let all = at
        .iter()
        .take(MAX_INPUTS)
        .map(|c| format!("{} = {}", c.input, shown(c.value)));
    let mut text = all.collect::<Vec<_>>().join(", ");
    if at.len() > MAX_INPUTS {
        text.push_str(", ...");
    }
    text
}

/// Returns the text of a missing rule: `IF a IS low AND b IS high THEN output IS ...`
fn missing_rule(antecedents: &[super::Antecedent], output: &str) -> String {
    let is = |one: &super::Antecedent| Condition::is(&one.input, &one.term);
    let mut parts: Vec<Condition> = antecedents.iter().map(is).collect();
    let condition = match parts.pop() {
        Some(only) if parts.is_empty() => only,
        last => {
            parts.extend(last);
            Condition::And(parts)
        }
    };
    let consequent = Consequent::is_hedged(output, &[], "?");
    let rule = Rule {
        condition,
        consequents: Vec::from([consequent]),
        weight: 1.0,
    };
    format!("`{}`", rule.to_string().replace("\"?\"", "..."))
}
