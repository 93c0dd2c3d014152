/** The text that one was at, kept in this browser. */

const KEY = 'flagred.rules';

/** The text that was kept last; nothing where there is none, or the browser keeps nothing. */
export function kept(): string | undefined {
  try {
    return localStorage.getItem(KEY) ?? undefined;
  } catch {
    return undefined;
  }
}

/** Keeps a text; says whether it could. */
export function keep(text: string): boolean {
  try {
    localStorage.setItem(KEY, text);
    return true;
  } catch {
    return false;
  }
}
