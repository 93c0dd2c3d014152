/**
 * An error that is caused by a bug in flagred. The running work is lost, and the module must be loaded again in a new
 * worker or a new process.
 */
export class Panic extends Error {
  override name = 'Panic';
}

/** The message of wasm-bindgen for an object that was freed. */
const FREED = 'null pointer passed to rust';

/**
 * Wraps calls into a module. If a call traps, the wrapper throws a {@link Panic} with the message of the module; if
 * the object of the call was freed, it throws an error with this reason.
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
