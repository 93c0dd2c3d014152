// The profile `flagred` with the rule set `flagred`, written by `flagred export --rust` 0.1.0. Do not edit.
// 4368 bytes of constants, 0 of them to fill gaps of the rules. A monitor of 4 motors takes 123392 bytes of memory.

/// The memory of a monitor for this number of motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<35, 6, 1, 6, MOTORS>;

/// The texts of findings with a cause, by the proposition of the cause.
#[allow(dead_code)]
#[rustfmt::skip]
pub static CAUSES: [::flagred::board::Words<'static>; 21] = [
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "sudden_change", brief: "sudden change", text: "The motors changed suddenly and strongly to hold attitude, as in a gust, a hard manoeuvre or when a motor fails.", advice: "Reduce speed; if neither wind nor a manoeuvre explains it, land. After landing, check motors and propellers." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "fighting_gusts", brief: "fighting gusts", text: "Over 20 s the motors changed strongly to hold attitude, as in gusts. A stronger gust may be too much.", advice: "Reduce speed and height, or land. After landing, if the air was calm, check propellers, payload and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "fighting_gusts", brief: "fighting gusts", text: "Over 20 s the motors changed strongly to hold attitude, as in gusts. A stronger gust may be too much.", advice: "Reduce speed and height, or land. After landing, if the air was calm, check propellers, payload and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "fighting_gusts", brief: "fighting gusts", text: "Over 20 s the motors changed strongly to hold attitude, as in gusts. A stronger gust may be too much.", advice: "Reduce speed and height, or land. After landing, if the air was calm, check propellers, payload and gains." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "thrust_surges", brief: "thrust surges", text: "The thrust of all motors together rose and fell strongly, as in turbulence or fast climbs and descents.", advice: "Climb and descend more slowly; in rough air, land. After landing, if the air was calm, check vibration and the gains for altitude." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "thrust_surges", brief: "thrust surges", text: "The thrust of all motors together rose and fell strongly, as in turbulence or fast climbs and descents.", advice: "Climb and descend more slowly; in rough air, land. After landing, if the air was calm, check vibration and the gains for altitude." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "thrust_surges", brief: "thrust surges", text: "The thrust of all motors together rose and fell strongly, as in turbulence or fast climbs and descents.", advice: "Climb and descend more slowly; in rough air, land. After landing, if the air was calm, check vibration and the gains for altitude." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "low_motor_margin", brief: "low motor margin", text: "To hold attitude, the motor commands varied by {percent} % of the reserve of the motor closest to its upper limit.", advice: "Reduce speed or land. After landing, check motors, propellers and battery; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "low_motor_margin", brief: "low motor margin", text: "To hold attitude, the motor commands varied by {percent} % of the reserve of the motor closest to its upper limit.", advice: "Reduce speed or land. After landing, check motors, propellers and battery; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "low_motor_margin", brief: "low motor margin", text: "To hold attitude, the motor commands varied by {percent} % of the reserve of the motor closest to its upper limit.", advice: "Reduce speed or land. After landing, check motors, propellers and battery; if this happens often, reduce payload." },
    ::flagred::board::Words { code: "motor_at_limit", brief: "motors at limits", text: "Over 2 s, {percent} % of the motor commands were at a limit, where a motor cannot correct anything.", advice: "Land now and gently, without hard climbs, descents and turns. After landing, check motors and propellers; if this happens often, reduce payload." },
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
        name: "flagred",
        rules: Rules {
            table: Table {
                and: Conjunction::Product,
                or: Disjunction::Maximum,
                conjunctions: Conjunctions::Trie,
                least_strength: 1e-12,
                sizes: Sizes { degrees: 12, alive: 4, partial: 1, stack: 1, strengths: 6 },
                inputs: &[
                    Input { low: 0.0, high: 0.5, first_literal: 0, first_cut: 0, end_cut: 2, first_start: 0, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 0.5, first_literal: 1, first_cut: 2, end_cut: 5, first_start: 4, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 0.5, first_literal: 4, first_cut: 5, end_cut: 8, first_start: 9, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 10.0, first_literal: 7, first_cut: 8, end_cut: 11, first_start: 14, first_curve: 0, end_curve: 0 },
                    Input { low: 0.0, high: 1.0, first_literal: 10, first_cut: 11, end_cut: 12, first_start: 19, first_curve: 0, end_curve: 0 },
                ],
                cuts: &[0.01, 0.036, 0.006, 0.012, 0.04, 0.0012, 0.008, 0.03, 0.03, 0.25, 1.0, 0.35],
                starts: &[0, 0, 1, 2, 2, 3, 5, 7, 8, 8, 9, 11, 13, 14, 14, 15, 17, 19, 20, 20, 22, 23],
                lines: &[
                    Line { foot: 0.01, run: 0.025999999999999995, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.0, run: inf, base: 1.0, rise: 0.0, literal: 0 },
                    Line { foot: 0.012, run: -0.006, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.006, run: 0.006, base: 0.0, rise: 1.0, literal: 1 },
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
                    Line { foot: 0.25, run: -0.22, base: 0.0, rise: 1.0, literal: 0 },
                    Line { foot: 0.03, run: 0.22, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 1.0, run: -0.75, base: 0.0, rise: 1.0, literal: 1 },
                    Line { foot: 0.25, run: 0.75, base: 0.0, rise: 1.0, literal: 2 },
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
                    Action { weight: 1.0, strength: 4, output: 0, rule: 1, sums: 1 },
                    Action { weight: 0.66, strength: 0, output: 0, rule: 2, sums: 1 },
                    Action { weight: 0.23, strength: 1, output: 0, rule: 3, sums: 1 },
                    Action { weight: 0.66, strength: 4, output: 0, rule: 4, sums: 1 },
                    Action { weight: 0.33, strength: 1, output: 0, rule: 5, sums: 1 },
                    Action { weight: 0.23, strength: 3, output: 0, rule: 6, sums: 1 },
                    Action { weight: 0.46, strength: 4, output: 0, rule: 7, sums: 1 },
                    Action { weight: 0.66, strength: 0, output: 0, rule: 8, sums: 1 },
                    Action { weight: 0.66, strength: 2, output: 0, rule: 9, sums: 1 },
                    Action { weight: 0.66, strength: 4, output: 0, rule: 10, sums: 1 },
                    Action { weight: 1.0, strength: 4, output: 0, rule: 0, sums: 1 },
                ],
                programs: &[
                    Program { weight: 1.0, first_step: 0, end_step: 2, first_action: 0, end_action: 1, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.66, first_step: 2, end_step: 4, first_action: 1, end_action: 2, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.23, first_step: 4, end_step: 6, first_action: 2, end_action: 3, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.66, first_step: 6, end_step: 8, first_action: 3, end_action: 4, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.33, first_step: 8, end_step: 10, first_action: 4, end_action: 5, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.23, first_step: 10, end_step: 12, first_action: 5, end_action: 6, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.46, first_step: 12, end_step: 14, first_action: 6, end_action: 7, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.66, first_step: 14, end_step: 16, first_action: 7, end_action: 8, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.66, first_step: 16, end_step: 18, first_action: 8, end_action: 9, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 0.66, first_step: 18, end_step: 20, first_action: 9, end_action: 10, first_hedge: 0, end_hedge: 0 },
                    Program { weight: 1.0, first_step: 20, end_step: 21, first_action: 10, end_action: 11, first_hedge: 0, end_hedge: 0 },
                ],
                steps: &[
                    AntecedentStep { op: Op(0), literal: 0 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 1 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 2 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 3 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 4 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 5 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 6 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 7 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 8 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 9 }, AntecedentStep { op: Op(1), literal: 10 },
                    AntecedentStep { op: Op(0), literal: 11 },
                ],
                blocks: &[],
                outputs: &[
                    Output { low: 0.0, high: 100.0, default_value: NaN, form: 2, first: 0, end: 5, first_strength: 0, end_strength: 5, clamps: 0, reduction: 0, lower: 0 },
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
            indices: &[],
        },
        output: 0,
        order: &[0, 1, 2, 3, 5],
        channels: &[
            channel::Channel { observed: channel::Observed::CommandLessYaw, motors: channel::Motors::Std, threshold: None, in_bins: true, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::CommandLessYaw, motors: channel::Motors::Std, threshold: None, in_bins: true, window_s: 20.0, exponential: false },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Mean, threshold: None, in_bins: true, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Std, threshold: None, in_bins: true, window_s: 2.0, exponential: false },
            channel::Channel { observed: channel::Observed::HighSide, motors: channel::Motors::Min, threshold: None, in_bins: false, window_s: 20.0, exponential: false },
            channel::Channel { observed: channel::Observed::Margin, motors: channel::Motors::Pooled, threshold: Some(channel::Threshold::Below(0.006)), in_bins: false, window_s: 2.0, exponential: false },
        ],
        inputs: &[
            channel::Input { channel: 0, statistic: channel::Statistic::StdLessNoise, ratio: None, if_missing: None },
            channel::Input { channel: 1, statistic: channel::Statistic::StdLessNoise, ratio: None, if_missing: None },
            channel::Input { channel: 2, statistic: channel::Statistic::StdLessNoise, ratio: None, if_missing: None },
            channel::Input { channel: 3, statistic: channel::Statistic::StdLessNoise, ratio: Some(channel::Ratio { per: 4, at_least: 0.02 }), if_missing: None },
            channel::Input { channel: 4, statistic: channel::Statistic::Mean, ratio: None, if_missing: None },
            channel::Input { channel: 5, statistic: channel::Statistic::ShareBelow(0.006), ratio: None, if_missing: None },
        ],
        signals: 0,
        settings: Settings { sampling: Sampling { min_samples: 5, warm_up_s: 0.5, longest_gap_s: 2.0, take_off_s: 3.0 }, elevated_risk: AccumulatorSettings { window_s: 3.0, high_pct: 50.0, low_pct: 46.0, rise_pct_per_s: 14.0, fall_pct_per_s: 28.0 }, verdict: VerdictSettings { warn: LevelSettings { raise: Threshold { risk_pct: Some(62.0), elevated_risk_pct: Some(60.0) }, after_s: 0.2, until: Threshold { risk_pct: Some(43.0), elevated_risk_pct: Some(20.0) } }, fail: LevelSettings { raise: Threshold { risk_pct: Some(80.0), elevated_risk_pct: None }, after_s: 0.3, until: Threshold { risk_pct: Some(65.0), elevated_risk_pct: None } }, clear_after_s: 5.0, quiet_after_take_off_s: 3.0, quiet_before_landing_s: 2.0, idle_below: 0.1, notices: NoticeSettings { noise: Some(Limit { value: 0.08, after_s: 5.0 }), reserve: Some(Limit { value: 0.1, after_s: 3.0 }), imbalance: Some(Limit { value: 0.15, after_s: 3.0 }) } } },
        coverage_below: 0.03125,
        filled: None,
        propositions: &[
            Proposition { rule: 0, input: 5, literal: 11 }, Proposition { rule: 1, input: 0, literal: 0 },
            Proposition { rule: 1, input: 5, literal: 10 }, Proposition { rule: 2, input: 1, literal: 1 },
            Proposition { rule: 2, input: 5, literal: 10 }, Proposition { rule: 3, input: 1, literal: 2 },
            Proposition { rule: 3, input: 5, literal: 10 }, Proposition { rule: 4, input: 1, literal: 3 },
            Proposition { rule: 4, input: 5, literal: 10 }, Proposition { rule: 5, input: 2, literal: 4 },
            Proposition { rule: 5, input: 5, literal: 10 }, Proposition { rule: 6, input: 2, literal: 5 },
            Proposition { rule: 6, input: 5, literal: 10 }, Proposition { rule: 7, input: 2, literal: 6 },
            Proposition { rule: 7, input: 5, literal: 10 }, Proposition { rule: 8, input: 3, literal: 7 },
            Proposition { rule: 8, input: 5, literal: 10 }, Proposition { rule: 9, input: 3, literal: 8 },
            Proposition { rule: 9, input: 5, literal: 10 }, Proposition { rule: 10, input: 3, literal: 9 },
            Proposition { rule: 10, input: 5, literal: 10 },
        ],
    }
};
