/** The decision map on a canvas: values, the surface over them, or the dominant rule; and the explained point. */

import type { Cells, Colours, Variable, View } from 'flagred';
import { h } from '../dom';
import { clamp, short, ticks, told } from './numbers';
import { FRONT, surface, turned } from './surface';

export type Kind = 'map' | 'surface' | 'rules';

/** The content to draw. */
export interface Shown {
  kind: Kind;
  view: View;
  cells: Cells;
  x: Variable;
  /** `undefined` if there is only one axis. */
  y: Variable | undefined;
  output: Variable;
  /** The value for each input. */
  point: number[];
}

export interface DecisionMap {
  element: HTMLCanvasElement;
  draw(shown: Shown): void;
}

export interface Frame {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** The margins around the map for the axes and the colour scale, in pixels. */
const LEFT = 54;
const RIGHT = 58;
const TOP = 28;
const BOTTOM = 40;
/** How far a key moves the point, as a share of the axis. */
const KEY_STEP = 0.02;
/** The angle by which a key turns a surface, in degrees. */
const KEY_TURN = 5;
/** The angle by which a drag turns a surface, in degrees per pixel. */
const PIXEL_TURN = 0.5;

/** The explained point: `at` returns its value for an input, `move` changes that value. */
export interface Point {
  at(input: number): number;
  move(input: number, value: number): void;
}

export function decisionMap(colours: Colours, point: Point): DecisionMap {
  const canvas = h('canvas', {
    class: 'decision',
    tabindex: 0,
    role: 'application',
    'aria-roledescription': 'decision map',
    'aria-label': 'Decision map',
  });
  const pen = canvas.getContext('2d', { alpha: true })!;
  const small = document.createElement('canvas');
  let shown: Shown | undefined;
  let asked = 0;
  let ink: Ink | undefined;
  let camera = FRONT;

  function draw(next: Shown): void {
    shown = next;
    asked ||= requestAnimationFrame(paint);
  }

  function paint(): void {
    asked = 0;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!shown || width === 0) return;
    const ratio = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    ink ??= inks(canvas);
    pen.font = '12px system-ui, sans-serif';
    const frame: Frame = { left: LEFT, top: TOP, width: width - LEFT - RIGHT, height: height - TOP - BOTTOM };
    if (isSurface()) {
      surface(pen, { left: 4, top: 4, width: width - RIGHT - 4, height: height - 8 }, shown, colours, ink, camera);
    }
    else if (shown.y) flat(pen, small, frame, shown, colours, ink);
    else curve(pen, frame, shown, ink);
    if (shown.kind !== 'rules' && shown.y) legend(pen, frame, width, shown, colours, ink);
    canvas.setAttribute('aria-label', spoken(shown));
  }

  new ResizeObserver(() => shown && draw(shown)).observe(canvas);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    ink = undefined;
    if (shown) draw(shown);
  });

  const isSurface = () => shown?.y !== undefined && shown.kind === 'surface';
  function turn(by: { turn?: number; tip?: number }): void {
    camera = turned(camera, by);
    if (shown) draw(shown);
  }

  function at(event: PointerEvent): void {
    if (!shown || isSurface()) return;
    const box = canvas.getBoundingClientRect();
    const part = (at: number, low: number, size: number) => clamp((at - low) / size, 0, 1);
    const [x, y] = shown.view.axes;
    const across = part(event.clientX - box.left, LEFT, box.width - LEFT - RIGHT);
    const up = 1 - part(event.clientY - box.top, TOP, box.height - TOP - BOTTOM);
    if (x) point.move(x.input, x.low + across * (x.high - x.low));
    if (y) point.move(y.input, y.low + up * (y.high - y.low));
  }
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    at(event);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    if (isSurface()) turn({ turn: -PIXEL_TURN * event.movementX, tip: PIXEL_TURN * event.movementY });
    else at(event);
  });
  canvas.addEventListener('dblclick', () => {
    camera = FRONT;
    if (shown) draw(shown);
  });
  canvas.addEventListener('keydown', (event) => {
    const [across, up] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
    if (isSurface() && (across || up)) {
      event.preventDefault();
      return turn({ turn: KEY_TURN * across!, tip: KEY_TURN * up! });
    }
    const [x, y] = shown?.view.axes ?? [];
    const axis = across ? x : up ? y : undefined;
    if (!axis) return;
    event.preventDefault();
    const by = KEY_STEP * (event.shiftKey ? 0.1 : 1) * (axis.high - axis.low);
    point.move(axis.input, clamp(point.at(axis.input) + (across! + up!) * by, axis.low, axis.high));
  });
  return { element: canvas, draw };
}

