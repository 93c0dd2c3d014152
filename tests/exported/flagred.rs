// The profile `flagred` with the rule set `flagred`, written by `flagred export --rust` 0.1.0. Do not edit.
// 3892 bytes of constants, 0 of them to fill gaps of the rules. A monitor of 4 motors takes 106176 bytes of memory.

/// Memory for a monitor of so many motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<31, 6, 1, 5, MOTORS>;

/// What the cause of a finding is called.
#[allow(dead_code)]
#[rustfmt::skip]
pub static CAUSES: [&str; 19] = [
    "at_limit much",
    "unsteady_lately calm",
    "at_limit none",
    "unsteady_lately gusty",
    "at_limit none",
    "unsteady_lately stormy",
    "at_limit none",
    "throttle_activity steady",
    "at_limit none",
    "throttle_activity moving",
    "at_limit none",
    "throttle_activity surging",
    "at_limit none",
    "swing_per_room small",
    "at_limit none",
    "swing_per_room moderate",
    "at_limit none",
    "swing_per_room large",
    "at_limit none",
];

/// The profile.
#[rustfmt::skip]
pub static PLAN: ::flagred::board::Plan<'static> = {
    #[allow(dead_code, non_upper_case_globals)]
    const inf: f64 = f64::INFINITY;
    #[allow(dead_code, non_upper_case_globals)]
    const NaN: f64 = f64::NAN;
    #[allow(unused_imports)]
    use ::flagred::{
        accumulator::AccumulatorSettings,
        board::{Plan, Proposition, Rules, table::{*, Hedge::*}},
        channel,
        follower::Settings,
        gap::FilledKnots,
        sample::Sampling,
        verdict::{LevelSettings, Limit, NoticeSettings, Threshold, VerdictSettings},
    };
    Plan {
        name: "flagred",
        rules: Rules {
            table: Table {
                and: Conjunction::Product,
                or: Disjunction::Maximum,
                conjunctions: Conjunctions::Trie,
                least_strength: 1e-12,
                sizes: Sizes { degrees: 11, alive: 4, partial: 1, stack: 1, strengths: 6 },
                inputs: &[
                    Input { low: 0.0, high: 0.5, first_literal: 0, first_cut: 0, end_cut: 3, first_start: 0, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 0.5, first_literal: 3, first_cut: 3, end_cut: 6, first_start: 5, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 10.0, first_literal: 6, first_cut: 6, end_cut: 9, first_start: 10, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 1.0, first_literal: 9, first_cut: 9, end_cut: 10, first_start: 15, first_curve: 0, end_curve: 0 },
                ],
                cuts: &[0.008, 0.012, 0.04, 0.0012, 0.008, 0.03, 0.05, 0.3, 1.0, 0.35],
                starts: &[0, 1, 3, 5, 6, 6, 7, 9, 11, 12, 12, 13, 15, 17, 18, 18, 20, 21],
                lines: &[
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.012, run: -0.004, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.008, run: 0.004, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.04, run: -0.028, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.012, run: 0.028, base: 0.0, rise: 1.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.008, run: -0.0068000000000000005, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.0012, run: 0.0068000000000000005, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.03, run: -0.022, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.008, run: 0.022, base: 0.0, rise: 1.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.3, run: -0.25, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.05, run: 0.25, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 1.0, run: -0.7, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.3, run: 0.7, base: 0.0, rise: 1.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                    Line { foot: 0.35, run: -0.35, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.0, run: 0.35, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
                ],
                curves: &[],
                points: &[],
                hedges: &[],
                axes: &[],
                dimensions: &[],
                cells: &[],
                nodes: &[Node { first_edge: 0, end_edge: 0, first_action: 0, end_action: 0 }],
                edges: &[],
                actions: &[
                    Action { weight: 1.0, strength: 0, output: 0, rule: 1, sums: 1 },
                    Action { weight: 1.0, strength: 1, output: 0, rule: 2, sums: 1 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 3, sums: 1 },
                    Action { weight: 0.7, strength: 0, output: 0, rule: 4, sums: 1 },
                    Action { weight: 0.35, strength: 2, output: 0, rule: 5, sums: 1 },
                    Action { weight: 0.7, strength: 3, output: 0, rule: 6, sums: 1 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 7, sums: 1 },
                    Action { weight: 1.0, strength: 2, output: 0, rule: 8, sums: 1 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 9, sums: 1 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 0, sums: 1 },
                ],
                programs: &[
                    Program { weight: 1.0, first_step: 0, end_step: 2, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 2, end_step: 4, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 4, end_step: 6, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.7, first_step: 6, end_step: 8, first_action: 3, end_action: 4, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.35, first_step: 8, end_step: 10, first_action: 4, end_action: 5, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.7, first_step: 10, end_step: 12, first_action: 5, end_action: 6, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 12, end_step: 14, first_action: 6, end_action: 7, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 14, end_step: 16, first_action: 7, end_action: 8, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 16, end_step: 18, first_action: 8, end_action: 9, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 18, end_step: 19, first_action: 9, end_action: 10, first_hedge: 0, end_hedge: 0 },
                ],
                steps: &[
                    Step { op: Op(0), literal: 0 }, Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 1 },
                    Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 2 }, Step { op: Op(1), literal: 9 },
                    Step { op: Op(0), literal: 3 }, Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 4 },
                    Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 5 }, Step { op: Op(1), literal: 9 },
                    Step { op: Op(0), literal: 6 }, Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 7 },
                    Step { op: Op(1), literal: 9 }, Step { op: Op(0), literal: 8 }, Step { op: Op(1), literal: 9 },
                    Step { op: Op(0), literal: 10 },
                ],
                blocks: &[],
                outputs: &[
                    Output { low: 0.0, high: 100.0, default_value: NaN, form: ClosedForm(2), first: 0, end: 5, first_strength: 0, end_strength: 5, clamps: 0 },
                ],
                pairs: &[],
                layered_sets: &[],
                bases: &[],
                layers: &[],
                moments: &[
                    Moment { area: 5.0, moment: -225.0 }, Moment { area: 5.0, moment: -125.0 },
                    Moment { area: 5.0, moment: 0.0 }, Moment { area: 5.0, moment: 125.0 },
                    Moment { area: 5.0, moment: 225.0 },
                ],
                consequents: &[],
                coefficients: &[],
                sets: &[],
                set_terms: &[],
                sections: &[],
                strands: &[],
                flanks: &[],
                knots: &[],
            },
            stages: &[],
            places: &[],
        },
        output: 0,
        order: &[0, 1, 2, 4],
        channels: &[
            channel::Channel { observed: channel::Observed::CommandLessYaw, motors: channel::Motors::Std, threshold: None, in_bins: true, window_s: 20.0, exponential: false },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Mean, threshold: None, in_bins: true, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Std, threshold: None, in_bins: true, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::HighSide, motors: channel::Motors::Min, threshold: None, in_bins: false, window_s: 20.0, exponential: false },
            channel::Channel { observed: channel::Observed::Margin, motors: channel::Motors::Pooled, threshold: Some(channel::Threshold::Below(0.006)), in_bins: false, window_s: 2.0, exponential: false },
        ],
        inputs: &[
            channel::Input { channel: 0, statistic: channel::Statistic::StdLessNoise, ratio: None },
            channel::Input { channel: 1, statistic: channel::Statistic::StdLessNoise, ratio: None },
            channel::Input { channel: 2, statistic: channel::Statistic::StdLessNoise, ratio: Some(channel::Ratio { plus: Some(1), per: 3, at_least: 0.02 }) },
            channel::Input { channel: 3, statistic: channel::Statistic::Mean, ratio: None },
            channel::Input { channel: 4, statistic: channel::Statistic::ShareBelow(0.006), ratio: None },
        ],
        signals: 0,
        settings: Settings { sampling: Sampling { min_samples: 5, warm_up_s: 1.0, longest_gap_s: 2.0, take_off_s: 3.0 }, elevated_risk: AccumulatorSettings { window_s: 3.0, high_pct: 47.0, low_pct: 43.0, rise_pct_per_s: 14.0, fall_pct_per_s: 28.0 }, verdict: VerdictSettings { warn: LevelSettings { raise: Threshold { risk_pct: Some(55.0), elevated_risk_pct: Some(40.0) }, after_s: 0.2, until: Threshold { risk_pct: Some(43.0), elevated_risk_pct: Some(20.0) } }, fail: LevelSettings { raise: Threshold { risk_pct: Some(80.0), elevated_risk_pct: None }, after_s: 0.3, until: Threshold { risk_pct: Some(65.0), elevated_risk_pct: None } }, clear_after_s: 5.0, quiet_after_take_off_s: 3.0, quiet_before_landing_s: 2.0, idle_below: 0.1, notices: NoticeSettings { noise: Some(Limit { value: 0.04, after_s: 5.0 }), reserve: Some(Limit { value: 0.1, after_s: 3.0 }), imbalance: Some(Limit { value: 0.15, after_s: 3.0 }) } } },
        coverage_below: 0.0625,
        filled: None,
        propositions: &[
            Proposition { rule: 0, input: 4, literal: 10 }, Proposition { rule: 1, input: 0, literal: 0 },
            Proposition { rule: 1, input: 4, literal: 9 }, Proposition { rule: 2, input: 0, literal: 1 },
            Proposition { rule: 2, input: 4, literal: 9 }, Proposition { rule: 3, input: 0, literal: 2 },
            Proposition { rule: 3, input: 4, literal: 9 }, Proposition { rule: 4, input: 1, literal: 3 },
            Proposition { rule: 4, input: 4, literal: 9 }, Proposition { rule: 5, input: 1, literal: 4 },
            Proposition { rule: 5, input: 4, literal: 9 }, Proposition { rule: 6, input: 1, literal: 5 },
            Proposition { rule: 6, input: 4, literal: 9 }, Proposition { rule: 7, input: 2, literal: 6 },
            Proposition { rule: 7, input: 4, literal: 9 }, Proposition { rule: 8, input: 2, literal: 7 },
            Proposition { rule: 8, input: 4, literal: 9 }, Proposition { rule: 9, input: 2, literal: 8 },
            Proposition { rule: 9, input: 4, literal: 9 },
        ],
    }
};
