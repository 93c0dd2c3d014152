/** Draws the surface of an output over two inputs on a canvas, with numbers at the axes. It can be turned. */

import type { Colours, Variable } from 'flagred';
import { dot, scaleOf, titled, type Frame, type Ink, type Shown } from './map';
import { clamp, short, ticks } from './numbers';

/** The direction of view in degrees: rotation about the vertical axis, and tilt. */
export interface Camera {
  turn: number;
  tip: number;
}

/** The direction of view of `flagred map --surface`. */
export const FRONT: Camera = { turn: 35, tip: 28 };

/** A camera that is turned further. It stays above the surface. */
export const turned = ({ turn, tip }: Camera, by: { turn?: number; tip?: number }): Camera => ({
  turn: (((turn + (by.turn ?? 0)) % 360) + 360) % 360,
  tip: clamp(tip + (by.tip ?? 0), 5, 85),
});

/** The maximum number of points of the surface along an axis. */
const MOST = 41;
/** The height of the box, as a share of its sides. */
const HEIGHT = 0.7;

type Place = [x: number, y: number];

/** The corners of the mesh, and the colour of each face. It is made once for a map and used for all views of it. */
interface Mesh {
  cells: Float64Array;
  colours: Colours;
  count: number;
  heights: Float64Array;
  faces: (string | undefined)[];
}

let latest: Mesh | undefined;

function mesh(shown: Shown, colours: Colours): Mesh {
  const { cells, view, output } = shown;
  if (latest?.cells === cells.values && latest.colours === colours) return latest;
  const { points } = view;
  const scale = scaleOf(shown, colours);
  const count = Math.min(points, MOST);
  const index = (i: number) => Math.round((i * (points - 1)) / (count - 1));
  const heights = new Float64Array(count * count);
  for (let i = 0; i < count; i++) {
    for (let j = 0; j < count; j++) {
      const value = cells.values[index(i) * points + index(j)]!;
      heights[i * count + j] = clamp((value - output.low) / (output.high - output.low), 0, 1);
    }
  }
  const faces: (string | undefined)[] = [];
  for (let i = 0; i + 1 < count; i++) {
    for (let j = 0; j + 1 < count; j++) {
      const at = i * count + j;
      const mean = (heights[at]! + heights[at + 1]! + heights[at + count]! + heights[at + count + 1]!) / 4;
      const colour = 3 * Math.round(255 * mean);
      faces.push(Number.isNaN(mean) ? undefined : `rgb(${scale[colour]},${scale[colour + 1]},${scale[colour + 2]})`);
    }
  }
  latest = { cells: cells.values, colours, count, heights, faces };
  return latest;
}

export function surface(pen: CanvasRenderingContext2D, frame: Frame, shown: Shown, colours: Colours, ink: Ink, camera: Camera): void {
  const { count, heights, faces } = mesh(shown, colours);
  const [turn, tip] = [(camera.turn * Math.PI) / 180, (camera.tip * Math.PI) / 180];
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  const size = Math.min(frame.width / 1.75, frame.height / (1.42 * Math.sin(tip) + HEIGHT * Math.cos(tip) + 0.18));
  const middle = { x: frame.left + frame.width / 2, y: frame.top + frame.height / 2 };
  const [rise, lean] = [size * HEIGHT * Math.cos(tip), size * Math.sin(tip)];
  const depth = (x: number, y: number) => (y - 0.5) * cos - (x - 0.5) * sin;
  const place = (x: number, y: number, z: number): Place => [
    middle.x + size * ((x - 0.5) * cos + (y - 0.5) * sin),
    middle.y - (z - 0.5) * rise - depth(x, y) * lean,
  ];
  // The corner at which the two walls behind the surface meet.
  const far = { x: sin > 0 ? 0 : 1, y: cos > 0 ? 1 : 0 };
  box(pen, shown, ink, place, far);

  const across = new Float64Array(count * count);
  const down = new Float64Array(count * count);
  for (let i = 0; i < count; i++) {
    for (let j = 0; j < count; j++) {
      const at = i * count + j;
      [across[at], down[at]] = place(i / (count - 1), j / (count - 1), heights[at]!);
    }
  }
  // Faces are drawn from the far corner to the near one, so that near faces cover those behind them.
  const order = (from: number) => Array.from({ length: count - 1 }, (_, i) => (from ? count - 2 - i : i));
  pen.lineWidth = 1;
  pen.lineJoin = 'round';
  for (const j of order(far.y)) {
    for (const i of order(far.x)) {
      const colour = faces[i * (count - 1) + j];
      if (!colour) continue;
      const at = i * count + j;
      pen.beginPath();
      pen.moveTo(across[at]!, down[at]!);
      pen.lineTo(across[at + count]!, down[at + count]!);
      pen.lineTo(across[at + count + 1]!, down[at + count + 1]!);
      pen.lineTo(across[at + 1]!, down[at + 1]!);
      pen.closePath();
      pen.fillStyle = pen.strokeStyle = colour;
      pen.fill();
      pen.stroke();
    }
  }
  marked(pen, shown, ink, place);
}

