/** The part of a rule set that the map shows, and its representation in the address. */

import type { About, View } from 'flagred';
import type { Kind } from './map';

/** The number of points along an axis of the map. */
const POINTS = 101;
/** The number of points of the curve of a rule set with one input. */
const CURVE = 401;

export const KINDS: [Kind, string][] = [['map', 'Map'], ['surface', 'Surface'], ['rules', 'Strongest rule']];

/** An output and the inputs along the axes, by their names, which survive changes of the text. */
export interface Choice {
  output: string;
  x: string;
  /** Empty if there is only one input. */
  y: string;
  kind: Kind;
  /** Whether whole ranges are shown, or only the parts in which terms change. */
  isWhole: boolean;
}

/** Replaces choices that the rule set does not have. */
export function settle(choice: Choice, { inputs, outputs, output }: About): void {
  const names = inputs.map(({ name }) => name);
  if (!outputs.some(({ name }) => name === choice.output)) choice.output = outputs[output]!.name;
  if (!names.includes(choice.x)) choice.x = names.find((name) => name !== choice.y)!;
  if (!names.includes(choice.y) || choice.y === choice.x) choice.y = names.find((name) => name !== choice.x) ?? '';
}

/** The view of a choice, at a point. */
export function view({ output, x, y, isWhole }: Choice, { inputs, outputs }: About, point: number[]): View {
  const chosen = [x, y].map((name) => inputs.findIndex((input) => input.name === name)).filter((input) => input >= 0);
  const axes = chosen.map((input) => {
    const { low, high, shown } = inputs[input]!;
    return isWhole ? { input, low, high } : { input, low: shown[0], high: shown[1] };
  });
  return {
    output: outputs.findIndex(({ name }) => name === output),
    axes,
    points: axes.length < 2 ? CURVE : POINTS,
    held: point,
  };
}

/** Converts a choice to parameters of an address. */
export function written(choice: Choice, point: number[] | undefined): URLSearchParams {
  const parameters = new URLSearchParams();
  for (const name of ['output', 'x', 'y'] as const) if (choice[name]) parameters.set(name, choice[name]);
  if (choice.kind !== 'map') parameters.set('show', choice.kind);
  if (choice.isWhole) parameters.set('whole', '1');
  if (point) parameters.set('at', point.map((value) => Number(value.toPrecision(6))).join(','));
  return parameters;
}

/** Sets the choice from an address; returns the point, if it contains one. */
export function read(choice: Choice, parameters: URLSearchParams): number[] | undefined {
  for (const name of ['output', 'x', 'y'] as const) choice[name] = parameters.get(name) ?? choice[name];
  choice.kind = KINDS.find(([kind]) => kind === parameters.get('show'))?.[0] ?? 'map';
  choice.isWhole = parameters.has('whole');
  const at = parameters.get('at')?.split(',').map(Number);
  return at?.every(Number.isFinite) ? at : undefined;
}
