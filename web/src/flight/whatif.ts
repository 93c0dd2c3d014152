/** A panel for trying other thresholds and times of the profile, with the resulting verdict. */

import type { LevelChanges, LevelSettings, Threshold, VerdictChanges, VerdictSettings } from 'flagred';
import { fill, h, type Child } from '../dom';

export interface WhatIf {
  element: HTMLElement;
  /** Shows the settings of a profile, and the changes to them. */
  set(base: VerdictSettings, changes: VerdictChanges): void;
  /** Shows the verdict with the profile and with the changes. */
  tell(...words: Child[]): void;
  /** Shows why the changes cannot be used. */
  refuse(message: string): void;
}

type LevelName = 'warn' | 'fail';
type Place = [LevelName, 'raise' | 'until', keyof Threshold] | [LevelName, 'after_s'] | [TimeName];
type TimeName = 'clear_after_s' | 'quiet_after_take_off_s' | 'quiet_before_landing_s';

interface Field {
  place: Place;
  label: string;
  unit: '%' | 's';
  slider?: boolean;
}

const level = (name: LevelName): Field[] => [
  { place: [name, 'raise', 'risk_pct'], label: 'raised at a risk of', unit: '%', slider: true },
  { place: [name, 'until', 'risk_pct'], label: 'held down to a risk of', unit: '%' },
  { place: [name, 'raise', 'elevated_risk_pct'], label: 'or at an elevated risk of', unit: '%' },
  { place: [name, 'until', 'elevated_risk_pct'], label: 'held down to an elevated risk of', unit: '%' },
  { place: [name, 'after_s'], label: 'reached for at least', unit: 's' },
];

const GROUPS: [string, Field[]][] = [
  ['WARN', level('warn')],
  ['FAIL', level('fail')],
  [
    'Times',
    [
      { place: ['clear_after_s'], label: 'lowered after', unit: 's' },
      { place: ['quiet_after_take_off_s'], label: 'quiet after take-off', unit: 's' },
      { place: ['quiet_before_landing_s'], label: 'quiet before landing', unit: 's' },
    ],
  ],
];

function valueAt(settings: VerdictSettings, place: Place): number | null {
  if (place.length === 1) return settings[place[0]];
  if (place.length === 2) return settings[place[0]].after_s;
  return settings[place[0]][place[1]][place[2]];
}

function changedAt(changes: VerdictChanges, place: Place): number | null | undefined {
  if (place.length === 1) return changes[place[0]];
  if (place.length === 2) return changes[place[0]]?.after_s;
  return changes[place[0]]?.[place[1]]?.[place[2]];
}

function put(changes: VerdictChanges, place: Place, value: number): void {
  if (place.length === 1) changes[place[0]] = value;
  else {
    const level: LevelChanges = (changes[place[0]] ??= {});
    if (place.length === 2) level.after_s = value;
    else (level[place[1]] ??= {})[place[2]] = value;
  }
}

/**
 * Keeps the threshold that holds a level at or below the threshold that raises it. If one is moved past the other,
 * the other is moved along.
 */
function keepOrder(changes: VerdictChanges, base: VerdictSettings, moved: Place): void {
  if (moved.length !== 3) return;
  const [name, part, key] = moved;
  const settings: LevelSettings = base[name];
  const at = (which: 'raise' | 'until') => changes[name]?.[which]?.[key] ?? settings[which][key];
  const [raise, until] = [at('raise'), at('until')];
  if (raise === null || until === null || until <= raise) return;
  put(changes, [name, part === 'raise' ? 'until' : 'raise', key], part === 'raise' ? raise : until);
}

/** Whether nothing is changed. */
export const isUnchanged = (changes: VerdictChanges): boolean => Object.keys(changes).length === 0;

/** Creates the panel; `change` receives all changes to the profile. */
export function whatIf(change: (changes: VerdictChanges) => void): WhatIf {
  let base: VerdictSettings | undefined;
  let changes: VerdictChanges = {};
  const shown: { field: Field; inputs: HTMLInputElement[] }[] = [];
  const verdict = h('p', { class: 'what-if-verdict', 'aria-live': 'polite' });
  const refusal = h('p', { class: 'refusal', role: 'alert', hidden: true });

  function changed(field: Field, input: HTMLInputElement): void {
    const value = input.valueAsNumber;
    if (!base || !Number.isFinite(value)) return;
    const next = structuredClone(changes);
    put(next, field.place, value);
    keepOrder(next, base, field.place);
    changes = next;
    update(input);
    change(changes);
  }

  /** Writes the values into the fields, except the one that the user is typing into. */
  function update(except?: HTMLInputElement): void {
    if (!base) return;
    for (const { field, inputs } of shown) {
      const now = changedAt(changes, field.place);
      const value = now ?? valueAt(base, field.place);
      for (const input of inputs) {
        if (input !== except) input.value = value === null ? '' : String(value);
        input.closest('.field')?.classList.toggle('changed', now !== undefined && now !== valueAt(base, field.place));
      }
    }
    reset.disabled = isUnchanged(changes);
    refusal.hidden = true;
  }

  function row(group: string, field: Field): HTMLElement {
    const range = field.unit === '%' ? { min: 0, max: 100, step: 'any' } : { min: 0, step: 'any' };
    const number = h('input', { type: 'number', ...range, placeholder: 'none', 'aria-label': `${group}, ${field.label}, ${field.unit}` });
    const inputs = [number];
    if (field.slider) {
      inputs.push(h('input', { type: 'range', min: 0, max: 100, step: 1, 'aria-label': `${group}, ${field.label}, ${field.unit}` }));
    }
    for (const input of inputs) input.addEventListener('input', () => changed(field, input));
    shown.push({ field, inputs });
    return h(
      'div',
      { class: field.slider ? 'field with-slider' : 'field' },
      h('span', {}, field.label),
      h('span', { class: 'value' }, number, ` ${field.unit}`),
      inputs[1] ?? null,
    );
  }

  const groups = GROUPS.map(([group, fields]) =>
    h('fieldset', { class: group.toLowerCase() }, h('legend', {}, group), ...fields.map((field) => row(group, field))),
  );
  const reset = h('button', { type: 'button', disabled: true }, 'Reset to the profile');
  reset.addEventListener('click', () => {
    changes = {};
    update();
    change(changes);
  });
  const element = h(
    'details',
    { class: 'what-if card' },
    h('summary', {}, h('b', {}, 'What if'), ' the thresholds were different?'),
    verdict,
    refusal,
    ...groups,
    reset,
  );
  return {
    element,
    set(settings, changed) {
      base = settings;
      changes = changed;
      update();
    },
    tell(...words) {
      fill(verdict, ...words);
    },
    refuse(message) {
      refusal.textContent = message;
      refusal.hidden = false;
    },
  };
}
