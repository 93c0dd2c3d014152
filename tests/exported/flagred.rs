// The profile `flagred` with the rule set `flagred`, written by `flagred export --rust` 0.1.0. Not to be edited.
// 3468 bytes of constants, of which 0 fill gaps of the rules' map; 78016 bytes of memory for a monitor of 4 motors.

/// Memory for a monitor of so many motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<22, 114, 1, 4, MOTORS>;

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
        assessment::Sampling,
        board::{Plan, scale::Scale, table::*},
        channel,
        follower::Settings,
        gap::{FilledCells, Run},
        verdict::{Idle, LevelSettings, Threshold, VerdictSettings},
    };
    Plan {
        name: "flagred",
        table: Table {
            and: Conjunction::Product,
            or: Disjunction::Maximum,
            conjunctions: Conjunctions::Dense,
            sizes: Sizes { degrees: 0, alive: 4, partial: 55, stack: 0, heights: 6 },
            inputs: &[
                Input { low: 0.0, high: 0.5, first_literal: 0, first_cut: 0, end_cut: 2, first_start: 0, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 0.5, first_literal: 3, first_cut: 2, end_cut: 4, first_start: 4, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 1.0, first_literal: 6, first_cut: 4, end_cut: 7, first_start: 8, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 1.0, first_literal: 9, first_cut: 7, end_cut: 8, first_start: 13, first_curve: 0, end_curve: 0 },
            ],
            cuts: &[0.025, 0.05, 0.025, 0.05, 0.3, 0.6, 0.9, 0.5],
            starts: &[0, 2, 4, 5, 5, 7, 9, 10, 10, 11, 13, 15, 16, 16, 18, 19],
            lines: &[
                Line { foot: 0.025, run: -0.025, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.0, run: 0.025, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.05, run: -0.025, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.025, run: 0.025, base: 0.0, rise: 1.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                Line { foot: 0.025, run: -0.025, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.0, run: 0.025, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.05, run: -0.025, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.025, run: 0.025, base: 0.0, rise: 1.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                Line { foot: 0.6, run: -0.3, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.3, run: 0.3, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.9, run: -0.30000000000000004, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.6, run: 0.30000000000000004, base: 0.0, rise: 1.0, literal: 2 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                Line { foot: 0.5, run: -0.5, base: 0.0, rise: 1.0, literal: 0 },
                Line { foot: 0.0, run: 0.5, base: 0.0, rise: 1.0, literal: 1 },
                Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 1 },
            ],
            curves: &[],
            points: &[],
            hedges: &[],
            axes: &[],
            dimensions: &[
                Dimension { input: 0, stride: 32, any: 3 }, Dimension { input: 1, stride: 8, any: 3 },
                Dimension { input: 2, stride: 2, any: 3 }, Dimension { input: 3, stride: 1, any: 4294967295 },
            ],
            cells: &[
                0, 1, 1, 2, 2, 3, 3, 3, 3, 4, 4, 5, 5, 6, 6, 6, 6, 7, 7, 8, 8, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 10,
                10, 11, 11, 12, 12, 12, 12, 13, 13, 14, 14, 15, 15, 15, 15, 16, 16, 17, 17, 18, 18, 18, 18, 18, 18,
                18, 18, 18, 18, 18, 18, 19, 19, 20, 20, 21, 21, 21, 21, 22, 22, 23, 23, 24, 24, 24, 24, 25, 25, 26,
                26, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27,
                27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 27, 28,
            ],
            nodes: &[],
            edges: &[],
            actions: &[
                Action { weight: 1.0, place: 0, output: 0, rule: 1, sums: 1 },
                Action { weight: 1.0, place: 0, output: 0, rule: 2, sums: 1 },
                Action { weight: 1.0, place: 1, output: 0, rule: 3, sums: 1 },
                Action { weight: 1.0, place: 1, output: 0, rule: 4, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 5, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 6, sums: 1 },
                Action { weight: 1.0, place: 1, output: 0, rule: 7, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 8, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 9, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 10, sums: 1 },
                Action { weight: 1.0, place: 3, output: 0, rule: 11, sums: 1 },
                Action { weight: 1.0, place: 3, output: 0, rule: 12, sums: 1 },
                Action { weight: 1.0, place: 2, output: 0, rule: 13, sums: 1 },
                Action { weight: 1.0, place: 3, output: 0, rule: 14, sums: 1 },
                Action { weight: 1.0, place: 3, output: 0, rule: 15, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 16, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 17, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 18, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 19, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 20, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 21, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 22, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 23, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 24, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 25, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 26, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 27, sums: 1 },
                Action { weight: 1.0, place: 4, output: 0, rule: 0, sums: 1 },
            ],
            programs: &[],
            steps: &[],
            outputs: &[
                Output { low: 0.0, high: 100.0, otherwise: NaN, set: Set(2), first: 0, end: 5, first_height: 0, end_height: 5 },
            ],
            pairs: &[],
            moments: &[
                Moment { area: 5.0, moment: -225.0 }, Moment { area: 5.0, moment: -125.0 },
                Moment { area: 5.0, moment: 8.881784197001252e-16 }, Moment { area: 5.0, moment: 125.0 },
                Moment { area: 5.0, moment: 225.0 },
            ],
            consequences: &[],
            coefficients: &[],
        },
        output: 0,
        order: &[0, 1, 2, 3],
        channels: &[
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Std, threshold: None, window_s: 2.0 },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Std, threshold: None, window_s: 20.0 },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Pooled, threshold: None, window_s: 2.0 },
            channel::Channel { observed: channel::Observed::Margin, motors: channel::Motors::Pooled, threshold: Some(channel::Threshold::Below(0.006)), window_s: 2.0 },
        ],
        inputs: &[
            channel::Input { channel: 0, statistic: channel::Statistic::Std },
            channel::Input { channel: 1, statistic: channel::Statistic::Std },
            channel::Input { channel: 2, statistic: channel::Statistic::Mean },
            channel::Input { channel: 3, statistic: channel::Statistic::ShareBelow(0.006) },
        ],
        signals: 0,
        settings: Settings { sampling: Sampling { min_samples: 5, warm_up_s: 1.0, longest_gap_s: 2.0 }, elevated_risk: AccumulatorSettings { window_s: 10.0, high_pct: 50.0, low_pct: 20.0, rise_pct_per_s: 1.5, fall_pct_per_s: 2.0 }, verdict: VerdictSettings { warn: LevelSettings { raise: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(50.0) }, after_s: 0.2, until: Threshold { risk_pct: Some(25.0), elevated_risk_pct: Some(30.0) } }, fail: LevelSettings { raise: Threshold { risk_pct: Some(85.0), elevated_risk_pct: Some(90.0) }, after_s: 0.4, until: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(70.0) } }, clear_after_s: 10.0, quiet_after_take_off_s: 5.0, quiet_before_landing_s: 1.0, idle: Idle { command_below: 0.1, risk_at_most_pct: 60.0 } } },
        coverage_below: 0.0625,
        filled: None,
    }
};
