/** flagred for JavaScript: rule sets and flight logs. Call {@link start} once before anything else. */

import { startFlight } from './flight.js';
import { startRules } from './rules.js';

export type { Source } from './load.js';
export { Panic } from './panic.js';
export * from './flight.js';
export * from './rules.js';
export { version } from './wasm/rules.js';

/**
 * Loads the WebAssembly modules for flights and rule sets: in a browser by `fetch`, in Node from their files. To load
 * only one of them, call `startFlight` or `startRules` instead.
 */
export async function start(): Promise<void> {
  await Promise.all([startFlight(), startRules()]);
}
