/**
 * The state of the flight room in its address. A link can contain everything except the logs, which stay on the
 * user's machine.
 */

import type { Stretch, VerdictChanges } from 'flagred';
import { isUnchanged } from './whatif';

export interface Place {
  example: string | undefined;
  /** The name of a shipped profile; `undefined` for the default. */
  profile: string | undefined;
  /** Changed thresholds. */
  changes: VerdictChanges;
  /** The names of signals that are drawn. */
  signals: string[];
  /** The time of the cursor, in seconds. */
  t_s: number | undefined;
  /** The stretch that is shown; `undefined` for the whole flight. */
  stretch: Stretch | undefined;
}

/** Parses an address; invalid numbers and JSON are ignored. */
export function placeIn(address: URLSearchParams): Place {
  const number = (name: string) => {
    const value = parseFloat(address.get(name) ?? '');
    return Number.isFinite(value) ? value : undefined;
  };
  const [start_s, end_s] = [number('from'), number('to')];
  return {
    example: address.get('example') ?? undefined,
    profile: address.get('profile') ?? undefined,
    changes: changesIn(address.get('verdict')),
    signals: (address.get('signals') ?? '').split(',').filter(Boolean),
    t_s: number('t'),
    stretch: start_s !== undefined && end_s !== undefined && start_s < end_s ? { start_s, end_s } : undefined,
  };
}

function changesIn(text: string | null): VerdictChanges {
  try {
    const given: unknown = JSON.parse(text ?? '{}');
    return typeof given === 'object' && given !== null ? (given as VerdictChanges) : {};
  } catch {
    return {};
  }
}

/** Converts a state to an address. */
export function said({ example, profile, changes, signals, t_s, stretch }: Place): URLSearchParams {
  const address = new URLSearchParams();
  if (example) address.set('example', example);
  if (profile) address.set('profile', profile);
  if (!isUnchanged(changes)) address.set('verdict', JSON.stringify(changes));
  if (signals.length > 0) address.set('signals', signals.join(','));
  if (t_s !== undefined && Number.isFinite(t_s)) address.set('t', t_s.toFixed(2));
  if (stretch) {
    address.set('from', stretch.start_s.toFixed(2));
    address.set('to', stretch.end_s.toFixed(2));
  }
  return address;
}
