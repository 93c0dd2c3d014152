// Without a network, the page works without errors after its first load, and so does the single file from the disk.

import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { browser, page as built, serve, studio, tab } from './page.mjs';
import * as rooms from './rooms.mjs';

let chromium;
before(async () => (chromium = await browser()));
after(() => chromium.close());

/** Uses each room. */
async function work(page) {
  for (const [room, fill] of Object.entries(rooms)) {
    await page.getByRole('navigation').getByRole('link', { name: room }).click();
    await page.locator(`.room.${room}:not([hidden])`).waitFor();
    await fill(page);
  }
}

test('a page that was loaded once works without a network', { timeout: 120_000 }, async (t) => {
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

/**
 * Browsers cache files for as long as the server allows, but files of an old build must not become a part of the next
 * build.
 */
test('another build replaces the one that was loaded', { timeout: 120_000 }, async (t) => {
  const folder = await mkdtemp(join(tmpdir(), 'flagred-page-'));
  t.after(() => rm(folder, { recursive: true }));
  await cp(built, folder, { recursive: true });
  const server = await serve(folder, { 'Cache-Control': 'max-age=3600' });
  t.after(server.close);
  const { page, context } = await tab(chromium, server.address);
  t.after(() => context.close());
  await page.evaluate(() => navigator.serviceWorker.ready);
  const change = async (file, from, to) => {
    const text = await readFile(join(folder, file), 'utf8');
    assert.match(text, from);
    await writeFile(join(folder, file), text.replace(from, to));
  };
  await change('index.html', /<\/body>/, '<p id="build">2</p></body>');
  await change('main.css', /^/, '#build { color: rgb(1, 2, 3) }');
  await change('offline.js', /"[0-9a-f]{16}"/g, '"2"');
  const colour = () => page.evaluate(() => getComputedStyle(document.getElementById('build') ?? document.body).color);
  for (let tries = 0; (await colour()) !== 'rgb(1, 2, 3)'; tries++) {
    assert.ok(tries < 10, 'the old build stays');
    // The browser does this itself some time after a load.
    await page.evaluate(async () => (await navigator.serviceWorker.getRegistration()).update());
    await page.waitForTimeout(500);
    await page.reload();
  }
});

test('the single file works from the disk and makes no requests', { timeout: 120_000 }, async (t) => {
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

test('a violation of the policy would be noticed', async (t) => {
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
