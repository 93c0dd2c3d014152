// The contents of the flight room and their positions: the verdict first, then signals and track, a table of many
// logs, and printing.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { test } from 'node:test';
import { GUST, STEADY, convert, folder, gustCsv, room } from './flights.mjs';
import { isTimed, opened, tab } from './page.mjs';

const { chromium, server } = await opened();

async function withLogs(paths, options = {}, hash = '#/flight') {
  const { page, context, complaints } = await tab(chromium, server.address + hash, { viewport: { width: 1280, height: 900 }, ...options });
  const flights = room(page);
  await flights.take(...paths);
  for (const path of paths) await flights.badge(basename(path));
  await flights.settled();
  return { page, context, complaints, room: flights };
}

/** The values of a signal in a flight CSV: times and values. */
function column(csv, name) {
  const lines = csv.toString().split('\n').filter((line) => line && !line.startsWith('#'));
  const index = lines[0].split(',').indexOf(name);
  return lines.slice(1).map((line) => [line.split(',')[0], line.split(',')[index]].map(Number));
}

const inReport = (page, use, ...args) =>
  page.evaluate(([use, args]) => new Function('root', 'args', `return (${use})(root, ...args)`)(document.querySelector('.report').shadowRoot, args), [String(use), args]);

for (const [device, options, most_px] of [
  ['desktop', {}, 120],
  ['phone', { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }, 160],
]) {
  test(`the verdict and its explanation come first, ${device}`, async () => {
    const { page, context } = await withLogs([GUST], options);
    const places = await page.evaluate(() => {
      const root = document.querySelector('.report').shadowRoot;
      const top = document.querySelector('.flight-view').getBoundingClientRect().top;
      const place = (element) => element.getBoundingClientRect();
      return {
        verdict: place(root.querySelector('h1 .badge')).bottom - top,
        sentence: place(root.querySelector('.findings .what')).top - top,
        tools: place(document.querySelector('.tools')),
        bar: place(document.querySelector('.timebar')),
        chart: place(root.querySelector('.panel')).top,
        line: Math.max(...[...document.querySelector('.tools').children].map((child) => place(child).bottom)) - Math.min(...[...document.querySelector('.tools').children].filter((child) => place(child).height > 0).map((child) => place(child).top)),
      };
    });
    assert.ok(places.verdict <= most_px && places.sentence <= most_px, JSON.stringify(places));
    assert.ok(places.line < 48, `the controls are ${places.line} px high`);
    assert.ok(places.chart - places.bar.bottom < 60, 'the slider is not at the charts');
    await context.close();
  });
}

test('the highest risk is one number', async () => {
  const { page, context } = await withLogs([GUST]);
  const words = await inReport(page, (root) => root.querySelector('[data-part=head]').textContent + root.querySelector('[data-part=about]').textContent);
  const numbers = [...words.matchAll(/risk reached (\d+) %|Highest risk(\d+)\s%/g)].map(([, a, b]) => a ?? b);
  assert.ok(numbers.length === 2, words);
  assert.equal(numbers[0], numbers[1]);
  await context.close();
});

test('several logs are shown in a table that can be sorted by its columns', async () => {
  const there = folder({ 'a-steady.BIN': readFileSync(STEADY), 'b-gust.csv': gustCsv(), 'c-no.log': 'nothing' });
  const { page, context, complaints } = await withLogs(['a-steady.BIN', 'b-gust.csv', 'c-no.log'].map((name) => `${there}/${name}`));
  const names = () => page.locator('.logs .name').allTextContents();
  assert.deepEqual(await names(), ['a-steady.BIN', 'b-gust.csv', 'c-no.log']);
  const head = (words) => page.locator('.logs th').filter({ hasText: words });
  await head('Highest risk').getByRole('button').click();
  assert.deepEqual(await names(), ['b-gust.csv', 'a-steady.BIN', 'c-no.log']);
  assert.equal(await head('Highest risk').getAttribute('aria-sort'), 'ascending');
  await head('Highest risk').getByRole('button').click();
  assert.deepEqual(await names(), ['a-steady.BIN', 'b-gust.csv', 'c-no.log'], 'unknown values are last in either order');
  await head('Verdict').getByRole('button').click();
  assert.deepEqual(await names(), ['b-gust.csv', 'a-steady.BIN', 'c-no.log']);
  const cells = await page.locator('.logs tbody tr').first().locator('td').allTextContents();
  assert.deepEqual(cells.slice(0, 5), ['FAIL', 'b-gust.csv', '83 %', '3:05 min', '1']);
  await page.locator('.logs .log').filter({ hasText: 'b-gust.csv' }).click();
  await page.locator('.report h1').filter({ hasText: 'b-gust.csv' }).waitFor();
  await room(page).remove('c-no.log');
  assert.equal(await page.locator('.logs tbody tr').count(), 2);
  assert.deepEqual(complaints, []);
  await context.close();
});

