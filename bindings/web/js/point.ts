/** Values for the inputs of a rule set, by position or by name. */

/** A known number, or `null` for an unknown one. NaN is unknown, too. */
export type Known = number | null;

/** A value for each input: in the order of the rule set, or by the names of the inputs. */
export type Point = ArrayLike<Known> | Readonly<Record<string, Known>>;

/** A column for each input: in the order of the rule set, or by the names of the inputs. */
export type Columns = readonly ArrayLike<Known>[] | Readonly<Record<string, ArrayLike<Known>>>;

/** Returns a value as a number; NaN is unknown. `of` returns the description of the value for messages. */
export function numberOf(value: unknown, of: () => string): number {
  if (typeof value === 'number') return value;
  if (value === null || value === undefined) return NaN;
  const words = typeof value === 'string' ? `the text "${value}"` : `a value of type ${typeof value}`;
  throw refusal(`${of()} is ${words}, not a number`, 'give a number, or `null` if it is unknown');
}

/** Returns a list of numbers. */
export function numbers(values: ArrayLike<unknown>, of: (index: number) => string): Float64Array {
  return values instanceof Float64Array ? values : Float64Array.from(values, (value, i) => numberOf(value, () => of(i)));
}

/** Returns the values in the order of the inputs. */
export function inOrder<T>(given: ArrayLike<T> | Readonly<Record<string, T>>, inputs: readonly string[]): ArrayLike<T> {
  if (isList(given)) {
    if (given.length === inputs.length) return given;
    const count = `${given.length} value${given.length === 1 ? '' : 's'}`;
    throw refusal(`${count} for ${inputs.length} input${inputs.length === 1 ? '' : 's'}`, `the inputs are ${quoted(inputs)}`);
  }
  if (typeof given !== 'object' || given === null) {
    throw refusal('the values are neither a list nor an object', `the inputs are ${quoted(inputs)}`);
  }
  const wrong = Object.keys(given).find((name) => !inputs.includes(name));
  if (wrong !== undefined) throw refusal(`\`${wrong}\` is not an input of the rule set`, `the inputs are ${quoted(inputs)}`);
  return inputs.map((name) => {
    if (Object.hasOwn(given, name)) return (given as Readonly<Record<string, T>>)[name]!;
    throw refusal(`input \`${name}\` has no value`, 'give `null` if it is unknown');
  });
}

const isList = (given: unknown): given is ArrayLike<never> => Array.isArray(given) || ArrayBuffer.isView(given);

const quoted = (names: readonly string[]) => names.map((name) => `\`${name}\``).join(', ');

export const refusal = (message: string, help: string): Error => new Error(`${message}\nhelp: ${help}`);
