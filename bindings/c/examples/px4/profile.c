/* The profile of `flagred export --c --output flagred_profile.h`, and the memory of a monitor. */
#include "flagred_profile.h"
#include "profile.hpp"

static _Alignas(16) unsigned char memory[FLAGRED_PROFILE_MEMORY];
_Static_assert(FLAGRED_PROFILE_MEMORY >= FLAGRED_MEMORY(FLAGRED_PROFILE_MOTORS), "more memory is needed");

const flagred_plan *flagred_profile(void) {
    return &flagred_plan_flagred;
}

void *flagred_profile_memory(void) {
    return memory;
}

const flagred_words *flagred_profile_words(const flagred_finding *finding) {
    return finding->cause >= 0 ? &flagred_flagred_causes[finding->cause] : &flagred_flagred_notices[finding->measure];
}