export type Ink = Record<'ink' | 'soft' | 'rule' | 'paper' | 'accent', string>;

/** The colours of the page, for drawing. */
function inks(element: Element): Ink {
  const style = getComputedStyle(element);
  const of = (name: keyof Ink) => style.getPropertyValue(`--${name}`);
  return { ink: of('ink'), soft: of('soft'), rule: of('rule'), paper: of('paper'), accent: of('accent') };
}

const share = (value: number, low: number, high: number) => clamp((value - low) / (high - low), 0, 1);

/** The 256 colours of the output. */
export const scaleOf = ({ output }: Shown, { scale, risk }: Colours): Uint8Array => (/^(.*_)?risk$/.test(output.name) ? risk : scale);

/** Draws the cells as pixels, seen from above; the second axis points up. */
function pixels(shown: Shown, colours: Colours): ImageData {
  const { cells, output, kind, view } = shown;
  const points = view.points;
  const image = new ImageData(points, points);
  const { distinct } = colours;
  const scale = scaleOf(shown, colours);
  const isRules = kind === 'rules';
  const steps = 255 / (output.high - output.low);
  for (let i = 0; i < points; i++) {
    for (let j = 0; j < points; j++) {
      const cell = i * points + j;
      const value = isRules ? cells.dominantRules[cell]! : cells.values[cell]!;
      if (value !== value) continue;
      const from = isRules ? distinct : scale;
      const colour = 3 * (isRules ? (value - 1) % (distinct.length / 3) : clamp(Math.round((value - output.low) * steps), 0, 255));
      const to = 4 * ((points - 1 - j) * points + i);
      image.data[to] = from[colour]!;
      image.data[to + 1] = from[colour + 1]!;
      image.data[to + 2] = from[colour + 2]!;
      image.data[to + 3] = !isRules && cells.filled[cell] ? 150 : 255;
    }
  }
  return image;
}

function flat(pen: CanvasRenderingContext2D, small: HTMLCanvasElement, frame: Frame, shown: Shown, colours: Colours, ink: Ink): void {
  hatch(pen, frame, ink);
  if (small.width !== shown.view.points) small.width = small.height = shown.view.points;
  small.getContext('2d')!.putImageData(pixels(shown, colours), 0, 0);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(small, frame.left, frame.top, frame.width, frame.height);
  axes(pen, frame, shown, ink);
  const [x, y] = shown.view.axes;
  if (x && y) cross(pen, frame, share(shown.point[x.input]!, x.low, x.high), share(shown.point[y.input]!, y.low, y.high), ink);
}

/** Hatches the area in which nothing is known. */
function hatch(pen: CanvasRenderingContext2D, frame: Frame, ink: Ink): void {
  pen.save();
  pen.beginPath();
  pen.rect(frame.left, frame.top, frame.width, frame.height);
  pen.clip();
  pen.strokeStyle = ink.rule;
  pen.lineWidth = 1;
  pen.beginPath();
  for (let x = frame.left - frame.height; x < frame.left + frame.width; x += 8) {
    pen.moveTo(x, frame.top + frame.height);
    pen.lineTo(x + frame.height, frame.top);
  }
  pen.stroke();
  pen.restore();
}

function curve(pen: CanvasRenderingContext2D, frame: Frame, shown: Shown, ink: Ink): void {
  const { output, cells, view } = shown;
  axes(pen, frame, shown, ink);
  const place = (i: number, value: number): [number, number] => [
    frame.left + (frame.width * i) / (view.points - 1),
    frame.top + frame.height * (1 - share(value, output.low, output.high)),
  ];
  pen.strokeStyle = ink.accent;
  pen.lineWidth = 2;
  pen.beginPath();
  let isOn = false;
  for (let i = 0; i < view.points; i++) {
    const value = cells.values[i]!;
    if (!Number.isNaN(value)) pen[isOn ? 'lineTo' : 'moveTo'](...place(i, value));
    isOn = !Number.isNaN(value);
  }
  pen.stroke();
  const [x] = view.axes;
  if (!x) return;
  const across = share(shown.point[x.input]!, x.low, x.high);
  const value = cells.values[Math.round(across * (view.points - 1))] ?? NaN;
  cross(pen, frame, across, Number.isNaN(value) ? undefined : share(value, output.low, output.high), ink);
}

