//! The gaps of a report, each listed once: regions without a rule, except those that follow from another finding.

use alloc::vec::Vec;

use super::{BoxSide, Report, TermOf, UncoveredRegion};

/// A region without a rule, with the parts of it in which no rule fires at all. Both have the same cause and are
/// reported together.
pub(super) struct Gap<'r> {
    pub(super) region: &'r UncoveredRegion,
    pub(super) silent: Vec<&'r UncoveredRegion>,
}

/// Returns the gaps of a report. A region that no rule could cover because an input has no term there is reported as a
/// hole instead.
pub(super) fn gaps(report: &Report) -> Vec<Gap<'_>> {
    let in_hole = |one: &UncoveredRegion| {
        one.sides.iter().any(|side| {
            let mut holes = report.holes.iter().filter(|hole| hole.input == side.input);
            let weak = one.missing.is_empty() && one.weak.contains(&side.input);
            holes.any(|hole| {
                (hole.low <= side.low && side.high <= hole.high)
                    || (weak && hole.low <= side.high && side.low <= hole.high)
            })
        })
    };
    let within = |inner: &UncoveredRegion, outer: &UncoveredRegion| {
        let contains = |outer: &BoxSide| {
            let mut sides = inner.sides.iter().filter(|side| side.input == outer.input);
            sides.any(|side| outer.low <= side.low && side.high <= outer.high)
        };
        inner.output == outer.output && outer.sides.iter().all(contains)
    };
    let reported = || report.uncovered.iter().filter(|one| !in_hole(one));
    let (silent, weak): (Vec<_>, Vec<_>) = reported().partition(|one| one.silent);
    let lone = silent
        .iter()
        .filter(|one| !weak.iter().any(|outer| within(one, outer)));
    let lone = lone.map(|region| Gap {
        region,
        silent: Vec::new(),
    });
    let weak = weak.iter().map(|region| Gap {
        region,
        silent: silent
            .iter()
            .copied()
            .filter(|one| within(one, region))
            .collect(),
    });
    lone.chain(weak).collect()
}

/// Returns whether a term is unused only because the rules of a gap are missing.
pub(super) fn is_missing(one: &TermOf, gaps: &[Gap<'_>]) -> bool {
    let mut missing = gaps.iter().flat_map(|gap| &gap.region.missing).flatten();
    one.term
        .as_ref()
        .is_some_and(|term| missing.any(|m| m.input == one.variable && m.term == *term))
}
