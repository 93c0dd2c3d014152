/* Replays a flight CSV of a quadrotor, and writes the time and the risk.
 *
 *   flagred convert flight.BIN -o flight.csv
 *   flagred export --c --output profile.h
 *   cargo build -p flagred-c --no-default-features --profile onboard
 *   cc -DPROFILE='"profile.h"' -I bindings/c/include -I . bindings/c/examples/replay.c target/onboard/libflagred.a -o replay
 *   ./replay < flight.csv */
#include <math.h>
#include <stdio.h>

#include PROFILE

static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(4)];

int main(void) {
    /* The full range: MOT_SPIN_MIN 0, MOT_SPIN_MAX 1. */
    const flagred_limits limits[4] = {{1000, 2000}, {1000, 2000}, {1000, 2000}, {1000, 2000}};
    /* Roll, pitch and yaw of motors in an X: FRAME_CLASS 1, FRAME_TYPE 1. */
    const flagred_factors geometry[4] = {{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}, {-1, -1, -1}};
    flagred_monitor *monitor;
    if (flagred_start(&flagred_plan_flagred, 4, limits, memory, sizeof memory, &monitor) != FLAGRED_OK ||
        flagred_set_geometry(monitor, geometry, 4) != FLAGRED_OK) {
        return 1;
    }
    char line[1024];
    puts("t_s,risk");
    while (fgets(line, sizeof line, stdin)) {
        double commands[4];
        flagred_sample sample = {.commands = commands, .motors = 4};
        if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%d", &sample.t_s, &commands[0], &commands[1], &commands[2], &commands[3],
                   &sample.in_air) != 6) {
            continue; /* a comment or the header */
        }
        flagred_update said;
        if (flagred_push(monitor, &sample, &said) != FLAGRED_OK) {
            return 1;
        }
        if (isnan(said.risk_pct)) {
            printf("%.6f,\n", said.t_s); /* unknown */
        } else {
            printf("%.6f,%.6f\n", said.t_s, said.risk_pct);
        }
    }
    return 0;
}
