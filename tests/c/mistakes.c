/* Invalid arguments return a status and do not crash. Prints the line of the first failure. */
#include <stdio.h>
#include <string.h>

#include PROFILE

#define MOTORS 4
#define CHECK(holds)                                 \
    do {                                             \
        if (!(holds)) {                              \
            printf("line %d: %s\n", __LINE__, #holds); \
            return 1;                                \
        }                                            \
    } while (0)

static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(MOTORS)];

static int32_t start(const flagred_plan *plan, flagred_monitor **monitor) {
    return flagred_start(plan, MOTORS, NULL, memory, sizeof memory, monitor);
}

int main(void) {
    flagred_monitor *monitor = NULL;
    flagred_update said;
    flagred_finding ended[FLAGRED_ENDED];
    const flagred_plan *plan = &PLAN;
    double commands[MOTORS] = {0.5, 0.5, 0.5, 0.5};

    CHECK(flagred_version()[0] != '\0');
    for (int32_t status = -1; status < 9; status++) {
        CHECK(flagred_status_text(status)[0] != '\0');
    }
    CHECK(flagred_memory_size(NULL, MOTORS) == 0);
    CHECK(flagred_memory_size(plan, MOTORS) > 0 && flagred_memory_size(plan, MOTORS) <= sizeof memory);

    /* Starting. */
    CHECK(start(NULL, &monitor) == FLAGRED_NULL_POINTER && monitor == NULL);
    CHECK(start(plan, NULL) == FLAGRED_NULL_POINTER);
    CHECK(flagred_start(plan, MOTORS, NULL, NULL, sizeof memory, &monitor) == FLAGRED_NULL_POINTER);
    CHECK(flagred_start(plan, 0, NULL, memory, sizeof memory, &monitor) == FLAGRED_NO_MOTORS);
    CHECK(flagred_start(plan, MOTORS, NULL, memory + 1, sizeof memory - 1, &monitor) == FLAGRED_MEMORY_SIZE);
    CHECK(flagred_start(plan, (size_t)-1 / 2, NULL, memory, sizeof memory, &monitor) == FLAGRED_MEMORY_SIZE);
    for (size_t size = 0; size < sizeof memory - 4096; size += 977) {
        CHECK(flagred_start(plan, MOTORS, NULL, memory, size, &monitor) == FLAGRED_MEMORY_SIZE && monitor == NULL);
    }
    size_t needed = flagred_memory_size(plan, MOTORS);
    CHECK(flagred_start(plan, MOTORS, NULL, memory, needed - 1, &monitor) == FLAGRED_MEMORY_SIZE);
    CHECK(flagred_start(plan, MOTORS, NULL, memory, needed, &monitor) == FLAGRED_OK);
    for (int shift = 20; shift < (int)sizeof(size_t) * 8; shift++) {
        size_t motors = ((size_t)1 << shift) + 3;
        needed = flagred_memory_size(plan, motors);
        CHECK(needed == 0 || needed > motors);
        CHECK(flagred_start(plan, motors, NULL, memory, sizeof memory, &monitor) == FLAGRED_MEMORY_SIZE);
    }
    flagred_limits limits[MOTORS] = {{1000, 2000}, {1000, 2000}, {2000, 1000}, {1000, 2000}};
    CHECK(flagred_start(plan, MOTORS, limits, memory, sizeof memory, &monitor) == FLAGRED_BAD_LIMITS);
    limits[2].low = -1e308;
    limits[2].high = 1e308;
    CHECK(flagred_start(plan, MOTORS, limits, memory, sizeof memory, &monitor) == FLAGRED_BAD_LIMITS);
    limits[2].low = NAN;
    CHECK(flagred_start(plan, MOTORS, limits, memory, sizeof memory, &monitor) == FLAGRED_BAD_LIMITS);

    /* Plans of another version, and damaged ones. */
    flagred_plan damaged = *plan;
    damaged.rules.format = 0;
    CHECK(start(&damaged, &monitor) == FLAGRED_OTHER_FORMAT && flagred_memory_size(&damaged, MOTORS) == 0);
    damaged = *plan;
    damaged.rules.and_operator = 99;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.rules.conjunctions = 99;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.output = 99;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.rules.lines_count = damaged.rules.actions_count = 1;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.rules.inputs = NULL;
    CHECK(start(&damaged, &monitor) == FLAGRED_NULL_POINTER);
    damaged = *plan;
    damaged.channels_count = 0;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.rules.degrees = 1;
    damaged.rules.starts_count = 0;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.order_count = 0;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    damaged = *plan;
    damaged.rules.strengths = 0;
    CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);

    flagred_channel channels[16];
    CHECK(plan->channels_count > 0 && plan->channels_count <= 16);
    for (int mistake = 0; mistake < 11; mistake++) {
        memcpy(channels, plan->channels, plan->channels_count * sizeof *channels);
        damaged = *plan;
        damaged.channels = channels;
        switch (mistake) {
        case 0: channels[0].observed = 6; channels[0].indices[0] = 4; break; /* the efforts are 0 to 3 */
        case 1: channels[0].observed = 10; break;
        case 2: channels[0].observed = 4; channels[0].indices[0] = plan->signals; break;
        case 3: channels[0].in_bins = !channels[0].in_bins; break;
        case 4: channels[0].window_s = 0; break;
        case 5: channels[0].window_s = NAN; break;
        case 6: channels[0].window_s = INFINITY; break;
        case 7: channels[0].observed = 8; channels[0].indices[1] = plan->signals; break;
        case 8: channels[0].exponential = 1; break; /* a statistic without weights, or with bins */
        case 9: channels[0].threshold = 3; break;
        case 10: damaged.settings.risk_window_s = -1; break;
        }
        CHECK(start(&damaged, &monitor) == FLAGRED_DAMAGED_PLAN);
    }

    /* The geometry. */
    flagred_factors geometry[MOTORS] = {{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}, {-1, -1, -1}};
    CHECK(start(plan, &monitor) == FLAGRED_OK);
    CHECK(flagred_set_geometry(NULL, geometry, MOTORS) == FLAGRED_NULL_POINTER);
    CHECK(flagred_set_geometry(monitor, NULL, MOTORS) == FLAGRED_NULL_POINTER);
    CHECK(flagred_set_geometry(monitor, geometry, MOTORS) == FLAGRED_OK);
    CHECK(flagred_set_geometry(monitor, geometry, MOTORS - 1) == FLAGRED_BAD_GEOMETRY);
    CHECK(flagred_set_geometry(monitor, NULL, 0) == FLAGRED_BAD_GEOMETRY);
    geometry[1].yaw = NAN;
    CHECK(flagred_set_geometry(monitor, geometry, MOTORS) == FLAGRED_BAD_GEOMETRY);
    for (int motor = 0; motor < MOTORS; motor++) {
        geometry[motor].roll = geometry[motor].pitch = geometry[motor].yaw = motor;
    }
    CHECK(flagred_set_geometry(monitor, geometry, MOTORS) == FLAGRED_BAD_GEOMETRY);

    /* Samples. */
    CHECK(start(plan, &monitor) == FLAGRED_OK && monitor != NULL);
    flagred_sample sample = {.t_s = 0, .commands = commands, .motors = MOTORS, .in_air = 1};
    CHECK(flagred_push(NULL, &sample, &said) == FLAGRED_NULL_POINTER);
    CHECK(flagred_push(monitor, NULL, &said) == FLAGRED_NULL_POINTER);
    CHECK(flagred_push(monitor, &sample, NULL) == FLAGRED_NULL_POINTER);
    sample.commands = NULL;
    CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_NULL_POINTER);
    sample.commands = commands;
    CHECK(flagred_finish(monitor, NULL) == FLAGRED_NULL_POINTER && flagred_finish(NULL, ended) == FLAGRED_NULL_POINTER);
    CHECK(flagred_open_finding(NULL, ended) == FLAGRED_NULL_POINTER);
    CHECK(flagred_evaluate(monitor, NULL, 4, &said) == FLAGRED_NULL_POINTER);
    CHECK(flagred_evaluate(monitor, commands, 0, &said) == FLAGRED_OK && isnan(said.risk_pct));

    double more[MOTORS + 1] = {0};
    sample.commands = more;
    sample.motors = MOTORS + 1;
    CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_WRONG_COUNT);
    sample.commands = commands;
    sample.motors = MOTORS;

    /* Unknown values never give a risk: NAN, 65535 and infinities in every field, too few and too many motors. */
    const double odd[] = {NAN, 65535.0, INFINITY, -INFINITY, -1.0, 1e300};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        CHECK(start(plan, &monitor) == FLAGRED_OK);
        for (int step = 0; step < 500; step++) {
            for (int motor = 0; motor < MOTORS; motor++) {
                commands[motor] = odd[i];
            }
            sample.t_s = step * 0.02;
            sample.motors = step % 3 == 0 ? 0 : MOTORS;
            CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_OK);
            CHECK(isnan(said.risk_pct) && isnan(said.elevated_risk_pct) && said.unknown != FLAGRED_KNOWN);
            CHECK(said.level == FLAGRED_LEVEL_NONE && said.change == FLAGRED_LEVEL_NONE);
        }
        sample.t_s = odd[i];
        CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_OK && isnan(said.risk_pct));
        sample.motors = MOTORS;
    }

    /* One unknown motor, or fewer commands than motors, make the risk unknown, and the level after two seconds. */
    const double one_odd[] = {NAN, 1500.0};
    for (int i = 0; i < 3; i++) {
        CHECK(start(plan, &monitor) == FLAGRED_OK);
        for (int step = 0; step < 1000; step++) {
            for (int motor = 0; motor < MOTORS; motor++) {
                commands[motor] = 0.5;
            }
            int is_odd = step >= 500;
            commands[2] = is_odd && i < 2 ? one_odd[i] : 0.5;
            sample.t_s = step * 0.02;
            sample.motors = is_odd && i == 2 ? 2 : MOTORS;
            CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_OK);
            if (is_odd) {
                CHECK(isnan(said.risk_pct) && said.unknown_motor == 2);
                CHECK(said.unknown == (i == 1 ? FLAGRED_COMMAND_OUTSIDE : FLAGRED_NO_COMMAND));
            } else {
                CHECK(said.unknown_motor == -1);
            }
        }
        CHECK(said.level == FLAGRED_LEVEL_NONE);
        /* Small excesses from rounding are clamped. */
        commands[2] = 1.0000001;
        sample.motors = MOTORS;
        for (int step = 1000; step < 1500; step++) {
            sample.t_s = step * 0.02;
            CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_OK);
        }
        CHECK(said.unknown == FLAGRED_KNOWN && said.unknown_motor == -1);
    }

    /* Limits of an empty range. */
    flagred_limits narrow[MOTORS];
    for (int motor = 0; motor < MOTORS; motor++) {
        narrow[motor].low = 0.0;
        narrow[motor].high = 5e-324;
    }
    CHECK(flagred_start(plan, MOTORS, narrow, memory, sizeof memory, &monitor) == FLAGRED_BAD_LIMITS);
    return 0;
}
