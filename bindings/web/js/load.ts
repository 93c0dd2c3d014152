import type { InitInput } from './wasm/rules.js';

/** The source of a module: its address, its bytes, a response, or a compiled module. */
export type Source = InitInput | Promise<InitInput>;

/** The module of a name, from the file beside this one. */
export async function beside(name: 'data' | 'flight' | 'rules'): Promise<InitInput> {
  const url = new URL(`./wasm/${name}_bg.wasm`, import.meta.url);
  if (url.protocol !== 'file:') return url;
  // Only Node can read it in this way. The name is concatenated so that bundlers for browsers do not resolve it.
  const files: typeof import('node:fs/promises') = await import(/* @vite-ignore */ ['node:fs', 'promises'].join('/'));
  return files.readFile(url);
}
