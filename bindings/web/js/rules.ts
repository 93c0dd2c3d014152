/**
 * Rule sets: open texts for editing, compiled rule sets for evaluation and pictures, and conversion from and to other
 * formats.
 */

import type { Explanation } from './documents.js';
import { beside, type Source } from './load.js';
import { guard } from './panic.js';
import { inOrder, numberOf, numbers, refusal, type Columns, type Known, type Point } from './point.js';
import * as wasm from './wasm/rules.js';

export type { Explanation } from './documents.js';
export type { Columns, Known, Point } from './point.js';

const guarded = guard(wasm.panicMessage);
let memory: WebAssembly.Memory;

/** Loads the module for rule sets, from the file next to this one or from `source`. Later calls do nothing. */
export async function startRules(source?: Source): Promise<void> {
  ({ memory } = await wasm.default({ module_or_path: source ?? (await beside(new URL('./wasm/rules_bg.wasm', import.meta.url))) }));
}

/** A finding in a text; offsets are in UTF-16 code units, as in JavaScript strings. */
export interface Diagnostic {
  severity: 'error' | 'warning' | 'note';
  code: string;
  message: string;
  help: string | null;
  from: number;
  to: number;
  /** The line, counted from 1. */
  line: number;
  related: { from: number; to: number; message: string }[];
}

/** A completion. */
export interface Completion {
  label: string;
  /** The text to insert. */
  text: string;
  kind: 'keyword' | 'variable' | 'choice' | 'key' | 'signal';
  detail: string | null;
}

/** The meaning of a name. */
export interface Hover {
  from: number;
  to: number;
  markdown: string;
}

/** A change of a text. */
export interface Edit {
  from: number;
  to: number;
  insert: string;
}

/** A handle for dragging a term. */
export interface Handle {
  /** The name of the parameter that the handle changes, such as `peak`. */
  name: string;
  x: number;
  degree: number;
  /** The smallest allowed `x`. */
  low: number;
  high: number;
  /** Whether the handle can also be moved vertically. */
  movesDegree: boolean;
}

/** A term as a curve of alternating x and degree. It is empty for a number, which is not a fuzzy set. */
export interface DrawnTerm {
  name: string;
  /** The shape in the syntax of rule sets: `triangle: [0, 2, 4]`. */
  shape: string;
  curve: number[];
  /** The lower curve of an interval type-2 term, whose upper one is `curve`; otherwise empty. */
  lower: number[];
  handles: Handle[];
}

/** A variable to draw. Its range is `null` if it cannot be read. */
export interface DrawnVariable {
  name: string;
  description: string | null;
  unit: string | null;
  isOutput: boolean;
  low: number | null;
  high: number | null;
  /** The part of the range in which its terms change. */
  shown: [number | null, number | null];
  terms: DrawnTerm[];
}

/** A term as shown in a form. */
export interface TermFields {
  /** The offset of its name. */
  at: number;
  /** Its shape, such as `triangle`; `peak` in a partition, and `limit` in `steps`. */
  shape: string;
  /** Its parameters without brackets: `0, 2, 4`. */
  parameters: string;
  /** The names of the parameters; empty for shapes without a fixed number of them. */
  names: string[];
  /** Whether {@link RuleText.setParameters} can change it. An interval type-2 term is edited as text. */
  isEditable: boolean;
  /** Whether {@link RuleText.setShape} can change it. */
  canChangeShape: boolean;
}

/** The parts of a rule set that can be changed, renamed and removed. */
export interface Parts {
  /** The variables, inputs first; `at` is the offset of the name. */
  variables: { at: number; terms: TermFields[] }[];
  /** The texts of the rules. */
  rules: string[];
  /** The shapes that a term can have. */
  shapes: string[];
}

/** The text of a rule set or a profile in an editor; it may contain errors. Call {@link RuleText.free} when done. */
export class RuleText {
  readonly #text: wasm.RuleText;

  constructor(text: string) {
    this.#text = guarded(() => new wasm.RuleText(text));
  }

