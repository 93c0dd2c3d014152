/** Runs flagred in a worker, so that the page stays responsive. The first message is the compiled module of a room. */

import { Panic, startFlight, startRules } from 'flagred';
import { startData } from 'flagred/data';
import type { Begin, Reply, Request, Tell } from './calls';
import * as flight from './flight/calls';
import * as rules from './rules/calls';
import * as tables from './rules/datacalls';

declare const self: DedicatedWorkerGlobalScope;

const calls = new Map(
  Object.entries({ ...flight, ...rules, ...tables }).map(([name, call]) => [name, call as (tell: Tell, ...args: unknown[]) => unknown]),
);
let started: Promise<void> | undefined;

self.onmessage = async ({ data }: MessageEvent<Begin | Request>) => {
  if ('module' in data) {
    started = { data: startData, flight: startFlight, rules: startRules }[data.room](data.module);
    return;
  }
  const { id, call, args } = data;
  const reply = (message: Reply, transfer: Transferable[] = []) => self.postMessage(message, transfer);
  try {
    await started;
    const run = calls.get(call);
    if (!run) throw new Error(`\`${call}\` is not a call`);
    const answer = await run((progress, found) => reply({ id, progress, found }), ...args);
    reply({ id, answer }, columns(answer));
  } catch (error) {
    const words = error instanceof Error ? error.message : String(error);
    reply(error instanceof Panic || error instanceof WebAssembly.RuntimeError ? { id, trapped: words } : { id, refused: words });
  }
};

/** The arrays of an answer, which are transferred instead of copied. */
function columns(answer: unknown): Transferable[] {
  const values = typeof answer === 'object' && answer !== null ? [answer, ...Object.values(answer)] : [];
  const buffers = values.flatMap((value) => (ArrayBuffer.isView(value) ? [value.buffer as ArrayBuffer] : []));
  return [...new Set(buffers)];
}
