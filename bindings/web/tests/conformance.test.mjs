// Runs the conformance corpus of all languages through the package in Node: every outcome must have the recorded bits.

import assert from 'node:assert/strict';
import { readFile, readdir } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { repository } from './installed.mjs';

/** The text of a rule set with the operators and defuzzifiers of a case. */
function varied(text, settings) {
  const { defuzzifier, ...operators } = settings;
  let changed = text;
  if (defuzzifier) {
    const [inputs, outputs, rules] = text.split(/^(?=outputs:|rules:)/m);
    changed = inputs + outputs.replaceAll(/^    range: .*$/gm, `$&\n    defuzzifier: ${defuzzifier}`) + rules;
  }
  const written = Object.entries(operators).map(([name, word]) => `${name}: ${word}`);
  return written.length > 0 ? `${changed}\noperators: {${written.join(', ')}}\n` : changed;
}

/** The cases: location, rule set, point, and for each output the recorded bits. */
async function corpus() {
  const folder = join(repository, 'tests/conformance');
  const onFile = new Map();
  for (const line of (await readFile(`${folder}.bits`, 'utf8')).trimEnd().split('\n')) {
    const [file, number, ...outcomes] = line.split(' ');
    onFile.set(`${file} ${number}`, outcomes);
  }
  const cases = [];
  for (const file of (await readdir(folder)).sort()) {
    const [text, lines] = (await readFile(join(folder, file), 'utf8')).split('\n---\n');
    for (const [i, line] of lines.trimEnd().split('\n').entries()) {
      const [before, behind] = line.split('at: ');
      const settings = Object.fromEntries([...before.matchAll(/(\w+): ([a-z_]+)\b/g)].map(([, key, word]) => [key, word]));
      const point = behind.slice(1, behind.indexOf(']')).split(', ').map(Number);
      const place = `${file} ${i}`;
      cases.push({ place, text: varied(text, settings), point, expected: onFile.get(place) });
      onFile.delete(place);
    }
  }
  if (onFile.size > 0) throw new Error(`no case for ${[...onFile.keys()]}`);
  return cases;
}

const bits = (x) => new BigUint64Array(Float64Array.of(x).buffer)[0].toString(16);
const known = (x) => (x === null || Number.isNaN(x) ? 'none' : bits(x));

test('every outcome of the corpus has the bits on file', async () => {
  const { RuleSet, start } = await import(join(repository, 'target/web/package/index.js'));
  await start();
  const cases = await corpus();
  assert.ok(cases.length >= 400);
  for (const { place, text, point, expected } of cases) {
    const rules = new RuleSet(text);
    const single = rules.evaluate(point).map(({ value, coverage, dominantRule, clamped }) => {
      return [known(value), bits(coverage), dominantRule === null ? 'none' : dominantRule - 1, Number(clamped)].join(',');
    });
    assert.deepEqual(single, expected, place);
    const values = expected.map((outcome) => outcome.split(',')[0]);
    assert.deepEqual(values.map((_, output) => known(rules.value(point, output))), values, place);
    const columns = rules.evaluateColumns(point.map((x) => [x]));
    assert.deepEqual(columns.map(([value]) => known(value)), values, place);
    assert.deepEqual(rules.explain(point).outputs.map(({ value }) => known(value)), values, place);
    rules.free();
  }
});
