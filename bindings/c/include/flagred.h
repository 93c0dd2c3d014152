/* FLAGRED on board: estimates a multirotor's risk of losing control from its motor commands.
 *
 * `flagred export --c` writes a profile and its rule set as constant data. A monitor assesses a flight with this data in
 * memory that the caller provides. It does not allocate, and the cost of a sample does not depend on the lengths of the
 * windows. The results are bit for bit those of the command `flagred` for the same samples.
 *
 *     #include "profile.h"                                     // flagred export --c flagred
 *     static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(4)];
 *     flagred_monitor *monitor;
 *     flagred_start(&flagred_plan_flagred, 4, limits, memory, sizeof memory, &monitor);
 *     flagred_push(monitor, &sample, &update);             // for every sample of the motors
 *
 * Functions do not block or lock, and write only to their arguments. Only one thread at a time may use a monitor.
 * An unknown value is NAN, with a reason.
 */
#ifndef FLAGRED_H
#define FLAGRED_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of the format of the data that `flagred export --c` writes. */
#define FLAGRED_FORMAT 11

/* ---- Assessing a flight ------------------------------------------------------------------------------------------- */

typedef enum flagred_status {
    FLAGRED_OK = 0,
    FLAGRED_NULL_POINTER = 1,   /* a required pointer is NULL */
    FLAGRED_OTHER_FORMAT = 2,   /* another version exported the plan: export it again */
    FLAGRED_DAMAGED_PLAN = 3,   /* an index in the plan is out of bounds, or a window has no length */
    FLAGRED_NO_MOTORS = 4,      /* the profile reads a motor that the vehicle does not have */
    FLAGRED_MEMORY_SIZE = 5,    /* less memory than flagred_memory_size returns, or not aligned to 16 bytes */
    FLAGRED_BAD_LIMITS = 6,     /* the lower limit of a motor is not below its upper limit */
    FLAGRED_BAD_GEOMETRY = 7,   /* the geometry does not separate roll, pitch, yaw and thrust */
    FLAGRED_WRONG_COUNT = 8     /* wrong number of inputs or outcomes, or too many commands */
} flagred_status;

typedef enum flagred_level {
    FLAGRED_LEVEL_NONE = -1,    /* on the ground, or unknown for a long time; as a change: no change */
    FLAGRED_GOOD = 0,
    FLAGRED_INFO = 1,           /* only of a finding: worth knowing but not dangerous */
    FLAGRED_WARN = 2,
    FLAGRED_FAIL = 3
} flagred_level;

/* The quantity that a threshold applies to. */
typedef enum flagred_measure {
    FLAGRED_RISK = 0,
    FLAGRED_ELEVATED_RISK = 1,
    FLAGRED_COMMAND_NOISE = 2,  /* the noise of the motor commands, in % of their range */
    FLAGRED_RESERVE = 3,        /* the reserve of the mean command to the upper limit, in % of the range */
    FLAGRED_IMBALANCE = 4,      /* the deviation of motors from their part of the thrust earlier in the flight, in % */
    FLAGRED_PAIR_IMBALANCE = 5, /* the difference between a motor and the opposite one, in % */
    FLAGRED_WEAK_MOTOR = 6,     /* how far one motor alone exceeds its part of the thrust earlier in the flight, in % */
    FLAGRED_IDLE_IN_AIR = 7     /* the risk of motors that idle in the air, which is 100 % */
} flagred_measure;

/* The reason why a risk is unknown. */
typedef enum flagred_unknown {
    FLAGRED_KNOWN = 0,
    FLAGRED_ON_GROUND = 1,
    FLAGRED_OUT_OF_ORDER = 2,   /* the timestamp is not after the previous one; the sample is ignored */
    FLAGRED_WARMING_UP = 3,     /* the window of an input is not full enough yet */
    FLAGRED_TOO_FEW_SAMPLES = 4,
    FLAGRED_NO_VALUE = 5,       /* the signal of an input is unknown */
    FLAGRED_NO_RULE = 6,        /* no rule covers the inputs, and nothing fills the gap */
    FLAGRED_NO_COMMAND = 7,     /* the command of a motor is unknown */
    FLAGRED_COMMAND_OUTSIDE = 8 /* a command is far outside 0 to 1 although there are no limits: it has another unit */
} flagred_unknown;

/* The commands for a motor's minimum and maximum thrust, in the unit of its commands. On an ArduPilot vehicle, in
 * us: MOT_PWM_MIN + MOT_SPIN_MIN * (MOT_PWM_MAX - MOT_PWM_MIN), and the same with MOT_SPIN_MAX. */
