/** The user's current text, stored in this browser. */

const KEY = 'flagred.rules';
/** The text that was stored before a link or an example was opened. */
const ASIDE = 'flagred.rules.before';

/** Returns the text that was stored last; `undefined` if there is none, or if the browser stores nothing. */
export const kept = (): string | undefined => read(KEY);

/** Returns the text that was set aside last. */
export const before = (): string | undefined => read(ASIDE);

/** Sets the stored text aside, before another text replaces it. */
export function setAside(): void {
  const text = kept();
  if (text !== undefined) write(ASIDE, text);
}

/** Stores a text; returns whether that succeeded. */
export const keep = (text: string): boolean => write(KEY, text);

function read(key: string): string | undefined {
  try {
    return localStorage.getItem(key) ?? undefined;
  } catch {
    return undefined;
  }
}

function write(key: string, text: string): boolean {
  try {
    localStorage.setItem(key, text);
    return true;
  } catch {
    return false;
  }
}
