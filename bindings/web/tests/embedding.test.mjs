// Runs the examples of the package's README in Chromium: a worker that assesses a log, and a bundle.

import assert from 'node:assert/strict';
import { cp, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { build } from '../../../web/node_modules/esbuild/lib/main.js';
import { browser, serve, tab } from '../../../web/tests/page.mjs';
import { install, repository } from './installed.mjs';

const { folder } = await install();
const document = await readFile(join(repository, 'bindings/web/README.md'), 'utf8');
for (const [, code, name] of document.matchAll(/^```js\n(\/\/ (\w+\.js).*?)^```$/gms)) await writeFile(join(folder, name), code);
await cp(join(folder, 'node_modules/flagred'), join(folder, 'flagred'), { recursive: true });
await cp(join(repository, 'rules/tipper.yaml'), join(folder, 'tipper.yaml'));

let chromium, server;
before(async () => {
  chromium = await browser();
  server = await serve(folder);
});
after(async () => {
  await chromium.close();
  await server.close();
});

/** Opens a page with a script; its log messages are collected in `said`. */
async function opened(t, script) {
  await writeFile(
    join(folder, 'index.html'),
    `<!doctype html><title>page</title><link rel="icon" href="data:,"><input type="file">
     <script>const said = []; console.log = (words) => said.push(words);</script><script type="module" src="${script}"></script>`,
  );
  const { page, context, complaints } = await tab(chromium, server.address);
  t.after(() => context.close());
  const says = (words) => page.waitForFunction((words) => said.some((one) => String(one).includes(words)), words, { timeout: 30_000 });
  return { page, complaints, says };
}

test('a worker assesses a log, and reports a file that it cannot read', async (t) => {
  const { page, complaints, says } = await opened(t, 'page.js');
  await page.locator('input').setInputFiles(join(repository, 'examples/flights/steady.BIN'));
  await says('GOOD');
  await page.locator('input').setInputFiles({ name: 'notes.txt', mimeType: '', buffer: Buffer.from('no log') });
  await says('`notes.txt`');
  assert.deepEqual(complaints, []);
});

test('a bundle finds its module', async (t) => {
  const loader = { '.wasm': 'file' };
  const { metafile } = await build({ absWorkingDir: folder, entryPoints: { out: 'bundled.js' }, bundle: true, format: 'esm', loader, outdir: folder, metafile: true });
  // A page that uses only rule sets does not contain the flight module.
  assert.deepEqual(Object.keys(metafile.inputs).filter((name) => name.includes('flight')), []);
  const { complaints, says } = await opened(t, 'out.js');
  await says('22.98');
  assert.deepEqual(complaints, []);
});
