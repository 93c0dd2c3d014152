// Written by `UPDATE_DOCUMENTS=1 cargo test --workspace --test bindings` from the types in Rust.

/** An input with an assumed value: `ProfileInput::if_missing`. */
export interface AssumedInput {
  /** The name of the input. */
  input: string;
  /** The assumed value. */
  value: number;
  /** The signals that the input is computed from; at least one was missing. */
  signals: string[];
}

/** The cause of the risk when a level was reached: `verdict::Cause` by name. */
export interface Cause {
  /** The input that distinguishes the rule. Of the true propositions in the rule's antecedent, the one that the fewest rules share is about this input. */
  input: string;
  /** The value of that input. */
  value: number;
  /** The term, with its hedges. */
  term: string;
  /** The index of the rule in the model; serialised as its number, from 1. */
  rule: number;
}

/** The nearest change of the result if one input changes and the others do not. */
export type Change = {
  /** The input that changes. */
  input: string;
  /** The value of the input at which the change takes effect. */
  at: number;
  /** The value `at` minus the current value of the input. */
  by: number;
  effect: 'term';
  /** The term. */
  term: string | null;
} | {
  /** The input that changes. */
  input: string;
  /** The value of the input at which the change takes effect. */
  at: number;
  /** The value `at` minus the current value of the input. */
  by: number;
  effect: 'rule';
  /** The name of the output. */
  output: string;
  /** The index of the rule in the model, null if no rule fires; serialised as the rule number, which counts from 1. */
  rule: number | null;
  /** The value of the output at the changed input. */
  value: number | null;
};

/** The degree of membership of a value in a term. */
export interface Degree {
  /** The name of the term. */
  term: string;
  /** The degree, in [0, 1]; for an interval type-2 term, the upper degree. */
  degree: number;
  /** The lower degree of an interval type-2 term; absent for any other term. */
  lower?: number | null;
}

/** An input with the degrees of its terms. */
export interface ExplainedInput {
  /** The name of the input. */
  name: string;
  /** The value before clamping. */
  given: number;
  /** The value that was used: clamped to the range of the input. */
  value: number;
  /** The degree of each term. */
  terms: Degree[];
}

/** An output with the rules that contribute to it. */
export interface ExplainedOutput {
  /** The name of the output. */
  name: string;
  /** The value; null if no rule fires and the output has no default. */
  value: number | null;
  /** The lower end of the interval whose middle is the value, if interval type-2 terms determine it; otherwise absent. */
  low?: number | null;
  /** The upper end of the interval whose middle is the value, if interval type-2 terms determine it; otherwise absent. */
  high?: number | null;
  /** Whether no rule fires and the value is the default of the output. */
  is_default: boolean;
  /** Whether the output keeps its previous value where no rule fires. An explanation covers a single point, which has no previous value. */
  keeps_previous: boolean;
  /** The outputs whose values this output reads. If one of them has no value, no rule of this output fires, and it has no value either. */
  reads: string[];
  /** The largest firing strength of a rule of this output. */
  coverage: number;
  /** The rules that contribute to the output, by decreasing share. */
  rules: Share[];
  /** The degree of the value in each term; empty for Takagi-Sugeno outputs. */
  terms: Degree[];
  /** The aggregated set; with interval type-2 terms, the upper aggregated set. It is a list of `(value, degree)` at evenly spaced values over the range, or at the singletons. Empty for Takagi-Sugeno and Tsukamoto outputs. */
  set: [number, number][];
}

/** An explanation of the outputs at a point: `flagred explain --json`. */
export interface Explanation {
  schema: 'flagred.explain/1';
  /** The name of the rule set. */
  model: string;
  /** The inputs, with the degree of each of their terms. */
  inputs: ExplainedInput[];
  /** The rules that fired, by decreasing firing strength. */
  rules: FiredRule[];
  /** The outputs. */
  outputs: ExplainedOutput[];
  /** The rules that do not fire. */
  silent?: SilentRule[] | null;
  /** The smallest changes of single inputs that change the result while the other inputs stay the same. */
  changes?: Change[] | null;
}

