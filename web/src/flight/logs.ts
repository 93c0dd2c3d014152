/** The list of logs: each is waiting, being read, assessed or refused. */

import type { Brief, Stretch } from 'flagred';
import { fill, h } from '../dom';
import type { Log } from './calls';

export interface Entry {
  log: Log;
  state: 'waiting' | 'reading' | 'done' | 'refused';
  /** The share of the file that has been read. */
  share: number;
  /** The assessment with the profile and its changes. */
  brief?: Brief;
  stretch?: Stretch;
  /** The verdict with the unchanged profile. */
  unchanged?: Brief['verdict'];
  /** The reason why there is no assessment, in the words of the command line. */
  refusal?: string;
}

export interface LogList {
  element: HTMLElement;
  show(entries: readonly Entry[], current: Entry | undefined): void;
}

interface Actions {
  choose(entry: Entry): void;
  remove(entry: Entry): void;
}

/** The class of a verdict in the style sheets. */
export const verdictClass = (verdict: Brief['verdict']): string =>
  ({ GOOD: 'good', INFO: 'good', WARN: 'warn', FAIL: 'fail', NA: 'na' })[verdict];

export const badge = (verdict: Brief['verdict']): HTMLElement => h('span', { class: `badge ${verdictClass(verdict)}` }, verdict);

const size = (bytes: number) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

function about(entry: Entry): string {
  switch (entry.state) {
    case 'waiting':
      return 'waiting';
    case 'reading':
      return entry.share < 1 ? `reading, ${Math.round(100 * entry.share)} %` : 'assessing';
    case 'refused':
      return 'cannot be used';
    case 'done':
      return `${(entry.brief?.summary.in_air_s ?? 0).toFixed(0)} s in the air`;
  }
}

/** Creates the list; only changed entries are drawn again. */
export function logList(actions: Actions): LogList {
  const list = h('ul', { class: 'logs', 'aria-label': 'Flights' });
  const rows = new Map<Entry, { element: HTMLElement; update(isCurrent: boolean): void }>();

  function row(entry: Entry): { element: HTMLElement; update(isCurrent: boolean): void } {
    const mark = h('span', { class: 'mark' });
    const name = h('span', { class: 'name' }, entry.log.file.name);
    const facts = h('span', { class: 'soft facts' });
    const progress = h('progress', { max: 1, 'aria-label': `Reading ${entry.log.file.name}` });
    const choose = h('button', { type: 'button', class: 'log' }, mark, h('span', { class: 'words' }, name, facts), progress);
    choose.addEventListener('click', () => actions.choose(entry));
    const remove = h('button', { type: 'button', class: 'remove' }, '×');
    remove.addEventListener('click', () => actions.remove(entry));
    return {
      element: h('li', {}, choose, remove),
      update(isCurrent) {
        if (isCurrent && !choose.hasAttribute('aria-current')) choose.scrollIntoView({ block: 'nearest', inline: 'nearest' });
        if (isCurrent) choose.setAttribute('aria-current', 'true');
        else choose.removeAttribute('aria-current');
        const isBusy = entry.state === 'reading';
        progress.hidden = !isBusy;
        progress.value = entry.share;
        facts.textContent = `${about(entry)} · ${size(entry.log.file.size)}`;
        remove.setAttribute('aria-label', `${isBusy ? 'Cancel' : 'Remove'} ${entry.log.file.name}`);
        remove.title = isBusy ? 'Cancel' : 'Remove';
        const badged = `${entry.state} ${entry.brief?.verdict}`;
        if (badged === mark.dataset['of']) return;
        mark.dataset['of'] = badged;
        if (entry.state === 'done' && entry.brief) fill(mark, badge(entry.brief.verdict));
        else if (entry.state === 'refused') fill(mark, h('span', { class: 'badge refused' }, 'error'));
        else fill(mark, h('span', { class: 'badge na' }, '…'));
      },
    };
  }

  return {
    element: list,
    show(entries, current) {
      for (const [entry, { element }] of rows) {
        if (entries.includes(entry)) continue;
        element.remove();
        rows.delete(entry);
      }
      for (const entry of entries) {
        let known = rows.get(entry);
        if (!known) {
          known = row(entry);
          rows.set(entry, known);
          list.append(known.element);
        }
        known.update(entry === current);
      }
    },
  };
}
