// The README of the package runs as printed: the comments after `console.log(...); //`, and those on their own lines,
// are the expected output.

import assert from 'node:assert/strict';
import { cp, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { install, repository, run } from './installed.mjs';

const readme = await readFile(join(repository, 'bindings/web/README.md'), 'utf8');
// Blocks that begin with the name of a file are for browsers; embedding.test.mjs runs them.
const file = /^\/\/ (\w+\.js)\b/;
const all = [...readme.matchAll(/^```js\n(.*?)^```$/gms)].map(([, code]) => code);
const blocks = all.filter((code) => !file.test(code));
const written = all.map((code) => file.exec(code)?.[1]);

const { folder, files } = await install();

/** The expected output in a block. */
function said(code) {
  const printed = code.split('\n').map((line) => /^\/\/ (.*)$|console\.log\(.*\); \/\/ (.*)$/.exec(line));
  return printed.filter((found) => found).map(([, own, behind]) => own ?? behind);
}

test('every block of the README runs as printed', async () => {
  await cp(join(repository, 'examples/flights/steady.BIN'), join(folder, 'steady.BIN'));
  await cp(join(repository, 'rules/tipper.yaml'), join(folder, 'tipper.yaml'));
  assert.equal(blocks.length, 4);
  for (const [i, code] of blocks.entries()) {
    await writeFile(join(folder, `block${i}.js`), code);
    const { stdout } = await run('node', [`block${i}.js`], { cwd: folder });
    assert.deepEqual(stdout.trimEnd().split('\n'), said(code), `block ${i + 1}`);
  }
});

test('every file that the README names exists in the package or in the README', () => {
  for (const [name] of readme.matchAll(/\b(wasm\/)?\w+\.(js|wasm)\b/g)) {
    assert.ok(files.includes(name) || written.includes(name), name);
  }
});
