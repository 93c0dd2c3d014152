// A bug of flagred throws a special exception, with the message of the panic.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { repository } from './installed.mjs';

const built = (file) => join(repository, 'target/web/package', file);
const { Panic, RuleSet, start } = await import(built('index.js'));
const { guard } = await import(built('panic.js'));
const { panicMessage, panicNow } = await import(built('wasm/rules.js'));

test('refused content is an ordinary error, and the module remains usable', async () => {
  await start();
  const refused = (error) => error instanceof Error && !(error instanceof Panic) && error.message.length > 0;
  assert.throws(() => new RuleSet('fuzzy: 1\n'), refused);
  const text = await readFile(join(repository, 'rules/tipper.yaml'), 'utf8');
  assert.throws(() => new RuleSet(text).evaluate([1]), refused);
  assert.ok(new RuleSet(text).evaluate([8, 9])[0].value > 22);
});

// This test is the last one: the module is unusable after it.
test('a panic is caught, with its message', async () => {
  await start();
  assert.throws(
    () => guard(panicMessage)(() => panicNow('the sky is falling')),
    (error) => error instanceof Panic && error.name === 'Panic' && error.message.includes('the sky is falling'),
  );
});