typedef struct flagred_limits {
    double low;
    double high;
} flagred_limits;

/* The factors of a motor in the mixer, scaled so that the largest factor of each axis is 1. On an axis that no motor
 * acts on, all factors are 0. */
typedef struct flagred_factors {
    double roll;                /* positive if more thrust rolls the vehicle to the right: a motor on the left */
    double pitch;               /* positive if it raises the nose: a motor in front */
    double yaw;                 /* positive if it turns the nose to the right: a counter-clockwise propeller */
} flagred_factors;

/* A sample of a flight. */
typedef struct flagred_sample {
    double t_s;                 /* seconds; must increase */
    const double *commands;     /* the command of each motor, in the unit of its limits; NAN if unknown */
    size_t motors;              /* the number of commands; if some are missing, they and the risk are unknown; more commands
                                   than motors of the monitor are refused with FLAGRED_WRONG_COUNT */
    const double *signals;      /* the signals of the profile, in its order; NAN if unknown; may be NULL */
    size_t signal_count;
    int32_t in_air;             /* the report of the land detector: 0 on the ground, 1 in the air; -1 unknown: motors that
                                   idle mean on the ground. If reported in the air, motors that idle for 3 s are a fall */
} flagred_sample;

/* The number of findings that can end at one time: of the risk, the noise, the reserve and the balance. */
#define FLAGRED_ENDED 4

/* A finding about the risk, or a notice. */
typedef struct flagred_finding {
    double from_s;              /* the time at which the threshold was first reached */
    double raised_s;            /* the time at which the level was raised */
    double failed_s;            /* the time at which it was raised to FLAGRED_FAIL; NAN if it was not */
    double to_s;                /* the time at which the threshold was last reached */
    double threshold_pct;
    double peak_pct;            /* the worst value of the measure: the smallest for the reserve, otherwise the largest */
    double mean_margin;         /* of the motor; NAN if no motor is known */
    double least_margin;
    double cause_value;         /* the value of the input that raised the risk, when the level was raised; NAN if unknown */
    int32_t level;              /* flagred_level; FLAGRED_LEVEL_NONE if there is no finding */
    int32_t measure;            /* flagred_measure: the quantity that reached the threshold */
    int32_t motor;              /* the index of the motor that is the cause: near a limit, or out of balance; otherwise -1 */
    int32_t or_motor;           /* a second motor that may be the cause, if the commands do not show which; otherwise -1 */
    int32_t at_high_limit;      /* 0: nearer to the lower limit; 1: to the upper limit. Out of balance: below, above */
    int32_t cause;              /* the cause of the risk, as an index of flagred_NAME_causes in the exported profile; -1 if no
                                   rule raised it: its words are then in flagred_NAME_notices, by measure */
    int32_t cause_rule;         /* the index of the rule; -1 */
    int32_t cause_input;        /* the index of the input of the profile; -1 */
} flagred_finding;

/* The texts of a finding for the pilot, in an exported profile. The program must replace the placeholders in braces:
 * {value} by cause_value, {percent} by 100 times cause_value, {peak} by peak_pct, {threshold} by threshold_pct,
 * {motor} by "motor 3" (motor + 1), {side} by "below" or "above" (at_high_limit). */
typedef struct flagred_words {
    const char *code;           /* for programs: small letters, digits and _ */
    const char *brief;          /* a few words, for messages limited to 50 characters */
    const char *text;           /* what happened, and what it means */
    const char *advice;         /* what to do */
} flagred_words;

/* The result of a monitor after a sample. */
typedef struct flagred_update {
    double t_s;
    double risk_pct;            /* NAN if unknown */
    double elevated_risk_pct;   /* NAN if unknown */
    double coverage;            /* the largest firing strength of a rule, 0 to 1; NAN if the risk is unknown */
    double filled_from;         /* the distance to the nearest covered point if the risk is interpolated; otherwise NAN */
    flagred_finding ended[FLAGRED_ENDED]; /* the findings that ended with this sample */
    int32_t dominant_rule;      /* the index of the rule with the largest firing strength; -1 where none fired */
    int32_t clamped;            /* 1 where an input was outside its range and was clamped to it */
    int32_t level;              /* flagred_level; if the risk is unknown, an ongoing alarm or FLAGRED_LEVEL_NONE, never
                                   FLAGRED_GOOD */
    int32_t change;             /* flagred_level: the new level if this sample changed it */
    int32_t unknown;            /* flagred_unknown */
    int32_t unknown_input;      /* the index of the unknown input of the profile; otherwise -1 */
    int32_t unknown_motor;      /* the index of the motor whose command is unknown; otherwise -1 */
} flagred_update;

