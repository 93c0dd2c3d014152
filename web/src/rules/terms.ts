/**
 * The terms of every variable as shapes. Their handles can be dragged by pointer, touch or keys, which changes the
 * text.
 */

import type { Colours, DrawnTerm, DrawnVariable, Handle } from 'flagred';
import { fill, h } from '../dom';
import { s, set } from '../svg';
import type { Place } from './calls';
import { clamp, short, ticks } from './numbers';

/** The size of the picture of a variable, in its own units. */
const WIDTH = 320;
const HEIGHT = 130;
const FRAME = { left: 20, right: 12, top: 12, bottom: 22 };
const INNER = { width: WIDTH - FRAME.left - FRAME.right, height: HEIGHT - FRAME.top - FRAME.bottom };
/** The distance by which a key moves a handle, as a share of the shown range. */
const KEY_STEP = 0.01;

export interface Terms {
  element: HTMLElement;
  show(variables: DrawnVariable[], isWhole: boolean): void;
  /** Marks the value of each input. */
  mark(point: number[]): void;
}

/** Receives the events of a drag. */
export interface Dragging {
  begin(): void;
  move(place: Place, x: number, degree: number): void;
  end(): void;
}

export function terms(colours: Colours, dragging: Dragging): Terms {
  const element = h('div', { class: 'terms' });
  let plots: Plot[] = [];
  let shape = '';
  return {
    element,
    show(variables, isWhole) {
      const now = JSON.stringify(variables.map((v) => [v.name, v.unit, v.terms.map((t) => [t.name, t.curve.length > 0, t.handles.length])]));
      if (now !== shape) {
        shape = now;
        plots = variables.map((variable, i) => plot(variable, i, colours, dragging));
        fill(element, ...plots.map((one) => one.element));
      }
      variables.forEach((variable, i) => plots[i]!.show(variable, isWhole));
    },
    mark: (point) => point.forEach((value, i) => plots[i]?.mark(value)),
  };
}

interface Plot {
  element: HTMLElement;
  show(variable: DrawnVariable, isWhole: boolean): void;
  mark(value: number): void;
}

