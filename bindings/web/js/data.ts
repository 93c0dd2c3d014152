/**
 * Rows of measured values: the error of a rule set on them, rules learned from them, and numbers tuned to them. Only
 * the page contains this module; with it, the npm package would be a third larger.
 */

import { beside, type Source } from './load.js';
import { guard } from './panic.js';
import * as wasm from './wasm/data.js';

const guarded = guard(wasm.panicMessage);

/** Loads the module for data, from the file next to this one or from `source`. Later calls do nothing. */
export async function startData(source?: Source): Promise<void> {
  await wasm.default({ module_or_path: source ?? (await beside(new URL('./wasm/data_bg.wasm', import.meta.url))) });
}

/** The errors of a rule set on rows: computed minus measured values. */
export interface Errors {
  output: string;
  unit: string | null;
  /** The number of rows that are used. */
  rows: number;
  /** The reasons why rows are not used, at most 20. */
  refused: string[];
  refusedCount: number;
  /** The number of rows in which the rule set has no value. */
  withoutValue: number;
  /** The RMS error; `null` if no row has a value. */
  rms: number | null;
  mean: number | null;
  largest: number | null;
  /** The rows with the largest errors, the largest first. */
  worst: { line: number; point: number[]; measured: number; computed: number }[];
}

/** A rule set that was learned from rows or tuned to them. */
export interface Made {
  text: string;
  /** A sentence that describes the result. */
  words: string;
  details: string[];
}

/** A table in CSV with a column for each input and the output. Call {@link DataTable.free} when done. */
export class DataTable {
  readonly #table: wasm.DataTable;

  constructor(file: string, text: string) {
    this.#table = guarded(() => new wasm.DataTable(file, text));
  }

  /** Returns the errors of a rule set in YAML. */
  errors(rules: string): Errors {
    return JSON.parse(guarded(() => this.#table.errors(rules))) as Errors;
  }

  /**
   * Fits the numbers of a rule set to the rows, like `flagred tune`. `watch` is called with the step, the error so
   * far and the text so far.
   */
  tune(rules: string, watch: (step: number, error: number, text: string) => void = () => undefined): Made {
    return JSON.parse(guarded(() => this.#table.tune(rules, watch))) as Made;
  }

  /**
   * Replaces the rules of a rule set by rules learned from the rows, like `flagred learn`; `complete` adds rules for
   * combinations of terms without rows.
   */
  learn(rules: string, complete = false): Made {
    return JSON.parse(guarded(() => this.#table.learn(rules, complete))) as Made;
  }

  free(): void {
    guarded(() => this.#table.free());
  }
}
