/** Loads rule sets from files and saves them, in YAML and in the formats of other programs. */

import type { Exchanged, Format, View } from 'flagred';
import type { App } from '../app';
import { download, h } from '../dom';
import { Trapped } from '../engine';
import type { Picture } from './calls';

const endings: Record<Format, string> = { FIS: 'fis', FLL: 'fll', FCL: 'fcl', FML: 'xml' };
/** The maximum size of a file; a larger one is not a rule set. */
const LARGEST_BYTES = 10_000_000;

/**
 * Returns the text of a file in YAML. If something would be lost the user is asked; `undefined` if the user declines.
 */
export async function opened(app: App, file: File): Promise<string | undefined> {
  if (file.size > LARGEST_BYTES) throw new Error(`\`${file.name}\` is larger than 10 MB: a rule set is a small text`);
  const text = new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer());
  const read = await withLosses(`Open ${file.name}`, (lossy) => app.engine.call('rulesImport', text, lossy));
  if (!read) return undefined;
  if (read.format === 'YAML') app.say(`${file.name} is open`);
  else await told(`${file.name} was read as ${read.format}`, read.notes);
  return read.text;
}

/** Downloads a rule set in a format. */
export async function saved(app: App, name: string, text: string, format: Format | 'YAML'): Promise<void> {
  if (format === 'YAML') return download(`${name}.yaml`, text, 'application/yaml');
  const written = await withLosses(`Write as ${format}`, (lossy) => app.engine.call('rulesExport', text, format, lossy));
  if (!written) return;
  download(`${name}.${endings[format]}`, written.text, 'text/plain');
  if (written.notes.length > 0) await told(`Written as ${format}`, written.notes);
}

/** Downloads a picture. */
export async function drawn(app: App, name: string, text: string, kind: Picture, view: View): Promise<void> {
  download(`${name}-${kind}.svg`, await app.engine.call('rulesPicture', text, kind, view), 'image/svg+xml');
}

/** Runs without losses. If that is refused, but is possible with losses, asks the user whether to accept them. */
async function withLosses(title: string, run: (lossy: boolean) => Promise<Exchanged>): Promise<Exchanged | undefined> {
  try {
    return await run(false);
  } catch (error) {
    if (error instanceof Trapped) throw error;
    const lossy = await run(true).catch((still: Error) => {
      if (still instanceof Trapped) throw still;
      return undefined;
    });
    const lines = (error as Error).message.split('\n');
    if (!lossy) {
      await dialog(title, lines, ['Close']);
      return undefined;
    }
    const goOn = await dialog(title, lines, ['Leave it out and continue', 'Cancel']);
    return goOn === 'Leave it out and continue' ? lossy : undefined;
  }
}

async function told(title: string, notes: string[]): Promise<void> {
  await dialog(title, notes.length > 0 ? notes : ['Nothing was lost.'], ['Close']);
}

/** Groups the lines of a message: help for a line, and its continuation, belong to that line. */
function items(lines: string[]): string[] {
  const made: string[] = [];
  for (const line of lines) {
    if (made.length > 0 && /^(\s|help: )/.test(line)) made.push(`${made.pop()}\n${line.trim()}`);
    else made.push(line);
  }
  return made;
}

/** Shows lines; returns the text on the button that was pressed. */
function dialog(title: string, lines: string[], answers: string[]): Promise<string> {
  return new Promise((resolve) => {
    const buttons = answers.map((answer, i) => h('button', { value: answer, class: i === 0 ? 'main' : '' }, answer));
    const made = h(
      'dialog',
      { 'aria-label': title, class: 'notes' },
      h('form', { method: 'dialog' }, h('h2', {}, title), h('ul', {}, ...items(lines).map((line) => h('li', {}, line))), h('div', { class: 'answers' }, ...buttons)),
    );
    made.addEventListener('close', () => {
      made.remove();
      resolve(made.returnValue);
    });
    document.body.append(made);
    made.showModal();
  });
}
