// The rule set `tipper`, written by `flagred export --rust` 0.1.0. Do not edit.
// Inputs, in this order: service (0 to 10), food (0 to 10).
// Outputs, in this order: tip (0 to 30 %).
// 1612 bytes of constants. An evaluation takes 352 bytes of memory.

/// Returns the outcome of each output at the given values of the inputs.
#[allow(dead_code)]
#[rustfmt::skip]
pub fn evaluate(inputs: &[f64; 2]) -> [::fuzzy::table::Outcome; 1] {
    #[allow(unused_imports)]
    use ::fuzzy::table::{Outcome, PartialConjunction, Scratch, StrongestRule, Values};
    let mut scratch = Scratch {
        values: &mut [0.0; 2],
        degrees: &mut [0.0; 5],
        alive: &mut [PartialConjunction::NONE; 5],
        partial: &mut [PartialConjunction::NONE; 1],
        next: &mut [PartialConjunction::NONE; 1],
        stack: &mut [0.0; 1],
        strengths: &mut [0.0; 6],
        strongest: &mut [StrongestRule::NONE; 1],
    };
    let mut outcomes = [Outcome::UNDEFINED; 1];
    RULES.evaluate(&mut scratch, inputs, &mut outcomes);
    outcomes
}

/// The rule set.
#[rustfmt::skip]
pub static RULES: ::fuzzy::table::Table<'static> = {
    #[allow(dead_code, non_upper_case_globals)]
    const inf: f64 = f64::INFINITY;
    #[allow(dead_code, non_upper_case_globals)]
    const NaN: f64 = f64::NAN;
    #[allow(unused_imports)]
    use ::fuzzy::table::{*, Hedge::*};
    Table {
        and: Conjunction::Minimum,
        or: Disjunction::Maximum,
        conjunctions: Conjunctions::Trie,
        least_strength: 1e-12,
        sizes: Sizes { degrees: 5, alive: 5, partial: 1, stack: 1, strengths: 6 },
        inputs: &[
            Input { low: 0.0, high: 10.0, first_literal: 0, first_cut: 0, end_cut: 0, first_start: 0, first_curve: 0, end_curve: 3 },
            Input { low: 0.0, high: 10.0, first_literal: 3, first_cut: 0, end_cut: 5, first_start: 2, first_curve: 3, end_curve: 3 },
        ],
        cuts: &[1.0, 3.0, 7.0, 9.0, 10.0],
        starts: &[0, 0, 0, 1, 2, 2, 3, 4, 5],
        lines: &[
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
            Line { foot: 3.0, run: -2.0, base: 0.0, rise: 1.0, literal: 0 },
            Line { foot: 7.0, run: 2.0, base: 0.0, rise: 1.0, literal: 1 },
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
            Line { foot: 11.0, run: -1.0, base: 0.0, rise: 1.0, literal: 1 },
        ],
        curves: &[
            Curve { parameters: [0.0, 1.5, 0.0, 0.0], height: 1.0, kind: ShapeKind(6), literal: 0, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 0 },
            Curve { parameters: [5.0, 1.5, 0.0, 0.0], height: 1.0, kind: ShapeKind(6), literal: 1, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 0 },
            Curve { parameters: [10.0, 1.5, 0.0, 0.0], height: 1.0, kind: ShapeKind(6), literal: 2, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 0 },
        ],
        points: &[],
        hedges: &[],
        axes: &[],
        dimensions: &[],
        cells: &[],
        nodes: &[Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 }],
        edges: &[],
        actions: &[
            Action { weight: 1.0, strength: 0, output: 0, rule: 0, sums: 0 },
            Action { weight: 1.0, strength: 2, output: 0, rule: 2, sums: 0 },
            Action { weight: 1.0, strength: 1, output: 0, rule: 1, sums: 0 },
        ],
        programs: &[
            Program { weight: 1.0, first_step: 0, end_step: 2, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 2, end_step: 4, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 4, end_step: 5, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
        ],
        steps: &[
            AntecedentStep { op: Op(0), literal: 0 }, AntecedentStep { op: Op(2), literal: 3 },
            AntecedentStep { op: Op(0), literal: 2 }, AntecedentStep { op: Op(2), literal: 4 },
            AntecedentStep { op: Op(0), literal: 1 },
        ],
        blocks: &[],
        outputs: &[
            Output { low: 0.0, high: 30.0, default_value: NaN, form: 1, first: 0, end: 2, first_strength: 0, end_strength: 5, clamps: 0, reduction: 0, lower: 0 },
        ],
        pairs: &[
            Pair { area: [[10.0, 10.0], [-5.0, -5.0]], moment: [[-100.0, 0.0], [50.0, 0.0], [0.0, 0.0]], width: [0.0, 0.0], middle: [0.0, 0.0] },
            Pair { area: [[10.0, 0.0], [-5.0, 0.0]], moment: [[100.0, 0.0], [-50.0, 0.0], [0.0, 0.0]], width: [0.0, 0.0], middle: [0.0, 0.0] },
        ],
        layered_sets: &[],
        bases: &[],
        layers: &[],
        moments: &[],
        consequents: &[],
        coefficients: &[],
        sets: &[],
        set_terms: &[],
        sections: &[],
        strands: &[],
        flanks: &[],
        knots: &[],
    }
};
