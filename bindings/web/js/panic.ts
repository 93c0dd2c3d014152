import { panicMessage } from './wasm/flagred.js';

/** A defect of flagred. What ran is lost, and the module must be loaded again: in a new worker or a new process. */
export class Panic extends Error {
  override name = 'Panic';
}

/** Runs a call into the module, and throws a {@link Panic} with its words where it traps. */
export function guarded<T>(call: () => T): T {
  try {
    return call();
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) throw new Panic(panicMessage() || error.message);
    throw error;
  }
}