/** A rule that fired. */
export interface FiredRule {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  /** The degree of the rule's condition. */
  degree: number;
  /** The degree of the condition times the weight of the rule, adjusted by the activation method. Hedges of its consequents are applied in `Share::strength`. If the condition reads an interval type-2 term, this is the upper bound, and so is `degree`. */
  strength: number;
  /** The lower bound of the strength, if the condition reads an interval type-2 term; otherwise absent. */
  lower?: number | null;
}

/** The assessment of a flight: `flagred assess --json`. `docs/json.md` describes it. */
export interface FlightDocument {
  schema: 'flagred.assess/1';
  /** The log that was read. */
  log: Log;
  vehicle: Vehicle;
  /** The amount of data that was read, and the damage that was found. */
  read: Report;
  profile: Profile;
  /** The level of the most severe finding; `NA` where there is no verdict. */
  verdict: VerdictWord;
  /** Only with `NA`: why there is no verdict. */
  reason?: string;
  /** Only with `NA`: how to get a verdict for the next flight. */
  help?: string | null;
  /** The findings, the most severe first, those of equal severity in order of time; at most 1,000. */
  findings: FlightFinding[];
  /** The number of findings that were left out. */
  findings_left_out: number;
  summary: Summary;
  /** The inputs whose values were assumed because their signals are missing from the log. */
  assumed_inputs: AssumedInput[];
  /** The risks of the profile that were unknown for some time in the air. */
  unknown_risks: UnknownRisk[];
  /** The risk over time. The npm package can leave it out; `flagred assess` never does. */
  steps?: Step[];
  /** The distance between the steps in seconds, if it is larger than requested because at most 250,000 steps are kept. */
  widened_step_s: number | null;
}

/** A finding with its texts, and the output of the motor that it names. */
export interface FlightFinding {
  /** The worst level that was reached. */
  severity: Level;
  /** The time at which a level was first reached, in seconds. */
  from_s: number;
  /** The time at which a level was first raised, in seconds: when it had been reached for the `after_s` of the level. */
  raised_s: number;
  /** The time at which the level was raised to FAIL, in seconds; null if it was not. */
  failed_s: number | null;
  /** The time at which the level was last reached, in seconds. The level is held for some time after that. */
  to_s: number;
  /** The measure that reached the level first. */
  measure: Measure;
  /** The threshold of the level in %. */
  threshold_pct: number;
  /** The worst value of the measure in that period, in %. */
  value_pct: number;
  /** The motor that is the cause. For a risk caused by motors near a limit, the motor with the least margin while the level was being raised. For an imbalance, the motor that is out of balance. */
  motor: MotorFinding | null;
  /** The cause of the risk; null if no rule raised it, as for a notice or an interpolated risk. */
  cause: Cause | null;
  /** The lower end in %. */
  risk_low?: number;
  /** The upper end in %. */
  risk_high?: number;
  /** The output that is the risk, if it is one of `Profile::other_risks`. */
  risk_output?: string;
  /** The name of the motor's output in the log. */
  output: string | null;
  /** The kind of finding: a stable identifier for use by programs, such as `fighting_gusts`. */
  code: string;
  /** What happened, and what it means, for pilots. */
  text: string;
  /** What to do. */
  advice: string;
}

/** How many of the moments were followed by an attitude error over 5 degrees within 5 s. */
export interface Followed {
  /** The number of moments, one every 0.5 s. */
  moments: number;
  /** The number of these moments that were followed by an attitude error over 5 degrees within 5 s. */
  followed: number;
}

/** The format of a flight log. */
export type Format = string;

