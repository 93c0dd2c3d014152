// Flight logs with the package, in Node.

import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { closeSync, openSync, readFileSync, readSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { Comparison, Flight, PARTS, Profile, reportStyle, start } from '../../../target/web/package/index.js';

const flights = fileURLToPath(new URL('../../../examples/flights/', import.meta.url));
const binary = fileURLToPath(new URL('../../../target/debug/flagred', import.meta.url));
const flagred = (...args) => execFileSync(binary, args, { cwd: flights, encoding: 'utf8', maxBuffer: 1 << 28 });

let bytes, profile, flight, assessment;
before(async () => {
  await start();
  bytes = readFileSync(`${flights}steady.BIN`);
  profile = Profile.named();
  flight = Flight.fromBytes('steady.BIN', bytes);
  assessment = flight.assess(profile);
});

test('an assessment is the document of the command line', () => {
  assert.equal(assessment.json(), flagred('assess', 'steady.BIN', '--json'));
  assert.equal(Buffer.from(assessment.csv()).toString(), flagred('assess', 'steady.BIN', '--csv'));
  assert.equal(assessment.html(), flagred('assess', 'steady.BIN', '--html', '-'));
  const { steps, ...brief } = JSON.parse(assessment.json());
  assert.ok(steps.length > 1000);
  assert.deepEqual(assessment.brief(), brief);
  assert.match(assessment.svg(), /^<svg /);
});

test('a log is read in pieces, plain or gzipped', () => {
  const file = openSync(`${flights}steady.BIN`);
  const asked = [];
  const read = (offset, length) => {
    asked.push(length);
    const piece = new Uint8Array(length);
    return piece.subarray(0, readSync(file, piece, 0, length, offset));
  };
  const inPieces = Flight.read('steady.BIN', read, profile.signals).assess(profile);
  closeSync(file);
  assert.equal(inPieces.json(), assessment.json());
  assert.ok(asked.length > 4 && Math.max(...asked) <= 1 << 20, `${asked}`);
  const gzipped = Flight.fromBytes('steady.BIN', gzipSync(bytes), profile.signals).assess(profile);
  assert.equal(gzipped.brief().verdict, 'GOOD');
});

test('a log or profile that cannot be read is an error with the message of the command line', () => {
  const read = (name, text) => () => Flight.fromBytes(name, Buffer.from(text));
  assert.throws(read('empty.bin', ''), { message: /^`empty.bin` is empty\nhelp: / });
  assert.throws(read('page.html', '<html>'), { message: /^`page.html` is a web page, not a flight log\nhelp: / });
  const broken = () => {
    throw new Error('the disk is gone');
  };
  assert.throws(() => Flight.read('x.bin', broken), { message: '`x.bin` cannot be read: the disk is gone' });
  assert.throws(() => Flight.read('x.bin', () => 'no bytes'), { message: /returned no bytes/ });
  assert.throws(() => Profile.named('nobody'), { message: '`nobody` is not a built-in profile\nhelp: built-in profiles are flagred, flagred-paper, flagred-battery' });
  assert.throws(() => Profile.fromText('mine.yaml', 'flagred: 1\nnam: x\n'), { message: /mine.yaml:2/ });
});

test('a report is drawn part by part and for a stretch of time', () => {
  const whole = PARTS.map((part) => assessment.part(part)).join('');
  assert.ok(assessment.html().includes(whole), 'the parts are not those of the whole report');
  assert.ok(assessment.html().includes(reportStyle()));
  const { start_s, end_s } = assessment.stretch;
  assert.ok(start_s > 48 && end_s < 179);
  const part = assessment.part('risk', { start_s: 100, end_s: 110 });
  assert.match(part, /data-start="100" data-length="10"/);
  assert.match(assessment.part('motors', { start_s: -5, end_s: 1e9 }), new RegExp(`data-start="${start_s.toFixed(3).replace(/0+$/, '')}`));
  assert.throws(() => assessment.part('nothing'), { message: 'a report has no part `nothing`' });
});

test('the signals of a log are listed and drawn', () => {
  const signals = assessment.signals();
  assert.deepEqual(signals.find(({ name }) => name === 'roll_deg'), { name: 'roll_deg', unit: '°', source: 'ATT.Roll' });
  assert.ok(signals.length > 20 && signals.every(({ name }, i) => i === 0 || name > signals[i - 1].name));
  const charts = assessment.signalCharts(['battery_v', 'nothing', 'roll_deg'], { start_s: 100, end_s: 110 });
  assert.deepEqual([...charts.matchAll(/<b>(\w+)<\/b>/g)].map(([, name]) => name), ['battery_v', 'roll_deg']);
  assert.match(charts, /data-unit="V" data-start="100" data-length="10"/);
  const few = Flight.fromBytes('steady.BIN', bytes, profile.signals).assess(profile);
  assert.ok(few.signals().length < signals.length && few.part('track') === assessment.part('track'));
  assert.match(few.part('track'), /data-points="[-\d. ;]+"/);
});

test('a moment has its step and the rules that fire', () => {
  const { steps } = JSON.parse(assessment.json());
  const moment = assessment.moment(100.05);
  assert.deepEqual(moment.step, steps.findLast((step) => step.t_s <= 100.05));
  assert.equal(moment.mode, 'GUIDED');
  assert.equal(moment.rules[0].rule, moment.step.dominant_rule);
  assert.ok(moment.rules.every(({ strength }, i) => i === 0 || strength <= moment.rules[i - 1].strength));
  assert.equal(assessment.moment(0).step, null);
});

test('thresholds are changed in the text of a profile', () => {
  const tried = profile.withVerdict({ warn: { raise: { risk_pct: 40 }, until: { risk_pct: 30 } }, clear_after_s: 7 });
  assert.equal(tried.verdict.warn.raise.risk_pct, 40);
  assert.equal(tried.verdict.warn.raise.elevated_risk_pct, 60);
  assert.equal(flight.assess(tried).brief().verdict, 'WARN');
  assert.match(tried.text, /clear_after_s: 7 +# a level is lowered when it has not been held for this time/);
  assert.equal(Profile.fromText('x.yaml', tried.text).verdict.clear_after_s, 7);
  assert.throws(() => profile.withVerdict({ warn: { raise: { risk_pct: 40 } } }), { message: /is 43, above 40, at which the level is raised\nhelp: / });
});

test('a rule set replaces the one that a profile names', () => {
  const { text } = Profile.named('flagred-paper');
  assert.match(text, /rules: flagred-paper/);
  const rules = readFileSync(new URL('../../../rules/flagred-paper.yaml', import.meta.url), 'utf8');
  const same = flight.assess(Profile.named('flagred-paper', rules));
  assert.equal(same.json(), flight.assess(Profile.named('flagred-paper')).json());
  assert.throws(() => Profile.named('flagred-paper', rules.replace('rules:', 'ruls:')), { message: /did you mean `rules`/ });
});

test('`serves` reports whether a flight has the signals of a profile', () => {
  const battery = 'flagred: 1\nname: b\nrules: flagred\ninputs: {x: {last: wind_m_s}}\n';
  assert.throws(() => Profile.fromText('b.yaml', battery), { message: /b.yaml/ });
  assert.ok(flight.serves(profile));
  assert.ok(!Flight.fromBytes('steady.BIN', bytes, []).serves(profile));
  assert.ok(Flight.fromBytes('steady.BIN', bytes).serves(profile));
});

test('flights are compared as on the command line, and only with one profile', () => {
  const all = new Comparison([assessment, assessment]);
  assert.equal(all.json(), flagred('assess', 'steady.BIN', 'steady.BIN', '--json'));
  assert.equal(Buffer.from(all.csv()).toString(), flagred('assess', 'steady.BIN', 'steady.BIN', '--csv'));
  assert.equal(all.html(), flagred('assess', 'steady.BIN', 'steady.BIN', '--html', '-'));
  assert.ok(all.html().includes(all.part()));
  assert.match(all.part({ start_s: 10, end_s: 20 }), /data-length="10"/);
  assert.ok(all.length_s > 129 && all.length_s < 130);
  const paper = flight.assess(Profile.named('flagred-paper'));
  assert.throws(() => new Comparison([assessment, paper]), { message: /with the same profile/ });
});

test('a flight is converted to flight CSV', () => {
  const pieces = [];
  const whole = Flight.fromBytes('steady.BIN', bytes);
  whole.writeCsv((piece) => pieces.push(piece));
  assert.equal(Buffer.concat(pieces).toString(), flagred('convert', 'steady.BIN', '-o', '-'));
  assert.match(whole.warnings.join(), /`steady.BIN` is damaged: the log ends inside a message/);
});
