// The profile `flagred-paper` with the rule set `flagred-paper`, written by `flagred export --rust` 0.1.0. Not to be edited.
// 3456 bytes of constants, of which 1128 fill gaps of the rules' map; 46864 bytes of memory for a monitor of 4 motors.

/// Memory for a monitor of so many motors.
#[allow(dead_code)]
pub type Storage<const MOTORS: usize> =
    ::flagred::board::Storage<16, 12, 1, 2, MOTORS>;

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
        name: "flagred-paper",
        table: Table {
            and: Conjunction::Minimum,
            or: Disjunction::Maximum,
            conjunctions: Conjunctions::Uniform { actions_a_cell: 1, first_action: 0, sums: false },
            sizes: Sizes { degrees: 0, alive: 4, partial: 4, stack: 0, heights: 8 },
            inputs: &[
                Input { low: 0.0, high: 0.5, first_literal: 0, first_cut: 0, end_cut: 0, first_start: 0, first_curve: 0, end_curve: 0 },
                Input { low: 0.0, high: 0.5, first_literal: 4, first_cut: 0, end_cut: 0, first_start: 2, first_curve: 0, end_curve: 0 },
            ],
            cuts: &[0.1, 0.2, 0.3, inf, 0.1, 0.2, inf, inf],
            starts: &[0, 0, 0, 0],
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
                Action { weight: 0.0, place: 7, output: 0, rule: 4294967295, sums: 0 },
                Action { weight: 1.0, place: 4, output: 0, rule: 9, sums: 0 },
                Action { weight: 1.0, place: 4, output: 0, rule: 8, sums: 0 },
                Action { weight: 0.0, place: 7, output: 0, rule: 4294967295, sums: 0 },
                Action { weight: 1.0, place: 2, output: 0, rule: 7, sums: 0 },
                Action { weight: 1.0, place: 4, output: 0, rule: 6, sums: 0 },
                Action { weight: 1.0, place: 0, output: 0, rule: 4, sums: 0 },
                Action { weight: 1.0, place: 1, output: 0, rule: 5, sums: 0 },
                Action { weight: 1.0, place: 0, output: 0, rule: 3, sums: 0 },
                Action { weight: 1.0, place: 0, output: 0, rule: 1, sums: 0 },
                Action { weight: 1.0, place: 0, output: 0, rule: 2, sums: 0 },
                Action { weight: 1.0, place: 0, output: 0, rule: 0, sums: 0 },
            ],
            programs: &[],
            steps: &[],
            outputs: &[
                Output { low: 0.0, high: 100.0, otherwise: NaN, set: Set(1), first: 0, end: 3, first_height: 0, end_height: 7 },
            ],
            pairs: &[
                Pair { area: [[25.0, 50.0], [-12.5, -25.0]], moment: [[-937.5, -1250.0], [312.5, 625.0], [104.16666666666667, 0.0]], width: [25.0, 25.0], middle: [-37.5, -12.5] },
                Pair { area: [[50.0, 50.0], [-25.0, -25.0]], moment: [[0.0, 1250.0], [0.0, -625.0], [0.0, 0.0]], width: [25.0, 25.0], middle: [12.5, 37.5] },
                Pair { area: [[25.0, 0.0], [-12.5, 0.0]], moment: [[937.5, 0.0], [-312.5, 0.0], [-104.16666666666667, 0.0]], width: [0.0, 0.0], middle: [0.0, 0.0] },
            ],
            moments: &[],
            consequences: &[],
            coefficients: &[],
        },
        output: 0,
        order: &[0, 1],
        channels: &[
            channel::Channel { observed: channel::Observed::Margin, motors: channel::Motors::Pooled, threshold: None, window_s: 2.0 },
            channel::Channel { observed: channel::Observed::Command, motors: channel::Motors::Pooled, threshold: None, window_s: 2.0 },
        ],
        inputs: &[
            channel::Input { channel: 0, statistic: channel::Statistic::Mean },
            channel::Input { channel: 1, statistic: channel::Statistic::Std },
        ],
        signals: 0,
        settings: Settings { sampling: Sampling { min_samples: 5, warm_up_s: 1.0, longest_gap_s: 2.0 }, elevated_risk: AccumulatorSettings { window_s: 10.0, high_pct: 50.0, low_pct: 20.0, rise_pct_per_s: 2.0, fall_pct_per_s: 3.0 }, verdict: VerdictSettings { warn: LevelSettings { raise: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(50.0) }, after_s: 0.2, until: Threshold { risk_pct: Some(25.0), elevated_risk_pct: Some(30.0) } }, fail: LevelSettings { raise: Threshold { risk_pct: Some(85.0), elevated_risk_pct: Some(90.0) }, after_s: 0.4, until: Threshold { risk_pct: Some(67.0), elevated_risk_pct: Some(70.0) } }, clear_after_s: 10.0, quiet_after_take_off_s: 5.0, quiet_before_landing_s: 1.0, idle: Idle { command_below: 0.1, risk_at_most_pct: 60.0 } } },
        coverage_below: 0.5,
        filled: Some(FilledCells {
            scales: &[Scale { low: 0.0, high: 0.5, points: 51 }, Scale { low: 0.0, high: 0.5, points: 51 }],
            runs: &[
                Run { cell: 0, first: 0, end: 5 }, Run { cell: 51, first: 5, end: 10 },
                Run { cell: 102, first: 10, end: 15 }, Run { cell: 153, first: 15, end: 20 },
                Run { cell: 204, first: 20, end: 25 }, Run { cell: 255, first: 25, end: 30 },
                Run { cell: 306, first: 30, end: 35 }, Run { cell: 357, first: 35, end: 40 },
                Run { cell: 408, first: 40, end: 45 }, Run { cell: 459, first: 45, end: 50 },
                Run { cell: 510, first: 50, end: 55 }, Run { cell: 561, first: 55, end: 60 },
                Run { cell: 612, first: 60, end: 65 }, Run { cell: 663, first: 65, end: 70 },
                Run { cell: 714, first: 70, end: 75 },
            ],
            values: &[
                91.52816393461839, 90.5763525615252, 89.92213318724947, 89.64857397704299, 89.60050581459839,
                84.86615388556879, 82.84321913638681, 81.53817774797336, 80.02233329420677, 78.27223925517528,
                79.05802506431088, 77.30790462653749, 75.35234192099658, 73.22992694335619, 71.09326355720518,
                74.25103007310668, 72.52315522489606, 70.65585373380387, 68.46709618684575, 67.1763248937936,
                71.567168749468, 69.76669239057344, 67.82686361391706, 64.9508961494284, 64.65747060126088,
                64.22204462868574, 63.95440052738851, 63.69353335887041, 63.383061149414786, 63.22385088736758,
                60.1613339845086, 60.583031722801884, 61.44848922967885, 61.492664180023226, 61.8922032173555,
                56.975092285530984, 57.73443482364571, 58.62185021535635, 59.84119500522381, 60.10608731593328,
                55.32805764433647, 55.81974855563705, 56.36769516898827, 57.14146820864113, 57.514326008314484,
                34.393267811762996, 53.20783815611847, 53.37326040297309, 53.993437861757826, 54.19553643003795,
                25.706476083341535, 36.75336231560541, 48.70011298561744, 49.91073845680893, 49.9484508277596,
                16.32624190044023, 28.700183861113103, 38.374787534232794, 44.250608236956836, 45.52835759244119,
                13.910638639156572, 25.037624251684527, 31.833905354463845, 39.71147506538663, 41.38766208805656,
                10.349910609414419, 21.08631569648658, 29.63318003368089, 34.76138076256229, 37.79690101296507,
                10.34033079522663, 21.33413032152124, 28.94249097022569, 33.03149799914209, 35.33099077797374,
            ],
            distances: &[
                0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08,
                0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04,
                0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1, 0.08, 0.06, 0.04, 0.02, 0.1,
                0.08, 0.06, 0.04, 0.02, 0.08, 0.08, 0.06, 0.04, 0.02, 0.06, 0.06, 0.06, 0.04, 0.02, 0.04, 0.04, 0.04,
                0.04, 0.02, 0.02, 0.02, 0.02, 0.02, 0.02,
            ],
        }),
    }
};
