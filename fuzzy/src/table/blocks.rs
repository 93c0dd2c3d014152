//! Rule blocks with their own operators and activation method. Each rule of a block is a program.

use super::actions::FiringConsumer;
use super::firing::run;
use super::{
    Activation, Arrays, Comparison, Conjunction, Disjunction, PartialConjunction, Program,
};

/// A rule block.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Block {
    /// The strength that the method compares with; 0 if it does not compare.
    pub strength: f64,
    /// The activation method.
    pub method: Method,
    /// The number of rules that the method selects; 0 if it does not count.
    pub rules: u32,
    /// The conjunction for AND, as an index in [`Conjunction::ALL`].
    pub and_operator: u32,
    /// The disjunction for OR, as an index in [`Disjunction::ALL`].
    pub or_operator: u32,
    /// The index of the first program; the programs are in the order of the rules.
    pub first_program: u32,
    /// The index after the last program.
    pub end_program: u32,
}

/// The activation method of a block.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Method(pub u32);

impl Method {
    const FIRST: Method = Method(1);
    const LAST: Method = Method(2);
    const HIGHEST: Method = Method(3);
    const LOWEST: Method = Method(4);
    const PROPORTIONAL: Method = Method(5);
    /// The code of a threshold is 6 plus the index of its comparison in `COMPARISONS`.
    const THRESHOLD: u32 = 6;
    const COMPARISONS: [Comparison; 6] = [
        Comparison::Below,
        Comparison::AtMost,
        Comparison::Equal,
        Comparison::NotEqual,
        Comparison::AtLeast,
        Comparison::Above,
    ];
}

impl Block {
    /// Creates a block that consists of a range of programs.
    pub(crate) fn new(
        (and, or): (Conjunction, Disjunction),
        activation: Activation,
        (first_program, end_program): (u32, u32),
    ) -> Self {
        let (method, rules, strength) = match activation {
            Activation::General => (Method(0), 0, 0.0),
            Activation::First { rules, at_least } => (Method::FIRST, rules, at_least),
            Activation::Last { rules, at_least } => (Method::LAST, rules, at_least),
            Activation::Highest { rules } => (Method::HIGHEST, rules, 0.0),
            Activation::Lowest { rules } => (Method::LOWEST, rules, 0.0),
            Activation::Proportional => (Method::PROPORTIONAL, 0, 0.0),
            Activation::Threshold {
                comparison,
                strength,
            } => {
                let place = Method::COMPARISONS.iter().zip(Method::THRESHOLD..);
                let place = place
                    .into_iter()
                    .find_map(|(known, code)| (*known == comparison).then_some(code));
                (Method(place.unwrap_or(Method::THRESHOLD)), 0, strength)
            }
        };
        Block {
            strength,
            method,
            rules,
            and_operator: and as u32,
            or_operator: or as u32,
            first_program,
            end_program,
        }
    }

    fn activation(&self) -> Activation {
        let (rules, at_least) = (self.rules, self.strength);
        match self.method {
            Method::FIRST => Activation::First { rules, at_least },
            Method::LAST => Activation::Last { rules, at_least },
            Method::HIGHEST => Activation::Highest { rules },
            Method::LOWEST => Activation::Lowest { rules },
            Method::PROPORTIONAL => Activation::Proportional,
            Method(code) => {
                let place = code.checked_sub(Method::THRESHOLD);
                let comparison = place.and_then(|i| Method::COMPARISONS.get(i as usize));
                comparison.map_or(Activation::General, |comparison| Activation::Threshold {
                    comparison: *comparison,
                    strength: self.strength,
                })
            }
        }
    }

    /// Returns the operators for AND and OR; minimum and maximum if a damaged table contains invalid codes.
    fn operators(&self) -> (Conjunction, Disjunction) {
        let and = Conjunction::ALL.get(self.and_operator as usize).copied();
        let or = Disjunction::ALL.get(self.or_operator as usize).copied();
        (and.unwrap_or_default(), or.unwrap_or_default())
    }
}

/// Applies the hedges of a rule's consequents to the strength of the rule, and passes the rule to `firing`.
#[inline(always)]
fn act<A: Arrays>(
    table: &A,
    program: &Program,
    strength: f64,
    firing: &mut impl FiringConsumer<1>,
) {
    let hedges = &table.hedges()[program.first_hedge as usize..program.end_hedge as usize];
    let strength = hedges.iter().fold(strength, |x, hedge| hedge.of(x));
    let actions = program.first_action as usize..program.end_action as usize;
    firing.act_with(&table.actions()[actions], |_| strength);
}

/// Passes the firing rules of all blocks to `firing`, with the strengths that result from the activation methods.
/// `rules` has room for the rules of the largest block.
// This function is separate, so that tables without blocks do not become slower.
#[inline(never)]
pub(super) fn fire_blocks<A: Arrays>(
    table: &A,
    degrees: &[[f64; 1]],
    rules: &mut [PartialConjunction],
    stack: &mut [[f64; 1]],
    firing: &mut impl FiringConsumer<1>,
) {
    for block in table.blocks() {
        let (and, or) = block.operators();
        let mut count = 0;
        let programs = block.first_program..block.end_program;
        for at in programs {
            let program = &table.programs()[at as usize];
            let steps = &table.steps()[program.first_step as usize..program.end_step as usize];
            // A program without steps continues the previous rule.
            if !steps.is_empty() {
                let (and, or) = (|a, b| and.of(a, b), |a, b| or.of(a, b));
                let mut degree = [0.0];
                run(steps, degrees, (and, or), stack, &mut degree);
                rules[count] = PartialConjunction::new(program.weight * degree[0], at);
                count += 1;
            }
        }
        let rules = &mut rules[..count];
        let least = table.least_strength();
        block.activation().activate(least, rules);
        let rules = rules.iter().map(PartialConjunction::parts);
        for (strength, at) in rules.filter(|(strength, _)| *strength >= least) {
            let programs = &table.programs()[at as usize..block.end_program as usize];
            let more = |program: &&Program| program.first_step == program.end_step;
            let others = programs.iter().skip(1).take_while(more);
            for program in programs.iter().take(1).chain(others) {
                act(table, program, strength, firing);
            }
        }
    }
}
