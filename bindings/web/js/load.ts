import type { InitInput } from './wasm/rules.js';

/** The source of a module: its address, its bytes, a response, or a compiled module. */
export type Source = InitInput | Promise<InitInput>;

/**
 * Returns the source of the module at an address next to the caller. The caller writes the address as a literal, so
 * that a bundler copies only this module.
 */
export async function beside(url: URL): Promise<InitInput> {
  if (url.protocol !== 'file:') return url;
  // Only Node can read the file in this way. The name is concatenated so that bundlers for browsers do not resolve it.
  const files: typeof import('node:fs/promises') = await import(/* @vite-ignore */ ['node:fs', 'promises'].join('/'));
  return files.readFile(url);
}
