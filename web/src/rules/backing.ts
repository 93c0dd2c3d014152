/**
 * The file on disk that the editor shows: saved, changed in the editor, changed on disk by another program, or
 * read-only.
 */

import type { BackingFile } from '../app';
import { fill, h } from '../dom';

export interface Backing {
  element: HTMLElement;
  /** The text that was read. */
  text: string;
  changed(text: string): void;
  save(text: string): Promise<void>;
}

/** The interval of checks of the file. */
const LOOK_MS = 3000;

/** Reads the file. `load` puts another text into the editor. */
export async function backing(file: BackingFile, say: (words: string) => void, load: (text: string) => void): Promise<Backing> {
  let saved = await file.read();
  let now = saved;
  /** The text on disk, if another program wrote it and the user has not decided yet which text to keep. */
  let theirs: string | undefined;
  const state = h('span', { role: 'status' });
  const choice = h('span', {});
  const save = h('button', { type: 'button', title: 'Save (Ctrl+S)', onclick: () => void made.save(now) }, 'Save');
  const element = h('div', { class: 'backing' }, h('b', {}, file.name), ' ', state, ' ', file.readOnly ? '' : save, choice);

  function show(): void {
    const words = file.readOnly ? 'read-only' : theirs !== undefined ? 'changed on disk' : now === saved ? 'saved' : 'changed';
    if (state.textContent !== words) state.textContent = words;
    state.className = words.replaceAll(' ', '-');
    save.disabled = now === saved || theirs !== undefined;
    if (theirs === undefined) return fill(choice);
    if (choice.childElementCount > 0) return;
    const take = (): void => {
      const text = theirs!;
      [saved, now, theirs] = [text, text, undefined];
      load(text);
      show();
    };
    const stay = (): void => {
      [saved, theirs] = [theirs!, undefined];
      show();
    };
    fill(
      choice,
      h('button', { type: 'button', onclick: take }, 'Load it'),
      h('button', { type: 'button', onclick: stay }, 'Keep mine'),
    );
  }

  async function look(): Promise<void> {
    const text = await file.read();
    if (text === saved || text === theirs) return;
    if (now === saved) {
      [saved, now] = [text, text];
      load(text);
      say(`${file.name} changed on disk and was read again`);
    } else if (text === now) saved = text;
    else theirs = text;
    show();
  }

  const made: Backing = {
    element,
    text: saved,
    changed(text) {
      now = text;
      show();
    },
    async save(text) {
      if (file.readOnly) return say(`${file.name} is read-only`);
      if (theirs !== undefined) return say(`${file.name} changed on disk: load it, or keep yours`);
      try {
        await file.write(text, saved);
        saved = text;
        say(`${file.name} is saved`);
      } catch (error) {
        say(error instanceof Error ? error.message : String(error));
        await look().catch(() => undefined);
      }
      show();
    },
  };
  // The server may be unavailable for a moment; saving reports errors.
  setInterval(() => void look().catch(() => undefined), LOOK_MS);
  show();
  return made;
}
