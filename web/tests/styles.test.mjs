// The style sheets of both rooms are on the page at the same time; neither must affect the other room.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { browser, repository, serve, tab } from './page.mjs';
import * as rooms from './rooms.mjs';

test('no style rule of one room matches in the other', { timeout: 120_000 }, async (t) => {
  const chromium = await browser();
  t.after(() => chromium.close());
  const server = await serve();
  t.after(server.close);
  const { page } = await tab(chromium, server.address);
  for (const [room, fill] of Object.entries(rooms)) {
    await page.getByRole('navigation').getByRole('link', { name: room }).click();
    await fill(page);
  }
  for (const [room, other] of [['flight', 'rules'], ['rules', 'flight']]) {
    const text = await readFile(join(repository, `web/src/${room}/${room}.css`), 'utf8');
    const strays = await page.evaluate(
      ([text, other]) => {
        const sheet = new CSSStyleSheet();
        sheet.replaceSync(text);
        const selectors = (rules) => [...rules].flatMap((rule) => (rule.selectorText ? [rule.selectorText] : selectors(rule.cssRules ?? [])));
        const inside = document.querySelector(`.room.${other}`);
        return selectors(sheet.cssRules).filter((selector) => inside.querySelector(selector.replaceAll(/::[\w-]+/g, '')));
      },
      [text, other],
    );
    assert.deepEqual(strays, [], `${room}.css in the room for ${other}`);
  }
});
