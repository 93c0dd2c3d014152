/**
 * The calls of the rules room to its worker. Every call contains the text it is about; results for the last texts are
 * kept.
 */

import {
  RuleSet,
  RuleText,
  colours,
  exportRules,
  importRules,
  startingPoints,
  type About,
  type Cells,
  type Colours,
  type Completion,
  type DrawnVariable,
  type Edit,
  type Exchanged,
  type Explanation,
  type Diagnostic,
  type Format,
  type Hover,
  type Parts,
  type Start,
  type View,
  type ViewedRules,
} from 'flagred/rules';
import type { Tell } from '../calls';

interface Known {
  text: string;
  open: RuleText;
  set: RuleSet | undefined;
  /** The reason why the text cannot be used. */
  refusal: string;
}

/** The number of texts whose results are kept: before a drag, during it, and while typing. */
const MOST = 3;
const known: Known[] = [];

function of(text: string): Known {
  const at = known.findIndex((one) => one.text === text);
  const [found] = at < 0 ? [] : known.splice(at, 1);
  const one = found ?? read(text);
  known.push(one);
  while (known.length > MOST) forget(known.shift()!);
  return one;
}

function read(text: string): Known {
  const open = new RuleText(text);
  try {
    return { text, open, set: open.ruleSet(), refusal: '' };
  } catch (error) {
    if (!(error instanceof Error) || error.name === 'Panic') throw error;
    return { text, open, set: undefined, refusal: error.message };
  }
}

function forget({ open, set }: Known): void {
  open.free();
  set?.free();
}

function compiled(text: string): RuleSet {
  const { set, refusal } = of(text);
  if (!set) throw new Error(refusal);
  return set;
}

/** The meaning of a text, as far as it can be read. */
export interface Opened {
  text: string;
  isProfile: boolean;
  variables: DrawnVariable[];
  /** The parts that forms can change; `null` for a profile. */
  parts: Parts | null;
  /** `undefined` if the rule set cannot be used. */
  about: About | undefined;
}

export function rulesOpen(_tell: Tell, text: string): Opened {
  const { open, set } = of(text);
  return { text, isProfile: open.isProfile, variables: open.variables(), parts: open.parts(), about: set?.about() };
}

export const rulesFindings = (_tell: Tell, text: string): Diagnostic[] => of(text).open.findings();
export const rulesCompletions = (_tell: Tell, text: string, at: number): Completion[] => of(text).open.completions(at);
export const rulesHover = (_tell: Tell, text: string, at: number): Hover | null => of(text).open.hover(at);
export const rulesDefinition = (_tell: Tell, text: string, at: number): number | undefined => of(text).open.definition(at);
export const rulesRename = (_tell: Tell, text: string, at: number, name: string): Edit[] => of(text).open.rename(at, name);
export const rulesFormat = (_tell: Tell, text: string): string => of(text).open.formatted();

export const rulesAddVariable = (_tell: Tell, text: string, name: string, low: number, high: number, isOutput: boolean): Edit[] =>
  of(text).open.addVariable(name, low, high, isOutput);
export const rulesAddTerm = (_tell: Tell, text: string, variable: number, name: string): Edit[] => of(text).open.addTerm(variable, name);
export const rulesRemoveNamed = (_tell: Tell, text: string, variable: number, term?: number): Edit[] =>
  of(text).open.removeNamed(variable, term);
export const rulesSetRange = (_tell: Tell, text: string, variable: number, low: number, high: number): Edit[] =>
  of(text).open.setRange(variable, low, high);
export const rulesSetUnit = (_tell: Tell, text: string, variable: number, unit: string): Edit[] => of(text).open.setUnit(variable, unit);
export const rulesSetShape = (_tell: Tell, text: string, variable: number, term: number, shape: string): Edit[] =>
  of(text).open.setShape(variable, term, shape);
export const rulesSetParameters = (_tell: Tell, text: string, variable: number, term: number, to: string): Edit[] =>
  of(text).open.setParameters(variable, term, to);
export const rulesAddRule = (_tell: Tell, text: string, rule: string): Edit[] => of(text).open.addRule(rule);
export const rulesChangeRule = (_tell: Tell, text: string, rule: number, to: string): Edit[] => of(text).open.changeRule(rule, to);
export const rulesRemoveRule = (_tell: Tell, text: string, rule: number): Edit[] => of(text).open.removeRule(rule);

export const rulesMap = (_tell: Tell, text: string, view: View): Cells => compiled(text).map(view);
/** The explanation of the outputs at a point: all rules, and the degree of each proposition. */
export interface Reasons {
  explanation: Explanation;
  viewed: ViewedRules;
  degrees: Float64Array;
  variables: DrawnVariable[];
}

export function rulesExplain(_tell: Tell, text: string, point: number[]): Reasons {
  const { open } = of(text);
  const set = compiled(text);
  return { explanation: set.explain(point), viewed: set.viewed(), degrees: set.propositionDegrees(point), variables: open.variables() };
}
export const rulesHeld = (_tell: Tell, text: string, output: number, axes: number[], fixed: (number | null)[]): number[] =>
  compiled(text).held(output, axes, fixed);

export type Picture = 'map' | 'surface' | 'rules' | 'terms' | 'explanation';

/** Returns a picture as drawn by the command line. */
export function rulesPicture(_tell: Tell, text: string, kind: Picture, view: View): string {
  const set = compiled(text);
  if (kind === 'terms') return set.termsSvg();
  return kind === 'explanation' ? set.explanationSvg(view.held) : set.mapSvg(kind, view);
}

/** Identifies a handle of a term. */
export interface Place {
  variable: number;
  term: number;
  handle: number;
}

/** Returns the text after a handle of a term was moved, starting from `text`, and its meaning. */
export function rulesDrag(_tell: Tell, text: string, { variable, term, handle }: Place, x: number, degree: number): Opened {
  const edits = of(text).open.drag(variable, term, handle, x, degree);
  return rulesOpen(_tell, edited(text, edits));
}

function edited(text: string, edits: Edit[]): string {
  let [changed, at] = ['', 0];
  for (const { from, to, insert } of [...edits].sort((a, b) => a.from - b.from || a.to - b.to)) {
    changed += text.slice(at, from) + insert;
    at = to;
  }
  return changed + text.slice(at);
}

export const rulesStarts = (_tell: Tell): Start[] => startingPoints();
export const rulesColours = (_tell: Tell): Colours => colours();
export const rulesImport = (_tell: Tell, text: string, lossy: boolean): Exchanged => importRules(text, lossy);
export const rulesExport = (_tell: Tell, text: string, format: Format, lossy: boolean): Exchanged =>
  exportRules(text, format, lossy);