/** Amounts of data that were left out because a limit was reached. No real flight reaches a limit; damaged and malicious logs may. */
export interface LeftOutCounts {
  /** Texts after the first 10,000. */
  texts: number;
  /** Changes of the flight mode after the first 10,000. */
  modes: number;
  /** Values of parameters after the first 16,384 names, and those with names longer than 64 bytes. */
  parameters: number;
  /** Changes of the armed state and of the in-air state after the first 10,000 of each, if they are derived from the commands. The time after them does not count as in the air. */
  changes: number;
  /** Messages after the flight has reached a limit: 67,108,864 numbers, 10,000 changes of the armed or in-air state, or 1,000 boots. The flight ends there. */
  messages: number;
}

/** How risky a moment, or a flight, is. */
export type Level = 'GOOD' | 'INFO' | 'WARN' | 'FAIL';

/** The conditions under which a level is raised and held. */
export interface LevelSettings {
  /** The threshold that raises the level. */
  raise: Threshold;
  /** How long the threshold must be reached without a break, in seconds. */
  after_s: number;
  /** The threshold that holds the level once it is raised; lower than `raise`. */
  until: Threshold;
}

/** A limit that must be exceeded for some time. */
export interface Limit {
  /** The limit, on the effective range. */
  value: number;
  /** How long the limit must be exceeded, in seconds. */
  after_s: number;
}

export interface Log {
  /** The path of the log, as given. */
  path: string;
  /** The format of the log, such as `ArduPilot DataFlash`. */
  format: Format;
}

/** The quantity that a threshold applies to. */
export type Measure = 'risk' | 'elevated_risk' | 'command_noise' | 'reserve' | 'imbalance' | 'pair_imbalance' | 'weak_motor' | 'idle_in_air';

/** The state of a flight at a given time. */
export interface Moment {
  /** The requested time, in seconds. */
  t_s: number;
  /** The flight mode. */
  mode: string | null;
  /** The latest step before the requested time, if it is recent. */
  step: Step | null;
  /** If the risk is interpolated, the distance to the nearest inputs that rules cover, in shares of their ranges. */
  filled_from: number | null;
  /** Whether an input was outside its range. */
  clamped: boolean;
  /** The inputs with the degrees of their terms; empty if an input that the risk depends on is unknown. */
  inputs: ExplainedInput[];
  /** The units of the inputs, by name; inputs without a unit are omitted. */
  units: Record<string, string>;
  /** The rules that fire, strongest first. */
  rules: FiredRule[];
}

/** One motor, and the output that drives it. */
export interface Motor {
  /** The motor number of the autopilot, from 1. */
  number: number;
  /** The name of the output in the log, such as `C3` or `actuator_motors.control[2]`. */
  output: string;
  /** The source of the assignment, such as `SERVO3_FUNCTION = 35`. */
  source: string;
}

/** The motor that caused a finding. */
export interface MotorFinding {
  /** The number of the motor, from 1: as numbered by the autopilot, or otherwise its position in the samples. */
  number: number;
  /** The number of a second motor that may be the cause instead, if the commands do not show which of the two. */
  or_number: number | null;
  /** The nearest limit. For an imbalance, `Lower` if the command of the motor is below its share earlier in the flight or below the opposite motor, `Upper` if it is above. */
  side: Side;
  /** The mean margin of the motor. */
  margin_mean: number;
  /** The smallest margin of the motor. */
  margin_min: number;
}

/** The limits of the findings that are not about the risk; null disables a finding. */
export interface NoticeSettings {
  /** The threshold on the noise of the commands: vibration, or gains that are too high. */
  noise: Limit | null;
  /** The threshold on the reserve, which is the distance of the mean command from the upper limit. */
  reserve: Limit | null;
  /** The threshold on the shift of a motor's command, relative to the mean command of all motors, since earlier in the flight. It is doubled for the difference of opposite motors, and halved if a single motor is higher than before. */
  imbalance: Limit | null;
}