typedef struct flagred_rules flagred_rules;
typedef struct flagred_plan flagred_plan;
typedef struct flagred_monitor flagred_monitor;

/* The version of this library, such as "0.1.0". */
const char *flagred_version(void);

/* The text of a status. */
const char *flagred_status_text(int32_t status);

/* The size of a monitor's memory in bytes; 0 for an invalid plan. FLAGRED_MEMORY of an exported profile is at least
 * as large on every processor. A program with several profiles uses the macro FLAGRED_PLAN_NAME_MEMORY of each
 * profile. */
size_t flagred_memory_size(const flagred_plan *plan, size_t motors);

/* Creates a monitor of a new flight in `memory`; there is nothing to free. `plan` and `memory` must outlive it.
 * `limits`, one for each motor, are copied, and commands are clamped to them. A command that is outside by more than
 * ten times the width of the range, such as 65535, is unknown. If `limits` is NULL, commands are from 0 to 1:
 * commands from -0.5 to 1.5 are clamped to this range, and others are unknown. While a motor is unknown, so is the
 * risk. A profile that reads no motors needs none: `motors` may then be 0, and the commands of samples may be NULL. */
int32_t flagred_start(const flagred_plan *plan, size_t motors, const flagred_limits *limits, void *memory, size_t size,
                      flagred_monitor **monitor);

/* Sets the factors of each motor, in the order of the commands, so that yaw commands are separated from the rest.
 * Call it before the first sample. Without it, yaw counts like any other motion. */
int32_t flagred_set_geometry(flagred_monitor *monitor, const flagred_factors *factors, size_t motors);

/* Processes the next sample and writes the update. */
int32_t flagred_push(flagred_monitor *monitor, const flagred_sample *sample, flagred_update *update);

/* Writes the open finding of the current level; its level is FLAGRED_LEVEL_NONE while the level is good. */
int32_t flagred_open_finding(const flagred_monitor *monitor, flagred_finding *finding);

/* Ends the flight and writes the open findings. The next sample begins a new flight. */
int32_t flagred_finish(flagred_monitor *monitor, flagred_finding ended[FLAGRED_ENDED]);

/* Computes the risk at given values of the profile's inputs, in the order of the profile. It does not depend on the
 * flight. Writes risk_pct, coverage, filled_from, dominant_rule and clamped. */
int32_t flagred_evaluate(flagred_monitor *monitor, const double *inputs, size_t count, flagred_update *update);

/* ---- Evaluating a rule set ----------------------------------------------------------------------------------------
 *
 * Evaluates any rule set without a profile or a flight. The outputs are bit for bit those of the command `flagred eval`.
 *
 *     #include "fan.h"                                         // flagred export --c fan.yaml
 *     static _Alignas(16) unsigned char memory[FLAGRED_FAN_MEMORY];
 *     flagred_evaluator *fan;
 *     flagred_rules_start(&flagred_rules_fan, memory, sizeof memory, &fan);
 *     flagred_rules_evaluate(fan, (double[]){27.5}, 1, &speed, 1);     // as often as wanted
 */

/* The kind of value of an outcome. */
typedef enum flagred_state {
    FLAGRED_DEFINED = 0,
    FLAGRED_DEFAULT = 1,        /* no rule fired; the value is the default value of the output */
    FLAGRED_NO_RULE_FIRED = 2,  /* there is no value */
    FLAGRED_NOT_FINITE = 3      /* an input is NAN or infinite; there is no value */
} flagred_state;

/* The outcome of an output. */
typedef struct flagred_outcome {
    double value;               /* NAN if there is none */
    double low, high;           /* the ends of the interval that type-2 terms give; without such terms the value */
    double coverage;            /* the largest firing strength of a rule, 0 to 1 */
    int32_t state;              /* flagred_state */
    int32_t dominant_rule;      /* the index of the rule with the largest firing strength; -1 where none fired */
    int32_t clamped;            /* 1 where an input was outside its range and was clamped to it */
} flagred_outcome;

typedef struct flagred_evaluator flagred_evaluator;

/* The size of an evaluator's memory in bytes; 0 for invalid rules. FLAGRED_NAME_MEMORY of an exported rule set is at least as
 * large on every processor. */
size_t flagred_rules_memory_size(const flagred_rules *rules);

/* Creates an evaluator in `memory`; there is nothing to free. `rules` and `memory` must outlive it. */
int32_t flagred_rules_start(const flagred_rules *rules, void *memory, size_t size, flagred_evaluator **evaluator);

