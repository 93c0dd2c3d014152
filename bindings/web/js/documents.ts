// Written by `UPDATE_DOCUMENTS=1 cargo test --workspace --test bindings` from the types in Rust.

/** An input with a value that nobody measured: `ProfileInput::if_missing`. */
export interface AssumedInput {
  /** Its name. */
  input: string;
  /** Its value. */
  value: number;
  /** The signals that it is made of; at least one was missing. */
  signals: string[];
}

/** What raised the risk when a level was reached: `verdict::Cause` by name. */
export interface Cause {
  /** The input of the rule that distinguishes it: of the propositions of its antecedent, that of the fewest rules. */
  input: string;
  /** The value of that input. */
  value: number;
  /** The term, with its hedges. */
  term: string;
  /** The rule as its index in the model; serialised, as its number from 1. */
  rule: number;
}

/** The nearest change if one input changes and the others stay. */
export type Change = {
  /** The input that changes. */
  input: string;
  /** The value of the input from which on the change holds. */
  at: number;
  /** How far that is from its value now; negative below it. */
  by: number;
  effect: 'term';
  /** The term. */
  term: string | null;
} | {
  /** The input that changes. */
  input: string;
  /** The value of the input from which on the change holds. */
  at: number;
  /** How far that is from its value now; negative below it. */
  by: number;
  effect: 'rule';
  /** The output. */
  output: string;
  /** The index of the rule in the model, none where no rule fires; serialised, rules count from 1. */
  rule: number | null;
  /** The value of the output there. */
  value: number | null;
};

/** The degree of membership of a value in a term. */
export interface Degree {
  /** The term. */
  term: string;
  /** The degree, in [0, 1]. */
  degree: number;
}

/** An input, and the degrees of its terms. */
export interface ExplainedInput {
  /** Its name. */
  name: string;
  /** The value that was given. */
  given: number;
  /** The value that was used: the end of the range where the given one lies outside. */
  value: number;
  /** The degree of each term. */
  terms: Degree[];
}

/** An output, and the rules that contribute to it. */
export interface ExplainedOutput {
  /** Its name. */
  name: string;
  /** The value; none where no rule fires and the model has no default. */
  value: number | null;
  /** Whether no rule fires and the value is the model's default. */
  is_default: boolean;
  /** Whether it keeps its previous value where no rule fires. One point has none before it. */
  keeps_previous: boolean;
  /** The outputs whose values it reads. Where one of them has no value, no rule of this output fires, and it has none. */
  reads: string[];
  /** The largest firing strength of a rule of this output. */
  coverage: number;
  /** The rules that contribute to it, the largest share first. */
  rules: Share[];
  /** The degree of the value in each term; empty for Takagi-Sugeno outputs. */
  terms: Degree[];
  /** The aggregated set: `(value, degree)` at even steps over the range, or at the places of singletons; empty for Takagi-Sugeno and Tsukamoto outputs. */
  set: [number, number][];
}

/** How the outputs come about at a point: `flagred explain --json`. */
export interface Explanation {
  schema: 'flagred.explain/1';
  /** The name of the rule set. */
  model: string;
  /** The inputs, with the degree of each of their terms. */
  inputs: ExplainedInput[];
  /** The rules that fired, the strongest first. */
  rules: FiredRule[];
  /** The outputs. */
  outputs: ExplainedOutput[];
  /** The rules that do not fire. */
  silent?: SilentRule[] | null;
  /** The nearest changes if one input changes. */
  changes?: Change[] | null;
}

/** A rule that fired. */
export interface FiredRule {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  /** The degree of its condition. */
  degree: number;
  /** The degree times the weight, as the activation method leaves it; hedges of its consequents change it in `Share::strength`. */
  strength: number;
}

/** What is said of a flight: `flagred assess --json`. `docs/json.md` describes it. */
export interface FlightDocument {
  schema: 'flagred.assess/1';
  /** The log that was read. */
  log: Log;
  vehicle: Vehicle;
  /** The amount of data read, and damage. */
  read: Report;
  profile: Profile;
  /** The level of the gravest finding; `NA` where there is no verdict. */
  verdict: VerdictWord;
  /** Only with `NA`: why there is no verdict. */
  reason?: string;
  /** Only with `NA`: what the pilot can do to get a verdict next time. */
  help?: string | null;
  /** The gravest first, those of equal severity in order of time; of many the gravest 1,000. */
  findings: FlightFinding[];
  /** How many findings were left out. */
  findings_left_out: number;
  summary: Summary;
  /** The inputs whose values were assumed because the log lacks their signals. */
  assumed_inputs: AssumedInput[];
  /** The risk over time. The npm package can leave it out; `flagred assess` never does. */
  steps?: Step[];
  /** Seconds between the steps, where they are further apart than was asked for: 250,000 are kept at most. */
  widened_step_s: number | null;
}

