/** Explains the outputs at a point: the rules that fire, and how strongly. */

import type { About, Explanation } from 'flagred';
import { fill, h } from '../dom';
import { short, told } from './numbers';

/** Shows the explanation in `place`. */
export function explain(place: HTMLElement, about: About, { outputs, rules, inputs }: Explanation): void {
  const values = outputs.map((output, i) => {
    const known = about.outputs[i];
    return h(
      'p',
      { class: 'value' },
      h('span', { class: 'soft' }, `${output.name} `),
      h('b', {}, output.value === null ? 'unknown' : told(output.value, known?.unit ?? null)),
      typeof output.low === 'number' && typeof output.high === 'number' && h('span', { class: 'soft' }, ` from ${between(output.low, output.high)}`),
      output.value === null && h('span', { class: 'soft' }, ' no rule fires'),
      output.is_default && h('span', { class: 'soft' }, ' the default: no rule fires'),
    );
  });
  const fired = rules.map(({ rule, text, strength, lower }) => {
    const bar = h('span', { class: 'bar' });
    bar.style.inlineSize = `${100 * Math.min(strength, 1)}%`;
    bar.style.opacity = String(0.35 + 0.65 * Math.min(strength, 1));
    return h('li', { value: rule }, h('div', {}, h('span', { class: 'track', 'aria-hidden': 'true' }, bar), h('span', { class: 'strength' }, strength.toFixed(3)), h('code', {}, text, typeof lower === 'number' && h('span', { class: 'soft' }, ` at least ${lower.toFixed(3)}`))));
  });
  const degrees = inputs.map((input, i) => {
    const terms = input.terms.filter(({ degree }) => degree > 0).map(({ term, degree, lower }) => `${term} ${typeof lower === 'number' ? between(lower, degree) : short(degree)}`);
    const unit = about.inputs[i]?.unit ?? null;
    return h('li', {}, h('b', {}, input.name), ` ${told(input.value, unit)} `, h('span', { class: 'soft' }, terms.join(', ') || 'degree 0 in every term'));
  });
  fill(
    place,
    h('div', { class: 'values' }, ...values),
    fired.length > 0 && h('ol', { class: 'fired', 'aria-label': 'Rules that fire' }, ...fired),
    h('ul', { class: 'degrees', 'aria-label': 'Inputs and their terms' }, ...degrees),
  );
}

/** The bounds that interval type-2 terms give to a number. */
const between = (low: number, high: number): string => `${short(low)} to ${short(high)}`;
