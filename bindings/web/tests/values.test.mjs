// Values that users pass to rule sets: by position and by name; known, unknown and invalid. Also the time to compute a
// value.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { repository } from './installed.mjs';
import { RuleSet, RuleText, startRules } from '../../../target/web/package/rules.js';
import { Flight, startFlight } from '../../../target/web/package/flight.js';

/** The maximum processor time for one value, in microseconds. It is asserted only if FLAGRED_TIMED is set. */
const MAX_US = 0.5;

let text, rules;
before(async () => {
  await startRules();
  text = await readFile(join(repository, 'rules/tipper.yaml'), 'utf8');
  rules = new RuleSet(text);
});

test('a point is a list, an array of numbers, or has names', () => {
  const { value } = rules.evaluate([8, 9])[0];
  assert.equal(value, 22.984937679969402);
  for (const point of [[8, 9], Float64Array.of(8, 9), Uint8Array.of(8, 9), { service: 8, food: 9 }, { food: 9, service: 8 }]) {
    assert.equal(rules.evaluate(point)[0].value, value);
    assert.equal(rules.value(point), value);
    assert.equal(rules.value(point, 'tip'), value);
    assert.equal(rules.explain(point).outputs[0].value, value);
  }
  for (const columns of [[[8], [9]], { food: [9], service: Float32Array.of(8) }]) {
    assert.equal(rules.evaluateColumns(columns)[0][0], value);
  }
});

test('an unknown input makes the value unknown, never 0', () => {
  for (const point of [[8, null], [8, NaN], [null, 9], [8, undefined], { service: null, food: 9 }]) {
    const [{ value }] = rules.evaluate(point);
    assert.equal(value, null, JSON.stringify(point));
    assert.ok(Number.isNaN(rules.value(point)));
  }
  const [tips] = rules.evaluateColumns([[8, null], [9, 9]]);
  assert.ok(tips[0] > 22 && Number.isNaN(tips[1]));
  // An unknown point does not affect the point after it.
  assert.equal(rules.value([8, 9]), 22.984937679969402);
});

test('a wrong name, text or number of values is an error with advice', () => {
  const all = [(point) => rules.evaluate(point), (point) => rules.value(point), (point) => rules.explain(point), (point) => rules.explanationSvg(point)];
  const wrong = [
    [['8', 9], 'input `service` is the text "8", not a number\nhelp: give a number, or `null` if it is unknown'],
    [[8, true], 'input `food` is a value of type boolean, not a number\nhelp: give a number, or `null` if it is unknown'],
    [{ servise: 8, food: 9 }, '`servise` is not an input of the rule set\nhelp: the inputs are `service`, `food`'],
    [{ service: 8 }, 'input `food` has no value\nhelp: give `null` if it is unknown'],
    [[8], '1 value for 2 inputs\nhelp: the inputs are `service`, `food`'],
    [8, 'the values are neither a list nor an object\nhelp: the inputs are `service`, `food`'],
    ['89', 'the values are neither a list nor an object\nhelp: the inputs are `service`, `food`'],
  ];
  for (const [point, message] of wrong) for (const use of all) assert.throws(() => use(point), { message });
  assert.throws(() => rules.value([8, 9], 'tips'), { message: '`tips` is not an output of the rule set\nhelp: the outputs are `tip`' });
  assert.throws(() => rules.value([8, 9], 1), { message: /not an output/ });
  assert.throws(() => rules.evaluateColumns([[8, 8], [9]]), { message: 'column `food` has 1 rows, the first one 2\nhelp: give columns of one length' });
  assert.throws(() => rules.evaluateColumns([[8, 'x'], [9, 9]]), { message: /^row 2 of column `service` is the text "x"/ });
});

