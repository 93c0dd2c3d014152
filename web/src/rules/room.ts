/** The rules room. */

import type { App, Room } from '../app';
import { h } from '../dom';

/** Opens the room. */
export function open(root: HTMLElement, app: App): Room {
  const text = h('textarea', { 'aria-label': 'Rule set' });
  const answer = h('pre', {});
  text.addEventListener('input', async () => {
    answer.textContent = JSON.stringify(await app.engine.call('findings', text.value), null, 1);
  });
  root.append(h('h1', {}, 'Rules'), text, answer);
  return {};
}