/** A finding with the output of its motor, and in words. */
export interface FlightFinding {
  /** The worst level that was reached. */
  severity: Level;
  /** Since when the level was reached, in seconds. */
  from_s: number;
  /** When it was first raised: `after_s` of that level later. */
  raised_s: number;
  /** When it became FAIL; null where it did not. */
  failed_s: number | null;
  /** When the level was last reached. It is held for a while longer. */
  to_s: number;
  /** What reached the level first. */
  measure: Measure;
  /** The threshold of the level in %. */
  threshold_pct: number;
  /** The worst value of the measure in that time, in %. */
  value_pct: number;
  /** The motor that is the cause. Of a risk: where the cause is that motors are near a limit, the one with the least margin while the level was being raised. Of an imbalance: the one out of balance. */
  motor: MotorFinding | null;
  /** What raised the risk; null where no rule did, as for a notice or an interpolated risk. */
  cause: Cause | null;
  /** The output that is the risk, where it is one of `Profile::other_risks`. */
  risk_output?: string;
  /** The output of the motor, as the log names it. */
  output: string | null;
  /** What kind of finding it is: a stable word for programs, such as `fighting_gusts`. */
  code: string;
  /** What happened, and what it means, for pilots. */
  text: string;
  /** What to do. */
  advice: string;
}

/** How many moments were followed by an attitude error over 5 degrees within 5 s. */
export interface Followed {
  /** All moments, one each 0.5 s. */
  moments: number;
  /** Those that were followed by such an error. */
  followed: number;
}

/** The kind of log a flight was read from. */
export type Format = string;

/** What a log has beyond the bounds of what is kept of it: counted only. No flight comes near a bound; damaged and hostile logs do. */
export interface LeftOut {
  /** Texts after the first 10,000. */
  texts: number;
  /** Changes of the flight mode after the first 10,000. */
  modes: number;
  /** Values of parameters after the first 16,384 names, and those with names longer than 64 bytes. */
  parameters: number;
  /** Changes of armed and in the air after the first 10,000 of each, where only the commands tell them. Nothing after these counts as in the air. */
  changes: number;
  /** Messages after those that fill a flight: 67,108,864 numbers, 10,000 events of arming and flying, or 1,000 boots. The flight ends there. */
  messages: number;
}

/** How risky it is, or was. */
export type Level = 'GOOD' | 'INFO' | 'WARN' | 'FAIL';

/** When a level is raised and until when it is held. */
export interface LevelSettings {
  /** The level is raised when this is reached ... */
  raise: Threshold;
  /** ... for this long without a break, in seconds. */
  after_s: number;
  /** Once raised, the level is held while this, which is lower, is reached. */
  until: Threshold;
}

/** A limit that has to be passed for a while. */
export interface Limit {
  /** The limit, on the effective range. */
  value: number;
  /** For how long, in seconds. */
  after_s: number;
}

export interface Log {
  /** Its path, as given. */
  path: string;
  /** The kind of log, such as `ArduPilot DataFlash`. */
  format: Format;
}

/** The quantity that a threshold is on. */
export type Measure = 'risk' | 'elevated_risk' | 'command_noise' | 'reserve' | 'imbalance' | 'pair_imbalance' | 'weak_motor' | 'idle_in_air';

/** A time of a flight. */
export interface Moment {
  /** The time that was asked for, in seconds. */
  t_s: number;
  /** The flight mode. */
  mode: string | null;
  /** The latest step, where it is not long ago. */
  step: Step | null;
  /** The distance to the nearest inputs that rules cover, in shares of their ranges, where the risk is interpolated. */
  filled_from: number | null;
  /** Whether an input was outside its range. */
  clamped: boolean;
  /** The inputs with the degrees of their terms; empty where one is unknown. */
  inputs: ExplainedInput[];
  /** The units of the inputs that have one. */
  units: Record<string, string>;
  /** The rules that fire, the strongest first. */
  rules: FiredRule[];
}