test('interval type-2 terms give an outcome an interval, and their curves have a lower one', async () => {
  const dinner = await readFile(join(repository, 'tests/authoring/ok/type2.yaml'), 'utf8');
  const [set, open] = [new RuleSet(dinner), new RuleText(dinner)];
  for (const { value, low, high } of set.evaluate([5])) assert.ok(low < value && value < high, `${low}, ${value}, ${high}`);
  const [tip] = set.explain([5]).outputs;
  assert.deepEqual(set.evaluate([5])[0].low, tip.low);
  assert.ok(!('low' in rules.evaluate([8, 9])[0]));
  const [bad, good, odd] = open.variables()[0].terms;
  assert.deepEqual([bad.curve.length, bad.lower.length, odd.lower.length], [8, 8, 0]);
  assert.ok(good.lower.every((y, i) => i % 2 === 0 || y <= good.curve[i]));
  const [food] = open.parts().variables;
  assert.deepEqual(food.terms.map(({ shape, isEditable }) => [shape, isEditable]), [['interval type-2', false], ['interval type-2', false], ['triangle', true]]);
  set.free();
  open.free();
});

test('a range, a unit and a term are changed in place', () => {
  const open = new RuleText(text);
  const after = (edits) => edits.sort((a, b) => b.from - a.from).reduce((all, { from, to, insert }) => all.slice(0, from) + insert + all.slice(to), text);
  const read = (edits) => {
    const changed = new RuleText(after(edits));
    const [variables, parts] = [changed.variables(), changed.parts()];
    changed.free();
    return { variables, parts };
  };
  const [low, high] = [-1, 12];
  const { variables: [ranged] } = read(open.setRange(0, low, high));
  assert.deepEqual([ranged.low, ranged.high], [low, high]);
  assert.equal(read(open.setUnit(0, 'points')).variables[0].unit, 'points');
  const term = open.parts().variables[0].terms.findIndex(({ canChangeShape }) => canChangeShape);
  assert.equal(read(open.setShape(0, term, 'triangle')).parts.variables[0].terms[term].shape, 'triangle');
  assert.throws(() => open.setRange(0, 3, 3), { message: /smaller one first/ });
  open.free();
});

test('messages of several lines keep their line ends', () => {
  assert.throws(() => new RuleSet('fuzzy: 1\n'), ({ message }) => message.includes('\n') && !message.includes('\\u{a}'));
});

test('a call on a freed object is an error with this reason', async () => {
  await startFlight();
  const freed = { message: 'this object was released by `free()`\nhelp: create a new one' };
  const set = new RuleSet(text);
  assert.ok(set.value([8, 9]) > 22);
  set.free();
  for (const use of [() => set.value([8, 9]), () => set.evaluate([8, 9]), () => set.about(), () => set.free()]) assert.throws(use, freed);
  const open = new RuleText(text);
  open.free();
  assert.throws(() => open.findings(), freed);
  const flight = Flight.fromBytes('steady.BIN', await readFile(join(repository, 'examples/flights/steady.BIN')));
  flight.free();
  assert.throws(() => flight.warnings, freed);
});

test('a value is right after the memory of the module has moved', () => {
  const expected = rules.value([8, 9]);
  const rows = 2_000_000;
  rules.evaluateColumns([new Float64Array(rows).fill(1), new Float64Array(rows).fill(2)]);
  const others = Array.from({ length: 50 }, () => new RuleSet(text));
  assert.equal(rules.value([8, 9]), expected);
  assert.deepEqual(new Set(others.map((other) => other.value([8, 9]))), new Set([expected]));
  for (const other of others) other.free();
});

test('a value is at least three times faster than all results of the same point', (told) => {
  const calls = 50_000;
  const point = [8, 9];
  const time_us = (call) => {
    const start = process.cpuUsage();
    for (let i = 0; i < calls; i++) {
      point[0] = (i % 100) / 10;
      call();
    }
    return process.cpuUsage(start).user / calls;
  };
  const times = Array.from({ length: 5 }, () => [time_us(() => rules.value(point)), time_us(() => rules.evaluate(point))]);
  const [value_us, results_us] = [0, 1].map((which) => Math.min(...times.map((pair) => pair[which])));
  told.diagnostic(`${value_us.toFixed(3)} us of a processor for a value, ${results_us.toFixed(3)} us for all results`);
  assert.ok(results_us > 3 * value_us, `${results_us / value_us} times faster`);
  assert.ok(!process.env.FLAGRED_TIMED || value_us < MAX_US, `${value_us} us`);
});
