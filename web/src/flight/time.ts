/** Stretches of time that are shown, and times in words. */

import type { Stretch } from 'flagred';

/** Minutes and seconds, as in `12:03.4`. */
export function minutes(seconds: number, decimals = 1): string {
  const unit = 10 ** decimals;
  const rounded = Math.round(Math.abs(seconds) * unit);
  const rest = ((rounded % (60 * unit)) / unit).toFixed(decimals).padStart(decimals > 0 ? decimals + 3 : 2, '0');
  return `${seconds < 0 && rounded > 0 ? '-' : ''}${Math.floor(rounded / (60 * unit))}:${rest}`;
}

/** The shortest stretch that is shown, in seconds. */
const SHORTEST_S = 0.5;

/** The stretch `part`, moved into `whole`; `undefined` if it is about as long as `whole`, or longer. */
export function within(part: Stretch, whole: Stretch): Stretch | undefined {
  const length_s = Math.max(part.end_s - part.start_s, SHORTEST_S);
  if (!(length_s < (whole.end_s - whole.start_s) * 0.999)) return undefined;
  const start_s = Math.min(Math.max(part.start_s, whole.start_s), whole.end_s - length_s);
  return { start_s, end_s: start_s + length_s };
}

/** The part of a stretch between two positions, given as shares of it. */
export function zoomed({ start_s, end_s }: Stretch, from: number, to: number, whole: Stretch): Stretch | undefined {
  const at = (share: number) => start_s + share * (end_s - start_s);
  return within({ start_s: at(from), end_s: at(to) }, whole);
}
