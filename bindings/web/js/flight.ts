/** Flight logs. */

import { guarded } from './panic.js';
import * as wasm from './wasm/flagred.js';

/** The verdict of a log. */
export const verdictOf = (log: Uint8Array, profile = 'flagred'): string => guarded(() => wasm.verdictOf(log, profile));