/** A parameter of the autopilot. */
export interface Parameter {
  /** The name of the parameter. */
  name: string;
  /** The first value, because failure tests and automatic tuning change parameters in flight. */
  value: number;
  /** The message that contains the parameter, such as `PARM` or `PARAM_VALUE`. */
  source: string;
}

/** The highest value of a quantity, and when it was reached. */
export interface Peak {
  /** The time at which the value was first reached, in seconds. */
  t_s: number;
  /** The value in %. */
  value_pct: number;
}

/** The profile that the assessment used. */
export interface Profile {
  /** The name of the profile. */
  name: string;
  /** The name or the file of the rule set. */
  rules: string;
  /** The conditions under which levels are raised and cleared. */
  verdict: VerdictSettings;
  /** How often large attitude errors followed a risk; empty if it was not measured. */
  reliability: Reliability[];
}

/** A range of commands, and its source. */
export interface Range {
  /** The lower end. */
  low: number;
  /** The upper end, above `low`. */
  high: number;
  /** The unit of both ends: `us`, `1` (a fraction) or `raw` (counts of a bus). */
  unit: string;
  /** The source of the range, such as `MOT_PWM_MIN/MAX`. */
  source: string;
}

/** How often a large attitude error followed moments with a risk in a band. */
export interface Reliability {
  /** The lower end of the band in %, inclusive. */
  from_pct: number;
  /** The upper end of the band in %, exclusive except for 100. */
  to_pct: number;
  /** The frequency on flights of real vehicles. */
  real: Followed | null;
  /** The frequency on flights of simulated vehicles. */
  simulated: Followed | null;
}

/** A report on reading a log. */
export interface Report {
  /** The number of bytes of the log that were read. */
  bytes: number;
  /** The number of complete messages, kept or not (rows in a CSV file). */
  messages: number;
  /** The number of bytes that are not part of any message. */
  skipped_bytes: number;
  /** The number of messages that were recognised and rejected as damaged. */
  bad_messages: number;
  /** Whether the log ends inside a message, or the compressed stream ends early. */
  truncated: boolean;
  /** The first reason why bytes were skipped or a message was rejected. */
  reason: string | null;
  /** The amounts of data that were left out because a limit was reached. */
  left_out: LeftOutCounts;
}

/** The contribution of a rule to an output. */
export interface Share {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The term that the rule concludes. */
  term: string;
  /** The firing strength; if the condition reads an interval type-2 term, its upper bound. */
  strength: number;
  /** The lower bound of the firing strength, if the condition reads an interval type-2 term; otherwise absent. */
  lower?: number | null;
  /** The rule's share of the result, in [0, 1]. With maximum as aggregation, it is the fraction of the aggregated set's area in which this rule is the highest; with sums, the rule's fraction of the area of all sets; in a Takagi-Sugeno or Tsukamoto output, its fraction of the weights. With interval type-2 terms, the share is computed from upper bounds. */
  share: number;
  /** The number that the consequent yields at these inputs; only for Takagi-Sugeno and Tsukamoto outputs and for singletons. */
  value: number | null;
}

/** The nearer limit of a motor. */
export type Side = 'lower' | 'upper';

/** A rule that does not fire at a point, with the reason. */
export type SilentRule = {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  reason: 'condition';
  /** The text of the part. */
  condition: string;
} | {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  reason: 'no_value';
  /** The name of that output. */
  output: string;
} | {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  reason: 'disabled';
} | {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  reason: 'weight';
} | {
  /** The index of the rule in the model; serialised as the rule number, which counts from 1. */
  rule: number;
  /** The text of the rule. */
  text: string;
  reason: 'activation';
  /** The degree of the condition times the weight. */
  strength: number;
};