/* Evaluates the rules: one value for each input gives one outcome for each output, in the order of the rule set. The
 * outcomes depend only on the inputs. */
int32_t flagred_rules_evaluate(flagred_evaluator *evaluator, const double *inputs, size_t input_count,
                               flagred_outcome *outcomes, size_t output_count);

/* ---- Exported data: written by `flagred export --c`, not by hand --------------------------------------------------- */

typedef struct flagred_input {
    double low, high;
    uint32_t first_literal, first_cut, end_cut, first_start, first_curve, end_curve;
} flagred_input;

typedef struct flagred_line {
    double foot, run, base, rise;
    uint32_t literal;
} flagred_line;

typedef struct flagred_curve {
    double parameters[4];
    double height;
    uint32_t kind, literal, first_point, end_point, first_hedge, end_hedge;
} flagred_curve;

typedef struct flagred_point {
    double x, degree;
} flagred_point;

/* A hedge: NOT, very, somewhat, extremely, seldom, any, counted from 0. */
typedef uint32_t flagred_hedge;

typedef struct flagred_axis {
    uint32_t input, first_cut, end_cut, first_line;
} flagred_axis;

typedef struct flagred_dimension {
    uint32_t input, stride, any;
} flagred_dimension;

typedef struct flagred_node {
    uint32_t first_edge, end_edge, first_action, end_action;
} flagred_node;

typedef struct flagred_edge {
    uint32_t literal, node;
} flagred_edge;

typedef struct flagred_action {
    double weight;
    uint32_t strength, output, rule, sums;
} flagred_action;

typedef struct flagred_program {
    double weight;
    uint32_t first_step, end_step, first_action, end_action, first_hedge, end_hedge;
} flagred_program;

typedef struct flagred_antecedent_step {
    uint32_t op, literal;
} flagred_antecedent_step;

typedef struct flagred_block {
    double strength;
    uint32_t method, rules, and_operator, or_operator, first_program, end_program;
} flagred_block;

typedef struct flagred_output {
    double low, high, default_value;
    uint32_t form, first, end, first_strength, end_strength, clamps, reduction, lower;
} flagred_output;

typedef struct flagred_pair {
    double area[2][2], moment[3][2], width[2], middle[2];
} flagred_pair;

typedef struct flagred_layered_set {
    uint32_t first_base, end_base, first_layer, end_layer;
} flagred_layered_set;

typedef struct flagred_base {
    uint32_t others, strength;
} flagred_base;

typedef struct flagred_layers {
    double low[4], high[4], area[2][4], moment[3][4];
    uint32_t bases[4], strength;
} flagred_layers;

typedef struct flagred_moment {
    double area, moment;
} flagred_moment;

typedef struct flagred_consequent {
    double constant;
    uint32_t first, end, first_code, end_code;
} flagred_consequent;

typedef struct flagred_coefficient {
    double coefficient;
    uint32_t input;
} flagred_coefficient;

typedef struct flagred_fuzzy_set {
    double unit;
    uint32_t defuzzifier, sum, first_section, end_section, first_term, end_term;
} flagred_fuzzy_set;

typedef struct flagred_set_term {
    double highest;
    uint32_t first_flank, end_flank;
} flagred_set_term;

typedef struct flagred_section {
    double from, to;
    uint32_t first_strand, end_strand;
} flagred_section;

typedef struct flagred_strand {
    double left, right, left_tail[2], right_tail[2];
    uint32_t strength, flank;
} flagred_strand;

typedef struct flagred_flank {
    double parameters[4], height, from, to, left, right, area, moment, beyond;
    uint32_t kind, first_knot, end_knot;
} flagred_flank;

typedef struct flagred_knot {
    double x, area, moment;
} flagred_knot;

typedef struct flagred_channel {
    double window_s, limit, unknown_below;
    uint32_t observed, indices[2], motors, threshold, in_bins, exponential;
} flagred_channel;

/* A proposition of a rule, and the input that it reads. */
typedef struct flagred_proposition {
    uint32_t rule, input, literal;
} flagred_proposition;

/* A stage: rules that are evaluated together. There are several stages if outputs read other outputs. `ends` are the
 * ends of the stage's part of each array. */
typedef struct flagred_stage {
    uint32_t conjunctions, actions_per_cell, first_action, sums;
    struct {
        uint32_t degrees, alive, partial, stack, strengths;
    } sizes;
    uint32_t reads, outputs, rules;
    struct {
        uint32_t inputs, cuts, starts, lines, curves, points, hedges, axes, dimensions, cells, nodes, edges,
            actions, programs, steps, blocks, outputs, pairs, layered_sets, bases, layers, moments,
            consequents, coefficients, sets, set_terms, sections, strands, flanks, knots;
    } ends;
} flagred_stage;

