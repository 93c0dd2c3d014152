/* Damages a plan: each word and each length in turn, then several at random. A monitor refuses the plan, or assesses
 * samples in memory of the size that the library returns. A panic stops the library, and the alarm then ends the program.
 * Arguments: the number of randomly damaged plans, and a seed. */
#define _POSIX_C_SOURCE 200809L
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include PROFILE

#define CHECK(holds)                                                     \
    do {                                                                 \
        if (!(holds)) {                                                  \
            printf("line %d: %s, plan %ld\n", __LINE__, #holds, tried); \
            exit(1);                                                     \
        }                                                                \
    } while (0)

/* A plan that requires more memory counts as refused here. */
#define MAX_MEMORY ((size_t)1 << 20)
#define MAX_MOTORS 4
/* The time limit of one call, in seconds. */
#define LONGEST 60

static flagred_plan plan;
static long tried, accepted;

/* The arrays of a plan: the location of their pointers, and the size of an item. Copies of the items can be damaged. */
#define ARRAY(name) {offsetof(flagred_plan, name), sizeof *((flagred_plan *)0)->name}
#define RULES(name) ARRAY(rules.name)
static const struct { size_t field, size; } arrays[] = {
    RULES(inputs), RULES(cuts), RULES(starts), RULES(lines), RULES(curves), RULES(points), RULES(hedges), RULES(axes),
    RULES(dimensions), RULES(cells), RULES(nodes), RULES(edges), RULES(actions), RULES(programs), RULES(steps),
    RULES(blocks), RULES(outputs), RULES(pairs), RULES(layered_sets), RULES(bases), RULES(layers), RULES(moments),
    RULES(consequents), RULES(coefficients), RULES(sets), RULES(set_terms), RULES(sections), RULES(strands), RULES(flanks),
    RULES(knots), RULES(stages), RULES(indices),
    ARRAY(order), ARRAY(channels), ARRAY(sources), ARRAY(coordinates), ARRAY(first_coordinates), ARRAY(values),
    ARRAY(distances), ARRAY(propositions),
};
#define ARRAYS (sizeof arrays / sizeof *arrays)

/* The words of a plan that are not arrays. */
static const struct { size_t first, end; } words[] = {
    {offsetof(flagred_plan, rules.and_operator), offsetof(flagred_plan, rules.inputs)},
    {offsetof(flagred_plan, output), offsetof(flagred_plan, order)},
};

typedef struct { void *items; size_t count; } array;

static array get(size_t index) {
    array found;
    memcpy(&found, (unsigned char *)&plan + arrays[index].field, sizeof found);
    return found;
}

static void set(size_t index, array changed) {
    memcpy((unsigned char *)&plan + arrays[index].field, &changed, sizeof changed);
}

static void use(flagred_monitor *monitor, size_t motors, int samples) {
    double inputs[16], commands[MAX_MOTORS], signals[16];
    flagred_update said;
    flagred_finding ended[FLAGRED_ENDED];
    flagred_factors geometry[MAX_MOTORS] = {{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}, {-1, -1, -1}};
    for (int i = 0; i < 9; i++) {
        for (size_t k = 0; k < 16; k++) {
            inputs[k] = plan.rules.inputs[k < plan.rules.inputs_count ? k : 0].low + (double)((i + k) % 9) * 0.125;
        }
        CHECK(flagred_evaluate(monitor, inputs, plan.sources_count < 16 ? plan.sources_count : 16, &said) == FLAGRED_OK);
    }
    flagred_set_geometry(monitor, geometry, motors);
    flagred_sample sample = {.t_s = 1, .commands = commands, .motors = motors, .signals = signals, .signal_count = 16};
    for (int i = 0; i < samples; i++) {
        for (size_t k = 0; k < 16; k++) {
            signals[k] = i % 40 == 39 ? NAN : i * 0.5 + (double)k;
            commands[k % MAX_MOTORS] = 0.25 * (double)((i + k) % 5);
        }
        sample.in_air = i % 200 > 2;
        CHECK(flagred_push(monitor, &sample, &said) == FLAGRED_OK);
        CHECK(flagred_open_finding(monitor, ended) == FLAGRED_OK);
        sample.t_s += 0.03 * (i % 3) + (i == 150 ? 1e6 : 0);
    }
    CHECK(flagred_finish(monitor, ended) == FLAGRED_OK);
}

static void try_plan(size_t motors, int samples) {
    static _Alignas(16) unsigned char most[MAX_MEMORY];
    flagred_monitor *monitor;
    void *memory;
    tried++;
    alarm(LONGEST);
    size_t size = flagred_memory_size(&plan, motors);
    if (size == 0 || size > MAX_MEMORY) {
        CHECK(flagred_start(&plan, motors, NULL, most, sizeof most, &monitor) != FLAGRED_OK && monitor == NULL);
        return;
    }
    /* Exactly this size, so that a sanitizer finds writes beyond it. */
    if (posix_memalign(&memory, 16, size) != 0) {
        exit(2);
    }
    CHECK(flagred_start(&plan, motors, NULL, memory, size - 1, &monitor) != FLAGRED_OK && monitor == NULL);
    if (flagred_start(&plan, motors, NULL, memory, size, &monitor) == FLAGRED_OK) {
        accepted++;
        use(monitor, motors, samples);
    }
    free(memory);
}

static uint64_t state;

/* xorshift64* (Vigna 2016). */
static uint32_t below(size_t limit) {
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 0x2545f4914f6cdd1d >> 32) % limit);
}

