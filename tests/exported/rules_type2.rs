// The rule set `type2`, written by `flagred export --rust` 0.1.0. Do not edit.
// Inputs, in this order: heat (0 to 40), damp (0 to 1).
// Outputs, in this order: speed (0 to 9), power (0 to 50), alarm (0 to 1).
// 4236 bytes of constants. An evaluation takes 936 bytes of memory.

/// Returns the outcome of each output at the given values of the inputs.
#[allow(dead_code)]
#[rustfmt::skip]
pub fn evaluate(inputs: &[f64; 2]) -> [::fuzzy::table::Outcome; 3] {
    #[allow(unused_imports)]
    use ::fuzzy::table::{Outcome, PartialConjunction, Scratch, StrongestRule, Values};
    let mut scratch = Scratch {
        values: &mut [0.0; 2],
        degrees: &mut [0.0; 18],
        alive: &mut [PartialConjunction::NONE; 13],
        partial: &mut [PartialConjunction::NONE; 1],
        next: &mut [PartialConjunction::NONE; 1],
        stack: &mut [0.0; 2],
        strengths: &mut [0.0; 13],
        strongest: &mut [StrongestRule::NONE; 5],
    };
    let mut outcomes = [Outcome::UNDEFINED; 3];
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
        sizes: Sizes { degrees: 18, alive: 13, partial: 1, stack: 2, strengths: 13 },
        inputs: &[
            Input { low: 0.0, high: 40.0, first_literal: 0, first_cut: 0, end_cut: 5, first_start: 0, first_curve: 0, end_curve: 8 },
            Input { low: 0.0, high: 1.0, first_literal: 11, first_cut: 5, end_cut: 7, first_start: 7, first_curve: 8, end_curve: 11 },
        ],
        cuts: &[8.0, 10.0, 18.0, 20.0, 30.0, 0.1, 0.9],
        starts: &[0, 2, 4, 7, 9, 10, 10, 10, 13, 17, 20],
        lines: &[
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 6 },
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
            Line { foot: 18.0, run: -10.0, base: 0.0, rise: 1.0, literal: 6 },
            Line { foot: 20.0, run: -10.0, base: 0.0, rise: 1.0, literal: 1 },
            Line { foot: 10.0, run: 10.0, base: 0.0, rise: 1.0, literal: 3 },
            Line { foot: 18.0, run: -10.0, base: 0.0, rise: 1.0, literal: 6 },
            Line { foot: 20.0, run: -10.0, base: 0.0, rise: 1.0, literal: 1 },
            Line { foot: 10.0, run: 10.0, base: 0.0, rise: 1.0, literal: 3 },
            Line { foot: 30.0, run: -10.0, base: 0.0, rise: 1.0, literal: 3 },
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
            Line { foot: -0.1, run: 1.0, base: 0.0, rise: 1.0, literal: 2 },
            Line { foot: 0.9, run: -1.0, base: 0.0, rise: 1.0, literal: 4 },
            Line { foot: 1.1, run: -1.0, base: 0.0, rise: 1.0, literal: 1 },
            Line { foot: -0.1, run: 1.0, base: 0.0, rise: 1.0, literal: 2 },
            Line { foot: 0.9, run: -1.0, base: 0.0, rise: 1.0, literal: 4 },
            Line { foot: 0.1, run: 1.0, base: 0.0, rise: 1.0, literal: 5 },
            Line { foot: 1.1, run: -1.0, base: 0.0, rise: 1.0, literal: 1 },
            Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
            Line { foot: 0.1, run: 1.0, base: 0.0, rise: 1.0, literal: 5 },
        ],
        curves: &[
            Curve { parameters: [1.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(18), literal: 0, first_point: 5, end_point: 5, first_hedge: 0, end_hedge: 1 },
            Curve { parameters: [10.0, 20.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 2, first_point: 5, end_point: 5, first_hedge: 1, end_hedge: 2 },
            Curve { parameters: [34.0, 5.0, 38.0, 5.0], height: 1.0, kind: ShapeKind(7), literal: 4, first_point: 5, end_point: 5, first_hedge: 2, end_hedge: 2 },
            Curve { parameters: [34.0, 5.0, 38.0, 5.0], height: 1.0, kind: ShapeKind(7), literal: 5, first_point: 5, end_point: 5, first_hedge: 2, end_hedge: 3 },
            Curve { parameters: [8.0, 18.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 7, first_point: 5, end_point: 5, first_hedge: 3, end_hedge: 4 },
            Curve { parameters: [12.5, 20.0, 25.0, 0.0], height: 0.8, kind: ShapeKind(19), literal: 8, first_point: 5, end_point: 5, first_hedge: 4, end_hedge: 4 },
            Curve { parameters: [0.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(22), literal: 9, first_point: 5, end_point: 19, first_hedge: 4, end_hedge: 4 },
            Curve { parameters: [0.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(22), literal: 10, first_point: 19, end_point: 33, first_hedge: 4, end_hedge: 5 },
            Curve { parameters: [1.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(18), literal: 0, first_point: 33, end_point: 33, first_hedge: 5, end_hedge: 6 },
            Curve { parameters: [-0.1, 0.9, 0.0, 0.0], height: 1.0, kind: ShapeKind(2), literal: 3, first_point: 33, end_point: 33, first_hedge: 6, end_hedge: 7 },
            Curve { parameters: [0.1, 1.1, 0.0, 0.0], height: 1.0, kind: ShapeKind(2), literal: 6, first_point: 33, end_point: 33, first_hedge: 7, end_hedge: 8 },
        ],
        points: &[
            [0.0, 8.0], [1.0, 1.0], [0.0, 2.0], [17.0, 0.0], [11.0, 0.0], [1.0, 0.0], [0.0, 36.0], [12.0, 0.0],
            [18.0, 0.0], [0.0, 2.0], [11.0, 0.0], [0.0, 4.0], [14.0, 0.0], [0.0, 2.0], [17.0, 0.0], [16.0, 0.0],
            [0.0, 2.0], [14.0, 0.0], [29.0, 0.0], [1.0, 0.0], [0.0, 36.0], [12.0, 0.0], [18.0, 0.0], [0.0, 2.0],
            [11.0, 0.0], [0.0, 4.0], [14.0, 0.0], [0.0, 2.0], [17.0, 0.0], [16.0, 0.0], [0.0, 2.0], [14.0, 0.0],
            [29.0, 0.0],
        ],
        hedges: &[Any, Not, Very, Not, Very, Any, Not, Not],
        axes: &[],
        dimensions: &[],
        cells: &[],
        nodes: &[Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 }],
        edges: &[],
        actions: &[
            Action { weight: 0.7, strength: 2, output: 0, rule: 2, sums: 1 },
            Action { weight: 0.7, strength: 9, output: 3, rule: 8, sums: 1 },
            Action { weight: 0.25, strength: 0, output: 0, rule: 5, sums: 1 },
            Action { weight: 0.25, strength: 7, output: 3, rule: 5, sums: 1 },
            Action { weight: 1.0, strength: 0, output: 0, rule: 0, sums: 1 },
            Action { weight: 1.0, strength: 3, output: 1, rule: 0, sums: 1 },
            Action { weight: 1.0, strength: 1, output: 0, rule: 1, sums: 1 },
            Action { weight: 1.0, strength: 4, output: 1, rule: 3, sums: 1 },
            Action { weight: 1.0, strength: 7, output: 3, rule: 6, sums: 1 },
            Action { weight: 1.0, strength: 10, output: 4, rule: 6, sums: 1 },
            Action { weight: 1.0, strength: 8, output: 3, rule: 7, sums: 1 },
            Action { weight: 1.0, strength: 11, output: 4, rule: 9, sums: 1 },
            Action { weight: 0.5, strength: 5, output: 2, rule: 4, sums: 1 },
        ],
        programs: &[
            Program { weight: 0.7, first_step: 0, end_step: 5, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
            Program { weight: 0.7, first_step: 5, end_step: 10, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
            Program { weight: 0.25, first_step: 10, end_step: 12, first_action: 2, end_action: 4, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 12, end_step: 14, first_action: 4, end_action: 6, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 14, end_step: 15, first_action: 6, end_action: 7, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 15, end_step: 17, first_action: 7, end_action: 8, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 17, end_step: 19, first_action: 8, end_action: 10, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 19, end_step: 20, first_action: 10, end_action: 11, first_hedge: 0, end_hedge: 0 },
            Program { weight: 1.0, first_step: 20, end_step: 22, first_action: 11, end_action: 12, first_hedge: 0, end_hedge: 0 },
            Program { weight: 0.5, first_step: 22, end_step: 23, first_action: 12, end_action: 13, first_hedge: 0, end_hedge: 0 },
        ],
        steps: &[
            AntecedentStep { op: Op(0), literal: 5 }, AntecedentStep { op: Op(0), literal: 15 },
            AntecedentStep { op: Op(1), literal: 2 }, AntecedentStep { op: Op(5), literal: 0 },
            AntecedentStep { op: Op(4), literal: 0 }, AntecedentStep { op: Op(0), literal: 10 },
            AntecedentStep { op: Op(0), literal: 12 }, AntecedentStep { op: Op(1), literal: 7 },
            AntecedentStep { op: Op(5), literal: 0 }, AntecedentStep { op: Op(4), literal: 0 },
            AntecedentStep { op: Op(0), literal: 0 }, AntecedentStep { op: Op(1), literal: 11 },
            AntecedentStep { op: Op(0), literal: 1 }, AntecedentStep { op: Op(1), literal: 13 },
            AntecedentStep { op: Op(0), literal: 3 }, AntecedentStep { op: Op(0), literal: 4 },
            AntecedentStep { op: Op(1), literal: 17 }, AntecedentStep { op: Op(0), literal: 6 },
            AntecedentStep { op: Op(1), literal: 16 }, AntecedentStep { op: Op(0), literal: 8 },
            AntecedentStep { op: Op(0), literal: 9 }, AntecedentStep { op: Op(1), literal: 14 },
            AntecedentStep { op: Op(0), literal: 11 },
        ],
        blocks: &[],
        outputs: &[
            Output { low: 0.0, high: 9.0, default_value: NaN, form: 3, first: 0, end: 3, first_strength: 0, end_strength: 3, clamps: 0, reduction: 1, lower: 3 },
            Output { low: 0.0, high: 50.0, default_value: 5.0, form: 4, first: 3, end: 5, first_strength: 3, end_strength: 5, clamps: 1, reduction: 1, lower: 4 },
            Output { low: 0.0, high: 1.0, default_value: NaN, form: 3, first: 5, end: 7, first_strength: 5, end_strength: 7, clamps: 0, reduction: 0, lower: 0 },
            Output { low: 0.0, high: 9.0, default_value: NaN, form: 3, first: 7, end: 10, first_strength: 7, end_strength: 10, clamps: 0, reduction: 4294967295, lower: 0 },
            Output { low: 0.0, high: 50.0, default_value: 5.0, form: 4, first: 10, end: 12, first_strength: 10, end_strength: 12, clamps: 1, reduction: 4294967295, lower: 0 },
        ],
        pairs: &[],
        layered_sets: &[],
        bases: &[],
        layers: &[],
        moments: &[],
        consequents: &[
            Consequent { constant: 1.0, first: 0, end: 0, first_code: 0, end_code: 0 },
            Consequent { constant: -1.0, first: 0, end: 2, first_code: 0, end_code: 0 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 0, end_code: 5 },
            Consequent { constant: -10.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 60.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 1.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
            Consequent { constant: 0.0, first: 2, end: 2, first_code: 5, end_code: 5 },
        ],
        coefficients: &[Coefficient { coefficient: 0.1, input: 0 }, Coefficient { coefficient: 2.0, input: 1 }],
        sets: &[],
        set_terms: &[],
        sections: &[],
        strands: &[],
        flanks: &[],
        knots: &[],
    }
};
