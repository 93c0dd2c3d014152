/**
 * Thrown for a bug of flagred. The running work is lost, and the module must be loaded again in a new worker or a new
 * process.
 */
export class Panic extends Error {
  override name = 'Panic';
}

/** The message of wasm-bindgen for an object without memory. */
const FREED = 'null pointer passed to rust';

/**
 * Wraps calls into a module: if one traps, a {@link Panic} with the message of the module is thrown, and if its object
 * was freed, an error that says so.
 */
export function guard(panicMessage: () => string): <T>(call: () => T) => T {
  return (call) => {
    try {
      return call();
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw new Panic(panicMessage() || error.message);
      if (error instanceof Error && error.message === FREED) throw freed();
      throw error;
    }
  };
}

function freed(): Error {
  return new Error('this object was released by `free()`\nhelp: create a new one');
}
