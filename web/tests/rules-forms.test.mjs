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

/** Waits until a box is marked as wrong, and described by this message. */
async function refused(page, box, message) {
  await page.locator('.parts .refusal').filter({ hasText: message }).last().waitFor();
  assert.equal(await box.getAttribute('aria-invalid'), 'true');
  const described = await box.evaluate((box) => document.getElementById(box.getAttribute('aria-describedby')).textContent);
  assert.ok(described.includes(message), described);
}

/** Fills a box and leaves it by the Enter key. */
async function enter(page, label, value) {
  await page.getByLabel(label).fill(value);
  await page.getByLabel(label).press('Enter');
}

test('ranges, units and terms are changed by the table, and undo restores each', async (t) => {
  const page = await table(t);
  const steps = [starter];
  const step = async (from, to) => {
    steps.push(steps.at(-1).replace(from, to));
    assert.notEqual(steps.at(-1), steps.at(-2));
    await becomes(page, steps.at(-1));
  };
  await enter(page, 'Lower end of the range of temperature', '-5');
  await step('range: [0, 40] #', 'range: [-5, 40] #');
  await enter(page, 'Unit of temperature', 'K');
  await step('unit: °C #', 'unit: K #');
  await enter(page, 'Peak of term mild of temperature', '22.5');
  await step('mild: 20', 'mild: 22.5');
  await enter(page, 'Parameters (top, foot) of term dry of humidity', '35, 60');
  await step('[40, 60]} # 1', '[35, 60]} # 1');
  await enter(page, 'Constant of term medium of fan', '45');
  await step('constant: 50', 'constant: 45');
  await page.getByLabel('Shape of term damp of humidity').focus();
  await page.getByLabel('Shape of term damp of humidity').selectOption('s_shape');
  await step('damp: {right_shoulder: [40, 60]} # 0', 'damp: {s_shape: [40, 60]} # 0');
  // The focus stays in the table that was drawn again.
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), 'Shape of term damp of humidity');
  await enter(page, 'Unit of humidity', '');
  await step('    unit: "%"\n    range: [0, 100]\n    # Terms', '    range: [0, 100]\n    # Terms');
  for (let i = steps.length - 2; i >= 0; i--) {
    await page.getByRole('button', { name: 'Undo' }).click();
    await becomes(page, steps[i]);
  }
  await page.waitForFunction(() => document.querySelector('[aria-label="Lower end of the range of temperature"]')?.value === '0');
});

test('a wrong range, number or shape is marked at its box', async (t) => {
  const page = await table(t);
  const wrong = [
    ['Upper end of the range of temperature', '-1', 'the range needs two numbers, the smaller one first'],
    ['Upper end of the range of humidity', '', 'the range needs two numbers, the smaller one first'],
    ['Peak of term mild of temperature', '35', 'the peak of `mild` must be between its neighbours'],
    ['Peak of term hot of temperature', 'warm', '`warm` is not a number'],
    ['Parameters (top, foot) of term dry of humidity', '40', 'the left_shoulder takes 2 numbers, not 1: top, foot'],
  ];
  for (const [label, value, message] of wrong) {
    await enter(page, label, value);
    await refused(page, page.getByLabel(label), message);
  }
  assert.equal(await page.locator('.parts [aria-invalid]').count(), wrong.length);
  // A refused change leaves the text as it was, and a right one removes the mark.
  assert.equal(await page.evaluate(() => localStorage.getItem('flagred.rules')), null);
  await enter(page, 'Peak of term mild of temperature', '25');
  await becomes(page, starter.replace('mild: 20', 'mild: 25'));
});

test('interval type-2 terms are shown, with their footprints and the interval of an outcome', async (t) => {
  const rules = await readFile(join(repository, 'tests/authoring/ok/type2.yaml'), 'utf8');
  const page = await table(t);
  await page.locator('input[type="file"][aria-label="Rule set"]').setInputFiles({ name: 'dinner.yaml', mimeType: 'text/yaml', buffer: Buffer.from(rules) });
  await page.getByLabel('Name of input food').waitFor();
  // Such terms can be renamed; their membership functions are edited as text.
  const bad = page.locator('.parts li').filter({ has: page.getByLabel('Name of term bad of food') });
  assert.match(await bad.textContent(), /interval type-2, edited as text: upper left_shoulder: \[2, 6\]; lower left_shoulder: \[1, 5\]/);
  assert.equal(await bad.locator('select').count(), 0);
  await page.getByLabel('Shape of term odd of food').waitFor();
  await enter(page, 'Name of term bad of food', 'awful');
  await becomes(page, rules.replaceAll('bad', 'awful'));
  await page.locator('.shapes').getByText('awful').waitFor();
  assert.equal(await page.locator('.shapes .variable').first().locator('.footprint').count(), 2);
  await page.locator('.shapes .variable').first().getByText('interval type-2').waitFor();
  const value = page.locator('.explanation .value').first();
  assert.match(await value.textContent(), /^tip [\d.]+ from [\d.]+ to [\d.]+$/);
  const [of, low, high] = (await value.textContent()).match(/[\d.]+/g).map(Number);
  assert.ok(low < of && of < high);
});

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
  const box = page.getByLabel('Name of term dry of moisture');
  await refused(page, box, 'the name `damp` is already used');
  await box.press('Escape');
  assert.equal(await box.inputValue(), 'dry');
  assert.equal(await box.getAttribute('aria-invalid'), null);
  assert.equal(await page.locator('.parts .refusal').count(), 0);
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
  await refused(page, page.getByLabel('Rule 4', { exact: true }), 'expected a term or a hedge, found the end of the rule');
  await page.getByLabel('Rule 4', { exact: true }).press('Escape');
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
