/* Evaluates an exported rule set and writes the outcomes bit for bit. PROFILE is the exported file, PLAN the name of the rule
 * set, MEMORY the size of its memory. Standard input contains doubles: the values of the inputs, point after point. Before that,
 * it tests that invalid arguments are refused. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include PROFILE

#define CHECK(holds)                                   \
    do {                                               \
        if (!(holds)) {                                \
            printf("line %d: %s\n", __LINE__, #holds); \
            return 1;                                  \
        }                                              \
    } while (0)

static _Alignas(16) unsigned char memory[MEMORY];

static void bits(double value) {
    uint64_t bits;
    if (value != value) {
        printf(" nan");
        return;
    }
    memcpy(&bits, &value, sizeof bits);
    printf(" %016llx", (unsigned long long)bits);
}

int main(int count, char **arguments) {
    size_t inputs = count > 2 ? (size_t)atol(arguments[1]) : 0, outputs = count > 2 ? (size_t)atol(arguments[2]) : 0;
    double *point = calloc(inputs + 1, sizeof *point);
    flagred_outcome *outcomes = calloc(outputs + 1, sizeof *outcomes);
    flagred_evaluator *rules = NULL;
    size_t needed = flagred_rules_memory_size(&PLAN);

    CHECK(needed > 0 && needed <= sizeof memory && flagred_rules_memory_size(NULL) == 0);
    CHECK(flagred_rules_start(NULL, memory, sizeof memory, &rules) == FLAGRED_NULL_POINTER && rules == NULL);
    CHECK(flagred_rules_start(&PLAN, NULL, sizeof memory, &rules) == FLAGRED_NULL_POINTER);
    CHECK(flagred_rules_start(&PLAN, memory, sizeof memory, NULL) == FLAGRED_NULL_POINTER);
    CHECK(flagred_rules_start(&PLAN, memory + 1, sizeof memory - 1, &rules) == FLAGRED_MEMORY_SIZE);
    CHECK(flagred_rules_start(&PLAN, memory, needed - 1, &rules) == FLAGRED_MEMORY_SIZE);
    flagred_rules damaged = PLAN;
    damaged.format++;
    CHECK(flagred_rules_start(&damaged, memory, sizeof memory, &rules) == FLAGRED_OTHER_FORMAT);
    CHECK(flagred_rules_memory_size(&damaged) == 0);
    damaged = PLAN;
    damaged.outputs_count = 0;
    CHECK(flagred_rules_start(&damaged, memory, sizeof memory, &rules) == FLAGRED_DAMAGED_PLAN && rules == NULL);
    CHECK(flagred_rules_start(&PLAN, memory, needed, &rules) == FLAGRED_OK && rules != NULL);
    CHECK(flagred_rules_evaluate(NULL, point, inputs, outcomes, outputs) == FLAGRED_NULL_POINTER);
    CHECK(flagred_rules_evaluate(rules, NULL, inputs, outcomes, outputs) == FLAGRED_NULL_POINTER);
    CHECK(flagred_rules_evaluate(rules, point, inputs, NULL, outputs) == FLAGRED_NULL_POINTER);
    CHECK(flagred_rules_evaluate(rules, point, inputs + 1, outcomes, outputs) == FLAGRED_WRONG_COUNT);
    CHECK(flagred_rules_evaluate(rules, point, inputs, outcomes, outputs + 1) == FLAGRED_WRONG_COUNT);

    while (fread(point, sizeof *point, inputs, stdin) == inputs) {
        CHECK(flagred_rules_evaluate(rules, point, inputs, outcomes, outputs) == FLAGRED_OK);
        for (size_t i = 0; i < outputs; i++) {
            const flagred_outcome *said = &outcomes[i];
            printf("%s%d", i > 0 ? ", " : "", (int)said->state);
            bits(said->value);
            bits(said->low);
            bits(said->high);
            bits(said->coverage);
            printf(" %d %d", (int)said->dominant_rule, (int)said->clamped);
        }
        printf("\n");
    }
    free(point);
    free(outcomes);
    return 0;
}
