// The results of the flight room are those of the command line, byte for byte; its cursor, zoom and thresholds work.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { basename } from 'node:path';
import { pathToFileURL } from 'node:url';
import { readFileSync } from 'node:fs';
import { GUST, STEADY, command, convert, folder, gustCsv, logs, room } from './flights.mjs';
import { opened, studio, tab } from './page.mjs';

const { chromium, server } = await opened();

async function open(hash = '#/flight', options = {}) {
  const opened = await tab(chromium, server.address + hash, { viewport: { width: 1280, height: 900 }, ...options });
  return { ...opened, room: room(opened.page) };
}

async function withLog(path, hash) {
  const opened = await open(hash);
  await opened.room.take(path);
  await opened.room.badge(basename(path));
  await opened.room.settled();
  return opened;
}

test('the documents of every log are those of the command line', { timeout: 600_000 }, async () => {
  const { page, room, context, complaints } = await open();
  for (const path of logs()) {
    const name = basename(path);
    const { out, err } = await command([path], '--json');
    await room.take(path);
    const badge = await room.badge(name);
    if (badge === 'error') {
      await room.row(name).locator('.log').click();
      const message = await page.locator('.message pre').textContent();
      assert.equal(`error: ${message.replace('\nhelp: ', '\n  help: ')}\n`, err, name);
    } else {
      await room.choose(name);
      const { content } = await room.download('JSON');
      assert.ok(content.equals(out), `${name}: the JSON differs`);
      assert.equal(badge, JSON.parse(out).verdict);
    }
    await room.remove(name);
  }
  assert.deepEqual(complaints, []);
  await context.close();
});

test('report, table and flight CSV are those of the command line', async () => {
  for (const path of [STEADY, GUST]) {
    const { room, context } = await withLog(path);
    const [html, csv] = await Promise.all(['--html', '--csv'].map(async (kind) => (await command([path], ...(kind === '--html' ? [kind, '-'] : [kind]))).out));
    assert.ok((await room.download('Report (HTML)')).content.equals(html), 'the report differs');
    assert.ok((await room.download('Steps (CSV)')).content.equals(csv), 'the table differs');
    const { name, content } = await room.download('Flight CSV');
    assert.ok(content.equals(convert(path)), 'the flight CSV differs');
    assert.match(name, /^(steady|gust)\.csv$/);
    await context.close();
  }
});

test('a cursor shows the values of all charts and the rules that fire', async () => {
  const { page, room, context } = await withLog(GUST, '#/flight?t=178.2');
  const document = JSON.parse((await command([GUST], '--json')).out);
  const step = (t_s) => document.steps.findLast((step) => step.t_s <= t_s);
  const check = async (t_s) => {
    const values = await room.values();
    const { risk, elevated_risk, inputs, dominant_rule } = step(t_s);
    assert.ok(Math.abs(parseFloat(values['Risk'][1]) - risk) < 1.5, `risk ${values['Risk'][1]} is not ${risk}`);
    assert.ok(Math.abs(parseFloat(values['Risk'][0]) - elevated_risk) < 1.5);
    assert.ok(Math.abs(parseFloat(values['swing per room'][0]) - inputs.swing_per_room) < 0.01);
    const dominant = await page.locator('.fired .dominant .rule b').textContent();
    assert.equal(Number(dominant), dominant_rule);
    const strengths = await page.locator('.fired .strength').allTextContents();
    assert.ok(strengths.length > 1 && parseFloat(strengths[0]) > 0);
  };
  await check(178.2);
  // With the arrow keys on the slider, and over the charts.
  const slider = page.getByRole('slider', { name: 'Time' });
  await slider.focus();
  for (let i = 0; i < 5; i++) await page.keyboard.press('Shift+ArrowLeft');
  await page.waitForTimeout(300);
  const moved = await room.time();
  assert.ok(moved < 175 && moved > 160, `${moved} s`);
  await check(moved);
  const area = page.locator('.report .panel .area').first();
  const box = await area.boundingBox();
  await page.mouse.move(box.x + box.width / 4, box.y + 20);
  await page.waitForTimeout(300);
  const pointed = await room.time();
  assert.ok(Math.abs(pointed - (49 + 185.1 / 4)) < 1, `${pointed} s`);
  await check(pointed);
  // The point on the map is at the values of the inputs.
  const here = await page.evaluate(() => document.querySelector('.report').shadowRoot.querySelector('.here').getAttribute('d'));
  assert.match(here, /^M[\d.]+ [\d.]+h0$/);
  assert.match(page.url(), /t=9\d\.\d\d/);
  await context.close();
});

