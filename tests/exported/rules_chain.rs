// The rule set `chain`, written by `flagred export --rust` 0.1.0. Do not edit.
// Inputs, in this order: x (0 to 10), y (0 to 1).
// Outputs, in this order: risk (0 to 100), strain (0 to 10), trend (0 to 10), comfort (0 to 10).
// 4584 bytes of constants. An evaluation takes 800 bytes of memory.

/// Returns the outcome of each output at the given values of the inputs.
#[allow(dead_code)]
#[rustfmt::skip]
pub fn evaluate(inputs: &[f64; 2]) -> [::fuzzy::table::Outcome; 4] {
    #[allow(unused_imports)]
    use ::fuzzy::table::{Outcome, PartialConjunction, Scratch, StrongestRule, Values};
    let mut scratch = Scratch {
        values: &mut [0.0; 5],
        degrees: &mut [0.0; 5],
        alive: &mut [PartialConjunction::NONE; 5],
        partial: &mut [PartialConjunction::NONE; 1],
        next: &mut [PartialConjunction::NONE; 1],
        stack: &mut [0.0; 1],
        strengths: &mut [0.0; 6],
        strongest: &mut [StrongestRule::NONE; 4],
    };
    let mut values = Values {
        inputs: &mut [0.0; 5],
        own: &mut [Outcome::UNDEFINED; 4],
    };
    let mut outcomes = [Outcome::UNDEFINED; 4];
    RULES.evaluate(&mut scratch, &mut values, inputs, &mut outcomes);
    outcomes
}