/** One motor, and the output that drives it. */
export interface Motor {
  /** Motor number of the autopilot, from 1. */
  number: number;
  /** The output as the log names it, such as `C3` or `actuator_motors.control[2]`. */
  output: string;
  /** Where the assignment came from, such as `SERVO3_FUNCTION = 35`. */
  source: string;
}

/** The motor behind a finding. */
export interface MotorFinding {
  /** Its number, from 1: of a log or a vehicle that of the autopilot, else its place in the samples. */
  number: number;
  /** The number of the other motor that it may be as well, where the commands do not show which of the two. */
  or_number: number | null;
  /** The limit it was nearest to. Out of balance: below or above its part. */
  side: Side;
  /** Its mean margin. */
  margin_mean: number;
  /** Its least margin. */
  margin_min: number;
}

/** What is told beside the risk; null is not. */
export interface NoticeSettings {
  /** Noise of the commands above this: vibration, or gains too high. */
  noise: Limit | null;
  /** A mean command that leaves less than this below the upper limit. */
  reserve: Limit | null;
  /** Motors that moved farther than this from their own part of the thrust earlier in the flight, or are farther than twice this from the motor opposite; half of it where one motor alone moved up. */
  imbalance: Limit | null;
}

/** A parameter of the autopilot. */
export interface Parameter {
  /** Its name. */
  name: string;
  /** Its first value: failure tests and learning change parameters in flight. */
  value: number;
  /** What told it, such as `PARM` or `PARAM_VALUE`. */
  source: string;
}

/** The largest value of a quantity. */
export interface Peak {
  /** When it was first reached, in seconds. */
  t_s: number;
  /** The value in %. */
  value_pct: number;
}

/** What the verdict rests on beside the flight. */
export interface Profile {
  /** Its name. */
  name: string;
  /** The name of its rule set, or its file. */
  rules: string;
  /** When levels are raised and lowered. */
  verdict: VerdictSettings;
  /** How often errors followed a risk; empty where it was not measured. */
  reliability: Reliability[];
}

/** A range of commands, and where it came from. */
export interface Range {
  /** Lower end. */
  low: number;
  /** Upper end, above `low`. */
  high: number;
  /** Unit of both: `us`, `1` (a fraction) or `raw` (counts of a bus). */
  unit: string;
  /** Where it came from, such as `MOT_PWM_MIN/MAX`. */
  source: string;
}

/** How many moments with a risk of a band were followed by a large attitude error. */
export interface Reliability {
  /** The lower end of the band in %; it belongs to it. */
  from_pct: number;
  /** The upper end in %; 100 belongs to the last band. */
  to_pct: number;
  /** On real vehicles. */
  real: Followed | null;
  /** On simulated ones. */
  simulated: Followed | null;
}

/** Report on the reading of a log. */
export interface Report {
  /** Bytes of the log that were read. */
  bytes: number;
  /** Complete messages, kept or not (rows in a CSV file). */
  messages: number;
  /** Bytes that belong to no message. */
  skipped_bytes: number;
  /** Messages that were recognised and rejected as damaged. */
  bad_messages: number;
  /** The log ends inside a message, or the compressed stream ends early. */
  truncated: boolean;
  /** The first reason for which bytes were skipped or a message was rejected. */
  reason: string | null;
  /** What the log has beyond the bounds of what is kept. */
  left_out: LeftOut;
}

/** What a rule contributes to an output. */
export interface Share {
  /** The rule's index in the model; serialised, rules count from 1. */
  rule: number;
  /** The term it concludes. */
  term: string;
  /** Its firing strength. */
  strength: number;
  /** Its share of the result, in [0, 1]. With the maximum as aggregation, the part of the aggregated set's area where this rule is the highest; with sums, its part of the area of all sets; in a Takagi-Sugeno or Tsukamoto output, its part of the weights. */
  share: number;
  /** In a Takagi-Sugeno or Tsukamoto output, and one of singletons, the number that its consequent gives at these inputs. */
  value: number | null;
}

/** The limit that a motor is nearer to. */
export type Side = 'lower' | 'upper';

