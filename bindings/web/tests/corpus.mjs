// The conformance corpus of all languages: rule sets, points, and the bits of every outcome.

import { readFile, readdir } from 'node:fs/promises';
import { join } from 'node:path';
import { repository } from './installed.mjs';

/** The text of a rule set with other operators and defuzzifiers, as a case asks for them. */
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

/** The cases: where each stands, its rule set, its point, and for each output the bits on file. */
export async function corpus() {
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

/** What a rule set says at a point, as the bits on file have it, by several ways. It runs in a page too, so it stands alone. */
export function outcomes(RuleSet, { text, point }) {
  const view = new DataView(new ArrayBuffer(8));
  const bits = (x) => (view.setFloat64(0, x), view.getBigUint64(0).toString(16));
  const known = (x) => (x === null || Number.isNaN(x) ? 'none' : bits(x));
  const rules = new RuleSet(text);
  const single = rules.evaluate(point).map(({ value, coverage, rule, clamped }) => {
    return [known(value), bits(coverage), rule ?? 'none', Number(clamped)].join(',');
  });
  const columns = rules.evaluateColumns(point.map((x) => [x, x, x])).map((column) => [...new Set([...column].map(known))].join());
  const explained = rules.explain(point).outputs.map(({ value }) => known(value));
  rules.free();
  return { single, columns, explained };
}
