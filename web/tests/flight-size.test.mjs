// A log of 100 MB is read and assessed in seconds and in limited memory, and the page stays responsive meanwhile.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { STEADY, folder, room } from './flights.mjs';
import { isTimed, opened, tab } from './page.mjs';

const LOG_BYTES = 100_000_000;
const MAX_S = 5;
const MAX_TASK_MS = 50;
const MAX_MEMORY_KB = 600_000;
const TRIES = 3;

const { chromium, server } = await opened();

/** A long DataFlash log: the messages of a short one, repeated with later times. */
function longLog(bytes, length) {
  const lengths = new Map([[128, 89]]);
  const timed = new Set();
  const messages = [];
  let last_us = 0n;
  for (let at = 0; at + 3 <= bytes.length; ) {
    const type = bytes[at + 2];
    const size = lengths.get(type);
    if (bytes[at] !== 0xa3 || bytes[at + 1] !== 0x95 || !size) {
      at++;
      continue;
    }
    if (type === 128) {
      lengths.set(bytes[at + 3], bytes[at + 4]);
      if (bytes[at + 9] === 0x51) timed.add(bytes[at + 3]);
    } else if (timed.has(type) && at + size <= bytes.length) {
      messages.push([at, size]);
      const t_us = bytes.readBigUInt64LE(at + 3);
      if (t_us > last_us && t_us < 1_000_000_000n) last_us = t_us;
    }
    at += size;
  }
  const log = Buffer.alloc(length);
  bytes.copy(log);
  let end = bytes.length;
  for (let round = 1n; ; round++) {
    for (const [at, size] of messages) {
      if (end + size > length) return log.subarray(0, end);
      bytes.copy(log, end, at, at + size);
      log.writeBigUInt64LE(bytes.readBigUInt64LE(at + 3) + round * last_us, end + 3);
      end += size;
    }
  }
}

/** The maximum memory of those processes of the browser that show pages, in kB. */
async function peakMemory() {
  const session = await chromium.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  const peaks = processInfo
    .filter(({ type }) => type === 'renderer')
    .map(({ id }) => readFileSync(`/proc/${id}/status`, 'utf8').match(/VmHWM:\s+(\d+)/)?.[1]);
  return Math.max(...peaks.map(Number));
}

/** The processor time of the longest task on the main thread of a page, in a trace. */
function longestTask(trace) {
  const events = JSON.parse(trace).traceEvents;
  const mark = events.find(({ name, cat }) => name === 'measured' && cat.includes('blink.user_timing'));
  const tasks = events.filter(({ pid, tid, name }) => pid === mark.pid && tid === mark.tid && name.endsWith('RunTask'));
  return Math.max(...tasks.map(({ tdur }) => (tdur ?? 0) / 1000));
}

async function measure(path) {
  const { page, context, complaints } = await tab(chromium, 'about:blank', { viewport: { width: 1280, height: 900 } });
  await page.addInitScript(() => {
    window.tasks = [];
    new PerformanceObserver((list) => window.tasks.push(...list.getEntries().map(({ duration }) => duration))).observe({
      type: 'longtask',
      buffered: true,
    });
  });
  await page.goto(`${server.address}#/flight`);
  await page.locator('.drop input').waitFor({ state: 'attached' });
  await page.waitForTimeout(500);
  await chromium.startTracing(page, { categories: ['toplevel', 'blink.user_timing', 'disabled-by-default-devtools.timeline'] });
  const before = await page.evaluate(() => (window.tasks.splice(0), performance.mark('measured').startTime));
  const flights = room(page);
  await flights.take(path);
  // The queries of the test are tasks too, so they are short.
  const { badge, now } = await page.evaluate(async () => {
    const badge = () => document.querySelector('.logs .badge')?.textContent;
    while (!badge() || badge() === '…') await new Promise((resolve) => setTimeout(resolve, 20));
    return { badge: badge(), now: performance.now() };
  });
  const assessed_s = (now - before) / 1000;
  await page.waitForTimeout(1500);
  // Then the cursor is moved, and the view zoomed in and out again.
  const area = () => document.querySelector('.report').shadowRoot.querySelector('.area').getBoundingClientRect().toJSON();
  const box = await page.evaluate(area);
  for (let i = 0; i <= 20; i++) await page.mouse.move(box.x + (box.width * i) / 20, box.y + 20);
  await page.evaluate(() => document.querySelector('[aria-label="Zoom in"]').click());
  await page.waitForTimeout(1000);
  await page.evaluate(async () => {
    for (let y = 0; y < document.documentElement.scrollHeight; y += 600) {
      window.scrollTo(0, y);
      await new Promise((resolve) => setTimeout(resolve, 60));
    }
  });
  const tasks = await page.evaluate(() => window.tasks);
  const processor_ms = longestTask(await chromium.stopTracing());
  const memory_kb = existsSync('/proc/self/status') ? await peakMemory() : 0;
  assert.deepEqual(complaints, []);
  await context.close();
  return { badge, assessed_s, longest_ms: Math.max(0, ...tasks), processor_ms, memory_kb };
}

test('a log of 100 MB', { timeout: 600_000 }, async (context) => {
  const there = folder();
  const path = join(there, 'long.bin');
  writeFileSync(path, longLog(readFileSync(STEADY), LOG_BYTES));
  const all = [];
  const best = (name) => Math.min(...all.map((measured) => measured[name]));
  const isGood = () => best('assessed_s') < MAX_S && best('longest_ms') < MAX_TASK_MS;
  while (all.length === 0 || (isTimed && all.length < TRIES && !isGood())) {
    all.push(await measure(path));
    context.diagnostic(JSON.stringify(all.at(-1)));
  }
  for (const { badge, processor_ms, memory_kb } of all) {
    assert.equal(badge, 'GOOD');
    assert.ok(processor_ms > 0);
    assert.ok(memory_kb < MAX_MEMORY_KB, `${memory_kb} kB`);
  }
  if (!isTimed) return;
  assert.ok(best('assessed_s') < MAX_S, `${best('assessed_s')} s`);
  assert.ok(best('longest_ms') < MAX_TASK_MS, `the longest task took ${best('longest_ms')} ms`);
  assert.ok(best('processor_ms') < MAX_TASK_MS, `a task took ${best('processor_ms')} ms of a processor`);
});