  get isProfile(): boolean {
    return guarded(() => this.#text.isProfile);
  }

  /** Compiles the rule set, or the profile with its rule set; throws its errors. */
  ruleSet(): RuleSet {
    return new RuleSet(guarded(() => this.#text.ruleSet()));
  }

  /** Returns the findings of `flagred check`. */
  findings(): Diagnostic[] {
    return parsed(() => this.#text.findings());
  }

  /** Returns the completions at an offset. */
  completions(at: number): Completion[] {
    return parsed(() => this.#text.completions(at));
  }

  /** Returns the meaning of the name at an offset. */
  hover(at: number): Hover | null {
    return parsed(() => this.#text.hover(at));
  }

  /** Returns the offset at which the name at `at` is defined. */
  definition(at: number): number | undefined {
    return guarded(() => this.#text.definition(at));
  }

  /** Returns the edits that rename the name at an offset. */
  rename(at: number, name: string): Edit[] {
    return parsed(() => this.#text.rename(at, name));
  }

  /** Returns the text as formatted by `flagred fmt`. */
  formatted(): string {
    return guarded(() => this.#text.formatted());
  }

  /** Returns the variables and terms to draw, inputs first. */
  variables(): DrawnVariable[] {
    return parsed(() => this.#text.variables());
  }

  /** Returns the edits that move a handle of a term; they change only numbers. */
  drag(variable: number, term: number, handle: number, x: number, degree: number): Edit[] {
    return parsed(() => this.#text.drag(variable, term, handle, x, degree));
  }

  /** Returns the variables, terms and rules that can be changed; `null` for a profile. */
  parts(): Parts | null {
    return parsed(() => this.#text.parts());
  }

  /** Returns the edits that add an input or output with two terms. */
  addVariable(name: string, low: number, high: number, isOutput: boolean): Edit[] {
    return parsed(() => this.#text.addVariable(name, low, high, isOutput));
  }

  /** Returns the edits that add a term to a variable. */
  addTerm(variable: number, name: string): Edit[] {
    return parsed(() => this.#text.addTerm(variable, name));
  }

  /** Returns the edits that change the range of a variable. */
  setRange(variable: number, low: number, high: number): Edit[] {
    return parsed(() => this.#text.setRange(variable, low, high));
  }

  /** Returns the edits that change the unit of a variable; an empty one is removed. */
  setUnit(variable: number, unit: string): Edit[] {
    return parsed(() => this.#text.setUnit(variable, unit));
  }

  /** Returns the edits that change the parameters of a term: numbers separated by commas, or in the notation of the text. */
  setParameters(variable: number, term: number, to: string): Edit[] {
    return parsed(() => this.#text.setParameters(variable, term, to));
  }

  /** Returns the edits that give a term another shape in about the same part of the range. */
  setShape(variable: number, term: number, shape: string): Edit[] {
    return parsed(() => this.#text.setShape(variable, term, shape));
  }

  /** Returns the edits that add a rule. */
  addRule(rule: string): Edit[] {
    return parsed(() => this.#text.addRule(rule));
  }

  /** Returns the edits that replace the text of a rule. */
  changeRule(rule: number, to: string): Edit[] {
    return parsed(() => this.#text.changeRule(rule, to));
  }

  /** Returns the edits that remove a variable, or a term of it, that no rule uses. */
  removeNamed(variable: number, term?: number): Edit[] {
    return parsed(() => this.#text.removeNamed(variable, term));
  }

  /** Returns the edits that remove a rule. */
  removeRule(rule: number): Edit[] {
    return parsed(() => this.#text.removeRule(rule));
  }

  free(): void {
    guarded(() => this.#text.free());
  }
}

/** An input or output of a rule set. */
export interface Variable {
  name: string;
  description: string | null;
  unit: string | null;
  low: number;
  high: number;
  /** The part of the range in which its terms change. */
  shown: [number, number];
}

/** A description of a rule set. */
export interface About {
  name: string;
  inputs: Variable[];
  outputs: Variable[];
  /** The texts of the rules. */
  rules: string[];
  /** The index of the output that a profile uses as risk; 0 for a rule set. */
  output: number;
  /** The method by which a profile fills gaps between the rules. */
  filling: string | null;
}

/** The value of an output; `null` is unknown. */
export interface Value {
  name: string;
  value: number | null;
  /** The ends of the interval whose middle is the value, if interval type-2 terms determine it; otherwise absent. */
  low?: number;
  high?: number;
  /** Whether no rule fires and the value is the default of the rule set. */
  isDefault: boolean;
  /** The largest firing strength. */
  coverage: number;
  /** The number of the rule with that strength, from 1; `null` if none fires. */
  dominantRule: number | null;
  /** Whether an input was outside its range. */
  clamped: boolean;
}

/** The content of a map: one output over one or two inputs, while the other inputs have fixed values. */
export interface View {
  /** The index of the output. */
  output: number;
  /** For one or two axes, the index of the input and the part of its range that is shown. */
  axes: { input: number; low: number; high: number }[];
  /** The number of points along each axis. */
  points: number;
  /** The fixed value of each input; the values of the axes are ignored. */
  held: number[];
}

/**
 * The cells of a map. Each array has one number for each combination of a point of the first axis and a point of the
 * second, which varies fastest. NaN is unknown.
 */
export interface Cells {
  values: Float64Array;
  /** The largest firing strength. */
  coverage: Float64Array;
  /** The number of the rule with that strength, from 1; NaN if none fires. */
  dominantRules: Float64Array;
  /** 1 if a profile filled a gap between rules, otherwise 0. */
  filled: Float64Array;
}

/** All rules with the terms that they read and conclude. */
export interface ViewedRules {
  /** Whether consequents are scaled by the firing strength; otherwise they are cut off at it. */
  scales: boolean;
  rules: {
    /**
     * `words` are the hedges and the term. `curve` is the curve with the hedges, as alternating x and degree; it is
     * empty without hedges.
     */
    conditions: { variable: string; words: string; term: string | null; curve: number[] }[];
    conclusions: { output: string; words: string; term: string }[];
  }[];
}

/** A rule set, compiled once. Call {@link RuleSet.free} when done. */
export class RuleSet {
  readonly #set: wasm.RuleSet;
  readonly #inputs: readonly string[];
  readonly #outputs: readonly string[];
  /** The point in the memory of the module that {@link RuleSet.value} reads. It is empty if that memory has moved. */
  #point = new Float64Array();

  /** Compiles a rule set in YAML, FIS, FLL, FCL or FML, or the rule set of a profile; throws its errors. */
  constructor(text: string | wasm.RuleSet) {
    this.#set = typeof text === 'string' ? guarded(() => new wasm.RuleSet(text)) : text;
    const { inputs, outputs } = this.about();
    this.#inputs = inputs.map(({ name }) => name);
    this.#outputs = outputs.map(({ name }) => name);
  }

  about(): About {
    return parsed(() => this.#set.about());
  }

  /** Returns the outputs at a point. */
  evaluate(point: Point): Value[] {
    const values = this.#numbers(point);
    return parsed(() => this.#set.evaluate(values));
  }

  /**
   * Returns the value of an output at a point; NaN if it has none. The output is given by its index or its name. This is
   * the fastest method, for use in loops; {@link RuleSet.evaluate} also returns the coverage and the dominant rule.
   */
  value(point: Point, output: number | string = 0): number {
    const index = typeof output === 'number' ? output : this.#outputs.indexOf(output);
    if (this.#outputs[index] === undefined) throw refusal(`\`${output}\` is not an output of the rule set`, `the outputs are \`${this.#outputs.join('`, `')}\``);
    const values = inOrder(point, this.#inputs);
    if (this.#point.length === 0) {
      const address = guarded(() => this.#set.point());
      this.#point = new Float64Array(memory.buffer, address, this.#inputs.length);
    }
    for (let i = 0; i < values.length; i++) {
      const value = values[i];
      this.#point[i] = typeof value === 'number' ? value : numberOf(value, () => `input \`${this.#inputs[i]}\``);
    }
    return guarded(() => this.#set.value(index));
  }

  /** Evaluates many rows, with one column for each input, and returns one column for each output. NaN is unknown. */
  evaluateColumns(columns: Columns): Float64Array[] {
    const given = inOrder<ArrayLike<Known>>(columns, this.#inputs);
    const rows = given[0]?.length ?? 0;
    const inputs = new Float64Array(rows * given.length);
    for (let i = 0; i < given.length; i++) {
      const column = given[i]!;
      const name = `column \`${this.#inputs[i]}\``;
      if (column.length !== rows) throw refusal(`${name} has ${column.length} rows, the first one ${rows}`, 'give columns of one length');
      inputs.set(numbers(column, (row) => `row ${row + 1} of ${name}`), i * rows);
    }
    const values = guarded(() => this.#set.evaluateColumns(inputs));
    return this.#outputs.map((_, i) => values.slice(i * rows, (i + 1) * rows));
  }

  #numbers(point: Point): Float64Array {
    return numbers(inOrder(point, this.#inputs), (i) => `input \`${this.#inputs[i]}\``);
  }

  /** Returns all rules with the terms that they read and conclude. */
  viewed(): ViewedRules {
    return parsed(() => this.#set.viewed());
  }

  /**
   * Returns the degrees of the propositions of all rules at a point, rule by rule. The degree is NaN if a proposition
   * reads an output.
   */
  propositionDegrees(point: Point): Float64Array {
    const values = this.#numbers(point);
    return guarded(() => this.#set.propositionDegrees(values));
  }

  /** Returns an explanation of the outputs at a point. */
  explain(point: Point): Explanation {
    const values = this.#numbers(point);
    return parsed(() => this.#set.explain(values));
  }

  /**
   * Returns a value for each input, to be used as {@link View.held}. Numbers in `fixed` are kept; the other values are
   * chosen so that the output varies over the axes.
   */
  held(output: number, axes: number[], fixed: Known[]): number[] {
    const known = numbers(fixed, (i) => `value ${i + 1}`);
    return [...guarded(() => this.#set.held(output, Uint32Array.from(axes), known))];
  }

  /** Computes the cells of a map. */
  map(view: View): Cells {
    const all = viewed(view, (made) => this.#set.map(made));
    const cells = all.length / 4;
    const part = (i: number) => all.subarray(i * cells, (i + 1) * cells);
    return { values: part(0), coverage: part(1), dominantRules: part(2), filled: part(3) };
  }

  /** Returns the picture of `flagred map` as SVG. */
  mapSvg(kind: 'map' | 'surface' | 'rules', view: View): string {
    return viewed(view, (made) => this.#set.mapSvg(kind, made));
  }

  /** Returns the picture of `flagred plot` as SVG. */
  termsSvg(): string {
    return guarded(() => this.#set.termsSvg());
  }

  /** Returns the picture of `flagred explain` as SVG. */
  explanationSvg(point: Point): string {
    const values = this.#numbers(point);
    return guarded(() => this.#set.explanationSvg(values));
  }

  free(): void {
    this.#point = new Float64Array();
    guarded(() => this.#set.free());
  }
}

/** Returns the document of `flagred check --json` as text. A rule set that a profile names must be a shipped one. */
export const checkRules = (text: string, file: string): string => guarded(() => wasm.checkRules(text, file));

/** A template text. */
export interface Start {
  name: string;
  about: string;
  text: string;
}

/** Returns the template of `flagred new`, the shipped rule sets and profiles, and examples. */
export const startingPoints = (): Start[] => parsed(() => wasm.startingPoints());

export type Format = 'FIS' | 'FLL' | 'FCL' | 'FML';

/** A converted rule set. */
export interface Exchanged {
  text: string;
  /** The format that was read or written. */
  format: Format | 'YAML';
  /** Notes about content that is expressed differently, or was omitted. */
  notes: string[];
}

/** Converts a rule set of another program to YAML; throws for content that cannot be converted, unless `lossy`. */
export const importRules = (text: string, lossy = false): Exchanged => parsed(() => wasm.importRules(text, lossy));

/**
 * Converts a rule set to the format of another program; throws for content that the format cannot represent, unless
 * `lossy`.
 */
export const exportRules = (text: string, format: Format, lossy = false): Exchanged =>
  parsed(() => wasm.exportRules(text, format, lossy));

/** Colours, each as red, green and blue. */
export interface Colours {
  /** 256 colours of a scale from low to high values. */
  scale: Uint8Array;
  /** The same for risks, whose high values are bad: outputs with the name `risk` or a name that ends in `_risk`. */
  risk: Uint8Array;
  /** Unordered colours. */
  distinct: Uint8Array;
  /** Unordered colours that are dark enough for thin lines on white. */
  lines: Uint8Array;
}

/** Returns the colours of flagred's pictures. */
export function colours(): Colours {
  const all = guarded(() => wasm.colours());
  const part = (from: number, to: number) => all.slice(3 * from, 3 * to);
  return { scale: part(0, 256), risk: part(256, 512), distinct: part(512, 524), lines: part(524, 536) };
}

function parsed<T>(call: () => string): T {
  return JSON.parse(guarded(call)) as T;
}

function viewed<T>(view: View, call: (made: wasm.View) => T): T {
  return guarded(() => {
    const axes = view.axes.flatMap(({ input, low, high }) => [input, low, high]);
    const made = new wasm.View(view.output, Float64Array.from(axes), view.points, numbers(view.held, (i) => `held value ${i + 1}`));
    try {
      return call(made);
    } finally {
      made.free();
    }
  });
}
