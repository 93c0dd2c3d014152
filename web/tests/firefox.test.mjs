// In Firefox, if it is installed, both rooms open, compute and react, without errors on the console.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { serve } from './page.mjs';
import { executable, firefox } from './firefox.mjs';

const skip = executable ? false : 'no Firefox (Debian: apt-get install firefox-esr), or name it in FIREFOX';

async function opened(t, room) {
  const server = await serve();
  t.after(server.close);
  const tab = await firefox(`${server.address}#/${room}`);
  t.after(tab.close);
  return tab;
}

test('a flight in Firefox: verdict, cursor, signals, track', { skip, timeout: 180_000 }, async (t) => {
  const { until, run, complaints } = await opened(t, 'flight');
  await until(`[...document.querySelectorAll('button')].find((button) => button.textContent === 'Try an example')`);
  await run(`[...document.querySelectorAll('button')].find((button) => button.textContent === 'Try an example').click()`);
  await until(`document.querySelector('.report')?.shadowRoot.querySelector('h1 .badge')?.textContent === 'FAIL'`);
  await until(`document.querySelector('.fired .rule')`);
  await run(`[...document.querySelectorAll('.offered label')].find((label) => label.textContent.startsWith('altitude_m')).click()`);
  const values = `[...document.querySelector('.report').shadowRoot.querySelectorAll('.panel')].map((panel) => panel.textContent)`;
  await until(`${values}.some((words) => /altitude_m.*CTUN|altitude_m.*\\d m/.test(words))`);
  const place = `document.querySelector('.report').shadowRoot.querySelector('.track output').textContent`;
  const before = await run(place);
  assert.match(before, /^\d+ m (north|south), \d+ m (east|west) of take-off$/);
  await run(`document.querySelector('.timebar input').focus()`);
  await run(`document.querySelector('.timebar input').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', shiftKey: true, bubbles: true }))`);
  await until(`${place} !== ${JSON.stringify(before)}`);
  assert.deepEqual(complaints, []);
});

test('a rule set in Firefox: text, map and reasons', { skip, timeout: 180_000 }, async (t) => {
  const { until, run, complaints } = await opened(t, 'rules');
  await until(`/\\d/.test(document.querySelector('.why')?.textContent)`);
  await until(`document.querySelector('.shapes svg')`);
  const before = await run(`document.querySelector('.why').textContent`);
  await run(`{
    const slider = [...document.querySelectorAll('.rules input[type=range]')].find((slider) => slider.value !== slider.max);
    slider.value = slider.max;
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  }`);
  await until(`document.querySelector('.why').textContent !== ${JSON.stringify(before)}`);
  assert.deepEqual(complaints, []);
});
