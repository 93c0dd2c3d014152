// Without a network: the page after its first load, and the one file from the disk. It computes, and complains of nothing.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { browser, serve, studio, tab } from './page.mjs';
import * as rooms from './rooms.mjs';

let chromium;
before(async () => (chromium = await browser()));
after(() => chromium.close());

/** Does something in each room. */
async function work(page) {
  for (const [room, fill] of Object.entries(rooms)) {
    await page.getByRole('navigation').getByRole('link', { name: room }).click();
    await page.locator(`.room.${room}:not([hidden])`).waitFor();
    await fill(page);
  }
}

test('what was loaded once works without a network', { timeout: 120_000 }, async (t) => {
  const server = await serve();
  const { page, context, complaints } = await tab(chromium, server.address);
  t.after(() => context.close());
  await page.evaluate(() => navigator.serviceWorker.ready);
  await server.close();
  await context.setOffline(true);
  await page.reload();
  await work(page);
  assert.deepEqual(complaints, []);
});

test('the one file works from the disk and asks nobody for anything', { timeout: 120_000 }, async (t) => {
  const context = await chromium.newContext();
  t.after(() => context.close());
  await context.setOffline(true);
  const page = await context.newPage();
  const [asked, complaints] = [[], []];
  page.on('request', (request) => asked.push(new URL(request.url()).protocol));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('console', (message) => complaints.push(`${message.type()}: ${message.text()}`));
  await page.goto(pathToFileURL(studio).href);
  await work(page);
  assert.deepEqual(complaints, []);
  assert.deepEqual([...new Set(asked)].filter((protocol) => !['file:', 'blob:', 'data:'].includes(protocol)), []);
});

test('a policy that is broken would be seen', async (t) => {
  const { page, context, complaints } = await tab(chromium, pathToFileURL(studio).href);
  t.after(() => context.close());
  await page.getByRole('heading', { level: 1 }).first().waitFor();
  await page.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'globalThis.ran = true';
    document.body.append(script);
  });
  assert.equal(await page.evaluate(() => globalThis.ran), undefined);
  assert.equal(complaints.length, 1);
  assert.match(complaints[0], /Content Security Policy/);
});
