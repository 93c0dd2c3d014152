/** Rule sets. */

import { guarded } from './panic.js';
import * as wasm from './wasm/flagred.js';

/** The findings of a rule set, as JSON. */
export const findingsOf = (text: string): string => guarded(() => wasm.findingsOf(text));
