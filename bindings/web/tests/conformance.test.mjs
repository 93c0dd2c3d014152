// The corpus through the package, in Node and in Chromium: every outcome has the bits on file.

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { browser, serve, tab } from '../../../web/tests/page.mjs';
import { corpus, outcomes } from './corpus.mjs';
import { install, repository } from './installed.mjs';

const cases = await corpus();

function compare(found) {
  for (const [i, { place, expected }] of cases.entries()) {
    const values = expected.map((outcome) => outcome.split(',')[0]);
    assert.deepEqual(found[i], { single: expected, columns: values, explained: values }, place);
  }
}

test('the corpus is as large as it should be', () => assert.ok(cases.length >= 400));

test('Node gives the bits on file', async () => {
  const { RuleSet, start } = await import(join(repository, 'target/web/package/index.js'));
  await start();
  compare(cases.map((one) => outcomes(RuleSet, one)));
});

test('Chromium gives the bits on file', async (t) => {
  const { folder } = await install(t);
  await writeFile(join(folder, 'index.html'), '<!doctype html><title>corpus</title><link rel="icon" href="data:,">');
  const server = await serve(folder);
  t.after(server.close);
  const chromium = await browser();
  t.after(() => chromium.close());
  const { page } = await tab(chromium, server.address);
  const inPage = async ([cases, outcomes]) => {
    const { RuleSet, start } = await import('./node_modules/flagred/index.js');
    await start();
    const asked = new Function(`return ${outcomes}`)();
    return cases.map((one) => asked(RuleSet, one));
  };
  compare(await page.evaluate(inPage, [cases, outcomes.toString()]));
});
