/* Assesses flights with an exported profile and writes the results bit for bit. PROFILE is the exported file, PLAN the name
 * of its plan. Standard input contains doubles: 0 and a sample (t_s, in_air, motors, signals), 1 and a point (inputs), 2 at the end
 * of a flight, or 3 before one and the factors of each motor. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include PROFILE

static void bits(double value) {
    uint64_t bits;
    if (value != value) {
        printf("nan");
        return;
    }
    memcpy(&bits, &value, sizeof bits);
    printf("%016llx", (unsigned long long)bits);
}

static void moment(const flagred_update *said) {
    bits(said->risk_pct);
    printf(" ");
    bits(said->coverage);
    printf(" ");
    bits(said->filled_from);
    printf(" %ld %d", (long)said->dominant_rule, (int)said->clamped);
}

static void findings(const flagred_finding ended[FLAGRED_ENDED]) {
    for (int i = 0; i < FLAGRED_ENDED; i++) {
        const flagred_finding *f = &ended[i];
        if (f->level == FLAGRED_LEVEL_NONE) {
            continue;
        }
        printf(" [%d ", (int)f->level);
        bits(f->from_s);
        printf(" ");
        bits(f->raised_s);
        printf(" ");
        bits(f->failed_s);
        printf(" ");
        bits(f->to_s);
        printf(" %d ", (int)f->measure);
        bits(f->threshold_pct);
        printf(" ");
        bits(f->peak_pct);
        printf(" %d %d ", (int)f->motor, (int)f->at_high_limit);
        bits(f->mean_margin);
        printf(" ");
        bits(f->least_margin);
        printf(" %d %d %d ", (int)f->cause, (int)f->cause_rule, (int)f->cause_input);
        bits(f->cause_value);
        printf("]");
    }
}

static int is(int32_t status) {
    if (status == FLAGRED_OK) {
        return 1;
    }
    fprintf(stderr, "%s\n", flagred_status_text(status));
    exit(1);
}

int main(int count, char **arguments) {
    static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(32)];
    size_t motors = count > 1 ? (size_t)atoi(arguments[1]) : 4;
    size_t inputs = PLAN.sources_count, signals = PLAN.signals;
    double values[64], kind;
    flagred_monitor *monitor;
    flagred_update said;
    flagred_finding ended[FLAGRED_ENDED];
    size_t size = flagred_memory_size(&PLAN, motors);
    if (size == 0 || size > sizeof memory) {
        fprintf(stderr, "%zu bytes are needed, and %zu are there\n", size, sizeof memory);
        return 1;
    }
    is(flagred_start(&PLAN, motors, NULL, memory, size, &monitor));
    while (fread(&kind, sizeof kind, 1, stdin) == 1) {
        if (kind == 0.0 && fread(values, sizeof *values, 2 + motors + signals, stdin) == 2 + motors + signals) {
            flagred_sample sample = {
                .t_s = values[0],
                .commands = values + 2,
                .motors = motors,
                .signals = values + 2 + motors,
                .signal_count = signals,
                .in_air = values[1] != 0.0,
            };
            is(flagred_push(monitor, &sample, &said));
            moment(&said);
            printf(" ");
            bits(said.elevated_risk_pct);
            printf(" %d %d %d %d", (int)said.level, (int)said.change, (int)said.unknown, (int)said.unknown_input);
            findings(said.ended);
        } else if (kind == 1.0 && fread(values, sizeof *values, inputs, stdin) == inputs) {
            is(flagred_evaluate(monitor, values, inputs, &said));
            moment(&said);
        } else if (kind == 3.0 && fread(values, sizeof *values, 3 * motors, stdin) == 3 * motors) {
            is(flagred_set_geometry(monitor, (const flagred_factors *)values, motors));
            continue;
        } else if (kind == 2.0) {
            is(flagred_finish(monitor, ended));
            findings(ended);
        } else {
            return 1;
        }
        printf("\n");
    }
    return 0;
}
