/**
 * A table of variables, terms and rules, which forms add, change, rename and remove. Each change is an edit of the text.
 */

import type { DrawnVariable, Edit, Parts, TermFields } from 'flagred';
import { fill, h } from '../dom';

/** The changes that forms make. Each returns the edits of the text, or fails with a message for the user. */
export interface Changes {
  rename(at: number, name: string): Promise<Edit[]>;
  addVariable(name: string, low: number, high: number, isOutput: boolean): Promise<Edit[]>;
  addTerm(variable: number, name: string): Promise<Edit[]>;
  removeNamed(variable: number, term?: number): Promise<Edit[]>;
  setRange(variable: number, low: number, high: number): Promise<Edit[]>;
  setUnit(variable: number, unit: string): Promise<Edit[]>;
  setShape(variable: number, term: number, shape: string): Promise<Edit[]>;
  setParameters(variable: number, term: number, to: string): Promise<Edit[]>;
  addRule(rule: string): Promise<Edit[]>;
  changeRule(rule: number, to: string): Promise<Edit[]>;
  removeRule(rule: number): Promise<Edit[]>;
}

export interface Table {
  element: HTMLElement;
  /** Shows the parts of a rule set; the table is empty if `parts` is `null`. */
  show(parts: Parts | null, variables: DrawnVariable[]): void;
}

/**
 * Creates the table. `change` makes a change of the text, and returns the reason if it was refused. `say` shows such a
 * reason if it does not belong to a box.
 */