/** The floor and the walls with their lines, the numbers and names of the axes. */
function box(
  pen: CanvasRenderingContext2D,
  shown: Shown,
  ink: Ink,
  place: (x: number, y: number, z: number) => Place,
  far: { x: number; y: number },
): void {
  const [x, y] = shown.view.axes;
  if (!x || !y) return;
  const near = { x: 1 - far.x, y: 1 - far.y };
  const line = (...places: Place[]) => {
    pen.beginPath();
    places.forEach((at, i) => pen[i ? 'lineTo' : 'moveTo'](...at));
    pen.stroke();
  };
  const share = (value: number, low: number, high: number) => (value - low) / (high - low);
  pen.strokeStyle = ink.rule;
  pen.lineWidth = 1;
  pen.fillStyle = ink.soft;
  pen.textBaseline = 'middle';
  pen.textAlign = 'center';
  const centre = place(0.5, 0.5, 0);
  /** Writes next to a place at an edge of the floor, on the side away from the centre. */
  const write = (words: string, [left, top]: Place, distance: number) => {
    const [dx, dy] = [left - centre[0], top - centre[1]];
    const length = Math.hypot(dx, dy) || 1;
    pen.textAlign = dx > 0.35 * length ? 'left' : dx < -0.35 * length ? 'right' : 'center';
    pen.fillText(words, left + (dx / length) * distance, top + (dy / length) * distance + (dy > 0 ? 4 : 0));
  };
  for (const tick of ticks(x.low, x.high, 4)) {
    const at = share(tick, x.low, x.high);
    line(place(at, near.y, 0), place(at, far.y, 0), place(at, far.y, 1));
    write(short(tick), place(at, near.y, 0), 9);
  }
  for (const tick of ticks(y.low, y.high, 4)) {
    const at = share(tick, y.low, y.high);
    line(place(near.x, at, 0), place(far.x, at, 0), place(far.x, at, 1));
    write(short(tick), place(near.x, at, 0), 9);
  }
  // The numbers of the output are at the outer edge of the wall that is farther left.
  const edges: [number, number][] = [[far.x, near.y], [near.x, far.y]];
  const [left] = edges.sort((a, b) => place(...a, 0)[0] - place(...b, 0)[0]);
  for (const tick of ticks(shown.output.low, shown.output.high, 4)) {
    const at = share(tick, shown.output.low, shown.output.high);
    line(place(far.x, near.y, at), place(far.x, far.y, at), place(near.x, far.y, at));
    // Numbers near the floor would overlap those of an input.
    if (at < 0.02) continue;
    const [from, top] = place(...left!, at);
    pen.textAlign = 'right';
    pen.fillText(short(tick), from - 6, top);
  }
  pen.fillStyle = ink.ink;
  write(titled(shown.x), place(0.5, near.y, 0), 34);
  write(titled(shown.y as Variable), place(near.x, 0.5, 0), 34);
}

/** Draws the explained point on the surface. */
function marked(pen: CanvasRenderingContext2D, shown: Shown, ink: Ink, place: (x: number, y: number, z: number) => Place): void {
  const [x, y] = shown.view.axes;
  if (!x || !y) return;
  const { points } = shown.view;
  const part = (axis: typeof x) => clamp((shown.point[axis.input]! - axis.low) / (axis.high - axis.low), 0, 1);
  const [across, deep] = [part(x), part(y)];
  const value = shown.cells.values[Math.round(across * (points - 1)) * points + Math.round(deep * (points - 1))] ?? NaN;
  const { low, high } = shown.output;
  if (!Number.isNaN(value)) dot(pen, ...place(across, deep, clamp((value - low) / (high - low), 0, 1)), ink);
}
