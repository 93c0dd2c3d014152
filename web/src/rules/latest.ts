/** Requests that come faster than their answers: one runs, and of those that wait only the latest runs next. */

export interface Latest<A extends unknown[]> {
  (...args: A): void;
  /** Resolves when nothing runs and nothing waits. */
  settled(): Promise<void>;
}

export function latest<A extends unknown[]>(run: (...args: A) => Promise<void>): Latest<A> {
  let next: A | undefined;
  let running: Promise<void> | undefined;
  async function all(): Promise<void> {
    while (next) {
      const args = next;
      next = undefined;
      await run(...args);
    }
    running = undefined;
  }
  const ask = (...args: A): void => {
    next = args;
    running ??= all();
  };
  return Object.assign(ask, { settled: () => running ?? Promise.resolve() });
}