/* The new value of a word: out of bounds, adjacent to the old one, or the upper half of a NaN or infinite double. */
#define VALUES 9
static uint32_t value(uint32_t kept, int index) {
    const uint32_t values[VALUES] = {0, 1, 7, UINT32_MAX, kept + 1, kept - 1, kept ^ 0x80000000, 0x7ff80000, 0x7ff00000};
    return values[index];
}

static void damage(unsigned char *word, int samples) {
    uint32_t kept;
    memcpy(&kept, word, sizeof kept);
    for (int i = 0; i < VALUES; i++) {
        uint32_t damaged = value(kept, i);
        memcpy(word, &damaged, sizeof damaged);
        try_plan(1, samples);
    }
    memcpy(word, &kept, sizeof kept);
}

/* Damages each word that is not an array, each length, and each word of each item. */
static void damage_in_turn(void) {
    for (int i = 0; i < 2; i++) {
        for (size_t word = words[i].first; word < words[i].end; word += sizeof(uint32_t)) {
            damage((unsigned char *)&plan + word, 200);
        }
    }
    for (size_t i = 0; i < ARRAYS; i++) {
        array found = get(i);
        size_t items = found.count, bytes = items * arrays[i].size;
        for (found.count = 0; found.count < items; found.count++) {
            set(i, found);
            try_plan(1, 3);
        }
        set(i, found);
        /* All knots are processed alike: a few of many are enough. */
        size_t step = sizeof(uint32_t) * (1 + bytes / 40000);
        for (size_t word = 0; word < bytes; word += step) {
            damage((unsigned char *)found.items + word, 3);
        }
    }
}

/* Damages up to six words and lengths at once. */
static void damage_at_random(void) {
    struct { unsigned char *word; uint32_t kept; } changed[6];
    flagred_plan kept = plan;
    int count = 0;
    for (uint32_t left = 1 + below(6); left > 0; left--) {
        size_t i = below(ARRAYS + 6);
        size_t k = i % 2;
        array found = i < ARRAYS ? get(i) : (array){(unsigned char *)&plan + words[k].first, 1};
        size_t bytes = i < ARRAYS ? found.count * arrays[i].size : words[k].end - words[k].first;
        if (bytes < sizeof(uint32_t)) {
            continue;
        }
        if (i < ARRAYS && below(8) == 0) {
            found.count = below(found.count);
            set(i, found);
            continue;
        }
        unsigned char *word = (unsigned char *)found.items + below(bytes / sizeof(uint32_t)) * sizeof(uint32_t);
        memcpy(&changed[count].kept, word, sizeof(uint32_t));
        changed[count].word = word;
        uint32_t damaged = below(3) == 0 ? below(UINT32_MAX) : value(changed[count].kept, (int)below(VALUES));
        memcpy(word, &damaged, sizeof damaged);
        count++;
    }
    try_plan(1 + below(MAX_MOTORS), 300);
    while (count-- > 0) {
        memcpy(changed[count].word, &changed[count].kept, sizeof(uint32_t));
    }
    plan = kept;
}

int main(int count, char **arguments) {
    long plans = count > 1 ? atol(arguments[1]) : 0;
    state = count > 2 ? strtoull(arguments[2], NULL, 10) | 1 : 1;
    plan = PLAN;
    for (size_t i = 0; i < ARRAYS; i++) {
        array found = get(i);
        void *copy = malloc(found.count * arrays[i].size + 1);
        if (found.count > 0) {
            memcpy(copy, found.items, found.count * arrays[i].size);
            found.items = copy;
            set(i, found);
        }
    }
    try_plan(MAX_MOTORS, 300);
    CHECK(accepted == 1);
    damage_in_turn();
    while (plans-- > 0) {
        damage_at_random();
    }
    printf("%ld of %ld\n", accepted, tried);
    return 0;
}
