/** The calls of the rules room to the worker for data. The table that was read last is kept. */

import { DataTable, type Errors, type Made } from 'flagred/data';
import type { Tell } from '../calls';

/** A file in CSV. */
export interface Csv {
  name: string;
  text: string;
}

let kept: { csv: Csv; table: DataTable } | undefined;

function table(csv: Csv): DataTable {
  if (kept?.csv.name === csv.name && kept.csv.text === csv.text) return kept.table;
  const made = new DataTable(csv.name, csv.text);
  kept?.table.free();
  kept = { csv, table: made };
  return made;
}

export const dataErrors = (_tell: Tell, csv: Csv, rules: string): Errors => table(csv).errors(rules);

/** Calls `tell` with the step, and with the error and the text so far. */
export const dataTune = (tell: Tell, csv: Csv, rules: string): Made =>
  table(csv).tune(rules, (step, error, text) => tell(step, { error, text }));

export const dataLearn = (_tell: Tell, csv: Csv, rules: string, complete: boolean): Made => table(csv).learn(rules, complete);
