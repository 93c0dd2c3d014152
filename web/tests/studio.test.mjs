// `flagred studio` with its page, under the policy that it sends, with a file and without.

import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import { browser, repository, serve as site, studio, tab } from './page.mjs';

const command = join(repository, 'target/debug/flagred');
let chromium, folder, file;
before(async () => {
  chromium = await browser();
  folder = await mkdtemp(join(tmpdir(), 'flagred-studio-'));
  file = join(folder, 'tipper.yaml');
  await writeFile(file, await readFile(join(repository, 'rules/tipper.yaml')));
});
after(async () => {
  await chromium.close();
  await rm(folder, { recursive: true });
});

/** Starts `flagred studio` for the duration of a test, and returns its address. */
async function serve(t, ...args) {
  const child = spawn(command, ['studio', '--no-browser', '--page', studio, ...args]);
  const ended = once(child, 'exit');
  t.after(async () => {
    child.kill('SIGINT');
    assert.deepEqual(await ended, [0, null]);
  });
  const [address] = await once(createInterface({ input: child.stdout }), 'line');
  return address;
}

/** Opens an address in a tab for the duration of a test. */
async function open(t, address) {
  const opened = await tab(chromium, address);
  t.after(() => opened.context.close());
  return opened;
}

test('the program contains the page', async () => {
  const { stdout } = await promisify(execFile)(command, ['studio', '--html', '-'], { maxBuffer: 1 << 27 });
  assert.ok(stdout === (await readFile(studio, 'utf8')), 'the program contains another page: cargo build -p flagred-cli');
});

test('the page opens with both rooms', async (t) => {
  const { page, complaints } = await open(t, await serve(t));
  await page.getByRole('heading', { level: 1 }).first().waitFor();
  assert.match(page.url(), /#\/flight/);
  await page.getByRole('link', { name: 'Rules' }).click();
  await page.locator('.room.rules:not([hidden])').waitFor();
  assert.deepEqual(complaints, []);
});

test('with a file it opens the room for rules, under the policy of the page', async (t) => {
  const address = await serve(t, file);
  const { page, complaints } = await open(t, address);
  await page.locator('.room.rules:not([hidden])').waitFor();
  assert.match(page.url(), /#\/rules/);
  assert.deepEqual(complaints, []);
  const policy = (await page.request.get(address)).headers()['content-security-policy'];
  const own = await page.locator('meta[http-equiv]').getAttribute('content');
  assert.equal(policy, `${own}; frame-ancestors 'none'`);
});

test('typed text is saved on disk, and changes by another editor are read', async (t) => {
  const text = '# mine\r\nfuzzy: 1\r\n';
  const mine = join(folder, 'mine.yaml');
  await writeFile(mine, text);
  const { page } = await open(t, await serve(t, mine));
  const backing = page.locator('.backing');
  await backing.filter({ hasText: 'mine.yaml' }).filter({ hasText: /saved/ }).waitFor();
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+End');
  await page.keyboard.type('name: typed');
  await page.keyboard.press('Control+s');
  await backing.filter({ hasText: /saved/ }).waitFor();
  assert.equal(await readFile(mine, 'utf8'), `${text}name: typed`);
  await writeFile(mine, '# theirs\n');
  await page.locator('.cm-content').filter({ hasText: '# theirs' }).waitFor();
});

test('another page cannot read anything, even if it knows the address', async (t) => {
  const address = await serve(t, file);
  await writeFile(join(folder, 'index.html'), '<!doctype html><title>another page</title>');
  const other = await site(folder);
  t.after(other.close);
  const { page } = await open(t, other.address);
  const ask = ([url, options]) => fetch(url, options).then((answer) => answer.type, () => 'refused');
  for (const options of [
    {},
    { mode: 'no-cors' },
    { method: 'POST', body: 'x', mode: 'no-cors' },
    { method: 'PUT', body: 'x', headers: { 'If-Match': '*' } },
  ]) {
    assert.equal(await page.evaluate(ask, [`${address}api/file`, options]), 'refused');
  }
  assert.equal(await readFile(file, 'utf8'), await readFile(join(repository, 'rules/tipper.yaml'), 'utf8'));
});