const FIVE = ['altitude_m', 'ground_speed_m_s', 'battery_v', 'ekf_wind_m_s', 'roll_deg'];

test('signals are plotted below the risk, with their values at the cursor', async () => {
  const { page, room, context, complaints } = await withLogs([GUST]);
  await page.locator('.menu summary').filter({ hasText: 'Signals' }).click();
  await page.getByLabel('Search the signals').fill('wind');
  assert.equal(await page.locator('.offered label:visible').count(), 1);
  await page.getByLabel('Search the signals').fill('');
  for (const name of FIVE) await page.locator('.offered label').filter({ hasText: name }).first().click();
  await page.waitForFunction(() => document.querySelector('.report').shadowRoot.querySelectorAll('[data-part=signals] .panel').length === 5);
  await page.keyboard.press('Escape');
  await room.settled();
  const parts = await inReport(page, (root) => [...root.querySelectorAll('section')].map((part) => part.dataset.part));
  assert.equal(parts[parts.indexOf('risk') + 1], 'signals');
  await page.waitForTimeout(400);
  assert.match(page.url(), /signals=altitude_m%2Cground_speed_m_s/);
  const csv = gustCsv();
  const check = async () => {
    const t_s = await room.time();
    const values = await room.values();
    for (const name of FIVE) {
      const near = column(csv, name).filter(([t]) => Math.abs(t - t_s) < 0.4).map(([, value]) => value);
      const shown = parseFloat(values[name][0]);
      assert.ok(shown >= Math.min(...near) - 0.02 && shown <= Math.max(...near) + 0.02, `${name} ${values[name]} at ${t_s} s is none of ${near}`);
    }
    assert.match(values.altitude_m[0], / m$/);
    assert.match(values.roll_deg[0], / °$/);
  };
  await check();
  const area = page.locator('.report .panel .area').nth(2);
  const box = await area.boundingBox();
  await page.mouse.move(box.x + box.width * 0.3, box.y + 20);
  await page.waitForTimeout(300);
  await check();
  // A link contains the signals, and they are redrawn for a stretch.
  const again = await withLogs([GUST], {}, new URL(page.url()).hash);
  await again.page.waitForFunction(() => document.querySelector('.report').shadowRoot.querySelectorAll('[data-part=signals] .panel').length === 5);
  await again.page.getByRole('button', { name: 'Zoom in' }).click();
  await again.room.settled();
  const lengths = await inReport(again.page, (root) => [...root.querySelectorAll('[data-part=signals] .panel')].map((panel) => Number(panel.dataset.length)));
  assert.ok(lengths.length === 5 && lengths.every((length) => length < 100), `${lengths}`);
  assert.deepEqual([...complaints, ...again.complaints], []);
  await again.context.close();
  await context.close();
});

