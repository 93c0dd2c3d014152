/** The menu of signals that are drawn below the risk. */

import type { SignalLabel } from 'flagred';
import { fill, h } from '../dom';
import { menu } from './download';

export interface Picker {
  element: HTMLElement;
  /** Offers the signals of a flight, of which some are chosen. */
  show(offered: readonly SignalLabel[], chosen: readonly string[]): void;
}

/** Creates the menu; `choose` receives all chosen signals, in the order in which they were chosen. */
export function picker(choose: (names: string[]) => void): Picker {
  let chosen: string[] = [];
  const search = h('input', { type: 'search', placeholder: 'Search', 'aria-label': 'Search the signals' });
  const list = h('div', { class: 'offered' });
  const none = h('p', { class: 'soft', hidden: true }, 'The log has no signals.');
  const element = menu('Signals', h('div', { class: 'menu-body signals' }, search, list, none));
  search.addEventListener('input', () => {
    const wanted = search.value.toLowerCase();
    for (const row of list.children) (row as HTMLElement).hidden = !row.textContent!.toLowerCase().includes(wanted);
  });
  const row = ({ name, unit, source }: SignalLabel) => {
    const box = h('input', { type: 'checkbox', checked: chosen.includes(name) });
    box.addEventListener('change', () => {
      chosen = box.checked ? [...chosen, name] : chosen.filter((other) => other !== name);
      choose(chosen);
    });
    // A source that contains the name of the signal, such as the column of a flight CSV, is not shown.
    const words = [source.includes(name) ? '' : source, unit].filter(Boolean).join(', ');
    return h('label', {}, box, h('span', {}, name), h('span', { class: 'soft' }, words));
  };
  return {
    element,
    show(offered, names) {
      chosen = [...names];
      fill(list, ...offered.map(row));
      none.hidden = offered.length > 0;
      search.hidden = offered.length === 0;
      search.value = '';
    },
  };
}
