/** The charts of a report: the values of their curves at a time. The data are parsed from the curves themselves. */

import { h } from '../dom';

export interface Chart {
  box: HTMLElement;
  area: HTMLElement;
  plot: SVGSVGElement;
  /** The time at the left edge of the chart, in seconds. */
  start_s: number;
  /** The length of the stretch that was drawn, in seconds. */
  length_s: number;
  /** The index of the input of the rules that the chart shows. */
  input: number | undefined;
  unit: string;
  /** The number of digits of a value. */
  digits: number;
  /** A line over the chart. It is not a part of the picture, so that moving it does not redraw the picture. */
  cursor: HTMLElement;
  outputs: HTMLElement[];
  lines: SVGPathElement[];
  /** The points of the lines, parsed on first use. */
  curves: Curve[] | undefined;
  events: { x_s: number; text: string }[];
}

/** The points of a curve: seconds since the start, and values; NaN where the line is interrupted. */
interface Curve {
  x_s: number[];
  values: number[];
}

export interface DecisionMap {
  box: HTMLElement;
  here: SVGPathElement;
  size: number;
  x: Axis;
  y: Axis;
}

interface Axis {
  input: number;
  low: number;
  high: number;
}

/** Finds the charts within an element, and gives them names for screen readers. */
export function chartsIn(root: ParentNode): Chart[] {
  const charts: Chart[] = [];
  for (const box of root.querySelectorAll<HTMLElement>('.panel')) {
    const area = box.querySelector<HTMLElement>('.area');
    const plot = area?.querySelector('svg');
    if (!area || !plot) continue;
    plot.querySelector('.cursor')?.remove();
    const cursor = h('div', { class: 'cursor' });
    area.append(cursor);
    plot.setAttribute('role', 'img');
    plot.setAttribute('aria-label', `${box.querySelector('b')?.textContent ?? ''} over time`);
    const events = [...plot.querySelectorAll('.event')].map((mark) => ({
      x_s: Number(/^M([-\d.]+)/.exec(mark.getAttribute('d') ?? '')?.[1]),
      text: mark.textContent ?? '',
    }));
    charts.push({
      box,
      area,
      plot,
      start_s: Number(box.dataset['start']),
      length_s: Number(box.dataset['length']),
      input: box.dataset['input'] === undefined ? undefined : Number(box.dataset['input']),
      unit: box.dataset['unit'] ?? '',
      digits: Number(box.dataset['digits'] ?? 3),
      cursor,
      outputs: [...box.querySelectorAll('output')],
      lines: [...plot.querySelectorAll<SVGPathElement>('.line')],
      curves: undefined,
      events,
    });
  }
  return charts;
}

/** Finds the decision map within an element. */
export function mapIn(root: ParentNode): DecisionMap | undefined {
  const box = root.querySelector<HTMLElement>('.map');
  const here = box?.querySelector<SVGPathElement>('.here');
  const [left, right, low, high] = (box?.dataset['box'] ?? '').split(' ').map(Number);
  const drawing = box?.querySelector('svg');
  drawing?.setAttribute('role', 'img');
  drawing?.setAttribute('aria-label', 'The path of the flight over the decision map');
  if (!box || !here || left === undefined || right === undefined || low === undefined || high === undefined) return undefined;
  return {
    box,
    here,
    size: box.querySelector('svg')?.viewBox.baseVal.width ?? 0,
    x: { input: Number(box.dataset['x']), low: left, high: right },
    y: { input: Number(box.dataset['y']), low, high },
  };
}

/** Parses the curves of a chart, which takes a millisecond or two. */
export function curvesOf(chart: Chart): Curve[] {
  chart.curves ??= chart.lines.map((line) => {
    const curve: Curve = { x_s: [], values: [] };
    for (const [, pen, x, y] of (line.getAttribute('d') ?? '').matchAll(/([ML])([-\d.]+) ([-\d.]+)/g)) {
      const last_s = curve.x_s.at(-1);
      if (pen === 'M' && last_s !== undefined) {
        curve.x_s.push(last_s);
        curve.values.push(NaN);
      }
      curve.x_s.push(Number(x));
      curve.values.push(Number(y));
    }
    return curve;
  });
  return chart.curves;
}

/** The latest value at or before `x`; NaN if it is unknown. */
export function held({ x_s, values }: Curve, x: number): number {
  let low = 0;
  let high = x_s.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x_s[middle]! <= x) low = middle + 1;
    else high = middle;
  }
  return values[low - 1] ?? NaN;
}

/** Formats a value as in the report. */
export function said(value: number, unit = '', digits = 3): string {
  if (!Number.isFinite(value)) return 'unknown';
  return String(Number(value.toPrecision(digits))) + (unit ? ` ${unit}` : '');
}

/** Moves the cursor of a chart, and shows the values there. */
export function point(chart: Chart, x_s: number): void {
  chart.cursor.style.transform = `translateX(${((100 * x_s) / chart.length_s).toFixed(3)}%)`;
  curvesOf(chart).forEach((curve, i) => {
    const output = chart.outputs[i];
    const words = said(held(curve, x_s), chart.unit, chart.digits);
    if (output && output.textContent !== words) output.textContent = words;
  });
}

/** Moves the point of the map to the values of the inputs. */
export function locate(map: DecisionMap, inputs: ReadonlyMap<number, number>): void {
  // A point beyond the map is shown at its edge, like the clamped values that the rules use.
  const along = ({ input, low, high }: Axis) =>
    Math.min(1, Math.max(0, ((inputs.get(input) ?? NaN) - low) / (high - low))) * map.size;
  const [across, up] = [along(map.x), along(map.y)];
  const isKnown = Number.isFinite(across) && Number.isFinite(up);
  map.here.setAttribute('d', isKnown ? `M${across.toFixed(2)} ${up.toFixed(2)}h0` : 'M-9-9h0');
}
