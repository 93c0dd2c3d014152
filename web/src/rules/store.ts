/** The text that one was at, kept in this browser. */

const KEY = 'flagred.rules';
/** What was kept before a link or an example was opened. */
const ASIDE = 'flagred.rules.before';

/** The text that was kept last; nothing where there is none, or the browser keeps nothing. */
export const kept = (): string | undefined => read(KEY);

/** The text that was set aside last. */
export const before = (): string | undefined => read(ASIDE);

/** Sets aside what is kept, before another text takes its place. */
export function setAside(): void {
  const text = kept();
  if (text !== undefined) write(ASIDE, text);
}

/** Keeps a text; says whether it could. */
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
