/** Rule sets: an open text under an author's hands, a compiled rule set to evaluate and draw, other programs' formats. */

import type { Explanation } from './documents.js';
import { beside, type Source } from './load.js';
import { guard } from './panic.js';
import * as wasm from './wasm/rules.js';

export type { Explanation } from './documents.js';

const guarded = guard(wasm.panicMessage);

/** Loads the module for rule sets, from beside this file or from elsewhere. Calls after the first do nothing. */
export async function startRules(source?: Source): Promise<void> {
  await wasm.default({ module_or_path: source ?? (await beside('rules')) });
}

/** A finding in a text; places count UTF-16 code units, as JavaScript does. */
export interface Diagnostic {
  severity: 'error' | 'warning' | 'note';
  code: string;
  message: string;
  help: string | null;
  from: number;
  to: number;
  /** Counted from 1. */
  line: number;
  related: { from: number; to: number; message: string }[];
}

/** What can be written at a place. */
export interface Completion {
  label: string;
  /** What is written. */
  text: string;
  kind: 'keyword' | 'variable' | 'choice' | 'key' | 'signal';
  detail: string | null;
}

/** What a name means. */
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

/** A point by which a term is dragged. */
export interface Handle {
  /** The parameter that it moves: `peak`. */
  name: string;
  x: number;
  degree: number;
  /** How far it goes. */
  low: number;
  high: number;
  /** Whether it moves up and down too. */
  movesDegree: boolean;
}

/** A term as a curve: x and degree in turns. A number, which is no set, has none. */
export interface DrawnTerm {
  name: string;
  /** As it stands in a rule set: `triangle: [0, 2, 4]`. */
  shape: string;
  curve: number[];
  handles: Handle[];
}

/** A variable as it is drawn. Its range is `null` where it cannot be read. */
export interface DrawnVariable {
  name: string;
  description: string | null;
  unit: string | null;
  isOutput: boolean;
  low: number | null;
  high: number | null;
  /** The part where its terms change. */
  shown: [number | null, number | null];
  terms: DrawnTerm[];
}

/** Where the parts of a rule set are that can be renamed and removed. */
export interface Parts {
  variables: { at: number; terms: number[] }[];
  /** The rules in words. */
  rules: string[];
}

/** A rule set or a profile as an editor shows it, whatever is wrong with it. Call {@link RuleText.free} when done. */
export class RuleText {
  readonly #text: wasm.RuleText;

  constructor(text: string) {
    this.#text = guarded(() => new wasm.RuleText(text));
  }

