/** The flight room. */

import type { App, Room } from '../app';
import { h } from '../dom';

/** Opens the room. */
export function open(root: HTMLElement, app: App): Room {
  const answer = h('output', {}, 'Drop a flight log here.');
  const choose = h('input', { type: 'file', 'aria-label': 'Flight log' });
  choose.addEventListener('change', async () => {
    const [file] = choose.files ?? [];
    if (file) answer.textContent = await app.engine.call('verdict', file, 'flagred').catch((error: Error) => error.message);
  });
  root.append(h('h1', {}, 'Flight'), choose, answer);
  return {};
}
