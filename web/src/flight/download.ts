/** The menu of files that can be downloaded for a flight. */

import { h } from '../dom';
import type { Download } from './calls';

export type Kind = Download | 'flight';

const WORDS: Record<Kind, string> = {
  html: 'Report (HTML)',
  csv: 'Steps (CSV)',
  json: 'JSON',
  flight: 'Flight CSV',
};

/** The endings of the file names. */
export const ENDINGS: Record<Kind, string> = { html: '.html', csv: '.steps.csv', json: '.json', flight: '.csv' };

/** Creates a menu that closes after a choice, or when the user clicks outside it. */
export function downloadMenu(choose: (kind: Kind) => void): HTMLElement {
  const body = h('div', { class: 'menu-body' });
  const element = menu('Download', body);
  for (const kind of Object.keys(WORDS) as Kind[]) {
    const button = h('button', { type: 'button' }, WORDS[kind]);
    button.addEventListener('click', () => {
      element.open = false;
      choose(kind);
    });
    body.append(button);
  }
  return element;
}

/** Creates a menu that closes when the user clicks outside it. */
export function menu(words: string, body: HTMLElement): HTMLDetailsElement {
  const menu = h('details', { class: 'menu' }, h('summary', { class: 'button' }, words), body);
  document.addEventListener('click', (event) => {
    if (!event.composedPath().includes(menu)) menu.open = false;
  });
  menu.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !menu.open) return;
    menu.open = false;
    menu.querySelector('summary')?.focus();
  });
  return menu;
}
