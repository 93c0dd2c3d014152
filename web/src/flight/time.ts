/** Stretches of time that are shown, and calls of which only the last counts. */

import type { Stretch } from 'flagred';

/** Less is not shown, in seconds. */
const SHORTEST_S = 0.5;

/** The part of a stretch that lies within another one; nothing where it is all of it. */
export function within(part: Stretch, whole: Stretch): Stretch | undefined {
  const length_s = Math.max(part.end_s - part.start_s, SHORTEST_S);
  if (!(length_s < (whole.end_s - whole.start_s) * 0.999)) return undefined;
  const start_s = Math.min(Math.max(part.start_s, whole.start_s), whole.end_s - length_s);
  return { start_s, end_s: start_s + length_s };
}

/** What lies between two places of a stretch, as shares of it. */
export function zoomed({ start_s, end_s }: Stretch, from: number, to: number, whole: Stretch): Stretch | undefined {
  const at = (share: number) => start_s + share * (end_s - start_s);
  return within({ start_s: at(from), end_s: at(to) }, whole);
}

/** Runs a task; of what is asked for while it runs only the last is done after. All that wait hear of that one. */
export function latest<A extends unknown[]>(task: (...args: A) => Promise<void>): (...args: A) => Promise<void> {
  let running: Promise<void> | undefined;
  let waiting: { args: A; end: Promise<void> } | undefined;
  const begin = (args: A): Promise<void> => {
    running = task(...args).finally(() => (running = undefined));
    return running;
  };
  return (...args) => {
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
}
