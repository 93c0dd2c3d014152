/**
 * The calls of the flight room to its worker. Each call names the log and the profile. Their data is kept between
 * calls, and loaded again if it is gone, as after a restart.
 */

import {
  Assessment,
  Comparison,
  Flight,
  PARTS,
  Profile,
  reportStyle,
  type Brief,
  type Moment,
  type Part,
  type SignalLabel,
  type Stretch,
  type VerdictChanges,
  type VerdictSettings,
} from 'flagred/flight';
import type { Tell } from '../calls';

/** A log that the user chose. */
export interface Log {
  id: number;
  file: File;
}

/**
 * The source of a profile: the name of a shipped one, or a file name with `text`. `rules` replaces the rule set that
 * the profile names.
 */
export interface ProfileSource {
  name: string;
  text?: string;
  rules?: string;
}

export interface ProfileFacts extends ProfileSource {
  text: string;
  /** The name in the profile's text. */
  title: string;
  warnings: string;
  verdict: VerdictSettings;
}

export type Download = 'html' | 'csv' | 'json';

const flights = new Map<number, Flight>();
const profiles = new Map<string, Profile>();
/** The latest assessment of each log, and the key of its profile. */
const assessments = new Map<number, { key: string; assessment: Assessment }>();

/** The maximum number of compiled profiles that are kept. */
const MAX_PROFILES = 8;

const keyOf = ({ name, text, rules }: ProfileSource) => JSON.stringify([text ?? name, rules]);

function profileOf(source: ProfileSource): Profile {
  const key = keyOf(source);
  const known = profiles.get(key);
  if (known) return known;
  const { name, text, rules } = source;
  const made = text === undefined ? Profile.named(name, rules) : Profile.fromText(name, text, rules);
  for (const [oldest, profile] of profiles) {
    if (profiles.size < MAX_PROFILES) break;
    profile.free();
    profiles.delete(oldest);
  }
  profiles.set(key, made);
  return made;
}

function flightOf(tell: Tell, { id, file }: Log, profile: Profile): Flight {
  const known = flights.get(id);
  if (known?.serves(profile)) return known;
  forgetLog(tell, id);
  let told = 0;
  const flight = Flight.fromFile(file, undefined, (share) => {
    if (share - told < 0.01) return;
    told = share;
    tell(share);
  });
  flights.set(id, flight);
  return flight;
}

function assessmentOf(tell: Tell, log: Log, source: ProfileSource): Assessment {
  const key = keyOf(source);
  const known = assessments.get(log.id);
  if (known?.key === key) return known.assessment;
  const profile = profileOf(source);
  const flight = flightOf(tell, log, profile);
  // Freed before the new one is created, so that memory contains only one of them.
  assessments.get(log.id)?.assessment.free();
  assessments.delete(log.id);
  const assessment = flight.assess(profile);
  assessments.set(log.id, { key, assessment });
  return assessment;
}

/** Returns the names of the shipped profiles, and the style sheet of the report. */
export function beginFlights(_tell: Tell): { shipped: string[]; style: string } {
  return { shipped: Profile.shipped(), style: reportStyle() };
}

/** Returns the properties of a profile, or the reason why it cannot be used. */
export function profileFacts(_tell: Tell, source: ProfileSource, changes: VerdictChanges = {}): ProfileFacts {
  const base = profileOf(source);
  const changed = base.withVerdict(changes);
  const { name: title, text, warnings, verdict } = changed;
  changed.free();
  return { ...source, text, title, warnings, verdict };
}

/** Returns the assessment of a log, and its signals. */
export function assessLog(
  tell: Tell,
  log: Log,
  source: ProfileSource,
): { brief: Brief; stretch: Stretch; signals: SignalLabel[] } {
  const assessment = assessmentOf(tell, log, source);
  return { brief: assessment.brief(), stretch: assessment.stretch, signals: assessment.signals() };
}

/** The parts of the report in their order; the charts of the chosen signals are below the risk. */
const SHOWN: readonly Part[] = PARTS.filter((part) => part !== 'signals').flatMap((part) => (part === 'risk' ? ['risk', 'signals'] : [part]));

/**
 * Returns parts of the report of a log as HTML, for a stretch of time or for all of it. The part `signals` contains the
 * charts of the `chosen` signals.
 */
export function reportParts(
  tell: Tell,
  log: Log,
  source: ProfileSource,
  chosen: string[],
  parts: readonly Part[] = SHOWN,
  stretch?: Stretch,
): [Part, string][] {
  const assessment = assessmentOf(tell, log, source);
  const draw = (part: Part) => (part === 'signals' ? assessment.signalCharts(chosen, stretch) : assessment.part(part, stretch));
  return parts.map((part) => [part, draw(part)]);
}

/** Returns the state at a time of a flight, with an explanation. */
export function momentOf(tell: Tell, log: Log, source: ProfileSource, t_s: number): Moment {
  return assessmentOf(tell, log, source).moment(t_s);
}

/** Returns the comparison of several logs as HTML. */
export function compareLogs(
  tell: Tell,
  logs: Log[],
  source: ProfileSource,
  stretch?: Stretch,
): { html: string; length_s: number } {
  return compared(tell, logs, source, (all) => ({ html: all.part(stretch), length_s: all.length_s }));
}

function compared<T>(tell: Tell, logs: Log[], source: ProfileSource, use: (all: Comparison) => T): T {
  const all = new Comparison(logs.map((log) => assessmentOf(tell, log, source)));
  try {
    return use(all);
  } finally {
    all.free();
  }
}

const TYPES = { html: 'text/html', csv: 'text/csv', json: 'application/json' };

/** Returns the output of the command line for one or several logs, byte for byte. */
export function downloadLogs(tell: Tell, logs: Log[], source: ProfileSource, kind: Download): Blob {
  const [only] = logs;
  const whole =
    logs.length === 1 && only
      ? assessmentOf(tell, only, source)[kind]()
      : compared(tell, logs, source, (all) => all[kind]());
  return new Blob([whole], { type: TYPES[kind] });
}

/** Converts a log to flight CSV with all its signals, and describes what is lost. */
export function convertLog(tell: Tell, { file }: Log): { csv: Blob; warnings: string[] } {
  const flight = Flight.fromFile(file, undefined, tell);
  try {
    const pieces: Uint8Array<ArrayBuffer>[] = [];
    flight.writeCsv((piece) => pieces.push(piece));
    return { csv: new Blob(pieces, { type: TYPES.csv }), warnings: flight.warnings };
  } finally {
    flight.free();
  }
}

/** Frees the memory of a log. */
export function forgetLog(_tell: Tell, id: number): void {
  assessments.get(id)?.assessment.free();
  assessments.delete(id);
  flights.get(id)?.free();
  flights.delete(id);
}
