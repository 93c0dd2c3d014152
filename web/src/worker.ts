/**
 * Runs flagred in a worker, so that the page stays responsive. The first message is the compiled module of a room, whose calls
 * are then loaded.
 */

import type { Begin, Reply, Request, Tell } from './calls';

declare const self: DedicatedWorkerGlobalScope;

/** Starts the module of a room, and returns the calls to it. */
const begin = {
  async data(module: WebAssembly.Module) {
    const [{ startData }, calls] = await Promise.all([import('flagred/data'), import('./rules/datacalls')]);
    await startData(module);
    return calls;
  },
  async flight(module: WebAssembly.Module) {
    const [{ startFlight }, calls] = await Promise.all([import('flagred/flight'), import('./flight/calls')]);
    await startFlight(module);
    return calls;
  },
  async rules(module: WebAssembly.Module) {
    const [{ startRules }, calls] = await Promise.all([import('flagred/rules'), import('./rules/calls')]);
    await startRules(module);
    return calls;
  },
};

let started: Promise<object> | undefined;

self.onmessage = async ({ data }: MessageEvent<Begin | Request>) => {
  if ('module' in data) {
    started = begin[data.room](data.module);
    return;
  }
  const { id, call, args } = data;
  const reply = (message: Reply, transfer: Transferable[] = []) => self.postMessage(message, transfer);
  try {
    const calls = new Map(Object.entries((await started) ?? {}));
    const run = calls.get(call) as ((tell: Tell, ...args: unknown[]) => unknown) | undefined;
    if (!run) throw new Error(`\`${call}\` is not a call`);
    const answer = await run((progress, found) => reply({ id, progress, found }), ...args);
    reply({ id, answer }, columns(answer));
  } catch (error) {
    const words = error instanceof Error ? error.message : String(error);
    reply(error instanceof WebAssembly.RuntimeError || (error instanceof Error && error.name === 'Panic') ? { id, trapped: words } : { id, refused: words });
  }
};

/** The arrays of an answer, which are transferred instead of copied. */
function columns(answer: unknown): Transferable[] {
  const values = typeof answer === 'object' && answer !== null ? [answer, ...Object.values(answer)] : [];
  const buffers = values.flatMap((value) => (ArrayBuffer.isView(value) ? [value.buffer as ArrayBuffer] : []));
  return [...new Set(buffers)];
}
