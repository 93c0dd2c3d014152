// The results of the package in Chromium are those of the command line: bits, documents, completions.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { readFile, readdir } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, repository, serve } from './page.mjs';

const command = join(repository, 'target/debug/flagred');
const read = (path) => readFile(join(repository, path), 'utf8');

let chromium, server, page;
before(async () => {
  chromium = await browser();
  server = await serve(join(repository, 'target/web/package'));
  page = await (await chromium.newContext()).newPage();
  await page.route(server.address, (route) => route.fulfill({ contentType: 'text/html', body: '<!doctype html>' }));
  await page.goto(server.address);
  await page.evaluate(async () => {
    window.flagred = await import('/index.js');
    await window.flagred.start();
  });
});
after(async () => {
  await chromium.close();
  await server.close();
});

/** A rule set with the operators and the defuzzifier of a case. */
function changed(text, line) {
  const words = [...line.matchAll(/(and|or|implication|aggregation|defuzzifier): ([a-z_]+)/g)];
  const operators = words.filter(([, key]) => key !== 'defuzzifier').map(([, key, word]) => `${key}: ${word}`);
  const [, , defuzzifier] = words.find(([, key]) => key === 'defuzzifier') ?? [];
  const [head, tail] = [text.slice(0, text.indexOf('\noutputs:')), text.slice(text.indexOf('\noutputs:'))];
  const outputs = defuzzifier ? tail.replaceAll(/^( +)range: .*$/gm, `$&\n$1defuzzifier: ${defuzzifier}`) : tail;
  return `${head}${outputs}${operators.length ? `\noperators: {${operators.join(', ')}}` : ''}\n`;
}

test('the results of the conformance corpus have the recorded bits', async () => {
  const known = new Map((await read('tests/conformance.bits')).trim().split('\n').map((line) => [line.split(' ', 2).join(' '), line]));
  const cases = [];
  for (const file of (await readdir(join(repository, 'tests/conformance'))).sort()) {
    const [text, lines] = (await read(`tests/conformance/${file}`)).split('\n---\n');
    lines.trim().split('\n').forEach((line, i) => {
      cases.push({ name: `${file} ${i}`, text: changed(text, line), point: /\bat: \[(.*?)\]/.exec(line)[1].split(', ').map(Number) });
    });
  }
  assert.equal(cases.length, known.size);
  const said = await page.evaluate((cases) => {
    const bits = (number) => new BigUint64Array(Float64Array.of(number).buffer)[0].toString(16);
    return cases.map(({ name, text, point }) => {
      const set = new window.flagred.RuleSet(text);
      const outputs = set.evaluate(point).map(({ value, coverage, dominantRule: rule, clamped }) =>
        [value === null ? 'none' : bits(value), bits(coverage), rule === null ? 'none' : rule - 1, Number(clamped)].join(','),
      );
      // A call with columns, which contain the row twice, gives the bits of the single call.
      const columns = set.evaluateColumns(point.map((value) => [value, value])).flatMap((column) => [...column]);
      const same = set.evaluate(point).flatMap(({ value }) => [value ?? NaN, value ?? NaN]);
      if (!columns.every((value, i) => Object.is(value, same[i]))) outputs.push('columns differ');
      set.free();
      return [name, ...outputs].join(' ');
    });
  }, cases);
  for (const line of said) assert.equal(line, known.get(line.split(' ', 2).join(' ')));
});

test('check gives the findings of the command line, for all wrong and all right rule sets', async () => {
  const files = [];
  for (const folder of ['tests/authoring/err', 'tests/authoring/ok', 'rules', 'rules/profiles', 'tests/examples']) {
    const names = await readdir(join(repository, folder)).catch(() => []);
    files.push(...names.filter((name) => name.endsWith('.yaml')).map((name) => `${folder}/${name}`));
  }
  let wrong = 0;
  for (const file of files) {
    const text = await read(file).catch(() => undefined);
    // A profile whose rule set is in another file is refused only by the command line.
    if (text === undefined || /^rules: .*(battery|\.yaml)/m.test(text)) continue;
    let said;
    try {
      said = execFileSync(command, ['check', '--json', file], { cwd: repository, encoding: 'utf8', stdio: 'pipe' });
    } catch (error) {
      said = error.stdout;
    }
    if (!said) continue;
    const here = await page.evaluate(([text, file]) => window.flagred.checkRules(text, file), [text, file]);
    assert.deepEqual(JSON.parse(here), JSON.parse(said), file);
    wrong += JSON.parse(said).findings.some(({ severity }) => severity === 'error');
  }
  assert.ok(wrong >= 107, `${wrong} wrong rule sets`);
});

test('explain gives the explanation of the command line', async () => {
  for (const [file, point] of [
    ['rules/flagred-paper.yaml', { margin: 0.007969, spread: 0.22631 }],
    ['rules/tipper.yaml', { service: 3, food: 8 }],
    ['rules/tipper.yaml', { service: -3, food: 80 }],
  ]) {
    const inputs = Object.entries(point).map(([name, value]) => `${name}=${value}`);
    const said = execFileSync(command, ['explain', '--json', file, ...inputs], { cwd: repository, encoding: 'utf8' });
    const svg = execFileSync(command, ['explain', file, ...inputs, '--svg', '-'], { cwd: repository, encoding: 'utf8' });
    const here = await page.evaluate(
      ([text, point]) => {
        const set = new window.flagred.RuleSet(text);
        return [set.explain(point), set.explanationSvg(point)];
      },
      [await read(file), Object.values(point)],
    );
    assert.deepEqual(here[0], JSON.parse(said));
    assert.equal(here[1], svg);
  }
});

