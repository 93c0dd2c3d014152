// Shared by the tests of the flight room: logs, the command line's output for them, and the room in Chromium.

import { execFile, execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { repository } from './page.mjs';

const flagred = join(repository, 'target/debug/flagred');
export const STEADY = join(repository, 'examples/flights/steady.BIN');
export const GUST = join(repository, 'web/src/flight/gust.csv.gz');

/** All logs in the repository, and those of the developers' data if that is present. */
export function logs() {
  const shared = process.env.FLAGRED_SHARED;
  const folders = shared ? ['flights', 'logs'].map((name) => join(shared, 'data', name)) : [];
  const found = folders.flatMap((folder) => readdirSync(folder).map((name) => join(folder, name)));
  return [STEADY, GUST, ...found.filter((path) => /\.(bin|log|ulg|tlog)$/i.test(path) && path !== STEADY)];
}

/** A temporary folder with files. */
export function folder(files = {}) {
  const made = mkdtempSync(join(tmpdir(), 'flagred-'));
  for (const [name, content] of Object.entries(files)) writeFileSync(join(made, name), content);
  return made;
}

/** The command line's output for logs in a folder. They are named without a path, as in a browser. */
export async function command(paths, ...args) {
  const names = paths.map((path) => basename(path));
  const options = { cwd: dirname(paths[0]), maxBuffer: 1 << 30, encoding: 'buffer' };
  return new Promise((resolve) => {
    execFile(flagred, ['assess', ...names, '--fail-on', 'never', ...args], options, (_, out, err) =>
      resolve({ out, err: err.toString() }),
    );
  });
}

export const convert = (path) => execFileSync(flagred, ['convert', basename(path), '-o', '-'], { cwd: dirname(path), maxBuffer: 1 << 30, stdio: ['ignore', 'pipe', 'ignore'] });

export const gustCsv = () => gunzipSync(readFileSync(GUST));

if (!existsSync(flagred)) throw new Error('the command line is not built: cargo build -p flagred-cli');

/** The flight room of a page. */
export function room(page) {
  const row = (name) => page.locator('.logs tbody tr').filter({ has: page.getByText(name, { exact: true }) });
  return {
    row,
    async take(...paths) {
      await page.locator('.drop input').setInputFiles(paths);
    },
    /** Waits for the badge of a log. */
    async badge(name) {
      const badge = row(name).locator('.badge:not(:text("…"))');
      // The table is hidden while it contains only one flight.
      await badge.waitFor({ timeout: 120_000, state: 'attached' });
      return badge.textContent();
    },
    async choose(name) {
      if (await row(name).isVisible()) await row(name).locator('.log').click();
      await page.locator('.report h1').filter({ hasText: name }).waitFor();
    },
    async remove(name) {
      const isListed = await row(name).isVisible();
      await (isListed ? row(name).locator('.remove') : page.getByRole('button', { name: 'Close' })).click();
    },
    /** The time at the cursor on the log's clock, in seconds. */
    time: async () => parseFloat(await page.locator('.moment .log-time').textContent()),
    /** Waits for the verdict of the only flight. */
    verdict: (words) => page.locator('.logs .badge').getByText(words, { exact: true }).waitFor({ state: 'attached' }),
    async download(words) {
      await page.locator('.menu summary').filter({ hasText: 'Download' }).click();
      const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: words }).click()]);
      return { name: file.suggestedFilename(), content: await readFile(await file.path()) };
    },
    /** Waits until the report is drawn and every curve has its value. */
    async settled() {
      await page.locator('.report output').first().waitFor();
      await page.waitForFunction(() => {
        const root = document.querySelector('.report').shadowRoot;
        return !root.querySelector('.preview') && [...root.querySelectorAll('output')].some((output) => output.textContent);
      });
      await page.waitForTimeout(150);
    },
    /** The values at the cursor, by the titles of their charts. */
    values: () =>
      page.evaluate(() => {
        const panels = document.querySelector('.report').shadowRoot.querySelectorAll('.panel');
        return Object.fromEntries([...panels].map((panel) => [panel.querySelector('b').textContent, [...panel.querySelectorAll('output')].map((o) => o.textContent)]));
      }),
  };
}
