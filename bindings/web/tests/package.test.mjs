// The packed package in a clean folder: in Node, in a browser without a bundler, and under a strict compiler.

import assert from 'node:assert/strict';
import { cp, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { browser, serve, tab } from '../../../web/tests/page.mjs';
import { install, repository, run } from './installed.mjs';

/** The maximum size of the packed package. */
const MAX_BYTES = 2_000_000;

const SCRIPT = `
import { start, version, RuleSet, Flight, Profile } from 'flagred';
const { rules, log } = await files();
await start();
const tip = new RuleSet(rules).evaluate([8, 9])[0];
const verdict = Flight.fromBytes('steady.BIN', log).assess(Profile.named()).brief().verdict;
`;

const { folder, files, bytes } = await install();

const SAID = ['0.1.0', 22.984937679969402, 'GOOD'];

test('the package contains the files that it needs and no others', () => {
  for (const needed of ['index.js', 'index.d.ts', 'wasm/flight_bg.wasm', 'wasm/rules_bg.wasm', 'README.md', 'LICENSE-MIT', 'LICENSE-APACHE']) {
    assert.ok(files.includes(needed), `${needed} is not in it`);
  }
  const stray = files.filter((file) => !/^((wasm\/)?[a-z]+\.(js|d\.ts)|wasm\/(flight|rules)_bg\.wasm|package\.json|README\.md|LICENSE-\w+)$/.test(file));
  assert.deepEqual(stray, []);
  assert.ok(bytes < MAX_BYTES || process.env.FLAGRED_QUICK, `${bytes} bytes`);
});

test('Node loads it, and the module from its file', async () => {
  const rules = JSON.stringify(join(repository, 'rules/tipper.yaml'));
  const log = JSON.stringify(join(repository, 'examples/flights/steady.BIN'));
  await writeFile(
    join(folder, 'use.js'),
    `import { readFile } from 'node:fs/promises';
     const files = async () => ({ rules: await readFile(${rules}, 'utf8'), log: await readFile(${log}) });
     ${SCRIPT} console.log(JSON.stringify([version(), tip.value, verdict]));`,
  );
  const { stdout, stderr } = await run('node', ['use.js'], { cwd: folder });
  assert.deepEqual(JSON.parse(stdout), SAID);
  assert.equal(stderr, '');
});

test('a browser loads it without a bundler', async (t) => {
  await cp(join(repository, 'rules/tipper.yaml'), join(folder, 'tipper.yaml'));
  await cp(join(repository, 'examples/flights/steady.BIN'), join(folder, 'steady.BIN'));
  await writeFile(
    join(folder, 'index.html'),
    `<!doctype html><meta charset="utf-8"><title>flagred</title><link rel="icon" href="data:,">
     <script type="importmap">{"imports": {"flagred": "./node_modules/flagred/index.js"}}</script>
     <script type="module">
     const fetched = async (name) => (await fetch(name)).arrayBuffer();
     const files = async () => ({
       rules: new TextDecoder().decode(await fetched('tipper.yaml')), log: new Uint8Array(await fetched('steady.BIN')),
     });
     ${SCRIPT} globalThis.said = [version(), tip.value, verdict];
     </script>`,
  );
  const server = await serve(folder);
  t.after(server.close);
  const chromium = await browser();
  t.after(() => chromium.close());
  const { page, complaints } = await tab(chromium, server.address);
  const said = await page.waitForFunction(() => globalThis.said, undefined, { timeout: 30_000 });
  assert.deepEqual(await said.jsonValue(), SAID);
  assert.deepEqual(complaints, []);
});

for (const resolution of ['nodenext', 'bundler']) {
  test(`its types hold under a strict compiler, module resolution ${resolution}`, async () => {
      await cp(join(repository, 'bindings/web/tests/example.ts'), join(folder, 'example.ts'));
    const module = resolution === 'bundler' ? 'esnext' : resolution;
    const flags = ['--strict', '--noEmit', '--exactOptionalPropertyTypes', '--noUncheckedIndexedAccess', '--types', ''];
    const target = ['--target', 'es2022', '--lib', 'es2022,dom', '--module', module, '--moduleResolution', resolution];
    const tsc = join(repository, 'web/node_modules/.bin/tsc');
    const compiled = run(tsc, [...flags, ...target, 'example.ts'], { cwd: folder });
    const told = await compiled.then(() => '', (failed) => failed.stdout);
    assert.equal(told, '');
    // Calls with wrong types are errors.
    await writeFile(join(folder, 'wrong.ts'), "import { RuleSet } from 'flagred'; new RuleSet(1);");
    await assert.rejects(run(tsc, [...flags, ...target, 'wrong.ts'], { cwd: folder }), { stdout: /TS2345/ });
  });
}

test('the version is that of the workspace', async () => {
  const { version } = JSON.parse(await readFile(join(repository, 'bindings/web/package.json'), 'utf8'));
  const cargo = await readFile(join(repository, 'Cargo.toml'), 'utf8');
  assert.equal(version, /^version = "(.+)"$/m.exec(cargo)[1]);
  assert.equal(SAID[0], version);
});
