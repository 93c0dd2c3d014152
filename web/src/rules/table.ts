/** A table of variables, terms and rules, which forms add, rename and remove. Each change is an edit of the text. */

import type { DrawnVariable, Edit, Parts } from 'flagred';
import { fill, h } from '../dom';
import { short } from './numbers';

/** The changes that forms make. Each returns the edits of the text, or fails with a message for the user. */
export interface Changes {
  rename(at: number, name: string): Promise<Edit[]>;
  addVariable(name: string, low: number, high: number, isOutput: boolean): Promise<Edit[]>;
  addTerm(variable: number, name: string): Promise<Edit[]>;
  removeNamed(variable: number, term?: number): Promise<Edit[]>;
  addRule(rule: string): Promise<Edit[]>;
  changeRule(rule: number, to: string): Promise<Edit[]>;
  removeRule(rule: number): Promise<Edit[]>;
}

export interface Table {
  element: HTMLElement;
  /** Shows the parts of a rule set; the table is empty if `parts` is `null`. */
  show(parts: Parts | null, variables: DrawnVariable[]): void;
}

/** Creates the table. `change` makes a change of the text, and returns whether it was made. */
export function table(changes: Changes, change: (run: () => Promise<Edit[]>) => Promise<boolean>): Table {
  const element = h('div', { class: 'parts' });
  let shape = '';

  const button = (words: string, label: string, key: string, run: () => Promise<Edit[]>) =>
    h('button', { type: 'button', class: 'small', 'aria-label': label, title: label, 'data-key': key, onclick: () => void change(run) }, words);

  /** A box whose text can be edited; if the change is refused, the old text is restored. */
  function box(label: string, value: string, key: string, run: (value: string) => Promise<Edit[]>): HTMLInputElement {
    const input = h('input', { type: 'text', value, 'aria-label': label, 'data-key': key, spellcheck: 'false', autocapitalize: 'off' });
    input.addEventListener('change', () => {
      const next = input.value.trim();
      if (next === value) return;
      void change(() => run(next)).then((isMade) => isMade || (input.value = value));
    });
    input.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') input.value = value;
    });
    return input;
  }

  /** A form whose boxes are emptied after a change was made. */
  function form(label: string, run: () => Promise<Edit[]>, ...children: (Node | string)[]): HTMLFormElement {
    const made = h('form', { 'aria-label': label }, ...children);
    made.addEventListener('submit', (event) => {
      event.preventDefault();
      void change(run).then((isMade) => isMade && made.reset());
    });
    return made;
  }

  function variableRow(variable: DrawnVariable, i: number, { at, terms }: Parts['variables'][number]): HTMLElement {
    const { name, isOutput, low, high, unit } = variable;
    const kind = isOutput ? 'output' : 'input';
    const sized = (input: HTMLInputElement, text: string) => {
      input.size = Math.max(4, text.length);
      return input;
    };
    const chips = variable.terms.map((term, t) =>
      h(
        'li',
        {},
        sized(box(`Name of term ${term.name} of ${name}`, term.name, `term-${i}-${t}`, (to) => changes.rename(terms[t]!, to)), term.name),
        button('×', `Remove term ${term.name} of ${name}`, `remove-${i}-${t}`, () => changes.removeNamed(i, t)),
      ),
    );
    const added = h('input', { type: 'text', 'aria-label': `New term of ${name}`, placeholder: 'new term', required: true, size: 8, 'data-key': `new-${i}`, autocapitalize: 'off' });
    const range = low === null || high === null ? '' : `${short(low)} to ${short(high)}${unit ? ` ${unit}` : ''}`;
    return h(
      'tr',
      {},
      h('th', { scope: 'row' }, sized(box(`Name of ${kind} ${name}`, name, `variable-${i}`, (to) => changes.rename(at, to)), name), h('span', { class: 'soft' }, `${kind}, ${range}`)),
      h('td', {}, h('ul', {}, ...chips, h('li', {}, form(`Add a term to ${name}`, () => changes.addTerm(i, added.value.trim()), added, h('button', { class: 'small', title: `Add a term to ${name}` }, 'Add'))))),
      h('td', {}, button('×', `Remove ${kind} ${name}`, `remove-${i}`, () => changes.removeNamed(i))),
    );
  }

  function newVariable(): HTMLElement {
    const name = h('input', { type: 'text', 'aria-label': 'Name of the new variable', placeholder: 'new variable', required: true, size: 12, autocapitalize: 'off', 'data-key': 'new-variable' });
    const ends = ['0', '1'].map((value, i) => h('input', { type: 'number', step: 'any', value, required: true, 'aria-label': i ? 'Upper end of its range' : 'Lower end of its range' }));
    const kind = h('select', { 'aria-label': 'Input or output' }, h('option', {}, 'input'), h('option', {}, 'output'));
    const [low, high] = ends as [HTMLInputElement, HTMLInputElement];
    return form(
      'Add a variable',
      () => changes.addVariable(name.value.trim(), low.valueAsNumber, high.valueAsNumber, kind.value === 'output'),
      name, kind, h('label', {}, h('span', { class: 'soft' }, 'from '), low), h('label', {}, h('span', { class: 'soft' }, 'to '), high), h('button', {}, 'Add variable'),
    );
  }

  function newRule(variables: DrawnVariable[]): HTMLElement {
    const chosen = variables.map((variable) => {
      const { name, isOutput, terms } = variable;
      const any = isOutput ? 'not concluded' : 'any';
      const select = h('select', { 'aria-label': `${name} in the new rule` }, h('option', { value: '' }, any), ...terms.map((term) => h('option', { value: term.name }, term.name)));
      if (isOutput && variables.filter((other) => other.isOutput).length === 1) select.value = terms[0]?.name ?? '';
      return { variable, select };
    });
    const joined = h('select', { 'aria-label': 'Joined by' }, h('option', {}, 'AND'), h('option', {}, 'OR'));
    const parts = (isOutput: boolean) =>
      chosen
        .filter(({ variable, select }) => variable.isOutput === isOutput && select.value !== '')
        .map(({ variable, select }) => `${quoted(variable.name)} IS ${quoted(select.value)}`);
    const make = () => {
      const [conditions, conclusions] = [parts(false), parts(true)];
      if (conditions.length === 0) return Promise.reject(new Error('choose a term of an input for the new rule'));
      if (conclusions.length === 0) return Promise.reject(new Error('choose a term of an output for the new rule'));
      return changes.addRule(`IF ${conditions.join(` ${joined.value} `)} THEN ${conclusions.join(' AND ')}`);
    };
    const labelled = ({ variable, select }: (typeof chosen)[number]) => h('label', {}, h('span', { class: 'soft' }, `${variable.name} `), select);
    const inputs = chosen.filter(({ variable }) => !variable.isOutput);
    return form(
      'Add a rule', make,
      h('span', { class: 'soft' }, 'IF'), ...inputs.map(labelled), ...(inputs.length > 1 ? [joined] : []),
      h('span', { class: 'soft' }, 'THEN'), ...chosen.filter(({ variable }) => variable.isOutput).map(labelled), h('button', {}, 'Add rule'),
    );
  }

  return {
    element,
    show(parts, variables) {
      const now = JSON.stringify([parts?.variables.map(({ terms }) => terms.length), parts, variables.map(({ name, isOutput, low, high, unit, terms }) => [name, isOutput, low, high, unit, terms.map((term) => term.name)])]);
      if (now === shape) return;
      shape = now;
      if (!parts || parts.variables.length !== variables.length) {
        fill(element, h('p', { class: 'soft' }, 'The table shows rule sets whose text can be read. A profile is edited as text.'));
        return;
      }
      const focused = (element.contains(document.activeElement) ? document.activeElement : null) as HTMLElement | null;
      const key = focused?.dataset['key'];
      fill(
        element,
        h('h2', {}, 'Variables and terms'),
        h('table', {}, h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Variable'), h('th', { scope: 'col' }, 'Terms'), h('td', {}))), h('tbody', {}, ...variables.map((variable, i) => variableRow(variable, i, parts.variables[i]!)))),
        newVariable(),
        h('h2', {}, 'Rules'),
        h(
          'ol',
          {},
          ...parts.rules.map((rule, r) =>
            h('li', {}, h('div', {}, box(`Rule ${r + 1}`, rule, `rule-${r}`, (to) => changes.changeRule(r, to)), button('×', `Remove rule ${r + 1}`, `remove-rule-${r}`, () => changes.removeRule(r)))),
          ),
        ),
        newRule(variables),
      );
      if (key) element.querySelector<HTMLElement>(`[data-key="${key}"]`)?.focus();
    },
  };
}

/** A name as rules write it. */
const quoted = (name: string): string => (/^[\p{L}_][\p{L}\p{N}_-]*$/u.test(name) && !/^(if|is|and|or|then|with|not|any|very|somewhat|extremely|seldom)$/i.test(name) ? name : `'${name}'`);
