/** Formats numbers for people. */

/** Formats a value with four significant digits. */
export function short(value: number): string {
  return String(Number(value.toPrecision(4))).replace('-', '\u2212');
}

/** Formats a value with its unit; `unknown` if there is none. */
export function told(value: number | null, unit: string | null): string {
  if (value === null || Number.isNaN(value)) return 'unknown';
  return unit ? `${short(value)} ${unit}` : short(value);
}

/** About `count` round numbers from `low` to `high`. */
export function ticks(low: number, high: number, count: number): number[] {
  const rough = (high - low) / count;
  if (!(rough > 0) || !Number.isFinite(rough)) return [];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((part) => part * power).find((one) => one >= rough * 0.999) ?? rough;
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

export const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);

/** The step of a slider over a range: a power of ten, about a thousandth of the range or slightly finer. */
export const step = (low: number, high: number): number => 10 ** (Math.floor(Math.log10(high - low)) - 3);
