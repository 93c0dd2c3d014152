import type { InitInput } from './wasm/rules.js';

/** Where a module comes from: its address, its bytes, a response, or a module that is compiled. */
export type Source = InitInput | Promise<InitInput>;

/** The module of a name, from the file beside this one. */
export async function beside(name: 'data' | 'flight' | 'rules'): Promise<InitInput> {
  const url = new URL(`./wasm/${name}_bg.wasm`, import.meta.url);
  if (url.protocol !== 'file:') return url;
  // Only Node can read it so; its name is put together so that bundlers for browsers do not look for it.
  const files: typeof import('node:fs/promises') = await import(/* @vite-ignore */ ['node:fs', 'promises'].join('/'));
  return files.readFile(url);
}
