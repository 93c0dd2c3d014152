// Bugs of flagred: the page reports a panic in a worker and continues, and reports a worker that cannot start.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { opened, repository, tab } from './page.mjs';
import { panicking } from './panics.mjs';
import { flight, rules } from './rooms.mjs';

const { chromium, server } = await opened();

/** A room whose module panics in a function. */
async function defective(t, room, name) {
  const context = await chromium.newContext({ serviceWorkers: 'block' });
  t.after(() => context.close());
  const module = panicking(await readFile(`${repository}/target/web/page/${room}.wasm`), name);
  await context.route(`**/${room}.wasm`, (route) => route.fulfill({ body: module, contentType: 'application/wasm' }));
  const page = await context.newPage();
  await page.goto(`${server.address}#/${room}`);
  return page;
}

const told = (page) => page.getByText(/panicked at .*lib\.rs/).first().waitFor({ timeout: 20_000 });

test('the room for flights reports a panic and continues', { timeout: 120_000 }, async (t) => {
  const page = await defective(t, 'flight', 'flight_writeCsv');
  await flight(page);
  const ask = async (words) => {
    await page.locator('.menu summary').filter({ hasText: 'Download' }).click();
    await page.getByRole('button', { name: words }).click();
  };
  await ask('Flight CSV');
  await told(page);
  const [file] = await Promise.all([page.waitForEvent('download'), ask('JSON')]);
  assert.equal(JSON.parse(await readFile(await file.path(), 'utf8')).verdict, 'FAIL');
});

test('the room for rules reports a panic and continues', { timeout: 120_000 }, async (t) => {
  const page = await defective(t, 'rules', 'ruleset_termsSvg');
  await rules(page);
  await page.getByLabel('Download').selectOption({ label: 'Terms as SVG' });
  await told(page);
  const before = await page.locator('.why').textContent();
  await page.getByRole('slider').first().press('End');
  await page.waitForFunction((before) => document.querySelector('.why').textContent !== before, before);
});

test('a worker that cannot start is reported, and not restarted forever', { timeout: 60_000 }, async (t) => {
  const { page, context } = await tab(chromium, 'about:blank', { serviceWorkers: 'block' });
  t.after(() => context.close());
  let begun = 0;
  page.on('worker', () => begun++);
  await context.route('**/worker.js', (route) => route.fulfill({ body: 'this is not a script', contentType: 'text/javascript' }));
  await page.goto(server.address);
  await page.getByText('the worker did not start').waitFor();
  await page.waitForTimeout(1000);
  assert.ok(begun <= 3, `${begun} workers were started`);
});
