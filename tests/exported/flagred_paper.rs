// The profile `flagred-paper` with the rule set `flagred-paper`, written by `flagred export --rust` 0.1.0. Do not edit.
// 3884 bytes of constants, 892 of them to fill gaps of the rules. A monitor of 4 motors takes 55256 bytes of memory.

/// The memory of a monitor for this number of motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<14, 12, 1, 2, MOTORS>;

/// The texts of findings with a cause, by the proposition of the cause.
#[allow(dead_code)]
#[rustfmt::skip]
pub static CAUSES: [::flagred::board::Words<'static>; 20] = [
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "The motors were on average only {percent} % of their range away from a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "unsteady_motors", brief: "unsteady motors", text: "The motor commands varied strongly, with a standard deviation of {percent} % of their range.", advice: "Reduce speed or land. After landing, check motors, propellers and gains." },
];

/// The texts of findings without a cause, by their measure.
#[allow(dead_code)]
#[rustfmt::skip]
pub static NOTICES: [::flagred::board::Words<'static>; 8] = [
    ::flagred::board::Words { code: "risk_interpolated", brief: "interpolated", text: "No rule applies to this moment, so the risk is interpolated between rules.", advice: "Reduce speed or land until the risk falls. After landing, look for the cause." },
    ::flagred::board::Words { code: "risk_interpolated", brief: "interpolated", text: "No rule applies to this moment, so the risk is interpolated between rules.", advice: "Reduce speed or land until the risk falls. After landing, look for the cause." },
    ::flagred::board::Words { code: "command_noise", brief: "command noise {peak} %", text: "The motor commands are noisy, by {peak} % of their range: vibration, or gains that are too high.", advice: "This alone is not a danger. After landing, check propellers, mounts and filters." },
    ::flagred::board::Words { code: "low_thrust_reserve", brief: "thrust reserve {peak} %", text: "The motors ran close to full thrust: on average only {peak} % of their range was left, less than {threshold} %. Gusts and climbs need that reserve.", advice: "Land soon. Before the next flight, reduce payload or charge the battery." },
    ::flagred::board::Words { code: "imbalance", brief: "imbalance {peak} %, {motor}", text: "The motors share the load differently from earlier in the flight, by {peak} % of their range. The motor to check is {motor}, whose share is now {side} its earlier share.", advice: "Land. After landing, check {motor}, and whether the load has shifted." },
    ::flagred::board::Words { code: "pair_imbalance", brief: "pair imbalance {peak} %, {motor}", text: "The commands of two opposite motors differ by {peak} % of their range. The motor to check is {motor}, whose command is {side} that of the opposite motor: it may be weak, or the load may be off centre.", advice: "Land. After landing, check {motor}, and the position of battery and payload." },
    ::flagred::board::Words { code: "weak_motor", brief: "{motor} weak: +{peak} %", text: "The command of {motor} rose by {peak} % of its range, compared with the other motors: this motor gives less thrust than before.", advice: "Land now. After landing, check {motor}: propeller, motor, speed controller and wiring." },
    ::flagred::board::Words { code: "motors_idle_in_air", brief: "motors idle in the air", text: "The motors had idled for 3 s while the autopilot reported that the vehicle was in the air: it fell.", advice: "Before the next flight, find out why the motors stopped: kill switch, failsafe, power." },
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
        name: "flagred-paper",
        rules: Rules {
            table: Table {
                and: Conjunction::Minimum,
                or: Disjunction::Maximum,
                conjunctions: Conjunctions::Uniform { actions_per_cell: 1, first_action: 0, sums: false },
                least_strength: 1e-12,
                sizes: Sizes { degrees: 0, alive: 4, partial: 4, stack: 0, strengths: 8 },
                inputs: &[
                    Input { low: 0.0, high: 0.5, first_literal: 0, first_cut: 8, end_cut: 8, first_start: 0, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 0.5, first_literal: 4, first_cut: 8, end_cut: 8, first_start: 2, first_curve: 0, end_curve: 0 },
                ],
                cuts: &[0.1, 0.2, 0.3, inf, 0.1, 0.2, inf, inf],
                starts: &[14, 14, 14, 14],
                lines: &[
                    Line { foot: 0.1, run: -0.1, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.0, run: 0.1, base: 0.0, rise: 1.0, literal: 3 },
                    Line { foot: 0.2, run: -0.1, base: 0.0, rise: 1.0, literal: 3 },
                    Line { foot: 0.1, run: 0.1, base: 0.0, rise: 1.0, literal: 6 },
                    Line { foot: 0.3, run: -0.09999999999999998, base: 0.0, rise: 1.0, literal: 6 },
                    Line { foot: 0.2, run: 0.09999999999999998, base: 0.0, rise: 1.0, literal: 9 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 9 },
                    Line { foot: 0.0, run: inf, base: 0.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.1, run: -0.1, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.0, run: 0.1, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.2, run: -0.1, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.1, run: 0.1, base: 0.0, rise: 1.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 2 },
                    Line { foot: 0.0, run: inf, base: 0.0, rise: 0.0, literal: 0 },
                ],
                curves: &[],
                points: &[],
                hedges: &[],
                axes: &[
                    Axis { input: 0, first_cut: 0, end_cut: 4, first_line: 0 },
                    Axis { input: 1, first_cut: 4, end_cut: 8, first_line: 8 },
                ],
                dimensions: &[],
                cells: &[],
                nodes: &[],
                edges: &[],
                actions: &[
                    Action { weight: 0.0, strength: 7, output: 0, rule: 4294967295, sums: 0 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 9, sums: 0 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 8, sums: 0 },
                    Action { weight: 0.0, strength: 7, output: 0, rule: 4294967295, sums: 0 },
                    Action { weight: 1.0, strength: 2, output: 0, rule: 7, sums: 0 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 6, sums: 0 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 4, sums: 0 },
                    Action { weight: 1.0, strength: 1, output: 0, rule: 5, sums: 0 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 3, sums: 0 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 1, sums: 0 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 2, sums: 0 },
                    Action { weight: 1.0, strength: 0, output: 0, rule: 0, sums: 0 },
                ],
                programs: &[],
                steps: &[],
                blocks: &[],
                outputs: &[
                    Output { low: 0.0, high: 100.0, default_value: NaN, form: 1, first: 0, end: 3, first_strength: 0, end_strength: 7, clamps: 0, reduction: 0, lower: 0 },
                ],
                pairs: &[
                    Pair { area: [[25.0, 50.0], [-12.5, -25.0]], moment: [[-937.5, -1250.0], [312.5, 625.0], [104.16666666666667, 0.0]], width: [25.0, 25.0], middle: [-37.5, -12.5] },
                    Pair { area: [[50.0, 50.0], [-25.0, -25.0]], moment: [[0.0, 1250.0], [0.0, -625.0], [0.0, 0.0]], width: [25.0, 25.0], middle: [12.5, 37.5] },
                    Pair { area: [[25.0, 0.0], [-12.5, 0.0]], moment: [[937.5, 0.0], [-312.5, 0.0], [-104.16666666666667, 0.0]], width: [0.0, 0.0], middle: [0.0, 0.0] },
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
            },
            stages: &[],
            indices: &[],
        },
        output: 0,
        order: &[0, 1],
        channels: &[
            channel::Channel { observed: channel::Observed::Margin, motors: channel::Motors::Pooled, threshold: None, in_bins: false, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Pooled, threshold: None, in_bins: false, window_s: 2.0, exponential: false },
        ],
        inputs: &[
            channel::Input { channel: 0, statistic: channel::Statistic::Mean, ratio: None, if_missing: None },
            channel::Input { channel: 1, statistic: channel::Statistic::Std, ratio: None, if_missing: None },
        ],
        signals: 0,
        settings: Settings { sampling: Sampling { min_samples: 5, warm_up_s: 1.0, longest_gap_s: 2.0, take_off_s: 0.0 }, elevated_risk: AccumulatorSettings { window_s: 10.0, high_pct: 50.0, low_pct: 20.0, rise_pct_per_s: 2.0, fall_pct_per_s: 3.0 }, verdict: VerdictSettings { warn: LevelSettings { raise: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(50.0) }, after_s: 0.2, until: Threshold { risk_pct: Some(25.0), elevated_risk_pct: Some(30.0) } }, fail: LevelSettings { raise: Threshold { risk_pct: Some(85.0), elevated_risk_pct: Some(90.0) }, after_s: 0.4, until: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(70.0) } }, clear_after_s: 10.0, quiet_after_take_off_s: 5.0, quiet_before_landing_s: 1.0, idle_below: 0.1, notices: NoticeSettings { noise: None, reserve: None, imbalance: None } } },
        coverage_below: 0.5,
        filled: Some(FilledKnots {
            coordinates: &[
                0.0, 0.05, 0.1, 0.15000000000000002, 0.2, 0.25, 0.3, 0.5, 0.0, 0.05, 0.1, 0.15000000000000002, 0.2,
                0.5,
            ],
            starts: &[0, 8, 14],
            values: &[
                84.10988974948856, 90.27777777777777, 91.66666666666666, 90.27777777777777, 91.66666666666666,
                91.66666666666666, 58.9025336663483, 63.425925925925924, 63.425925925925924, 63.42592592592593,
                90.27777777777777, 90.27777777777777, 36.73333188026007, 50.0, 50.0, 63.425925925925924,
                91.66666666666666, 91.66666666666666, 9.722222222222229, 34.46969696969697, 37.5, 46.42857142857143,
                50.0, 50.0, 8.333333333333343, 22.023809523809522, 25.0, 22.02380952380953, 8.333333333333343,
                8.333333333333343, 9.722222222222221, 22.023809523809522, 22.023809523809522, 22.023809523809526,
                9.722222222222221, 9.722222222222221, 8.333333333333343, 9.722222222222221, 8.333333333333343,
                9.722222222222229, 8.333333333333343, 8.333333333333343, 8.333333333333343, 9.722222222222221,
                8.333333333333343, 9.722222222222229, 8.333333333333343, 8.333333333333343,
            ],
            distances: &[
                0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
                0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
                0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            ],
        }),
        propositions: &[
            Proposition { rule: 0, input: 0, literal: 3 }, Proposition { rule: 0, input: 1, literal: 6 },
            Proposition { rule: 1, input: 1, literal: 4 }, Proposition { rule: 1, input: 0, literal: 3 },
            Proposition { rule: 2, input: 0, literal: 3 }, Proposition { rule: 2, input: 1, literal: 5 },
            Proposition { rule: 3, input: 0, literal: 2 }, Proposition { rule: 3, input: 1, literal: 6 },
            Proposition { rule: 4, input: 1, literal: 4 }, Proposition { rule: 4, input: 0, literal: 2 },
            Proposition { rule: 5, input: 0, literal: 2 }, Proposition { rule: 5, input: 1, literal: 5 },
            Proposition { rule: 6, input: 0, literal: 1 }, Proposition { rule: 6, input: 1, literal: 6 },
            Proposition { rule: 7, input: 0, literal: 1 }, Proposition { rule: 7, input: 1, literal: 5 },
            Proposition { rule: 8, input: 0, literal: 0 }, Proposition { rule: 8, input: 1, literal: 6 },
            Proposition { rule: 9, input: 0, literal: 0 }, Proposition { rule: 9, input: 1, literal: 5 },
        ],
    }
};
