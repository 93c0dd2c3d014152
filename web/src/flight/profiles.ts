/** The choice of a profile: a shipped one, or one from a file. */

import { fill, h } from '../dom';
import type { ProfileSource } from './calls';

export interface Profiles {
  element: HTMLElement;
  /** Offers the shipped profiles, and the chosen one. */
  show(shipped: readonly string[], chosen: ProfileSource): void;
}

/** Creates the choice; `use` receives the name of a shipped profile, or a text. */
export function profiles(use: (source: ProfileSource) => void): Profiles {
  const select = h('select', { 'aria-label': 'Profile', title: 'Profile' });
  const file = h('input', { type: 'file', accept: '.yaml,.yml', multiple: true, 'aria-label': 'Profile from a file', hidden: true });
  select.addEventListener('change', () => {
    if (select.value === '') file.click();
    else use({ name: select.value });
  });
  file.addEventListener('change', async () => {
    const chosen = [...(file.files ?? [])];
    file.value = '';
    if (chosen.length > 0) use(await profileIn(chosen));
  });
  return {
    element: h('span', {}, select, file),
    show(shipped, { name: chosen, text }) {
      const names = text === undefined ? shipped : [...shipped, chosen];
      const option = (value: string, words: string) => h('option', { value, selected: value === chosen }, words);
      fill(select, ...names.map((name) => option(name, `Profile ${name}`)), option('', 'Profile from a file, rule set optional …'));
    },
  };
}

/** Reads a profile that was chosen, with its rule set if that was chosen too. */
async function profileIn(files: File[]): Promise<ProfileSource> {
  const texts = await Promise.all(files.map(async (file) => ({ name: file.name, text: await file.text() })));
  const isProfile = ({ text }: { text: string }) => /^flagred\s*:/m.test(text);
  const profile = texts.find(isProfile) ?? texts[0]!;
  const rules = texts.find((other) => other !== profile)?.text;
  return rules === undefined ? profile : { ...profile, rules };
}