/// The rule set.
#[rustfmt::skip]
pub static RULES: ::fuzzy::table::Chain<'static> = {
    #[allow(dead_code, non_upper_case_globals)]
    const inf: f64 = f64::INFINITY;
    #[allow(dead_code, non_upper_case_globals)]
    const NaN: f64 = f64::NAN;
    #[allow(unused_imports)]
    use ::fuzzy::table::{*, Hedge::*};
    Chain {
        table: Table {
            and: Conjunction::Product,
            or: Disjunction::Maximum,
            conjunctions: Conjunctions::Trie,
            least_strength: 1e-12,
            sizes: Sizes { degrees: 5, alive: 5, partial: 1, stack: 1, strengths: 6 },
            inputs: &[
                Input { low: 0.0, high: 10.0, first_literal: 0, first_cut: 0, end_cut: 2, first_start: 0, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 1.0, first_literal: 3, first_cut: 2, end_cut: 2, first_start: 4, first_curve: 0, end_curve: 2 },
                Input { low: 0.0, high: 10.0, first_literal: 0, first_cut: 0, end_cut: 0, first_start: 0, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 1.0, first_literal: 0, first_cut: 0, end_cut: 2, first_start: 2, first_curve: 0, end_curve: 1 },
                Input { low: 0.0, high: 10.0, first_literal: 2, first_cut: 2, end_cut: 4, first_start: 6, first_curve: 1, end_curve: 2 },
                Input { low: 0.0, high: 10.0, first_literal: 0, first_cut: 0, end_cut: 0, first_start: 0, first_curve: 0, end_curve: 1 },
                Input { low: 0.0, high: 1.0, first_literal: 1, first_cut: 0, end_cut: 0, first_start: 2, first_curve: 1, end_curve: 1 },
                Input { low: 0.0, high: 10.0, first_literal: 1, first_cut: 0, end_cut: 1, first_start: 4, first_curve: 1, end_curve: 1 },
                Input { low: 0.0, high: 10.0, first_literal: 2, first_cut: 1, end_cut: 3, first_start: 7, first_curve: 1, end_curve: 2 },
                Input { low: 0.0, high: 10.0, first_literal: 4, first_cut: 3, end_cut: 3, first_start: 11, first_curve: 2, end_curve: 3 },
            ],
            cuts: &[5.0, 10.0, 0.4, 0.9, 5.0, 10.0, 5.0, 2.0, 4.0],
            starts: &[0, 2, 4, 5, 5, 5, 0, 0, 0, 0, 1, 2, 2, 3, 5, 6, 0, 0, 0, 0, 0, 1, 1, 1, 2, 3, 3, 3, 3],
            lines: &[
                Line { foot: 5.0, run: -5.0, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.0, run: 5.0, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 10.0, run: -5.0, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 5.0, run: 5.0, base: 0.0, rise: 1.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                Line { foot: 0.4, run: 0.5, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
                Line { foot: 0.0, run: 5.0, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 10.0, run: -5.0, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 5.0, run: 5.0, base: 0.0, rise: 1.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                Line { foot: 5.0, run: -5.0, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.0, run: 2.0, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 4.0, run: -2.0, base: 0.0, rise: 1.0, literal: 0 },
            ],
            curves: &[
                Curve { parameters: [0.4, 0.9, 0.0, 0.0], height: 1.0, kind: ShapeKind(2), literal: 0, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 1 },
                Curve { parameters: [0.4, 0.9, 0.0, 0.0], height: 1.0, kind: ShapeKind(2), literal: 1, first_point: 0, end_point: 0, first_hedge: 1, end_hedge: 2 },
                Curve { parameters: [0.0, 0.3, 0.0, 0.0], height: 1.0, kind: ShapeKind(6), literal: 0, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 0 },
                Curve { parameters: [0.0, 5.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 0, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 1 },
                Curve { parameters: [0.0, 5.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 0, first_point: 0, end_point: 0, first_hedge: 0, end_hedge: 1 },
                Curve { parameters: [5.0, 7.0, 8.0, 9.0], height: 1.0, kind: ShapeKind(0), literal: 1, first_point: 0, end_point: 0, first_hedge: 1, end_hedge: 2 },
                Curve { parameters: [0.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(5), literal: 0, first_point: 0, end_point: 4, first_hedge: 2, end_hedge: 3 },
                Curve { parameters: [0.0, 5.0, 10.0, 0.0], height: 1.0, kind: ShapeKind(19), literal: 0, first_point: 4, end_point: 4, first_hedge: 6, end_hedge: 6 },
                Curve { parameters: [5.0, 10.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(2), literal: 0, first_point: 4, end_point: 4, first_hedge: 6, end_hedge: 6 },
                Curve { parameters: [0.0, 5.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 0, first_point: 4, end_point: 4, first_hedge: 6, end_hedge: 7 },
                Curve { parameters: [5.0, 7.0, 8.0, 9.0], height: 1.0, kind: ShapeKind(0), literal: 0, first_point: 4, end_point: 4, first_hedge: 7, end_hedge: 8 },
                Curve { parameters: [0.0, 0.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(5), literal: 0, first_point: 4, end_point: 8, first_hedge: 8, end_hedge: 9 },
                Curve { parameters: [0.0, 5.0, 0.0, 0.0], height: 1.0, kind: ShapeKind(1), literal: 0, first_point: 8, end_point: 8, first_hedge: 9, end_hedge: 9 },
                Curve { parameters: [0.0, 2.0, 4.0, 0.0], height: 1.0, kind: ShapeKind(19), literal: 0, first_point: 8, end_point: 8, first_hedge: 9, end_hedge: 9 },
            ],
            points: &[[5.0, 0.0], [6.0, 0.8], [7.0, 1.0], [9.0, 0.0], [5.0, 0.0], [6.0, 0.8], [7.0, 1.0], [9.0, 0.0]],
            hedges: &[Not, Very, Not, Not, Somewhat, Not, Not, Somewhat, Not],
            axes: &[],
            dimensions: &[],
            cells: &[],
            nodes: &[
                Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 },
                Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 },
                Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 },
            ],
            edges: &[],
            actions: &[
                Action { weight: 1.0, strength: 0, output: 0, rule: 0, sums: 1 },
                Action { weight: 1.0, strength: 4, output: 1, rule: 0, sums: 1 },
                Action { weight: 1.0, strength: 1, output: 0, rule: 1, sums: 1 },
                Action { weight: 1.0, strength: 1, output: 0, rule: 3, sums: 1 },
                Action { weight: 1.0, strength: 2, output: 0, rule: 2, sums: 1 },
                Action { weight: 1.0, strength: 3, output: 1, rule: 2, sums: 1 },
                Action { weight: 1.0, strength: 0, output: 0, rule: 0, sums: 1 },
                Action { weight: 0.6, strength: 1, output: 0, rule: 2, sums: 1 },
                Action { weight: 1.0, strength: 1, output: 0, rule: 1, sums: 1 },
                Action { weight: 1.0, strength: 1, output: 0, rule: 1, sums: 1 },
                Action { weight: 0.7, strength: 0, output: 0, rule: 2, sums: 1 },
                Action { weight: 1.0, strength: 2, output: 0, rule: 0, sums: 1 },
            ],
            programs: &[
                Program { weight: 1.0, first_step: 0, end_step: 1, first_action: 0, end_action: 2, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 1, end_step: 2, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 2, end_step: 4, first_action: 3, end_action: 4, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 4, end_step: 6, first_action: 4, end_action: 6, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 0, end_step: 2, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
                Program { weight: 0.6, first_step: 2, end_step: 4, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 4, end_step: 5, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 0, end_step: 2, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
                Program { weight: 0.7, first_step: 2, end_step: 3, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
                Program { weight: 1.0, first_step: 3, end_step: 5, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
            ],
            steps: &[
                AntecedentStep { op: Op(0), literal: 0 }, AntecedentStep { op: Op(0), literal: 1 },
                AntecedentStep { op: Op(0), literal: 2 }, AntecedentStep { op: Op(1), literal: 3 },
                AntecedentStep { op: Op(0), literal: 2 }, AntecedentStep { op: Op(1), literal: 4 },
                AntecedentStep { op: Op(0), literal: 0 }, AntecedentStep { op: Op(1), literal: 3 },
                AntecedentStep { op: Op(0), literal: 1 }, AntecedentStep { op: Op(1), literal: 2 },
                AntecedentStep { op: Op(0), literal: 4 }, AntecedentStep { op: Op(0), literal: 1 },
                AntecedentStep { op: Op(2), literal: 2 }, AntecedentStep { op: Op(0), literal: 0 },
                AntecedentStep { op: Op(0), literal: 3 }, AntecedentStep { op: Op(1), literal: 4 },
            ],
            blocks: &[],
            outputs: &[
                Output { low: 0.0, high: 10.0, default_value: NaN, form: 2, first: 0, end: 3, first_strength: 0, end_strength: 3, clamps: 0, reduction: 0, lower: 0 },
                Output { low: 0.0, high: 10.0, default_value: 5.0, form: 2, first: 3, end: 5, first_strength: 3, end_strength: 5, clamps: 0, reduction: 0, lower: 0 },
                Output { low: 0.0, high: 10.0, default_value: NaN, form: 2, first: 0, end: 2, first_strength: 0, end_strength: 2, clamps: 0, reduction: 0, lower: 0 },
                Output { low: 0.0, high: 100.0, default_value: NaN, form: 3, first: 0, end: 3, first_strength: 0, end_strength: 3, clamps: 0, reduction: 0, lower: 0 },
            ],
            pairs: &[],
            layered_sets: &[],
            bases: &[],
            layers: &[],
            moments: &[
                Moment { area: 2.5, moment: -8.333333333333334 }, Moment { area: 5.0, moment: 0.0 },
                Moment { area: 2.5, moment: 8.333333333333334 }, Moment { area: 2.0, moment: -6.0 },
                Moment { area: 2.3, moment: 4.300000000000001 }, Moment { area: 2.0, moment: -6.0 },
                Moment { area: 2.5, moment: 5.5 },
            ],
            consequents: &[
                Consequent { constant: 12.0, first: 0, end: 3, first_code: 0, end_code: 0 },
                Consequent { constant: 5.0, first: 3, end: 3, first_code: 0, end_code: 0 },
                Consequent { constant: 90.0, first: 3, end: 3, first_code: 0, end_code: 0 },
            ],
            coefficients: &[
                Coefficient { coefficient: 10.0, input: 1 }, Coefficient { coefficient: 5.0, input: 2 },
                Coefficient { coefficient: 2.0, input: 3 },
            ],
            sets: &[],
            set_terms: &[],
            sections: &[],
            strands: &[],
            flanks: &[],
            knots: &[],
        },
        stages: &[
            Stage { conjunctions: 2, actions_per_cell: 0, first_action: 0, sums: 0, sizes: Sizes { degrees: 5, alive: 4, partial: 1, stack: 1, strengths: 6 }, reads: 0, outputs: 2, rules: 4, ends: Ends { inputs: 2, cuts: 2, starts: 6, lines: 5, curves: 2, points: 0, hedges: 2, axes: 0, dimensions: 0, cells: 0, nodes: 1, edges: 0, actions: 6, programs: 4, steps: 6, blocks: 0, outputs: 2, pairs: 0, layered_sets: 0, bases: 0, layers: 0, moments: 5, consequents: 0, coefficients: 0, sets: 0, set_terms: 0, sections: 0, strands: 0, flanks: 0, knots: 0 } },
            Stage { conjunctions: 2, actions_per_cell: 0, first_action: 0, sums: 0, sizes: Sizes { degrees: 5, alive: 5, partial: 1, stack: 1, strengths: 3 }, reads: 1, outputs: 1, rules: 3, ends: Ends { inputs: 5, cuts: 6, starts: 16, lines: 11, curves: 4, points: 0, hedges: 3, axes: 0, dimensions: 0, cells: 0, nodes: 2, edges: 0, actions: 9, programs: 7, steps: 11, blocks: 0, outputs: 3, pairs: 0, layered_sets: 0, bases: 0, layers: 0, moments: 7, consequents: 0, coefficients: 0, sets: 0, set_terms: 0, sections: 0, strands: 0, flanks: 0, knots: 0 } },
            Stage { conjunctions: 2, actions_per_cell: 0, first_action: 0, sums: 0, sizes: Sizes { degrees: 5, alive: 4, partial: 1, stack: 1, strengths: 4 }, reads: 3, outputs: 1, rules: 3, ends: Ends { inputs: 10, cuts: 9, starts: 29, lines: 14, curves: 7, points: 4, hedges: 6, axes: 0, dimensions: 0, cells: 0, nodes: 3, edges: 0, actions: 12, programs: 10, steps: 16, blocks: 0, outputs: 4, pairs: 0, layered_sets: 0, bases: 0, layers: 0, moments: 7, consequents: 3, coefficients: 3, sets: 0, set_terms: 0, sections: 0, strands: 0, flanks: 0, knots: 0 } },
        ],
        indices: &[1, 3, 3, 4, 5, 6, 1, 2, 7, 8, 9, 1, 2, 3, 0, 0, 1, 2],
    }
};
