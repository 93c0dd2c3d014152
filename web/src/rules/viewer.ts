/** The rule viewer: a row for each rule with its terms, their degrees at the point, and the result. */

import type { DrawnVariable, ViewedRules } from 'flagred';
import { fill, h } from '../dom';
import { s, set } from '../svg';
import type { Reasons } from './calls';
import { clamp, short, told } from './numbers';

/** The size of the picture of a term, in its own units. */
const WIDTH = 100;
const HEIGHT = 32;

export interface Viewer {
  element: HTMLElement;
  /** Shows the rules, and the degree of each proposition at a point. */
  show(reasons: Reasons, point: number[]): void;
}

interface Cell {
  /** The index of the variable. */
  variable: number;
  term: string | null;
  curve: number[];
  /** The position of a term that is a number instead of a set. */
  stick: number | undefined;
  whole: SVGPathElement;
  cut: SVGPathElement;
  line: SVGLineElement | undefined;
  degree: HTMLElement;
  /** A key of the current drawing. The cell is redrawn only if its key changes. */
  drawn: string;
}

interface Row {
  row: HTMLElement;
  conditions: Cell[];
  conclusions: Cell[];
  strength: HTMLElement;
}

export function viewer(moved: (input: number, value: number) => void): Viewer {
  const table = h('table', {});
  const element = h('div', { class: 'viewer', tabindex: 0, role: 'region', 'aria-label': 'Rules at this point' }, table);
  let variables: DrawnVariable[] = [];
  let rows: Row[] = [];
  let results: { variable: number; path: SVGPathElement; line: SVGLineElement; words: HTMLElement }[] = [];
  let shape = '';

  const across = (variable: DrawnVariable, x: number) => {
    const [low, high] = part(variable);
    return clamp((WIDTH * (x - low)) / (high - low || 1), 0, WIDTH);
  };
  const up = (degree: number) => HEIGHT * (1 - clamp(degree, 0, 1));

  function outline(variable: DrawnVariable, curve: number[], degree = (y: number) => y): string {
    if (curve.length < 4) return '';
    let path = `M${across(variable, curve[0]!).toFixed(1)} ${HEIGHT}`;
    for (let i = 0; i + 1 < curve.length; i += 2) path += `L${across(variable, curve[i]!).toFixed(1)} ${up(degree(curve[i + 1]!)).toFixed(1)}`;
    return `${path}V${HEIGHT}Z`;
  }

  /** The part of a set that remains at a degree: cut off at it, or scaled by it. */
  function left(variable: DrawnVariable, curve: number[], stick: number | undefined, degree: number, isScaled: boolean): string {
    if (!(degree > 0)) return '';
    if (stick !== undefined) return `M${across(variable, stick)} ${HEIGHT}V${up(degree)}`;
    return isScaled ? outline(variable, curve, (y) => y * degree) : outline(variable, crossed(curve, degree), (y) => Math.min(y, degree));
  }

  /** The curve of a term with its hedges. A term that is a number has a position instead. */
  function form(variable: DrawnVariable, term: string | null, hedged: number[]): Pick<Cell, 'curve' | 'stick'> {
    const drawn = variable.terms.find((known) => known.name === term);
    const curve = hedged.length > 0 ? hedged : (drawn?.curve ?? []);
    return { curve, stick: curve.length === 0 ? drawn?.handles[0]?.x : undefined };
  }

  /** Makes the line of an input draggable, in every row. */
  function draggable(svg: SVGSVGElement, variable: number): void {
    const move = (event: PointerEvent) => {
      const box = svg.getBoundingClientRect();
      const [low, high] = part(variables[variable]!);
      moved(variable, clamp(low + ((event.clientX - box.left) / box.width) * (high - low), low, high));
    };
    svg.classList.add('moves');
    svg.addEventListener('pointerdown', (event) => {
      svg.setPointerCapture(event.pointerId);
      move(event);
    });
    svg.addEventListener('pointermove', (event) => svg.hasPointerCapture(event.pointerId) && move(event));
  }

  function cell(name: string, term: string | null, words: string, isInput: boolean): [HTMLElement, Cell] | undefined {
    const variable = variables.findIndex((known) => known.name === name);
    const of = variables[variable];
    if (!of) return undefined;
    const [whole, cut] = [s('path', { class: 'whole' }), s('path', { class: 'cut' })];
    const line = isInput && !of.isOutput ? s('line', { class: 'at', y1: 0, y2: HEIGHT }) : undefined;
    const svg = s('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true' }, whole, cut, ...(line ? [line] : []));
    if (line) draggable(svg, variable);
    const degree = h('span', { class: 'degree' });
    const element = h('div', { class: 'part' }, svg, h('span', { class: 'words' }, words), ' ', degree);
    return [element, { variable, term, curve: [], stick: undefined, whole, cut, line, degree, drawn: '' }];
  }

  function row(rule: ViewedRules['rules'][number], index: number, columns: number[]): Row {
    const conditions = rule.conditions.map((one) => cell(one.variable, one.term, one.words, true));
    const conclusions = rule.conclusions.map((one) => cell(one.output, one.term, one.words, false));
    const strength = h('td', { class: 'strength' });
    const cells = columns.map((column) => {
      const here = [...conditions, ...conclusions].filter((made) => made?.[1].variable === column);
      return h('td', {}, ...here.map((made) => made![0]));
    });
    const element = h('tr', {}, h('th', { scope: 'row' }, index + 1), ...cells, strength);
    const cellsOf = (all: (typeof conditions)[number][]) => all.flatMap((made) => (made ? [made[1]] : []));
    return { row: element, conditions: cellsOf(conditions), conclusions: cellsOf(conclusions), strength };
  }

  /** The rows for these rules. */
  function build(rules: ViewedRules['rules']): void {
    const used = new Set(rules.flatMap(({ conditions, conclusions }) => [...conditions.map((one) => one.variable), ...conclusions.map((one) => one.output)]));
    const columns = variables.flatMap(({ name }, i) => (used.has(name) ? [i] : []));
    rows = rules.map((rule, i) => row(rule, i, columns));
    results = [];
    const last = columns.map((column) => {
      if (!variables[column]!.isOutput) return h('td', {});
      const [path, line, words] = [s('path', { class: 'cut' }), s('line', { class: 'at', y1: 0, y2: HEIGHT }), h('b', {})];
      results.push({ variable: column, path, line, words });
      return h('td', {}, h('div', { class: 'part' }, s('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true' }, path, line), words));
    });
    const heads = ['Rule', ...columns.map((column) => variables[column]!.name), 'Strength'];
    fill(
      table,
      h('thead', {}, h('tr', {}, ...heads.map((words) => h('th', { scope: 'col' }, ...broken(words))))),
      h('tbody', {}, ...rows.map((one) => one.row)),
      h('tfoot', {}, h('tr', {}, h('th', { scope: 'row' }, 'Result'), ...last, h('td', {}))),
    );
  }

  function draw(one: Cell, hedged: number[], degree: number, isScaled: boolean): void {
    const of = variables[one.variable]!;
    const { curve, stick } = form(of, one.term, hedged);
    const now = JSON.stringify([curve, stick, degree, of.shown]);
    if (one.drawn === now) return;
    one.drawn = now;
    for (const path of [one.whole, one.cut]) path.classList.toggle('stick', stick !== undefined);
    one.whole.setAttribute('d', left(of, curve, stick, 1, false));
    one.cut.setAttribute('d', left(of, curve, stick, degree, isScaled));
    one.degree.textContent = Number.isNaN(degree) ? '' : short(Number(degree.toFixed(3)));
  }

  /** Places a line at a value, or hides it if there is no value. */
  function place(line: SVGLineElement, variable: number, value: number | null | undefined): void {
    line.style.display = typeof value === 'number' ? '' : 'none';
    if (typeof value === 'number') set(line, { x1: across(variables[variable]!, value), x2: across(variables[variable]!, value) });
  }

  return {
    element,
    show({ viewed, variables: next, degrees, explanation }, point) {
      variables = next;
      const words = viewed.rules.map(({ conditions, conclusions }) => [conditions.map((one) => [one.variable, one.words]), conclusions.map((one) => [one.output, one.words])]);
      const now = JSON.stringify([words, next.map(({ name, isOutput }) => [name, isOutput])]);
      if (now !== shape) build(viewed.rules);
      shape = now;
      const strengths = new Map(explanation.rules.map(({ rule, strength, lower }) => [rule, { strength, lower }]));
      const parts = new Map<number, string>();
      let at = 0;
      rows.forEach(({ row, conditions, conclusions, strength }, i) => {
        const rule = viewed.rules[i]!;
        const { strength: fired, lower } = strengths.get(i + 1) ?? { strength: 0, lower: null };
        row.classList.toggle('fires', fired > 0);
        const least = typeof lower === 'number' ? `${lower.toFixed(3)} to ` : '';
        strength.textContent = fired > 0 ? least + fired.toFixed(3) : '0';
        conditions.forEach((one, c) => {
          draw(one, rule.conditions[c]!.curve, degrees[at++] ?? NaN, false);
          if (one.line) place(one.line, one.variable, point[one.variable]);
        });
        for (const one of conclusions) {
          draw(one, [], fired, viewed.scales);
          if (fired > 0) parts.set(one.variable, (parts.get(one.variable) ?? '') + one.cut.getAttribute('d'));
        }
      });
      for (const { variable, path, line, words } of results) {
        const of = variables[variable]!;
        const value = explanation.outputs.find(({ name }) => name === of.name)?.value ?? null;
        path.setAttribute('d', parts.get(variable) ?? '');
        path.classList.toggle('stick', of.terms.every(({ curve }) => curve.length === 0));
        words.textContent = told(value, of.unit);
        place(line, variable, value);
      }
    },
  };
}

/** The part of a variable that is drawn: where its terms change. */
const part = ({ shown: [from, to], low, high }: DrawnVariable): [number, number] => [from ?? low ?? 0, to ?? high ?? 1];

/** A name that may be broken at its underscores. */
const broken = (name: string): (Node | string)[] => name.split(/(?<=_)/).flatMap((piece, i) => (i > 0 ? [h('wbr', {}), piece] : [piece]));

/** A curve with points added where it crosses a degree. */
function crossed(curve: number[], degree: number): number[] {
  const made: number[] = [];
  for (let i = 0; i + 1 < curve.length; i += 2) {
    const [x, y] = [curve[i]!, curve[i + 1]!];
    if (i >= 2) {
      const [x0, y0] = [curve[i - 2]!, curve[i - 1]!];
      if ((y0 - degree) * (y - degree) < 0) made.push(x0 + ((degree - y0) / (y - y0)) * (x - x0), degree);
    }
    made.push(x, y);
  }
  return made;
}