export function table(
  changes: Changes,
  change: (run: () => Promise<Edit[]>) => Promise<string | undefined>,
  say: (message: string) => void,
): Table {
  const element = h('div', { class: 'parts' });
  let shape = '';
  let messages = 0;

  async function made(run: () => Promise<Edit[]>): Promise<boolean> {
    const refusal = await change(run);
    if (refusal) say(refusal);
    return refusal === undefined;
  }

  const button = (words: string, label: string, key: string, run: () => Promise<Edit[]>) =>
    h('button', { type: 'button', class: 'small', 'aria-label': label, title: label, 'data-key': key, onclick: () => void made(run) }, words);

  /** Shows the reason below a box, or removes it. */
  function mark(box: HTMLElement, refusal: string | undefined): void {
    const old = box.getAttribute('aria-describedby');
    if (old) box.ownerDocument.getElementById(old)?.remove();
    for (const name of ['aria-invalid', 'aria-describedby']) box.removeAttribute(name);
    if (!refusal) return;
    const id = `refusal-${messages++}`;
    box.setAttribute('aria-invalid', 'true');
    box.setAttribute('aria-describedby', id);
    box.closest('li, .cell')!.append(h('p', { class: 'refusal', role: 'alert', id }, refusal));
  }

  /** A box whose content can be edited. If the change is refused, the reason is shown and Escape restores the old content. */
  function box(label: string, value: string, key: string, run: (value: string) => Promise<Edit[]>, type = 'text'): HTMLInputElement {
    const input = h('input', { type, step: 'any', value, 'aria-label': label, 'data-key': key, spellcheck: 'false', autocapitalize: 'off' });
    input.addEventListener('change', () => {
      const next = input.value.trim();
      if (next === value) return mark(input, undefined);
      void change(() => run(next)).then((refusal) => mark(input, refusal));
    });
    input.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      input.value = value;
      mark(input, undefined);
    });
    return input;
  }

  const sized = (input: HTMLInputElement, size: number) => {
    input.size = size;
    return input;
  };

  /** A form whose boxes are emptied after a change was made. */
  function form(label: string, run: () => Promise<Edit[]>, ...children: (Node | string)[]): HTMLFormElement {
    const element = h('form', { 'aria-label': label }, ...children);
    element.addEventListener('submit', (event) => {
      event.preventDefault();
      void made(run).then((isMade) => isMade && element.reset());
    });
    return element;
  }

  /** The shape and the parameters of a term. */
  function shaped(of: string, { shape, parameters, names, isEditable, canChangeShape }: TermFields, shapes: string[], i: number, t: number): (Node | string)[] {
    if (!isEditable) return [h('span', { class: 'soft' }, shape === 'limit' ? 'the rest of the range' : `${shape}, edited as text: `), h('code', {}, parameters)];
    const label = `${names.length > 1 ? `Parameters (${names.join(', ')})` : `${shape[0]!.toUpperCase()}${shape.slice(1)}`} of ${of}`;
    const numbers = sized(box(label, parameters, `parameters-${i}-${t}`, (to) => changes.setParameters(i, t, to)), Math.max(5, Math.min(parameters.length, 24)));
    numbers.title = names.join(', ');
    if (!canChangeShape) return [h('span', { class: 'soft' }, shape), numbers];
    const known = shapes.includes(shape) ? shapes : [shape, ...shapes];
    const select = h('select', { 'aria-label': `Shape of ${of}`, 'data-key': `shape-${i}-${t}` }, ...known.map((name) => h('option', { value: name }, name.replaceAll('_', ' '))));
    select.value = shape;
    select.addEventListener('change', () => {
      void change(() => changes.setShape(i, t, select.value)).then((refusal) => {
        mark(select, refusal);
        if (refusal) select.value = shape;
      });
    });
    return [select, numbers];
  }

  function variableParts(variable: DrawnVariable, i: number, { at, terms }: Parts['variables'][number], shapes: string[]): HTMLElement {
    const { name, isOutput, low, high, unit } = variable;
    const kind = isOutput ? 'output' : 'input';
    const rows = terms.map((fields, t) => {
      const term = variable.terms[t]!.name;
      return h(
        'li',
        {},
        sized(box(`Name of term ${term} of ${name}`, term, `term-${i}-${t}`, (to) => changes.rename(fields.at, to)), Math.max(4, term.length)),
        ...shaped(`term ${term} of ${name}`, fields, shapes, i, t),
        button('×', `Remove term ${term} of ${name}`, `remove-${i}-${t}`, () => changes.removeNamed(i, t)),
      );
    });
    const added = h('input', { type: 'text', 'aria-label': `New term of ${name}`, placeholder: 'new term', required: true, size: 8, 'data-key': `new-${i}`, autocapitalize: 'off' });
    // Each box reads the other one when it is changed.
    const from: HTMLInputElement = box(`Lower end of the range of ${name}`, low === null ? '' : String(low), `low-${i}`, () => changes.setRange(i, from.valueAsNumber, to.valueAsNumber), 'number');
    const to: HTMLInputElement = box(`Upper end of the range of ${name}`, high === null ? '' : String(high), `high-${i}`, () => changes.setRange(i, from.valueAsNumber, to.valueAsNumber), 'number');
    const units = sized(box(`Unit of ${name}`, unit ?? '', `unit-${i}`, (to) => changes.setUnit(i, to)), 4);
    units.placeholder = 'unit';
    return h(
      'section',
      { 'aria-label': `${kind} ${name}` },
      h(
        'div',
        { class: 'cell' },
        sized(box(`Name of ${kind} ${name}`, name, `variable-${i}`, (to) => changes.rename(at, to)), Math.max(4, name.length)),
        h('span', { class: 'soft' }, kind),
        from,
        h('span', { class: 'soft' }, 'to'),
        to,
        units,
        button('×', `Remove ${kind} ${name}`, `remove-${i}`, () => changes.removeNamed(i)),
      ),
      h('ul', {}, ...rows, h('li', {}, form(`Add a term to ${name}`, () => changes.addTerm(i, added.value.trim()), added, h('button', { class: 'small', title: `Add a term to ${name}` }, 'Add')))),
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
      const now = JSON.stringify([parts, variables.map(({ name, isOutput, low, high, unit, terms }) => [name, isOutput, low, high, unit, terms.map((term) => term.name)])]);
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
        ...variables.map((variable, i) => variableParts(variable, i, parts.variables[i]!, parts.shapes)),
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