test('a selected stretch is redrawn, with points that thinning left out', async () => {
  const { page, room, context } = await withLog(STEADY);
  const points = () =>
    page.evaluate(() => {
      const [line] = [...document.querySelector('.report').shadowRoot.querySelectorAll('.line.motor')];
      return [line.getAttribute('d').split('L').length, line.closest('.panel').dataset.start];
    });
  const [, whole] = await points();
  const area = page.locator('.report .panel .area').first();
  await area.scrollIntoViewIfNeeded();
  const box = await area.boundingBox();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 30);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.55, box.y + 35, { steps: 5 });
  await page.mouse.up();
  await room.settled();
  const [, start] = await points();
  assert.ok(Math.abs(Number(start) - (48.8 + 129.1 / 2)) < 0.5, `it starts at ${start} s`);
  await page.waitForTimeout(400);
  assert.match(page.url(), /from=113\.\d\d&to=119\.\d\d/);
  // The slider shows another stretch of the same length.
  await page.getByRole('slider', { name: 'Time' }).focus();
  await page.keyboard.press('Home');
  await room.settled();
  assert.equal((await points())[1], whole);
  await page.waitForTimeout(400);
  assert.match(page.url(), /from=48\.\d\d&to=55\.\d\d/);
  await page.getByRole('button', { name: 'All of the flight' }).click();
  await room.settled();
  assert.equal((await points())[1], whole);
  assert.ok(await page.getByRole('button', { name: 'Zoom out' }).isDisabled());
  // The wheel zooms around the pointer; a link to the stretch shows it again.
  await page.mouse.move(box.x + box.width * 0.5, box.y + 30);
  await page.keyboard.down('Control');
  for (let i = 0; i < 4; i++) await page.mouse.wheel(0, -200);
  await page.keyboard.up('Control');
  // The browser delivers wheel events when it draws the next frame.
  await page.waitForFunction(
    (start) => document.querySelector('.report').shadowRoot.querySelector('.panel').dataset.start !== start,
    whole,
  );
  await room.settled();
  await page.waitForTimeout(400);
  const [, zoomed] = await points();
  assert.ok(Number(zoomed) > 100 && Number(zoomed) < 113.4, `it starts at ${zoomed} s`);
  const again = await withLog(STEADY, new URL(page.url()).hash);
  const there = await again.page.evaluate(() => document.querySelector('.report').shadowRoot.querySelector('.panel').dataset.start);
  assert.ok(Math.abs(Number(there) - Number(zoomed)) < 0.02);
  await again.context.close();
  await context.close();
});

