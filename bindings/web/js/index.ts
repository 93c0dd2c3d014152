/** flagred for JavaScript: rule sets and flight logs. Call {@link start} once before anything else. */

import initialize, { type InitInput } from './wasm/flagred.js';

export { Panic } from './panic.js';
export * from './flight.js';
export * from './rules.js';
export { version } from './wasm/flagred.js';

/** Where the module comes from, if not from the file beside this one: its bytes, a response, or a module that is compiled. */
export type Source = InitInput | Promise<InitInput>;

/** Loads the WebAssembly module: in a browser by `fetch`, in Node from its file. Calls after the first do nothing. */
export async function start(source?: Source): Promise<void> {
  await initialize({ module_or_path: source ?? (await beside()) });
}

async function beside(): Promise<InitInput> {
  const url = new URL('./wasm/flagred_bg.wasm', import.meta.url);
  if (url.protocol !== 'file:') return url;
  // Only Node can read it so; its name is put together so that bundlers for browsers do not look for it.
  const files: typeof import('node:fs/promises') = await import(/* @vite-ignore */ ['node:fs', 'promises'].join('/'));
  return files.readFile(url);
}