  get isProfile(): boolean {
    return guarded(() => this.#text.isProfile);
  }

  /** The rule set, or the profile with its rule set, compiled; throws what is wrong with it. */
  ruleSet(): RuleSet {
    return new RuleSet(guarded(() => this.#text.ruleSet()));
  }

  /** What `flagred check` finds. */
  findings(): Diagnostic[] {
    return parsed(() => this.#text.findings());
  }

  /** What can be written at a place. */
  completions(at: number): Completion[] {
    return parsed(() => this.#text.completions(at));
  }

  /** What the name at a place means. */
  hover(at: number): Hover | null {
    return parsed(() => this.#text.hover(at));
  }

  /** Where the name at a place is defined. */
  definition(at: number): number | undefined {
    return guarded(() => this.#text.definition(at));
  }

  /** The edits that give the name at a place another. */
  rename(at: number, name: string): Edit[] {
    return parsed(() => this.#text.rename(at, name));
  }

  /** The text in the layout of `flagred fmt`. */
  formatted(): string {
    return guarded(() => this.#text.formatted());
  }

  /** Variables and terms to draw, inputs first. */
  variables(): DrawnVariable[] {
    return parsed(() => this.#text.variables());
  }

  /** The edits that drag a point of a term: they change its numbers and nothing else. */
  drag(variable: number, term: number, handle: number, x: number, degree: number): Edit[] {
    return parsed(() => this.#text.drag(variable, term, handle, x, degree));
  }

  /** Where the names of variables, inputs first, and of their terms are, and the rules; `null` of a profile. */
  parts(): Parts | null {
    return parsed(() => this.#text.parts());
  }

  /** The edits that add an input or output with two terms. */
  addVariable(name: string, low: number, high: number, isOutput: boolean): Edit[] {
    return parsed(() => this.#text.addVariable(name, low, high, isOutput));
  }

  /** The edits that add a term to a variable. */
  addTerm(variable: number, name: string): Edit[] {
    return parsed(() => this.#text.addTerm(variable, name));
  }

  /** The edits that add a rule. */
  addRule(rule: string): Edit[] {
    return parsed(() => this.#text.addRule(rule));
  }

  /** The edits that give a rule other words. */
  changeRule(rule: number, to: string): Edit[] {
    return parsed(() => this.#text.changeRule(rule, to));
  }

  /** The edits that remove a variable, or a term of it, that no rule uses. */
  removeNamed(variable: number, term?: number): Edit[] {
    return parsed(() => this.#text.removeNamed(variable, term));
  }

  /** The edits that remove a rule. */
  removeRule(rule: number): Edit[] {
    return parsed(() => this.#text.removeRule(rule));
  }

  free(): void {
    this.#text.free();
  }
}

/** An input or output of a rule set. */
export interface Variable {
  name: string;
  description: string | null;
  unit: string | null;
  low: number;
  high: number;
  /** The part where its terms change. */
  shown: [number, number];
}

/** What a rule set has. */
export interface About {
  name: string;
  inputs: Variable[];
  outputs: Variable[];
  /** The rules in words. */
  rules: string[];
  /** The index of the output that a profile takes; 0 of a rule set. */
  output: number;
  /** How a profile fills gaps between the rules. */
  filling: string | null;
}

/** The value of an output; `null` is unknown. */
export interface Value {
  name: string;
  value: number | null;
  /** Whether no rule fires and the value is the rule set's default. */
  isDefault: boolean;
  /** The largest firing strength. */
  coverage: number;
  /** The number of the rule that has it, from 1; `null` where none fires. */
  dominantRule: number | null;
  /** Whether an input lay outside its range. */
  clamped: boolean;
}

/** What a map shows: one output over one or two inputs, the others held. */
export interface View {
  /** The index of the output. */
  output: number;
  /** The index of an input and the part of it that is shown; one or two. */
  axes: { input: number; low: number; high: number }[];
  /** The points along each axis. */
  points: number;
  /** A value for each input; those of the axes do not count. */
  held: number[];
}

/** The cells of a map: for each point of the first axis one for each of the second. NaN is none. */
export interface Cells {
  values: Float64Array;
  /** The largest firing strength. */
  coverage: Float64Array;
  /** The number of the rule that has it, from 1; NaN where none fires. */
  dominantRules: Float64Array;
  /** 1 where a profile filled a gap between rules. */
  filled: Float64Array;
}

/** All rules with the terms that they read and conclude. */
export interface ViewedRules {
  /** Whether a consequent is scaled by the firing strength, rather than cut. */
  scales: boolean;
  rules: {
    /** `words` are hedges and term; `curve` is that of hedges, x and degree in turns, and empty without hedges. */
    conditions: { variable: string; words: string; term: string | null; curve: number[] }[];
    conclusions: { output: string; words: string; term: string }[];
  }[];
}

/** A rule set, compiled once. Call {@link RuleSet.free} when done. */
export class RuleSet {
  readonly #set: wasm.RuleSet;

  /** Compiles a rule set in YAML, FIS, FLL, FCL or FML, or that of a profile; throws what is wrong with it. */
  constructor(text: string | wasm.RuleSet) {
    this.#set = typeof text === 'string' ? guarded(() => new wasm.RuleSet(text)) : text;
  }

  about(): About {
    return parsed(() => this.#set.about());
  }

  /** The outputs at a point, which holds a value for each input. */
  evaluate(point: number[]): Value[] {
    return parsed(() => this.#set.evaluate(Float64Array.from(point)));
  }

  /** The outputs of many rows: a column for each input in, one for each output out. NaN is unknown. */
  evaluateColumns(columns: ArrayLike<number>[]): Float64Array[] {
    const rows = columns[0]?.length ?? 0;
    const inputs = new Float64Array(rows * columns.length);
    columns.forEach((column, i) => inputs.set(column, i * rows));
    const values = guarded(() => this.#set.evaluateColumns(inputs));
    return this.about().outputs.map((_, i) => values.slice(i * rows, (i + 1) * rows));
  }

  /** What each rule reads and concludes. */
  viewed(): ViewedRules {
    return parsed(() => this.#set.viewed());
  }

  /** The degrees of the propositions of all rules at a point, rule by rule. NaN where a proposition reads an output. */
  propositionDegrees(point: number[]): Float64Array {
    return guarded(() => this.#set.propositionDegrees(Float64Array.from(point)));
  }

  /** Why the outputs at a point are what they are. */
  explain(point: number[]): Explanation {
    return parsed(() => this.#set.explain(Float64Array.from(point)));
  }

  /** Values for the inputs that are no axis: those of `fixed` that are numbers stay. */
  held(output: number, axes: number[], fixed: (number | null)[]): number[] {
    const known = Float64Array.from(fixed, (value) => value ?? NaN);
    return [...guarded(() => this.#set.held(output, Uint32Array.from(axes), known))];
  }

  /** The cells of a map. */
  map(view: View): Cells {
    const all = viewed(view, (made) => this.#set.map(made));
    const cells = all.length / 4;
    const part = (i: number) => all.subarray(i * cells, (i + 1) * cells);
    return { values: part(0), coverage: part(1), dominantRules: part(2), filled: part(3) };
  }

  /** The picture of `flagred map`: SVG. */
  mapSvg(kind: 'map' | 'surface' | 'rules', view: View): string {
    return viewed(view, (made) => this.#set.mapSvg(kind, made));
  }

  /** The picture of `flagred plot`: SVG. */
  termsSvg(): string {
    return guarded(() => this.#set.termsSvg());
  }

  /** The picture of `flagred explain`: SVG. */
  explanationSvg(point: number[]): string {
    return guarded(() => this.#set.explanationSvg(Float64Array.from(point)));
  }

  free(): void {
    this.#set.free();
  }
}

/** The document of `flagred check --json`, as text. A rule set that a profile names is a shipped one. */
export const checkRules = (text: string, file: string): string => guarded(() => wasm.checkRules(text, file));

/** A text to start from. */
export interface Start {
  name: string;
  about: string;
  text: string;
}

/** The starter of `flagred new`, the shipped rule sets and profiles, and examples. */
export const startingPoints = (): Start[] => parsed(() => wasm.startingPoints());

export type Format = 'FIS' | 'FLL' | 'FCL' | 'FML';

/** A rule set in another format. */
export interface Exchanged {
  text: string;
  /** The format that was read or written. */
  format: Format | 'YAML';
  /** What is said in another way, and what is left out. */
  notes: string[];
}

/** A rule set of another program in YAML; throws what it says that cannot be carried over, unless `lossy`. */
export const importRules = (text: string, lossy = false): Exchanged => parsed(() => wasm.importRules(text, lossy));

/** A rule set for another program; throws what the format cannot say, unless `lossy`. */
export const exportRules = (text: string, format: Format, lossy = false): Exchanged =>
  parsed(() => wasm.exportRules(text, format, lossy));

/** Colours: red, green and blue of each. */
export interface Colours {
  /** Of values from low to high, 256. */
  scale: Uint8Array;
  /** Without order. */
  distinct: Uint8Array;
  /** Without order, dark enough for thin lines on white. */
  lines: Uint8Array;
}

/** The colours of flagred's pictures. */
export function colours(): Colours {
  const all = guarded(() => wasm.colours());
  const part = (from: number, to: number) => all.slice(3 * from, 3 * to);
  return { scale: part(0, 256), distinct: part(256, 268), lines: part(268, 280) };
}

function parsed<T>(call: () => string): T {
  return JSON.parse(guarded(call)) as T;
}

function viewed<T>(view: View, call: (made: wasm.View) => T): T {
  return guarded(() => {
    const axes = view.axes.flatMap(({ input, low, high }) => [input, low, high]);
    const made = new wasm.View(view.output, Float64Array.from(axes), view.points, Float64Array.from(view.held));
    try {
      return call(made);
    } finally {
      made.free();
    }
  });
}
