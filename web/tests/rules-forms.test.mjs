// Forms change variables, terms and rules: the text changes with them, its comments stay, and undo restores it.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { opened, repository, tab } from './page.mjs';

const { chromium, server } = await opened();
const starter = (await readFile(join(repository, 'crates/authoring/src/starter.yaml'), 'utf8'));

/** The table of the starter. */
async function table(t, options = { viewport: { width: 1280, height: 1000 } }) {
  const { page, context, complaints } = await tab(chromium, `${server.address}#/rules?start=my-rules`, options);
  t.after(async () => {
    await context.close();
    assert.deepEqual(complaints, []);
  });
  await page.locator('.explanation .value').first().waitFor();
  await page.getByRole('tab', { name: 'Table' }).click();
  await page.getByLabel('Name of input temperature').waitFor();
  return page;
}

/** Waits until the editor has this text. */
const becomes = (page, text) => page.waitForFunction((text) => localStorage.getItem('flagred.rules') === text, text);

test('a name is changed everywhere', async (t) => {
  const page = await table(t);
  await page.getByLabel('Name of input humidity').fill('moisture');
  await page.getByLabel('Name of input humidity').press('Enter');
  // Words in comments are not names.
  const names = (text, from, to) => text.replaceAll(/^.*$/gm, (line) => line.replace(/^[^#]*/, (part) => part.replaceAll(from, to)));
  const renamed = names(starter, 'humidity', 'moisture');
  await becomes(page, renamed);
  await page.getByLabel('Name of term dry of moisture').fill('arid');
  await page.getByLabel('Name of term dry of moisture').press('Enter');
  await becomes(page, names(renamed, 'dry', 'arid'));
  await page.getByRole('button', { name: 'Undo' }).click();
  await becomes(page, renamed);
  await page.getByLabel('Name of term dry of moisture').waitFor();
  await page.getByLabel('Name of term dry of moisture').fill('damp');
  await page.getByLabel('Name of term dry of moisture').press('Enter');
  await page.getByText('the name `damp` is already used').waitFor();
  assert.equal(await page.getByLabel('Name of term dry of moisture').inputValue(), 'dry');
});

test('a variable with a term and a rule is added and removed', async (t) => {
  const page = await table(t);
  await page.getByLabel('Name of the new variable').fill('noise');
  await page.getByLabel('Upper end of its range').fill('60');
  await page.getByRole('button', { name: 'Add variable' }).click();
  const after = '1 from 60 on\n';
  const added = starter.replace('\n\noutputs:', (end) => `\n  noise:\n    range: [0, 60]\n    partition: [low, high]${end}`).replace(after, after);
  await becomes(page, added);
  await page.getByLabel('New term of noise').fill('painful');
  await page.getByLabel('New term of noise').press('Enter');
  const three = added.replace('partition: [low, high]\n\noutputs', 'partition: [low, high, painful]\n\noutputs');
  await becomes(page, three);
  await page.getByLabel('noise in the new rule').selectOption('painful');
  await page.getByLabel('fan in the new rule').selectOption('slow');
  await page.getByRole('button', { name: 'Add rule' }).click();
  const ruled = `${three}  - IF noise IS painful THEN fan IS slow\n`;
  await becomes(page, ruled);
  // The new parts are shown by the sliders, the viewer and the shapes.
  await page.getByLabel('noise, as a number').waitFor();
  await page.locator('.viewer tbody tr').nth(5).waitFor();
  await page.locator('.shapes').getByText('painful').waitFor();

  await page.getByRole('button', { name: 'Remove input noise' }).click();
  await page.getByText('rule 6 uses `noise`; remove or change it first').waitFor();
  await page.getByRole('button', { name: 'Remove rule 6' }).click();
  await becomes(page, three);
  await page.getByRole('button', { name: 'Remove term painful of noise' }).click();
  await becomes(page, added);
  await page.getByRole('button', { name: 'Remove input noise' }).click();
  await becomes(page, starter);
  // Each change is one step for undo.
  for (let i = 0; i < 6; i++) await page.getByRole('button', { name: 'Undo' }).click();
  await becomes(page, starter);
  assert.ok(await page.getByRole('button', { name: 'Undo' }).isDisabled());
});

test('a rule is changed in place, and a text that is not a rule is refused', async (t) => {
  const page = await table(t);
  await page.getByLabel('Rule 4', { exact: true }).fill('IF temperature IS hot AND humidity IS damp THEN fan IS medium');
  await page.getByLabel('Rule 4', { exact: true }).press('Enter');
  await becomes(page, starter.replace('humidity IS damp THEN fan IS fast,', 'humidity IS damp THEN fan IS medium,'));
  await page.getByLabel('Rule 4', { exact: true }).fill('IF temperature IS');
  await page.getByLabel('Rule 4', { exact: true }).press('Enter');
  await page.locator('#said:not(:empty)').waitFor();
  assert.match(await page.getByLabel('Rule 4', { exact: true }).inputValue(), /fan IS medium$/);
  await page.getByRole('button', { name: 'Add rule' }).click();
  await page.getByText('choose a term of an input for the new rule').waitFor();
});

test('the table fits on a phone, and keys switch its tabs', async (t) => {
  const page = await table(t, { viewport: { width: 390, height: 844 } });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(wide <= 0, `${wide} pixels too wide`);
  await page.getByRole('tab', { name: 'Table' }).press('ArrowLeft');
  assert.equal(await page.getByRole('tab', { name: 'Text' }).getAttribute('aria-selected'), 'true');
  await page.locator('.cm-content').waitFor();
});