function plot(first: DrawnVariable, index: number, { distinct, lines }: Colours, dragging: Dragging): Plot {
  let variable = first;
  let drawn = '';
  let [low, high] = [0, 1];
  const across = (x: number) => FRAME.left + (INNER.width * (x - low)) / (high - low);
  const up = (degree: number) => FRAME.top + INNER.height * (1 - degree);
  /** Gives an element the colours of a term, for light and dark backgrounds. */
  function coloured<E extends HTMLElement | SVGElement>(element: E, term: number): E {
    element.classList.add('term');
    for (const [name, all] of [['--light', lines], ['--dark', distinct]] as const) {
      const at = 3 * (term % (all.length / 3));
      element.style.setProperty(name, `rgb(${all[at]} ${all[at + 1]} ${all[at + 2]})`);
    }
    return element;
  }

  const grid = s('g', { class: 'grid' });
  const line = s('line', { class: 'mark', y1: FRAME.top, y2: FRAME.top + INNER.height });
  line.style.display = 'none';
  const curves = first.terms.map((_, t) => coloured(s('path', { class: 'curve' }), t));
  const clip = `clip-${index}`;
  const frame = s('rect', { x: FRAME.left, y: FRAME.top - 3, width: INNER.width, height: INNER.height + 6 });
  const svg = s('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'group', 'aria-label': `Terms of ${first.name}` });
  const points = first.terms.map((term, t) => term.handles.map((_, i) => handle(t, i)));
  svg.append(
    s('defs', {}, s('clipPath', { id: clip }, frame)),
    grid,
    s('g', { 'clip-path': `url(#${clip})` }, ...curves),
    line,
    ...points.flat().map((point) => point.element),
  );
  const told = h('output', { class: 'soft' });
  /** The point that was moved last. */
  let moved: [term: number, handle: number] | undefined;
  const legend = first.terms.map((term, t) => {
    return h('li', {}, coloured(h('span', { class: 'swatch', 'aria-hidden': 'true' }), t), term.name);
  });
  const type2 = h('span', { class: 'tag', title: 'Shaded from the lower to the upper membership function' }, 'interval type-2');
  const element = h(
    'section',
    { class: 'variable', 'aria-label': first.name },
    h('h3', {}, first.name, first.unit && h('span', { class: 'soft' }, ` ${first.unit}`), first.isOutput && h('span', { class: 'tag' }, 'output'), type2),
    h('ul', { class: 'legend' }, ...legend),
    h('div', { class: 'picture' }),
    told,
  );
  element.querySelector('.picture')!.append(svg);

  function handle(t: number, i: number): { element: SVGGElement; show(term: DrawnTerm, handle: Handle): void } {
    const dot = coloured(s('circle', { class: 'dot', r: 5 }), t);
    const group = s('g', { class: 'handle', tabindex: 0, role: 'slider' }, s('circle', { class: 'reach', r: 16 }), dot);
    const place: Place = { variable: index, term: t, handle: i };
    /** The position to which the handle was moved, until it is drawn there. */
    let aim: { x: number; degree: number } | undefined;
    const now = () => ({ ...variable.terms[t]!.handles[i]!, ...aim });
    const move = (x: number, degree: number) => {
      aim = { x: clamp(x, now().low, now().high), degree: clamp(degree, 0, 1) };
      dragging.move(place, aim.x, aim.degree);
    };

    let toSvg = new DOMMatrix();
    group.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      group.focus({ preventScroll: true });
      // Computed once, because it requires a layout of the page.
      toSvg = svg.getScreenCTM()!.inverse();
      group.setPointerCapture(event.pointerId);
      group.classList.add('held');
      dragging.begin();
    });
    group.addEventListener('pointermove', (event) => {
      if (!group.hasPointerCapture(event.pointerId)) return;
      const there = new DOMPoint(event.clientX, event.clientY).matrixTransform(toSvg);
      move(low + ((there.x - FRAME.left) / INNER.width) * (high - low), 1 - (there.y - FRAME.top) / INNER.height);
    });
    group.addEventListener('lostpointercapture', () => {
      group.classList.remove('held');
      dragging.end();
    });
    group.addEventListener('keydown', (event) => {
      const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
      if (!dx && !dy) return;
      event.preventDefault();
      const { x, degree, movesDegree } = now();
      // If a handle only moves left and right, up means right, as for sliders.
      const steps = movesDegree ? dx! : dx! + dy!;
      const by = KEY_STEP * (event.shiftKey ? 0.1 : 1);
      dragging.begin();
      move(x + steps * by * (high - low), degree + (movesDegree ? dy! : 0) * by);
      dragging.end();
    });
    return {
      element: group,
      show(term, { name, x, degree, low, high }) {
        aim = undefined;
        group.setAttribute('transform', `translate(${across(x)} ${up(degree)})`);
        const words = `${term.name}: ${name} ${short(x)}`;
        set(group, {
          'aria-label': `${term.name}: ${name}`,
          'aria-valuemin': low,
          'aria-valuemax': high,
          'aria-valuenow': x,
          'aria-valuetext': variable.unit ? `${short(x)} ${variable.unit}` : short(x),
        });
        // A handle beyond the shown range cannot be grabbed.
        group.style.display = across(x) < FRAME.left - 1 || across(x) > WIDTH - FRAME.right + 1 ? 'none' : '';
        if (group.classList.contains('held') || document.activeElement === group) moved = [t, i];
        if (moved?.[0] === t && moved[1] === i) told.textContent = words;
      },
    };
  }

  function show(next: DrawnVariable, isWhole: boolean): void {
    const now = JSON.stringify([next, isWhole]);
    if (now === drawn) return;
    drawn = now;
    variable = next;
    const [from, to] = isWhole ? [next.low, next.high] : next.shown;
    if (from === null || to === null || from === undefined || to === undefined) {
      told.textContent = 'The range cannot be read.';
      return;
    }
    type2.hidden = next.terms.every(({ lower }) => lower.length === 0);
    // The shown range does not change while a handle is held; otherwise the handle would move away from the pointer.
    if (!svg.querySelector('.held') || low === high) [low, high] = [from, to];
    ruled();
    next.terms.forEach((term, t) => {
      curves[t]!.setAttribute('d', outline(term.curve, term.handles) + outline(term.lower, []));
      curves[t]!.classList.toggle('footprint', term.lower.length > 0);
      term.handles.forEach((one, i) => points[t]![i]!.show(term, one));
    });
  }

  let ruledFor = '';
  /** Draws the lines and numbers behind the curves. */
  function ruled(): void {
    if (ruledFor === `${low} ${high}`) return;
    ruledFor = `${low} ${high}`;
    const labels = ticks(low, high, 5).map((tick) => {
      const text = s('text', { x: across(tick), y: HEIGHT - 6 });
      text.textContent = short(tick);
      return [s('line', { x1: across(tick), x2: across(tick), y1: FRAME.top, y2: FRAME.top + INNER.height }), text];
    });
    const degrees = [0, 1].map((degree) => {
      const text = s('text', { x: FRAME.left - 6, y: up(degree) + 4, class: 'degree' });
      text.textContent = String(degree);
      return [s('line', { x1: FRAME.left, x2: WIDTH - FRAME.right, y1: up(degree), y2: up(degree) }), text];
    });
    grid.replaceChildren(...labels.flat(), ...degrees.flat());
  }

  /** The outline of a term: a curve for a set, a line for a number. */
  function outline(curve: number[], handles: Handle[]): string {
    const places: string[] = [];
    for (let i = 0; i + 1 < curve.length; i += 2) places.push(`${across(curve[i]!).toFixed(2)} ${up(curve[i + 1]!).toFixed(2)}`);
    if (places.length > 0) return `M${across(curve[0]!)} ${up(0)}L${places.join('L')}L${across(curve.at(-2)!)} ${up(0)}`;
    return handles.map(({ x }) => `M${across(x)} ${up(0)}V${up(1)}`).join('');
  }

  return {
    element,
    show,
    mark(value) {
      set(line, { x1: across(value), x2: across(value) });
      line.style.display = value < low || value > high || variable.isOutput ? 'none' : '';
    },
  };
}