/** A rule that does not fire at a point, and why. */
export type SilentRule = {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  reason: 'condition';
  /** The part as it is written. */
  condition: string;
} | {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  reason: 'no_value';
  /** The output. */
  output: string;
} | {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  reason: 'disabled';
} | {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  reason: 'weight';
} | {
  /** Its index in the model; serialised, rules count from 1. */
  rule: number;
  /** The rule as it is written. */
  text: string;
  reason: 'activation';
  /** The degree of its condition times its weight. */
  strength: number;
};

/** What was known at one time of a flight, as serde data; from `Step::by_name`. */
export interface Step {
  /** The time on the clock of the log, in seconds. */
  t_s: number;
  /** The risk in %. */
  risk: number | null;
  /** The elevated risk in %. */
  elevated_risk: number | null;
  /** The largest firing strength of a rule, in [0, 1]. */
  coverage: number | null;
  /** Whether the risk is interpolated, since no rule applies. */
  filled: boolean | null;
  /** The number of the rule with the largest firing strength, from 1; null where none fires. */
  dominant_rule: number | null;
  /** The mean margin over all motors and the window of the profile. */
  margin: number | null;
  /** The standard deviation of the commands over all motors and the window of the profile. */
  spread: number | null;
  /** Whether the step counts for findings and summary. */
  judged: boolean;
  /** The inputs of the rule set by their names. */
  inputs: Record<string, number | null>;
}

/** A flight in a few numbers. The risks are those of judged time (`Update::judged`). */
export interface Summary {
  /** The time in the air: the sum of all flights of a log, in seconds. */
  in_air_s: number;
  /** The time in the air with a known risk, of several with all of them known, in seconds. */
  assessed_s: number;
  /** The time in the air with a risk interpolated where no rule applies, in seconds. */
  filled_s: number;
  /** The mean risk in %. */
  risk_mean_pct: number | null;
  /** The highest risk. */
  risk_max: Peak | null;
  /** The highest elevated risk. */
  elevated_risk_max: Peak | null;
  /** The share of motor commands in the air within 0.5 % of a limit, in [0, 1]. */
  saturated_share: number | null;
}

/** A limit on each quantity; reaching either is enough. */
export interface Threshold {
  /** On the risk, in %. */
  risk_pct: number | null;
  /** On the elevated risk, in %. */
  elevated_risk_pct: number | null;
}

export interface Vehicle {
  /** What kind it is, such as `multirotor`. */
  kind: VehicleKind;
  /** Frame or type name, such as `QUAD/X`. */
  frame: string | null;
  /** Firmware with version. */
  firmware: string | null;
  /** The motors in order of their number. */
  motors: Motor[];
  /** The range of the raw commands. */
  range: Range | null;
  /** The part of the range that is used in flight, as fractions of it. */
  effective_range: Range;
  /** Why the used part counts as the whole range although the log reports limits. */
  effective_range_doubt: string | null;
  /** What is assumed of motors, their commands and ranges because the log does not report it, in words. */
  assumed: string[];
  /** Parameters of the autopilot that motors and ranges rest on, and gains, as far as the log has them. */
  parameters: Parameter[];
}

/** What kind of vehicle flew. */
export type VehicleKind = string;

/** When levels are raised and lowered. */
export interface VerdictSettings {
  /** When to warn. */
  warn: LevelSettings;
  /** When it fails. */
  fail: LevelSettings;
  /** A level is lowered when nothing has held it for this long, in seconds: to the level that is held then. */
  clear_after_s: number;
  /** In the first seconds in the air only FAIL is raised; WARN does not count as reached. */
  quiet_after_take_off_s: number;
  /** A WARN that is raised in the last seconds before touch-down is taken back, unless FAIL is being reached at touch-down. */
  quiet_before_landing_s: number;
  /** While their mean effective command is below this, the motors idle: before take-off and after landing the vehicle is on the ground, also where the land detector lags. Motors that begin to idle within 2 s after a risk that reaches WARN do not rest. Motors that idle for 3 s while the autopilot reports that the vehicle is in the air are a fall, with a risk of 100 %. */
  idle_below: number;
  /** What is told beside the risk. */
  notices: NoticeSettings;
}

/** A verdict in one word. */
export type VerdictWord = 'GOOD' | 'WARN' | 'FAIL' | 'NA';
