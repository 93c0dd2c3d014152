/* Damages each word of a plan in turn. A monitor refuses the plan, or assesses samples without a panic: the library
 * stops at a panic, and the alarm ends the program. Arguments: the size of an item of each array of the table. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include PROFILE

static _Alignas(16) unsigned char memory[FLAGRED_MEMORY(1) + (1 << 20)];
static flagred_plan plan;
static long tried, accepted;
/* The samples of each monitor. */
static int samples = 1;

static void try_plan(void) {
    flagred_monitor *monitor;
    tried++;
    if (flagred_start(&plan, 1, NULL, memory, sizeof memory, &monitor) != FLAGRED_OK) {
        return;
    }
    accepted++;
    double inputs[16];
    flagred_update result;
    for (int i = 0; i < 9; i++) {
        for (size_t k = 0; k < 16; k++) {
            inputs[k] = plan.inputs[k < plan.inputs_count ? k : 0].low + (double)((i + k) % 9) * 0.125;
        }
        flagred_evaluate(monitor, inputs, plan.sources_count, &result);
    }
    double command = 0.5;
    flagred_sample sample = {.t_s = 1.0, .commands = &command, .motors = 1, .in_air = 1};
    for (int i = 0; i < samples; i++) {
        flagred_push(monitor, &sample, &result);
        sample.t_s += 0.03 * (i % 3);
        command = 0.25 * (i % 5);
    }
}

static void damage(unsigned char *word) {
    uint32_t kept, values[5] = {0, 1, 7, UINT32_MAX, 0};
    memcpy(&kept, word, sizeof kept);
    values[4] = kept + 1;
    for (int i = 0; i < 5; i++) {
        memcpy(word, &values[i], sizeof kept);
        try_plan();
    }
    memcpy(word, &kept, sizeof kept);
}

/* An array of a plan. */
typedef struct { void *items; size_t count; } array;

/* Shortens an array of the plan, then damages each word of its items. */
static void damage_array(unsigned char *field, size_t size) {
    array found;
    memcpy(&found, field, sizeof found);
    size_t items = found.count, bytes = items * size;
    unsigned char *copy = malloc(bytes + 1);
    if (bytes > 0) {
        memcpy(copy, found.items, bytes);
        found.items = copy;
    }
    for (found.count = 0; found.count < items; found.count++) {
        memcpy(field, &found, sizeof found);
        try_plan();
    }
    memcpy(field, &found, sizeof found);
    for (size_t word = 0; word < bytes; word += 4) {
        damage(copy + word);
    }
}

int main(int count, char **sizes) {
    alarm(120);
    plan = PLAN;
    for (unsigned char *word = (unsigned char *)&plan.and_operator; word <= (unsigned char *)&plan.signals; word += 4) {
        damage(word);
    }
    unsigned char *field = (unsigned char *)&plan.inputs;
    for (int i = 1; i < count; i++, field += sizeof(array)) {
        damage_array(field, (size_t)atol(sizes[i]));
    }
    samples = 200;
    unsigned char *settings = (unsigned char *)&plan.settings;
    for (size_t word = 0; word < sizeof plan.settings; word += 4) {
        damage(settings + word);
    }
    damage_array((unsigned char *)&plan.order, sizeof *plan.order);
    damage_array((unsigned char *)&plan.channels, sizeof *plan.channels);
    damage_array((unsigned char *)&plan.sources, sizeof *plan.sources);
    printf("%ld of %ld\n", accepted, tried);
    return 0;
}