test('the cursor moves with every frame over five signals', async (told) => {
  const { page, context } = await withLogs([GUST], {}, `#/flight?signals=${FIVE.join()}`);
  await page.waitForFunction(() => document.querySelector('.report').shadowRoot.querySelectorAll('[data-part=signals] .panel').length === 5);
  await page.waitForTimeout(500);
  const frames = await page.evaluate(async () => {
    const area = document.querySelector('.report').shadowRoot.querySelector('.panel .area');
    const box = area.getBoundingClientRect();
    const stamps = [];
    for (let i = 0; i < 180; i++) {
      stamps.push(await new Promise(requestAnimationFrame));
      area.dispatchEvent(new PointerEvent('pointermove', { clientX: box.x + (box.width * i) / 180, clientY: box.y + 20, bubbles: true, composed: true }));
    }
    return stamps.slice(1).map((t, i) => t - stamps[i]).sort((a, b) => a - b);
  });
  const at = (share) => frames[Math.floor(frames.length * share)];
  told.diagnostic(`frames ${at(0.5).toFixed(1)} ms apart, 95 of 100 within ${at(0.95).toFixed(1)} ms`);
  assert.ok(at(0.5) < 25, `frames are ${at(0.5)} ms apart`);
  assert.ok(!isTimed || at(0.95) < 17.5);
  await context.close();
});

test('the track has the positions of the log, and the cursor is on it', async () => {
  const { page, room, context } = await withLogs([STEADY]);
  const csv = convert(STEADY);
  const [north, east] = ['latitude_deg', 'longitude_deg'].map((name) => column(csv, name).filter(([, value]) => value !== 0 && Number.isFinite(value)));
  const held = (of, t_s) => (of.findLast(([t]) => t <= t_s) ?? of[0])[1];
  const start_s = await inReport(page, (root) => Number(root.querySelector('.track').dataset.start));
  const slider = page.getByRole('slider', { name: 'Time' });
  await slider.focus();
  for (const key of ['Home', 'Shift+ArrowRight', 'End']) {
    await page.keyboard.press(key);
    if (key.startsWith('Shift')) for (let i = 0; i < 40; i++) await page.keyboard.press(key);
    await page.waitForTimeout(400);
    const t_s = await room.time();
    const words = await inReport(page, (root) => root.querySelector('.track output').textContent);
    const [, n, ns, e, ew] = /^(\d+) m (north|south), (\d+) m (east|west) of take-off$/.exec(words);
    const metres = Math.PI / 180 * 6_371_008.8;
    const up = (held(north, t_s) - held(north, start_s)) * metres;
    const across = (held(east, t_s) - held(east, start_s)) * metres * Math.cos((held(north, start_s) * Math.PI) / 180);
    assert.ok(Math.abs((ns === 'south' ? -n : +n) - up) < 3, `${words} at ${t_s} s, not ${up} m north`);
    assert.ok(Math.abs((ew === 'west' ? -e : +e) - across) < 3, `${words} at ${t_s} s, not ${across} m east`);
  }
  await context.close();
});

test('the parameters are collapsed, and can be searched', async () => {
  const { page, context } = await withLogs([STEADY]);
  const fold = page.locator('.report details.searched');
  assert.equal(await fold.locator('tr').first().isVisible(), false);
  await fold.locator('summary').click();
  const all = await fold.locator('tr:visible').count();
  assert.ok(all > 10, `${all} parameters`);
  await fold.locator('input').fill('mot_');
  const found = await fold.locator('tr:visible').allTextContents();
  assert.ok(found.length > 0 && found.length < all && found.every((words) => /mot_/i.test(words)), `${found}`);
  await context.close();
});

test('only the report is printed, in colour', async () => {
  const { page, context } = await withLogs([GUST]);
  await page.emulateMedia({ media: 'print' });
  for (const control of ['body > header', '.tools', '.timebar', '.moment', '.what-if']) {
    assert.equal(await page.locator(control).isVisible(), false, control);
  }
  const styles = await inReport(page, (root) => {
    const badge = getComputedStyle(root.querySelector('h1 .badge'));
    return [badge.printColorAdjust, getComputedStyle(root.querySelector('section[data-part=motors]')).contentVisibility];
  });
  assert.deepEqual(styles, ['exact', 'visible']);
  assert.ok(await page.locator('.report .track').isVisible());
  await context.close();
});
