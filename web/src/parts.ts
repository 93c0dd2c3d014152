/** The sources of the worker and the module: files next to the page, or the page itself if it is a single file. */

const embedded = (id: string) => document.getElementById(id)?.textContent ?? undefined;

/** Whether the page is a single self-contained file. */
export const isOneFile = embedded('worker.js') !== undefined;

/** Creates a worker. */
export function worker(): Worker {
  const script = embedded('worker.js');
  if (script === undefined) return new Worker('worker.js', { type: 'module' });
  const url = URL.createObjectURL(new Blob([bytes(script)], { type: 'text/javascript' }));
  return new Worker(url);
}

/** The compiled module of a room. */
export async function module(room: 'data' | 'flight' | 'rules'): Promise<WebAssembly.Module> {
  const name = `${room}.wasm`;
  const packed = embedded(name);
  if (packed === undefined) return WebAssembly.compileStreaming(fetch(name));
  const unpacked = new Blob([bytes(packed)]).stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(unpacked).arrayBuffer());
}

function bytes(base64: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
}
