/** A defect of flagred. What ran is lost, and the module must be loaded again: in a new worker or a new process. */
export class Panic extends Error {
  override name = 'Panic';
}

/** Runs calls into a module; one that traps throws a {@link Panic} with the words that the module left. */
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
