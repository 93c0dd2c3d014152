/** Rows of measured values: the error of a rule set on them, rules learned from them, numbers tuned to them. The page has it; the npm package does not, which would grow by a third. */

import { beside, type Source } from './load.js';
import { guard } from './panic.js';
import * as wasm from './wasm/data.js';

const guarded = guard(wasm.panicMessage);

/** Loads the module for data, from beside this file or from elsewhere. Calls after the first do nothing. */
export async function startData(source?: Source): Promise<void> {
  await wasm.default({ module_or_path: source ?? (await beside(new URL('./wasm/data_bg.wasm', import.meta.url))) });
}

/** The errors of a rule set on rows: computed less measured. */
export interface Errors {
  output: string;
  unit: string | null;
  /** The rows that are used. */
  rows: number;
  /** Why rows are not used, at most 20 of them. */
  refused: string[];
  refusedCount: number;
  /** Rows in which the rule set has no value. */
  withoutValue: number;
  /** `null` where no row has a value. */
  rms: number | null;
  mean: number | null;
  largest: number | null;
  /** The rows with the largest errors, the largest first. */
  worst: { line: number; point: number[]; measured: number; computed: number }[];
}

/** A rule set made from rows. */
export interface Made {
  text: string;
  /** What was done, in a sentence. */
  words: string;
  details: string[];
}

/** A table in CSV with a column for each input and the output. Call {@link DataTable.free} when done. */
export class DataTable {
  readonly #table: wasm.DataTable;

  constructor(file: string, text: string) {
    this.#table = guarded(() => new wasm.DataTable(file, text));
  }

  /** The errors of a rule set in YAML. */
  errors(rules: string): Errors {
    return JSON.parse(guarded(() => this.#table.errors(rules))) as Errors;
  }

  /** The rule set with numbers that fit the rows, as `flagred tune`. `watch` hears the step, and the error and the text so far. */
  tune(rules: string, watch: (step: number, error: number, text: string) => void = () => undefined): Made {
    return JSON.parse(guarded(() => this.#table.tune(rules, watch))) as Made;
  }

  /** The rule set with rules from the rows, as `flagred learn`; `complete` adds rules for combinations of terms without rows. */
  learn(rules: string, complete = false): Made {
    return JSON.parse(guarded(() => this.#table.learn(rules, complete))) as Made;
  }

  free(): void {
    guarded(() => this.#table.free());
  }
}
