// Accessibility of both rooms: axe-core finds nothing serious or critical, light and dark, on a phone and a desktop.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { opened, tab } from './page.mjs';
import { flight, rules } from './rooms.mjs';

const axe = await readFile(fileURLToPath(import.meta.resolve('axe-core/axe.min.js')), 'utf8');
const states = [
  ['the room for flights', 'flight', (page) => page.locator('.drop').waitFor()],
  ['a flight', 'flight', flight],
  ['a rule set', 'rules', rules],
  ['a rule set as a table', 'rules', async (page) => {
    await rules(page);
    await page.getByRole('tab', { name: 'Table' }).click();
    await page.getByRole('button', { name: 'Add rule' }).waitFor();
    await page.getByLabel('Peak of term mild of temperature').fill('warm');
    await page.getByLabel('Peak of term mild of temperature').press('Enter');
    await page.locator('.parts .refusal').waitFor();
  }],
  ['a rule set with rows of data', 'rules', async (page) => {
    await rules(page);
    const rows = 'temperature,humidity,fan\n10,20,0\n30,80,90\n35,x,90\n';
    await page.getByLabel('Rows of data').setInputFiles({ name: 'rows.csv', mimeType: 'text/csv', buffer: Buffer.from(rows) });
    await page.locator('.data tbody tr').first().waitFor();
  }],
];
const sizes = { phone: { width: 390, height: 844 }, desktop: { width: 1280, height: 900 } };

const { chromium, server } = await opened();

/** The problems, one per line: the rule, the element and the reason. */
async function violations(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  const grave = violations.filter(({ impact }) => ['serious', 'critical'].includes(impact));
  return grave.flatMap(({ id, impact, nodes }) => {
    return nodes.map(({ target, failureSummary }) => `${impact} ${id} at ${target.flat().join(' ')}: ${failureSummary.replaceAll(/\s+/g, ' ')}`);
  });
}

for (const [state, room, reach] of states) {
  for (const [device, viewport] of Object.entries(sizes)) {
    for (const colorScheme of ['light', 'dark']) {
      test(`${state}, ${device}, ${colorScheme}`, { timeout: 120_000 }, async (t) => {
        const { page, context } = await tab(chromium, `${server.address}#/${room}`, { viewport, colorScheme, reducedMotion: 'reduce' });
        t.after(() => context.close());
        await reach(page);
        assert.deepEqual(await violations(page), []);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        assert.ok(wide <= 0, `it is ${wide} pixels too wide`);
      });
    }
  }
}
