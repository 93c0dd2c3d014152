import type { InitInput } from './wasm/rules.js';

/** The source of a module: its address, its bytes, a response, or a compiled module. */
export type Source = InitInput | Promise<InitInput>;

/**
 * The module beside the caller, which writes its address as a literal: then a bundler copies this module and no other.
 */
export async function beside(url: URL): Promise<InitInput> {
  if (url.protocol !== 'file:') return url;
  // Only Node can read it in this way. The name is concatenated so that bundlers for browsers do not resolve it.
  const files: typeof import('node:fs/promises') = await import(/* @vite-ignore */ ['node:fs', 'promises'].join('/'));
  return files.readFile(url);
}
