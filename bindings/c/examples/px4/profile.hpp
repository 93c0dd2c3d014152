/* The profile, compiled as C because PX4's C++ has no designated initialisers. */
#pragma once

#include <stddef.h>

#include "flagred.h"

/* The maximum number of motors, and enough memory for that many. */
#define FLAGRED_PROFILE_MOTORS 12
#define FLAGRED_PROFILE_MEMORY 140000

#ifdef __cplusplus
extern "C" {
#endif

const flagred_plan *flagred_profile(void);
void *flagred_profile_memory(void);
const flagred_words *flagred_profile_words(const flagred_finding *finding);

#ifdef __cplusplus
}
#endif
