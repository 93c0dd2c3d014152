/** A worker as an object with promises. */

import type { Answer, Arguments, Begin, Name, Reply } from './calls';

/** A bug of flagred ended the worker. A new one replaces it, without the state of the old one. */
export class Trapped extends Error {
  override name = 'Trapped';
}

/** The call was cancelled. */
export class Cancelled extends Error {
  override name = 'Cancelled';
}

export interface Engine {
  /** Runs a call in the worker; calls are answered in order. */
  call<K extends Name>(call: K, ...args: Arguments<K>): Promise<Answer<K>>;
  /** As `call`, but also reports the progress and the best result so far. */
  follow<K extends Name>(progress: (share: number, found?: unknown) => void, call: K, ...args: Arguments<K>): Promise<Answer<K>>;
  /** Cancels all calls, and starts with a new worker. */
  restart(): void;
  /** Called when a new worker replaced one that had a state. */
  onRestart?: () => void;
}

interface Waiting {
  resolve(answer: unknown): void;
  reject(error: Error): void;
  progress?: (share: number, found?: unknown) => void;
}

/** Creates an engine: `create` creates a worker, `first` is its first message. */
export function engine(create: () => Worker, first: Promise<Begin>): Engine {
  const waiting = new Map<number, Waiting>();
  let next = 0;
  let worker: Worker | undefined = begin();

  function begin(): Worker {
    const made = create();
    made.onmessage = ({ data }: MessageEvent<Reply>) => answer(data);
    // A new worker would probably fail too, so it is created only with the next call.
    made.onerror = (event) => drop(new Trapped(event.message || 'the worker did not start'));
    return made;
  }

  let begun: Worker | undefined;

  async function send(id: number, call: string, args: unknown[]): Promise<void> {
    const given = await first;
    // The call may have been cancelled meanwhile.
    if (!waiting.has(id)) return;
    worker ??= begin();
    if (begun !== worker) {
      begun = worker;
      worker.postMessage(given);
    }
    worker.postMessage({ id, call, args });
  }

  function answer(reply: Reply): void {
    const asked = waiting.get(reply.id);
    if (!asked) return;
    if ('progress' in reply) {
      asked.progress?.(reply.progress, reply.found);
      return;
    }
    waiting.delete(reply.id);
    if ('answer' in reply) asked.resolve(reply.answer);
    else if ('refused' in reply) asked.reject(new Error(reply.refused));
    else {
      asked.reject(new Trapped(reply.trapped));
      replace(new Trapped(reply.trapped));
    }
  }

  function drop(why: Error): void {
    worker?.terminate();
    worker = undefined;
    for (const asked of waiting.values()) asked.reject(why);
    waiting.clear();
  }

  function replace(why: Error): void {
    drop(why);
    worker = begin();
    made.onRestart?.();
  }

  function follow(progress: ((share: number, found?: unknown) => void) | undefined, call: string, args: unknown[]): Promise<unknown> {
    return new Promise((resolve, reject) => {
      const id = next++;
      waiting.set(id, progress ? { resolve, reject, progress } : { resolve, reject });
      send(id, call, args).catch((error: Error) => {
        waiting.delete(id);
        reject(error);
      });
    });
  }

  const made: Engine = {
    call: (call, ...args) => follow(undefined, call, args) as Promise<never>,
    follow: (progress, call, ...args) => follow(progress, call, args) as Promise<never>,
    restart: () => replace(new Cancelled('cancelled')),
  };
  return made;
}