test('two fingers zoom, and keys move the cursor', async () => {
  const { page, room, context } = await open('#/flight', { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await room.take(GUST);
  await room.badge(basename(GUST));
  await room.settled();
  const area = page.locator('.report .panel .area').first();
  await area.evaluate((element) => element.scrollIntoView({ block: 'center' }));
  const { x, y, width } = await area.boundingBox();
  const session = await context.newCDPSession(page);
  const touch = (type, ...shares) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: shares.map((share, id) => ({ x: x + share * width, y: y + 40, id })) });
  await touch('touchStart', 0.45);
  await touch('touchStart', 0.45, 0.55);
  for (let i = 1; i <= 5; i++) await touch('touchMove', 0.45 - 0.03 * i, 0.55 + 0.03 * i);
  await touch('touchEnd');
  await room.settled();
  const [start, length] = await area.evaluate((element) => [element.closest('.panel').dataset.start, element.closest('.panel').dataset.length].map(Number));
  // The stretch is now about a quarter of the flight: what was a tenth of the chart is four tenths of it.
  assert.ok(Math.abs(length - 185.15 / 4) < 3, `${length} s`);
  assert.ok(Math.abs(start + length / 2 - (49 + 185.15 / 2)) < 3, `from ${start} s`);
  const shown = room.time;
  await page.evaluate(() => document.activeElement?.blur());
  const before = await shown();
  await page.keyboard.press('Shift+ArrowRight');
  await page.waitForTimeout(300);
  assert.ok(Math.abs((await shown()) - before - length * 0.01) < 0.11);
  await page.keyboard.press('0');
  await room.settled();
  assert.ok(await page.getByRole('button', { name: 'Zoom out' }).isDisabled());
  await context.close();
});

