/** Runs one request at a time. Of the requests made meanwhile, only the latest is run. */

export interface Latest<A extends unknown[]> {
  /** Resolves when a run for this or a later request has ended. */
  (...args: A): Promise<void>;
  /** Resolves when nothing runs and nothing waits. */
  settled(): Promise<void>;
}

export function latest<A extends unknown[]>(task: (...args: A) => Promise<void>): Latest<A> {
  let running: Promise<void> | undefined;
  let waiting: { args: A; end: Promise<void> } | undefined;
  const begin = (args: A): Promise<void> => {
    running = task(...args).finally(() => (running = undefined));
    return running;
  };
  const ask = (...args: A): Promise<void> => {
    if (!running) return begin(args);
    if (waiting) {
      waiting.args = args;
      return waiting.end;
    }
    const end = running
      .catch(() => undefined)
      .then(() => {
        const { args } = waiting!;
        waiting = undefined;
        return begin(args);
      });
    waiting = { args, end };
    return end;
  };
  const settled = async (): Promise<void> => {
    for (let last; (last = waiting?.end ?? running); ) await last.catch(() => undefined);
  };
  return Object.assign(ask, { settled });
}
