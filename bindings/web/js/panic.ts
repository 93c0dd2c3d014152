/**
 * Thrown for a bug of flagred. The running work is lost, and the module must be loaded again in a new worker or a new
 * process.
 */
export class Panic extends Error {
  override name = 'Panic';
}

/** Wraps calls into a module: if one traps, a {@link Panic} with the message of the module is thrown. */
export function guard(panicMessage: () => string): <T>(call: () => T) => T {
  return (call) => {
    try {
      return call();
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw new Panic(panicMessage() || error.message);
      throw error;
    }
  };
}
