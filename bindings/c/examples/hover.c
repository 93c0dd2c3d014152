/* A quadrotor hovers calmly for half a minute, then fights gusts that saturate its motors.
 *
 *   flagred export --c --output profile.h
 *   cargo build -p flagred-c --no-default-features --profile onboard
 *   cc -DPROFILE='"profile.h"' -I bindings/c/include bindings/c/examples/hover.c target/onboard/libflagred.a -o hover */
#include <stdio.h>

#include PROFILE

/* The time between samples in seconds: 50 Hz. */
#define STEP_S 0.02

/* The memory of the monitor. */
static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(4)];

/* The commands in us: calm, or neighbouring motors alternately at their limits. */
static void commands_at(int step, double commands[4]) {
    int gust = step > 1500 && (step / 40) % 2 == 0;
    for (int motor = 0; motor < 4; motor++) {
        int up = (motor + step / 10) % 2;
        commands[motor] = gust ? (up ? 1950.0 : 1150.0) : 1500.0 + 2.0 * (step % 5);
    }
}

static const char *word(int32_t level) {
    static const char *const words[] = {"GOOD", "INFO", "WARN", "FAIL"};
    return words[level];
}

int main(void) {
    /* MOT_PWM_MIN 1000, MOT_PWM_MAX 2000, MOT_SPIN_MIN 0.15, MOT_SPIN_MAX 0.95 */
    const flagred_limits limits[4] = {{1150, 1950}, {1150, 1950}, {1150, 1950}, {1150, 1950}};
    /* Roll, pitch and yaw of motors in an X: front right, rear left, front left, rear right. */
    const flagred_factors geometry[4] = {{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}, {-1, -1, -1}};
    flagred_monitor *monitor;
    int32_t status = flagred_start(&flagred_plan_flagred, 4, limits, memory, sizeof memory, &monitor);
    if (status == FLAGRED_OK) {
        status = flagred_set_geometry(monitor, geometry, 4);
    }
    if (status != FLAGRED_OK) {
        printf("%s\n", flagred_status_text(status));
        return 1;
    }
    for (int step = 0; step < 2500; step++) {
        double commands[4];
        flagred_update said;
        commands_at(step, commands);
        flagred_sample sample = {.t_s = step * STEP_S, .commands = commands, .motors = 4, .in_air = 1};
        status = flagred_push(monitor, &sample, &said);
        if (status != FLAGRED_OK) {
            printf("%s\n", flagred_status_text(status));
            return 1;
        }
        if (said.change != FLAGRED_LEVEL_NONE) {
            printf("%5.2f s  %s  risk %.0f %%, elevated risk %.0f %%\n", said.t_s, word(said.change), said.risk_pct,
                   said.elevated_risk_pct);
        }
    }
    flagred_finding ended[FLAGRED_ENDED];
    flagred_finish(monitor, ended);
    for (int i = 0; i < FLAGRED_ENDED; i++) {
        if (ended[i].level == FLAGRED_LEVEL_NONE) {
            continue;
        }
        const flagred_words *words = ended[i].cause >= 0 ? &flagred_flagred_causes[ended[i].cause]
                                                         : &flagred_flagred_notices[ended[i].measure];
        printf("%s from %.2f s to %.2f s: %s", word(ended[i].level), ended[i].from_s, ended[i].to_s, words->code);
        if (ended[i].motor >= 0) {
            printf(", motor %d", (int)ended[i].motor + 1);
        }
        printf("\n");
    }
    return 0;
}