test('pictures are those of the command line', async () => {
  const run = (...args) => execFileSync(command, args, { cwd: repository, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  for (const file of ['rules/flagred-paper.yaml', 'rules/flagred.yaml', 'rules/profiles/flagred-paper.yaml']) {
    const here = await page.evaluate((text) => {
      const set = new window.flagred.RuleSet(text);
      const { inputs, output } = set.about();
      const axes = [0, 1].map((input) => ({ input, low: inputs[input].shown[0], high: inputs[input].shown[1] }));
      const view = { output, axes, points: 51, held: set.held(output, [0, 1], inputs.map(() => null)) };
      return ['map', 'surface', 'rules'].map((kind) => set.mapSvg(kind, view)).concat(set.termsSvg());
    }, await read(file));
    assert.equal(here[0], run('map', file, '--svg', '-'), file);
    assert.equal(here[1], run('map', file, '--surface', '--svg', '-'), file);
    assert.equal(here[2], run('map', file, '--activations', '--svg', '-'), file);
    if (!file.includes('profiles')) assert.equal(here[3], run('plot', file, '--svg', '-'), file);
  }
});

test('other formats are read and written as by the command line', async () => {
  const run = (input, ...args) => execFileSync(command, args, { cwd: repository, encoding: 'utf8', input, stdio: ['pipe', 'pipe', 'ignore'] });
  const text = await read('rules/tipper.yaml');
  for (const format of ['FIS', 'FLL', 'FCL', 'FML']) {
    const there = run('', 'export', `--${format.toLowerCase()}`, '--lossy', 'rules/tipper.yaml');
    const back = run(there, 'import', '-');
    const here = await page.evaluate(
      ([text, format]) => {
        const written = window.flagred.exportRules(text, format, true);
        return [written.text, window.flagred.importRules(written.text)];
      },
      [text, format],
    );
    assert.equal(here[0], there);
    assert.equal(here[1].text, back);
    assert.equal(here[1].format, format);
  }
});

/** The completions of `flagred lsp` at places of a text. */
async function completed(text, offsets) {
  const server = spawn(command, ['lsp', '--stdio']);
  const send = (message) => {
    const body = JSON.stringify({ jsonrpc: '2.0', ...message });
    server.stdin.write(`Content-Length: ${Buffer.byteLength(body)}\r\n\r\n${body}`);
  };
  const place = (offset) => {
    const lines = text.slice(0, offset).split('\n');
    return { line: lines.length - 1, character: lines.at(-1).length };
  };
  const textDocument = { uri: 'file:///nowhere/rules.yaml' };
  send({ id: 0, method: 'initialize', params: { capabilities: {} } });
  send({ method: 'initialized', params: {} });
  send({ method: 'textDocument/didOpen', params: { textDocument: { ...textDocument, languageId: 'yaml', version: 1, text } } });
  offsets.forEach((offset, i) => send({ id: i + 1, method: 'textDocument/completion', params: { textDocument, position: place(offset) } }));
  const answers = new Map();
  let buffer = Buffer.alloc(0);
  for await (const chunk of server.stdout) {
    buffer = Buffer.concat([buffer, chunk]);
    for (let head; (head = buffer.indexOf('\r\n\r\n')) >= 0; ) {
      const length = Number(/Content-Length: (\d+)/.exec(buffer.subarray(0, head))[1]);
      if (buffer.length < head + 4 + length) break;
      const message = JSON.parse(buffer.subarray(head + 4, head + 4 + length));
      buffer = buffer.subarray(head + 4 + length);
      if (message.id > 0) answers.set(message.id, message.result);
    }
    if (answers.size === offsets.length) break;
  }
  server.kill();
  return offsets.map((_, i) => answers.get(i + 1));
}

test('completion is that of the language server, with positions in UTF-16 units', async () => {
  const text = (await read('rules/flagred-paper.yaml')).replace('fuzzy: 1', '# 𝛼 °C\nfuzzy: 1').replace(/WITH .*$/m, '');
  const at = (words) => text.indexOf(words) + words.length;
  const offsets = [at('\n  - IF '), at('IF margin IS '), at('THEN risk IS '), at('\noutputs:\n  risk:\n    '), at('defuzzifier: '), text.length];
  const there = await completed(text, offsets);
  const here = await page.evaluate(
    ([text, offsets]) => {
      const open = new window.flagred.RuleText(text);
      return offsets.map((offset) => open.completions(offset));
    },
    [text, offsets],
  );
  here.forEach((found, i) => {
    const wanted = there[i].map(({ label, insertText, detail }) => ({ label, text: insertText ?? label, detail: detail ?? null }));
    assert.deepEqual(found.map(({ label, text, detail }) => ({ label, text, detail })), wanted, `at ${offsets[i]}`);
  });
  assert.ok(here[1].some(({ label }) => label === 'low') && here[4].some(({ label }) => label === 'centroid'));
});

test('names, definitions and renaming have positions in UTF-16 units', async () => {
  const text = (await read('rules/tipper.yaml')).replace('# The textbook', '# 𝛼𝛽 The textbook');
  const at = text.indexOf('poor OR');
  const [hover, definition, edits] = await page.evaluate(
    ([text, at]) => {
      const open = new window.flagred.RuleText(text);
      return [open.hover(at), open.definition(at), open.rename(at, 'bad')];
    },
    [text, at],
  );
  assert.equal(text.slice(hover.from, hover.to), 'poor');
  assert.match(hover.markdown, /gaussian/);
  assert.equal(definition, text.indexOf('poor:'));
  assert.deepEqual(edits.map(({ from, to }) => text.slice(from, to)), ['poor', 'poor']);
});