/** The state of a flight at one time, for serialisation; created by `Step::by_name`. */
export interface Step {
  /** The time on the clock of the log, in seconds. */
  t_s: number;
  /** The risk in %. */
  risk: number | null;
  /** The elevated risk in %. */
  elevated_risk: number | null;
  /** The coverage: the largest firing strength of a rule, in [0, 1]. */
  coverage: number | null;
  /** Whether the risk is interpolated, because no rule applies. */
  filled: boolean | null;
  /** The number of the rule with the largest firing strength, from 1; null if none fires. */
  dominant_rule: number | null;
  /** The lower end of the interval of the risk in %, from the uncertainty of its inputs; null if it is unknown. */
  risk_low: number | null;
  /** The upper end of that interval in %. */
  risk_high: number | null;
  /** The mean margin over all motors and the window of the profile. */
  margin: number | null;
  /** The standard deviation of the commands over all motors and the window of the profile. */
  spread: number | null;
  /** Whether the step counts for findings and summary. */
  judged: boolean;
  /** The inputs of the rule set by their names. */
  inputs: Record<string, number | null>;
  /** The other risks of the profile in %, by the names of their outputs. Left out if there are no other risks. */
  other_risks?: Record<string, number | null>;
}

/** Summary figures of a flight. The risks are those of judged time (`Update::judged`). */
export interface Summary {
  /** The time in the air, summed over all flights of a log, in seconds. */
  in_air_s: number;
  /** The time in the air with a known risk, in seconds. If there are several risks, all of them must be known. */
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

/** Thresholds on the risk and the elevated risk; reaching either is enough. */
export interface Threshold {
  /** The threshold on the risk, in %. */
  risk_pct: number | null;
  /** The threshold on the elevated risk, in %. */
  elevated_risk_pct: number | null;
}

/** A risk that was unknown for some time in the air. */
export interface UnknownRisk {
  /** The output of the rule set that is this risk. */
  output: string;
  /** The time in the air for which the risk was unknown, in seconds. */
  unknown_s: number;
  /** Why it was unknown; of several reasons, the one that applied longest. */
  reason: string;
  /** Advice on how to know it in the next flight, if there is any. */
  help: string | null;
}

export interface Vehicle {
  /** The kind of vehicle, such as `multirotor`. */
  kind: VehicleKind;
  /** The name of the frame or type, such as `QUAD/X`. */
  frame: string | null;
  /** The firmware with its version. */
  firmware: string | null;
  /** The motors in order of their number. */
  motors: Motor[];
  /** The range of the raw commands. */
  range: Range | null;
  /** The part of the range that is used in flight, as fractions of the whole range. */
  effective_range: Range;
  /** The reason why the whole range is used although the log contains limits. */
  effective_range_doubt: string | null;
  /** The assumptions about motors, commands and ranges that replace information missing from the log, as texts. */
  assumed: string[];
  /** The parameters of the autopilot that determine motors and ranges, and the gains, if the log contains them. */
  parameters: Parameter[];
}

/** The kind of vehicle. */
export type VehicleKind = string;

/** The conditions under which levels are raised and cleared. */
export interface VerdictSettings {
  /** The conditions for WARN. */
  warn: LevelSettings;
  /** The conditions for FAIL. */
  fail: LevelSettings;
  /** A level is cleared when no threshold has held it for this time, in seconds. It is replaced by the level that is still held. */
  clear_after_s: number;
  /** In this time after take-off, in seconds, only FAIL is raised; WARN does not count as reached. */
  quiet_after_take_off_s: number;
  /** A WARN that is raised in this time before touch-down, in seconds, is withdrawn, unless FAIL is being reached at touch-down. */
  quiet_before_landing_s: number;
  /** The motors idle while their mean effective command is below this. Before take-off and after landing the vehicle then counts as on the ground, even if the land detector lags. Motors that begin to idle within 2 s after a risk that reaches WARN do not count as a landing. Motors that idle for 3 s while the autopilot reports that the vehicle is in the air count as a fall, with a risk of 100 %. */
  idle_below: number;
  /** The limits of the findings that are not about the risk. */
  notices: NoticeSettings;
}

/** A verdict as one word. */
export type VerdictWord = 'GOOD' | 'WARN' | 'FAIL' | 'NA';