function axes(pen: CanvasRenderingContext2D, frame: Frame, shown: Shown, ink: Ink): void {
  const [x, y] = shown.view.axes;
  const up = y ?? { low: shown.output.low, high: shown.output.high };
  const upper = shown.y ?? shown.output;
  pen.strokeStyle = ink.rule;
  pen.lineWidth = 1;
  pen.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
  pen.fillStyle = ink.soft;
  pen.textBaseline = 'top';
  pen.textAlign = 'center';
  const bottom = frame.top + frame.height;
  if (x) {
    for (const tick of ticks(x.low, x.high, Math.max(2, frame.width / 80))) {
      const at = frame.left + frame.width * share(tick, x.low, x.high);
      pen.fillRect(at, bottom, 1, 4);
      pen.fillText(short(tick), at, bottom + 6);
    }
  }
  pen.textAlign = 'right';
  pen.textBaseline = 'middle';
  for (const tick of ticks(up.low, up.high, Math.max(2, frame.height / 60))) {
    const at = bottom - frame.height * share(tick, up.low, up.high);
    pen.fillRect(frame.left - 4, at, 4, 1);
    pen.fillText(short(tick), frame.left - 7, at);
  }
  pen.fillStyle = ink.ink;
  pen.textAlign = 'center';
  pen.textBaseline = 'bottom';
  pen.fillText(part(shown.x, x), frame.left + frame.width / 2, bottom + BOTTOM - 3);
  pen.save();
  pen.translate(3, frame.top + frame.height / 2);
  pen.rotate(-Math.PI / 2);
  pen.textBaseline = 'top';
  pen.fillText(part(upper, y), 0, 0);
  pen.restore();
}

export const titled = ({ name, unit }: Variable): string => (unit ? `${name} [${unit}]` : name);

/** The title of an axis, with the shown part if the axis does not show the whole range. */
function part(variable: Variable, axis: { low: number; high: number } | undefined): string {
  const { low, high } = variable;
  if (!axis || (axis.low <= low && axis.high >= high)) return titled(variable);
  return `${titled(variable)}, ${short(axis.low)} to ${short(axis.high)} of ${short(low)} to ${short(high)}`;
}

/** Draws the explained point. */
function cross(pen: CanvasRenderingContext2D, frame: Frame, across: number, up: number | undefined, ink: Ink): void {
  const x = frame.left + frame.width * across;
  const y = up === undefined ? undefined : frame.top + frame.height * (1 - up);
  for (const [colour, width] of [[ink.paper, 3], [ink.ink, 1]] as const) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(x, frame.top);
    pen.lineTo(x, frame.top + frame.height);
    if (y !== undefined) {
      pen.moveTo(frame.left, y);
      pen.lineTo(frame.left + frame.width, y);
    }
    pen.stroke();
  }
  if (y !== undefined) dot(pen, x, y, ink);
}

export function dot(pen: CanvasRenderingContext2D, x: number, y: number, ink: Ink): void {
  pen.beginPath();
  pen.arc(x, y, 6, 0, 2 * Math.PI);
  pen.fillStyle = ink.paper;
  pen.fill();
  pen.lineWidth = 2;
  pen.strokeStyle = ink.ink;
  pen.stroke();
}

/** Draws the colours next to the map and their meaning. */
function legend(pen: CanvasRenderingContext2D, frame: Frame, width: number, shown: Shown, colours: Colours, ink: Ink): void {
  const left = width - RIGHT + 12;
  const scale = scaleOf(shown, colours);
  for (let y = 0; y < frame.height; y++) {
    const at = 3 * Math.round(255 * (1 - y / (frame.height - 1)));
    pen.fillStyle = `rgb(${scale[at]} ${scale[at + 1]} ${scale[at + 2]})`;
    pen.fillRect(left, frame.top + y, 10, 1.5);
  }
  pen.fillStyle = ink.soft;
  pen.textAlign = 'left';
  pen.textBaseline = 'middle';
  const { low, high } = shown.output;
  for (const tick of ticks(low, high, 4)) pen.fillText(short(tick), left + 14, frame.top + frame.height * (1 - share(tick, low, high)));
  pen.fillStyle = ink.ink;
  pen.textAlign = 'right';
  pen.textBaseline = 'top';
  pen.fillText(titled(shown.output), width - 2, 6);
}

/** The description of the map for screen readers. */
function spoken({ kind, output, x, y, view, cells, point }: Shown): string {
  const [across, up] = view.axes;
  const cell = (axis: typeof across) => (axis ? Math.round(share(point[axis.input]!, axis.low, axis.high) * (view.points - 1)) : 0);
  const value = cells.values[up ? cell(across) * view.points + cell(up) : cell(across)] ?? NaN;
  const at = [x, ...(y ? [y] : [])].map((variable, i) => `${variable.name} ${short(point[view.axes[i]!.input]!)}`);
  return `${output.name} over ${x.name}${y ? ` and ${y.name}` : ''}; at ${at.join(', ')}: ${told(value, output.unit)}. Arrow keys ${kind === 'surface' && y ? 'turn the surface' : 'move the point'}.`;
}
