// The page around the rooms: it starts under its policy, from a server and as one file, and tells defects.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { browser, serve, studio, tab } from './page.mjs';

let chromium, server;
before(async () => {
  chromium = await browser();
  server = await serve();
});
after(async () => {
  await chromium.close();
  await server.close();
});

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
