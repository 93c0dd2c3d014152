// The page around the rooms: it starts under its policy, from a server and as a single file, and reports bugs.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';
import { opened, studio, tab } from './page.mjs';

/** The maximum size of the first load of the page, gzipped. */
const MAX_BYTES = 1_000_000;

const { chromium, server } = await opened();

for (const [from, address] of [
  ['a server', () => server.address],
  ['one file', () => pathToFileURL(studio).href],
]) {
  test(`both rooms open from ${from}`, async () => {
    const { page, complaints, context } = await tab(chromium, address());
    await page.getByRole('heading', { level: 1 }).first().waitFor();
    assert.match(page.url(), /#\/flight/);
    await page.getByRole('link', { name: 'Rules' }).click();
    await page.locator('.room.rules:not([hidden])').waitFor();
    assert.match(page.url(), /#\/rules/);
    assert.deepEqual(complaints, []);
    await context.close();
  });
}

for (const room of ['flight', 'rules']) {
  test(`the first load of the ${room} room is small`, async (told) => {
    const context = await chromium.newContext({ serviceWorkers: 'block' });
    const page = await context.newPage();
    const sizes = [];
    page.on('response', (response) => sizes.push(response.body().then((body) => gzipSync(body, { level: 9 }).length)));
    await page.goto(`${server.address}#/${room}`, { waitUntil: 'networkidle' });
    const bytes = (await Promise.all(sizes)).reduce((sum, size) => sum + size, 0);
    const ready_ms = await page.evaluate(() => performance.getEntriesByName('interactive')[0].startTime);
    told.diagnostic(`${bytes} bytes gzipped, interactive after ${ready_ms.toFixed()} ms`);
    assert.ok(sizes.length > 4 && (bytes < MAX_BYTES || process.env.FLAGRED_QUICK), `${bytes} bytes gzipped in ${sizes.length} files`);
    await context.close();
  });
}

test('the policy of the page forbids inline code', async () => {
  const { page, context } = await tab(chromium, server.address);
  const policy = await page.locator('meta[http-equiv="Content-Security-Policy"]').getAttribute('content');
  assert.doesNotMatch(policy, /unsafe-inline|unsafe-eval(?<!wasm-unsafe-eval)/);
  const ran = await page.evaluate(async () => {
    document.body.insertAdjacentHTML('beforeend', '<img src="x:" onerror="window.ran = true"><p style="color: red">x</p>');
    await new Promise((resolve) => setTimeout(resolve, 100));
    return [window.ran, document.body.lastElementChild.style.color];
  });
  assert.deepEqual(ran, [undefined, '']);
  await context.close();
});