typedef struct flagred_source {
    double number, at_least;
    double if_missing; /* the value until its signals are known for the first time; NAN: none */
    uint32_t channel, statistic;
    uint32_t per; /* a source; UINT32_MAX: none */
} flagred_source;

typedef struct flagred_threshold {
    double risk_pct, elevated_risk_pct;   /* NAN: none */
} flagred_threshold;

typedef struct flagred_level_settings {
    flagred_threshold raise;
    double after_s;
    flagred_threshold until;
} flagred_level_settings;

typedef struct flagred_limit {
    double value, after_s;                /* value NAN: none */
} flagred_limit;

typedef struct flagred_settings {
    double warm_up_s, longest_gap_s, take_off_s;
    double risk_window_s, high_pct, low_pct, rise_pct_per_s, fall_pct_per_s;
    flagred_level_settings warn, fail;
    double clear_after_s, quiet_after_take_off_s, quiet_before_landing_s;
    double idle_below;
    flagred_limit noise, reserve, imbalance;
    uint32_t min_samples;
} flagred_settings;

/* An array and its length. */
#define FLAGRED_ARRAY(type, name) \
    const type *name;             \
    size_t name##_count

struct flagred_rules {
    uint32_t format;
    uint32_t and_operator, or_operator;
    uint32_t conjunctions, actions_per_cell, first_action, sums;
    uint32_t degrees, alive, partial, stack, strengths;
    double least_strength;
    FLAGRED_ARRAY(flagred_input, inputs);
    FLAGRED_ARRAY(double, cuts);
    FLAGRED_ARRAY(uint32_t, starts);
    FLAGRED_ARRAY(flagred_line, lines);
    FLAGRED_ARRAY(flagred_curve, curves);
    FLAGRED_ARRAY(flagred_point, points);
    FLAGRED_ARRAY(flagred_hedge, hedges);
    FLAGRED_ARRAY(flagred_axis, axes);
    FLAGRED_ARRAY(flagred_dimension, dimensions);
    FLAGRED_ARRAY(uint32_t, cells);
    FLAGRED_ARRAY(flagred_node, nodes);
    FLAGRED_ARRAY(flagred_edge, edges);
    FLAGRED_ARRAY(flagred_action, actions);
    FLAGRED_ARRAY(flagred_program, programs);
    FLAGRED_ARRAY(flagred_antecedent_step, steps);
    FLAGRED_ARRAY(flagred_block, blocks);
    FLAGRED_ARRAY(flagred_output, outputs);
    FLAGRED_ARRAY(flagred_pair, pairs);
    FLAGRED_ARRAY(flagred_layered_set, layered_sets);
    FLAGRED_ARRAY(flagred_base, bases);
    FLAGRED_ARRAY(flagred_layers, layers);
    FLAGRED_ARRAY(flagred_moment, moments);
    FLAGRED_ARRAY(flagred_consequent, consequents);
    FLAGRED_ARRAY(flagred_coefficient, coefficients);
    FLAGRED_ARRAY(flagred_fuzzy_set, sets);
    FLAGRED_ARRAY(flagred_set_term, set_terms);
    FLAGRED_ARRAY(flagred_section, sections);
    FLAGRED_ARRAY(flagred_strand, strands);
    FLAGRED_ARRAY(flagred_flank, flanks);
    FLAGRED_ARRAY(flagred_knot, knots);
    FLAGRED_ARRAY(flagred_stage, stages);
    FLAGRED_ARRAY(uint32_t, indices);           /* for each stage: the outputs that it reads, its outputs, its rules */
};

struct flagred_plan {
    flagred_rules rules;
    uint32_t output, signals;
    double coverage_below;
    flagred_settings settings;
    FLAGRED_ARRAY(uint32_t, order);             /* UINT32_MAX: an input that the risk does not depend on */
    FLAGRED_ARRAY(flagred_channel, channels);
    FLAGRED_ARRAY(flagred_source, sources);
    FLAGRED_ARRAY(double, coordinates);         /* coordinates of the knots that fill gaps, input by input; empty without filling */
    FLAGRED_ARRAY(uint32_t, first_coordinates); /* the index of the first coordinate of each input, then the end of the last */
    FLAGRED_ARRAY(double, values);
    FLAGRED_ARRAY(double, distances);
    FLAGRED_ARRAY(flagred_proposition, propositions);
};

#undef FLAGRED_ARRAY

#ifdef __cplusplus
}
#endif

#endif
