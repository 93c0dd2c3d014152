/** The state at the time of the cursor, and the rules that fire. */

import type { Moment } from 'flagred';
import { fill, h, type Child } from '../dom';
import { said } from './charts';
import { minutes } from './time';

export interface MomentPanel {
  element: HTMLElement;
  /** Shows a moment of a flight that began at `zero_s`, in seconds on the log's clock. */
  show(moment: Moment, zero_s: number, events: string[]): void;
}

/** The maximum number of rules in the list; the others hardly matter. */
const MAX_RULES = 8;

const percent = (value: number | null | undefined) => (value === null || value === undefined ? 'unknown' : `${said(value)} %`);

/** The name of an input or output as words on one line. */
const wordsOf = (name: string) => name.replaceAll('_', '\u00a0');

const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

/** Creates a panel, which is empty at first. */
export function momentPanel(): MomentPanel {
  const head = h('summary', {}, 'At the cursor');
  const body = h('div', { class: 'moment-body' });
  // On a phone it covers the report, so it is closed at first.
  const open = matchMedia('(min-width: 64rem)').matches;
  const element = h('details', { class: 'moment card', open }, head, body);
  return {
    element,
    show(moment, zero_s, events) {
      const { step } = moment;
      fill(
        head,
        h('b', {}, `${minutes(moment.t_s - zero_s)} min`),
        h('span', { class: 'log-time soft' }, `${moment.t_s.toFixed(1)} s of the log`),
        moment.mode ? h('span', { class: 'mode' }, moment.mode) : null,
        h('span', { class: 'risk-now' }, `risk ${percent(step?.risk)}`),
      );
      fill(
        body,
        events.length > 0 ? h('p', { class: 'soft' }, events.join(' · ')) : null,
        facts(moment),
        rules(moment),
        inputs(moment),
      );
    },
  };
}

function facts({ step, filled_from, clamped }: Moment): Child {
  if (!step) return h('p', { class: 'soft' }, 'The assessment has no step at this time.');
  const rows: [string, string][] = [
    ['Risk', percent(step.risk)],
    ['Elevated risk', percent(step.elevated_risk)],
    ...Object.entries(step.other_risks ?? {}).map(([name, risk]): [string, string] => [capital(wordsOf(name)), percent(risk)]),
    ['Coverage', step.coverage === null ? 'unknown' : said(step.coverage)],
  ];
  const list = h('dl', { class: 'now' });
  for (const [name, value] of rows) list.append(h('div', {}, h('dt', {}, name), h('dd', {}, value)));
  const notes = [
    filled_from !== null && `Interpolated: no rule applies. The nearest inputs with a rule are ${said(100 * filled_from)} % of their ranges away.`,
    clamped && 'An input is outside its range; the end of the range is used.',
    !step.judged && 'Not judged: just after take-off, before landing, or on the ground.',
  ];
  return h('div', {}, list, ...notes.map((note) => note && h('p', { class: 'soft' }, note)));
}

function rules({ rules: fired, step }: Moment): Child {
  if (fired.length === 0) return step && h('p', { class: 'soft' }, 'No rule fires.');
  const list = h('ol', { class: 'fired' });
  for (const { rule, text, strength } of fired.slice(0, MAX_RULES)) {
    const meter = h('span', { class: 'bar' });
    meter.style.width = `${100 * strength}%`;
    list.append(
      h(
        'li',
        { class: rule === step?.dominant_rule ? 'dominant' : null },
        h('span', { class: 'strength' }, strength < 0.005 ? '<0.01' : strength.toFixed(2)),
        h('span', { class: 'rule' }, h('b', {}, `${rule} `), text),
        h('span', { class: 'track', 'aria-hidden': 'true' }, meter),
      ),
    );
  }
  const more = fired.length - MAX_RULES;
  return h(
    'div',
    {},
    h('h3', {}, fired.length === 1 ? '1 rule fires' : `${fired.length} rules fire`),
    list,
    more > 0 && h('p', { class: 'soft' }, `and ${more} weaker`),
  );
}

function inputs({ inputs: explained, step, units }: Moment): Child {
  if (explained.length === 0) {
    const unknown = Object.entries(step?.inputs ?? {}).flatMap(([name, value]) => (value === null ? [wordsOf(name)] : []));
    return unknown.length > 0 && h('p', { class: 'soft' }, `Unknown: ${unknown.join(', ')}.`);
  }
  const list = h('dl', { class: 'inputs' });
  for (const { name, given, terms } of explained) {
    const degrees = terms.filter(({ degree }) => degree >= 0.005).map(({ term, degree }) => `${term} ${degree.toFixed(2)}`);
    list.append(
      h('div', {}, h('dt', {}, wordsOf(name)), h('dd', {}, said(given, units[name]), h('span', { class: 'soft' }, ` ${degrees.join(', ')}`))),
    );
  }
  return h('div', {}, h('h3', {}, 'Inputs'), list);
}
