// Damaged logs: the page continues whatever they contain, and its results are those of the command line.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { GUST, STEADY, command, folder, gustCsv, room } from './flights.mjs';
import { opened, tab } from './page.mjs';

const COUNT = 200;

const { chromium, server } = await opened();

/** Pseudo-random numbers from a seed: Lehmer's generator. */
function random(seed) {
  let state = (seed * 2654435761) % 2147483647 || 1;
  return (below) => {
    state = (state * 48271) % 2147483647;
    return Math.floor((state / 2147483647) * below);
  };
}

/** A copy with some damage: bytes overwritten, lost, repeated, added, or cut off. */
function damaged(bytes, below) {
  let copy = Buffer.from(bytes);
  for (let wounds = 1 + below(8); wounds > 0 && copy.length > 0; wounds--) {
    // The beginning identifies the format, so it is damaged more often than other parts.
    const at = below(2) ? below(copy.length) : below(Math.min(copy.length, 4096));
    const piece = copy.subarray(at, at + 1 + below(64));
    switch (below(6)) {
      case 0:
        copy = Buffer.concat([copy.subarray(0, at), copy.subarray(at + piece.length)]);
        break;
      case 1:
        copy = Buffer.concat([copy.subarray(0, at), piece, copy.subarray(at)]);
        break;
      case 2:
        copy.fill(below(256), at, at + piece.length);
        break;
      case 3:
        if (!below(4)) copy = copy.subarray(0, at);
        break;
      default:
        for (let i = 0; i < piece.length; i++) piece[i] = below(256);
    }
  }
  return copy;
}

test(`${COUNT} damaged logs are assessed or refused as by the command line`, { timeout: 900_000 }, async () => {
  // A piece of the binary log that is long enough to contain a flight, and one that is not.
  const steady = readFileSync(STEADY);
  const seeds = [
    ['bin', steady.subarray(0, 2_400_000)],
    ['bin', steady.subarray(0, 200_000)],
    ['csv', gustCsv()],
    ['csv.gz', readFileSync(GUST)],
  ];
  const there = folder();
  const names = Array.from({ length: COUNT }, (_, i) => {
    const [extension, bytes] = seeds[i % seeds.length];
    const name = `${String(i).padStart(3, '0')}.${extension}`;
    writeFileSync(join(there, name), damaged(bytes, random(i + 1)));
    return name;
  });
  const paths = names.map((name) => join(there, name));
  const { out, err } = await command(paths, '--json');
  const documents = new Map(JSON.parse(out).map((document) => [document.log.path, document]));
  const { page, context, complaints } = await tab(chromium, server.address);
  const flights = room(page);
  await flights.take(...paths);
  let refused = 0;
  for (const name of names) {
    const badge = await flights.badge(name);
    const document = documents.get(name);
    if (badge === 'error') {
      refused++;
      assert.equal(document, undefined, `${name} is refused only in the page`);
      await flights.row(name).locator('.log').click();
      const message = await page.locator('.message pre').textContent();
      const told = `error: ${message.replace('\nhelp: ', '\n  help: ')}\n`;
      assert.ok(err.includes(told), `${name}: ${told} is not what the command line says`);
    } else {
      assert.equal(badge, document?.verdict, name);
    }
  }
  assert.ok(refused > 5 && refused < COUNT / 2, `${refused} are refused`);
  // For some logs the reports are compared byte for byte.
  for (const name of names.filter((name) => documents.has(name)).slice(0, 12)) {
    await flights.choose(name);
    const { content } = await flights.download('JSON');
    assert.ok(content.equals((await command([join(there, name)], '--json')).out), `${name}: the JSON differs`);
  }
  assert.deepEqual(complaints, []);
  await context.close();
});
