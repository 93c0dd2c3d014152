// Rows of data: the error is that of the command line, and rules and numbers are learned from the rows.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { opened, repository, tab } from './page.mjs';

const { chromium, server } = await opened();
const starter = await readFile(join(repository, 'crates/authoring/src/starter.yaml'), 'utf8');

/** Rows of a fan whose speed grows with temperature and humidity; one row has no value. */
function csv(rows) {
  const lines = ['temperature,humidity,fan'];
  for (let i = 0; i < rows; i++) {
    const [temperature, humidity] = [(i * 7.3) % 40, (i * 13.7) % 100];
    const fan = Math.min(100, Math.max(0, 3 * (temperature - 12) + 0.3 * (humidity - 50)));
    lines.push(`${temperature.toFixed(2)},${humidity.toFixed(2)},${i === 3 ? '' : fan.toFixed(2)}`);
  }
  return `${lines.join('\n')}\n`;
}

async function room(t, requests = []) {
  const { page, context, complaints } = await tab(chromium, 'about:blank', { viewport: { width: 1280, height: 1200 } });
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(`${server.address}#/rules?start=my-rules`);
  t.after(async () => {
    await context.close();
    assert.deepEqual(complaints, []);
  });
  await page.locator('.explanation .value').first().waitFor();
  return page;
}

/** Chooses a table. */
const choose = (page, text, name = 'rows.csv') => page.getByLabel('Rows of data').setInputFiles({ name, mimeType: 'text/csv', buffer: Buffer.from(text) });
const figure = async (page, words) => parseFloat((await page.locator('.data dl div', { hasText: words }).locator('dd').textContent()).replace('\u2212', '-'));
const text = (page) => page.evaluate(() => localStorage.getItem('flagred.rules'));

test('for a dropped table the error is that of the command line', async (t) => {
  const requests = [];
  const page = await room(t, requests);
  assert.ok(!requests.some((url) => url.endsWith('data.wasm')), 'the module for data is loaded on demand');
  const rows = csv(200);
  const dropped = await page.evaluateHandle((content) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([content], 'rows.csv'));
    return transfer;
  }, rows);
  await page.locator('.editor').dispatchEvent('drop', { dataTransfer: dropped });
  await page.locator('.data dl').waitFor();
  await page.getByText('199 rows with values of fan').waitFor();
  await page.getByText('1 row is not used').waitFor();
  const folder = await mkdtemp(join(tmpdir(), 'flagred-rows-'));
  t.after(() => rm(folder, { recursive: true }));
  await writeFile(join(folder, 'rules.yaml'), starter);
  // Unlike the page, the command evaluates rows without a measured value, so these are removed.
  await writeFile(join(folder, 'rows.csv'), rows.split('\n').filter((line) => !line.endsWith(',')).join('\n'));
  const said = execFileSync('sh', ['-c', `'${join(repository, 'target/debug/flagred')}' eval --suffix _model rules.yaml rows.csv 2>&1 >/dev/null`], { cwd: folder, encoding: 'utf8' });
  const [, rms, mean] = /RMS error ([\d.]+), mean error (-?[\d.]+)/.exec(said);
  assert.equal(await figure(page, 'RMS error'), Number(Number(rms).toPrecision(4)), said);
  assert.ok(Math.abs((await figure(page, 'Mean error')) - Number(mean)) < 1e-3, said);
  // After a click on the worst row, its point is explained.
  const cells = await page.locator('.data tbody tr').first().locator('td').allTextContents();
  await page.locator('.data tbody button').first().click();
  await page.waitForFunction((value) => Number(document.querySelector('[aria-label="temperature, as a number"]').value) === Number(value), cells[1]);
  // The error changes with the text.
  await page.getByRole('slider', { name: 'dry: top' }).focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction((rms) => !document.querySelector('.data dl').textContent.includes(rms), rms);
});

test('numbers are tuned in the text, and undo brings the old ones back', async (t) => {
  const page = await room(t);
  await choose(page, csv(300));
  await page.locator('.data dl').waitFor();
  const before = await figure(page, 'RMS error');
  await page.getByRole('button', { name: 'Tune' }).click();
  await page.locator('.data .state', { hasText: 'after tuning' }).waitFor({ timeout: 60_000 });
  const tuned = await text(page);
  assert.match(tuned, /flagred tune/);
  const comments = starter.split('\n').filter((line) => line.includes('#'));
  for (const comment of comments) assert.ok(tuned.includes(comment.slice(comment.indexOf('#'))), comment);
  await page.waitForFunction((before) => parseFloat(document.querySelector('.data dd').textContent) < 0.9 * before, before);
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.waitForFunction((starter) => localStorage.getItem('flagred.rules') === starter, starter);
});

test('rules are learned, and a search that is stopped uses only what it found', async (t) => {
  const page = await room(t);
  await choose(page, csv(300));
  await page.locator('.data dl').waitFor();
  await page.getByRole('button', { name: 'Learn rules' }).click();
  await page.locator('.data .state', { hasText: /\d+ rules learned from 299 rows/ }).waitFor({ timeout: 60_000 });
  assert.match(await text(page), /flagred learn/);
  await page.locator('.viewer tbody tr').first().waitFor();

  const learned = await text(page);
  await choose(page, csv(40_000), 'many.csv');
  await page.getByText('many.csv', { exact: true }).waitFor();
  await page.getByRole('button', { name: 'Tune' }).click();
  await page.locator('.data .state', { hasText: 'Step' }).waitFor({ timeout: 60_000 });
  await page.getByRole('button', { name: 'Stop' }).click();
  await page.locator('.data .state', { hasText: 'Stopped; the best rule set so far is in the editor.' }).waitFor();
  await page.waitForFunction((learned) => localStorage.getItem('flagred.rules') !== learned, learned);
  // After a stopped search, the next one works.
  await page.getByRole('button', { name: 'Learn rules' }).click();
  await page.locator('.data .state', { hasText: 'rules learned' }).waitFor({ timeout: 60_000 });
});

test('a table that does not fit is refused with help', async (t) => {
  const page = await room(t);
  await choose(page, 'temperatur;humidity;fan\n1;2;3\n');
  await page.locator('.data .refusal', { hasText: 'no column `temperature`' }).waitFor();
  assert.match(await page.locator('.data .refusal').textContent(), /`rows.csv`.*\nhelp: .*temperatur/s);
  await choose(page, 'temperature,humidity,fan\n');
  await page.locator('.data .refusal', { hasText: 'there are no rows' }).waitFor();
});