test('other thresholds give the verdict of a profile that has them', async () => {
  const { page, room, context, complaints } = await withLog(GUST);
  assert.equal(await room.badge(basename(GUST)), 'FAIL');
  await page.getByText('the thresholds were different?').click();
  const field = (name) => page.getByRole('spinbutton', { name });
  await field('FAIL, raised at a risk of, %').fill('95');
  await page.locator('.what-if-verdict').getByText('WARN').waitFor();
  assert.equal(await page.locator('.what-if-verdict').textContent(), 'With the profile FAIL, with these thresholds WARN.');
  await field('WARN, reached for at least, s').fill('300');
  await room.verdict('GOOD');
  const { content } = await room.download('JSON');
  // The report contains the changed profile, with which the command line gives the same verdict.
  const report = (await room.download('Report (HTML)')).content.toString();
  const [, profile] = /<h2>Profile<\/h2><pre>([^]*?)<\/pre>/.exec(report);
  assert.match(profile, /fail: \{risk: 95, after_s: 0.3, until: \{risk: 65\}\}/);
  assert.match(profile, /# a level is lowered when it has not been held for this time/);
  const text = profile.replaceAll('&gt;', '>').replaceAll('&lt;', '<').replaceAll('&quot;', '"').replaceAll('&amp;', '&');
  const there = folder({ [basename(GUST)]: readFileSync(GUST), 'tried.yaml': text });
  const { out } = await command([`${there}/${basename(GUST)}`], '--json', '--profile', 'tried.yaml');
  assert.ok(content.equals(out), 'the command line gives another result with this profile');
  // The link contains the thresholds, too.
  await page.waitForTimeout(400);
  const again = await withLog(GUST, new URL(page.url()).hash);
  assert.equal(await again.room.badge(basename(GUST)), 'GOOD');
  await again.context.close();
  await page.getByRole('button', { name: 'Reset to the profile' }).click();
  await room.verdict('FAIL');
  await page.getByRole('combobox', { name: 'Profile' }).selectOption('flagred-paper');
  const paper = JSON.parse((await command([GUST], '--json', '--profile', 'flagred-paper')).out);
  await room.verdict(paper.verdict);
  assert.deepEqual(complaints, []);
  await context.close();
});

test('a profile from a file is used; one with errors is reported and changes nothing', async () => {
  const { page, room, context } = await withLog(GUST);
  const profile = readFileSync(new URL('../../rules/profiles/multirotor.yaml', import.meta.url), 'utf8');
  const choose = (name, text) => page.getByLabel('Profile from a file').setInputFiles({ name, mimeType: 'text/yaml', buffer: Buffer.from(text) });
  await choose('wrong.yaml', profile.replace('window_s: 2 ', 'windw_s: 2 '));
  await page.locator('.message').getByText('did you mean `window_s`?').waitFor();
  assert.equal(await room.badge(basename(GUST)), 'FAIL');
  await choose('calm.yaml', profile.replace('fail: {risk: 80', 'fail: {risk: 99'));
  await room.verdict('WARN');
  assert.ok(await page.locator('.message').isHidden());
  // The user chooses a profile together with the rule set that it names; the command line finds this file next to the
  // profile.
  const rules = readFileSync(new URL('../../rules/flagred.yaml', import.meta.url), 'utf8').replace('unsteady_lately IS stormy AND at_limit IS none THEN risk IS very_high', 'unsteady_lately IS stormy AND at_limit IS none THEN risk IS very_low');
  const there = folder({ [basename(GUST)]: readFileSync(GUST), 'mine.yaml': profile.replace('rules: flagred ', 'rules: mild.yaml '), 'mild.yaml': rules });
  await page.getByLabel('Profile from a file').setInputFiles([`${there}/mild.yaml`, `${there}/mine.yaml`]);
  const { out } = await command([`${there}/${basename(GUST)}`], '--json', '--profile', 'mine.yaml');
  await room.verdict(JSON.parse(out).verdict);
  await room.settled();
  assert.ok((await room.download('JSON')).content.equals(out), 'the JSON differs');
  await context.close();
});

test('flights are compared as the command line compares them', async () => {
  const there = folder({ 'steady.BIN': readFileSync(STEADY), 'gust.csv.gz': readFileSync(GUST) });
  const paths = [`${there}/steady.BIN`, `${there}/gust.csv.gz`];
  const { page, room, context, complaints } = await open();
  await room.take(...paths);
  assert.equal(await room.badge('steady.BIN'), 'GOOD');
  assert.equal(await room.badge('gust.csv.gz'), 'FAIL');
  await page.getByRole('button', { name: 'Compare' }).click();
  await page.locator('.report h1').filter({ hasText: '2 flights compared' }).waitFor();
  await room.settled();
  for (const [words, args] of [
    ['Report (HTML)', ['--html', '-']],
    ['Steps (CSV)', ['--csv']],
    ['JSON', ['--json']],
  ]) {
    const { content } = await room.download(words);
    assert.ok(content.equals((await command(paths, ...args)).out), `${words} differs`);
  }
  await page.getByRole('button', { name: 'Zoom in' }).click();
  await room.settled();
  const starts = await page.evaluate(() => [...document.querySelector('.report').shadowRoot.querySelectorAll('.panel')].map((panel) => Number(panel.dataset.start)));
  assert.ok(Math.abs(starts[0] - 48.8 - (starts[1] - 49)) < 0.2 && starts[0] > 90, `${starts}`);
  await page.locator('.report a').filter({ hasText: 'gust.csv.gz' }).click();
  await page.locator('.report h1').filter({ hasText: 'gust.csv.gz' }).waitFor();
  assert.equal(await page.getByRole('button', { name: 'Compare' }).getAttribute('aria-pressed'), 'false');
  assert.deepEqual(complaints, []);
  await context.close();
});

test('axe finds nothing serious', async () => {
  const axe = readFileSync(new URL('../node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');
  for (const colorScheme of ['light', 'dark']) {
    for (const viewport of [
      { width: 1280, height: 900 },
      { width: 390, height: 844 },
    ]) {
      const { page, room, context } = await open('#/flight', { colorScheme, viewport });
      const check = async (what) => {
        const found = await page.evaluate(async () => (await window.axe.run()).violations.map(({ id, impact, nodes }) => [impact, id, nodes[0].html.slice(0, 200), nodes[0].failureSummary]));
        const grave = found.filter(([impact]) => ['serious', 'critical'].includes(impact));
        assert.deepEqual(grave, [], `${what}, ${colorScheme}, ${viewport.width}`);
      };
      await page.evaluate(axe);
      await check('empty');
      await room.take(GUST);
      await room.badge(basename(GUST));
      await room.settled();
      await page.getByText('the thresholds were different?').click();
      await check('a report');
      await room.take({ name: 'no.log', mimeType: '', buffer: Buffer.from('nothing') });
      await room.badge('no.log');
      await room.row('no.log').locator('.log').click();
      await check('a refusal');
      await context.close();
    }
  }
});

test('nothing in a log is markup', async () => {
  const attack = '<img src=x onerror="window.attacked = true"><style>*{display:none}</style>';
  const csv = gustCsv().toString().replace('# firmware:', `# firmware: ${attack}`);
  const name = "<img src=x onerror='window.attacked=true'>.csv";
  const { page, room, context, complaints } = await open();
  await page.locator('.drop input').setInputFiles([
    { name, mimeType: 'text/csv', buffer: Buffer.from(csv) },
    { name: `no${name}`, mimeType: 'text/csv', buffer: Buffer.from(attack) },
  ]);
  assert.equal(await room.badge(name), 'FAIL');
  assert.equal(await room.badge(`no${name}`), 'error');
  await room.settled();
  await room.row(`no${name}`).locator('.log').click();
  await page.locator('.message pre').waitFor();
  const found = await page.evaluate(() => {
    const roots = [document, document.querySelector('.report').shadowRoot];
    return [window.attacked, ...roots.map((root) => root.querySelectorAll('img, body style, div style').length)];
  });
  assert.deepEqual(found, [undefined, 0, 0]);
  assert.match(await page.locator('.report').evaluate((element) => element.shadowRoot.textContent), /<img src=x onerror="window.attacked = true">/);
  assert.deepEqual(complaints, []);
  await context.close();
});

test('reading of a log can be cancelled, and the next one is read', async () => {
  const { page, room, context } = await open();
  // The log is long enough to be cancelled during reading: the same rows repeated at later times.
  const [head, rows] = gustCsv().toString().split(/(?<=t_s,.*\n)/);
  const lines = rows.trimEnd().split('\n');
  const parts = Array.from({ length: 60 }, (_, i) => lines.map((line) => line.replace(/^[\d.]+/, (t) => String(Number(t) + 200 * i))).join('\n'));
  const there = folder({ 'long.csv': `${head}${parts.join('\n')}\n`, 'gust.csv.gz': readFileSync(GUST) });
  await room.take(`${there}/long.csv`, `${there}/gust.csv.gz`);
  await page.getByRole('button', { name: 'Cancel long.csv' }).click();
  assert.equal(await room.badge('gust.csv.gz'), 'FAIL');
  assert.equal(await room.row('long.csv').count(), 0);
  await context.close();
});

test('the page as a single file reads logs, too', async () => {
  const { page, context, complaints } = await tab(chromium, `${pathToFileURL(studio).href}#/flight?example=gust`);
  const flights = room(page);
  assert.equal(await flights.badge('octocopter-in-a-gust.csv.gz'), 'FAIL');
  await flights.settled();
  await flights.take(STEADY);
  assert.equal(await flights.badge('steady.BIN'), 'GOOD');
  assert.deepEqual(complaints, []);
  await context.close();
});

test('a link to the example opens it, on a phone too', async () => {
  const { page, room, context, complaints } = await open('#/flight?example=gust&t=100&from=90&to=120', {
    viewport: { width: 390, height: 844 },
    hasTouch: true,
    isMobile: true,
  });
  await room.settled();
  const [width, start] = await page.evaluate(() => [
    document.documentElement.scrollWidth,
    document.querySelector('.report').shadowRoot.querySelector('.panel').dataset.start,
  ]);
  assert.equal(width, 390);
  assert.equal(Number(start), 90);
  assert.equal(await page.locator('.moment .log-time').textContent(), '100.0 s of the log');
  assert.equal(await page.locator('.moment summary b').textContent(), '0:51.0 min');
  const area = page.locator('.report .panel .area').first();
  await area.evaluate((element) => element.scrollIntoView({ block: 'center' }));
  const box = await area.boundingBox();
  await page.touchscreen.tap(box.x + box.width / 2, box.y + 20);
  await page.waitForTimeout(300);
  assert.ok(Math.abs(await room.time() - 105) < 0.5);
  assert.deepEqual(complaints, []);
  await context.close();
});
