/** The table of logs: each is waiting, being read, assessed or refused. */

import type { Brief, SignalLabel, Stretch } from 'flagred';
import { fill, h } from '../dom';
import type { Log } from './calls';
import { minutes } from './time';

export interface Entry {
  log: Log;
  state: 'waiting' | 'reading' | 'done' | 'refused';
  /** The share of the file that has been read. */
  share: number;
  /** The assessment with the profile and its changes. */
  brief?: Brief;
  stretch?: Stretch;
  signals?: SignalLabel[];
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
      return '';
  }
}

/** The highest risk in judged time, or in a finding that extends beyond judged time. */
function highest({ summary, findings }: Brief): number | undefined {
  const ofRisk = findings.filter(({ measure, risk_output }) => measure === 'risk' && risk_output === undefined);
  const values = [summary.risk_max, ...ofRisk].flatMap((of) => (of ? [of.value_pct] : []));
  return values.length > 0 ? Math.max(...values) : undefined;
}

const GRAVITY: Record<Brief['verdict'], number> = { NA: 0, GOOD: 1, WARN: 2, FAIL: 3 };

/** The columns: heading, text, and what they are sorted by; unknown values come last. */
const COLUMNS: [string, (entry: Entry) => string, (entry: Entry) => number | string | undefined][] = [
  ['Verdict', () => '', ({ brief }) => brief && -GRAVITY[brief.verdict]],
  ['Flight', () => '', ({ log }) => log.file.name],
  ['Highest risk', ({ brief }) => percent(brief && highest(brief)), ({ brief }) => brief && -(highest(brief) ?? -1)],
  ['In the air', ({ brief }) => (brief ? `${minutes(brief.summary.in_air_s, 0)} min` : ''), ({ brief }) => brief && -brief.summary.in_air_s],
  ['Findings', ({ brief }) => (brief ? String(brief.findings.length) : ''), ({ brief }) => brief && -brief.findings.length],
];

const percent = (value: number | undefined) => (value === undefined ? '' : `${value.toFixed(0)} %`);

interface Row {
  element: HTMLElement;
  update(isCurrent: boolean): void;
}

/**
 * Creates the table; only changed entries are drawn again. It is hidden while it contains only the flight that the room
 * shows.
 */
export function logList(actions: Actions): LogList {
  const rows = new Map<Entry, Row>();
  let shown: { entries: readonly Entry[]; current: Entry | undefined } = { entries: [], current: undefined };
  /** The column that sorts the table, and whether in reverse. At first, logs are in the order in which they were added. */
  let sorted: { column: number; isReversed: boolean } | undefined;
  const heads = COLUMNS.map(([words], column) => {
    const button = h('button', { type: 'button' }, words);
    button.addEventListener('click', () => {
      sorted = { column, isReversed: sorted?.column === column && !sorted.isReversed };
      draw();
    });
    return h('th', { scope: 'col', class: column > 1 ? 'n' : null }, button);
  });
  const body = h('tbody', {});
  const table = h('table', {}, h('thead', {}, h('tr', {}, ...heads, h('td', {}))), body);
  const element = h('div', { class: 'logs', role: 'region', 'aria-label': 'Flights', tabindex: 0 }, table);

  function row(entry: Entry): Row {
    const mark = h('td', { class: 'mark' });
    const facts = h('span', { class: 'soft facts' });
    const progress = h('progress', { max: 1, 'aria-label': `Reading ${entry.log.file.name}` });
    const choose = h('button', { type: 'button', class: 'log' }, h('span', { class: 'name' }, entry.log.file.name));
    choose.addEventListener('click', () => actions.choose(entry));
    const remove = h('button', { type: 'button', class: 'remove' }, '×');
    remove.addEventListener('click', () => actions.remove(entry));
    const values = COLUMNS.slice(2).map(() => h('td', { class: 'n' }));
    const element = h('tr', {}, mark, h('td', {}, choose, facts, progress), ...values, h('td', {}, remove));
    return {
      element,
      update(isCurrent) {
        if (isCurrent) choose.setAttribute('aria-current', 'true');
        else choose.removeAttribute('aria-current');
        element.classList.toggle('current', isCurrent);
        const isBusy = entry.state === 'reading';
        progress.hidden = !isBusy;
        progress.value = entry.share;
        facts.textContent = entry.state === 'done' ? '' : `${about(entry)} · ${size(entry.log.file.size)}`;
        values.forEach((cell, i) => (cell.textContent = COLUMNS[i + 2]![1](entry)));
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

  function inOrder(entries: readonly Entry[]): Entry[] {
    if (!sorted) return [...entries];
    const { column, isReversed } = sorted;
    const key = COLUMNS[column]![2];
    const collator = new Intl.Collator(undefined, { numeric: true });
    return [...entries].sort((a, b) => {
      const [one, other] = [key(a), key(b)];
      if (one === undefined || other === undefined) return Number(one === undefined) - Number(other === undefined);
      const order = typeof one === 'number' && typeof other === 'number' ? one - other : collator.compare(String(one), String(other));
      return isReversed ? -order : order;
    });
  }

  function draw(): void {
    const { entries, current } = shown;
    const [only] = entries;
    element.hidden = !only || (entries.length === 1 && only.state === 'done');
    heads.forEach((head, column) => {
      const isSorted = sorted?.column === column;
      head.setAttribute('aria-sort', !isSorted ? 'none' : sorted!.isReversed ? 'descending' : 'ascending');
    });
    for (const [entry, { element }] of rows) {
      if (entries.includes(entry)) continue;
      element.remove();
      rows.delete(entry);
    }
    inOrder(entries).forEach((entry, i) => {
      let known = rows.get(entry);
      if (!known) rows.set(entry, (known = row(entry)));
      // An element that is moved loses the focus.
      if (body.children[i] !== known.element) body.insertBefore(known.element, body.children[i] ?? null);
      known.update(entry === current);
    });
  }

  return {
    element,
    show(entries, current) {
      shown = { entries, current };
      draw();
    },
  };
}
