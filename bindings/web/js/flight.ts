/** Flight logs: read, assessed, explained, compared. */

import type { FlightDocument, Moment, Threshold, VerdictSettings } from './documents.js';
import { beside, type Source } from './load.js';
import { guard } from './panic.js';
import * as wasm from './wasm/flight.js';

export type {
  FlightDocument,
  FlightFinding,
  Level,
  LevelSettings,
  Moment,
  Peak,
  Reliability,
  Step,
  Summary,
  Threshold,
  VerdictSettings,
  VerdictWord,
} from './documents.js';

const guarded = guard(wasm.panicMessage);

/** Loads the module for flight logs, from beside this file or from elsewhere. Calls after the first do nothing. */
export async function startFlight(source?: Source): Promise<void> {
  await wasm.default({ module_or_path: source ?? (await beside('flight')) });
}

/** Only workers have it. */
declare const FileReaderSync: new () => { readAsArrayBuffer(blob: Blob): ArrayBuffer };

/** Gives `length` bytes of a log from `offset` on, fewer before its end, none at its end. */
export type Read = (offset: number, length: number) => Uint8Array;

/** Other thresholds and times; what is left out stays as it is. */
export interface VerdictChanges {
  warn?: LevelChanges;
  fail?: LevelChanges;
  clear_after_s?: number;
  quiet_after_take_off_s?: number;
  quiet_before_landing_s?: number;
}

export interface LevelChanges {
  raise?: Partial<Threshold>;
  after_s?: number;
  until?: Partial<Threshold>;
}

/** What is said of a flight, without its steps. `docs/json.md` describes it. */
export type Brief = Omit<FlightDocument, 'steps'>;

/** A stretch of time on the log's clock, in seconds; of a comparison, since each flight began. */
export interface Stretch {
  start_s: number;
  end_s: number;
}

/** The parts of a report, in their order. */
export const PARTS = [
  'head',
  'risk',
  'map',
  'inputs',
  'rules',
  'motors',
  'attitude',
  'events',
  'sources',
  'texts',
] as const;
export type Part = (typeof PARTS)[number];

/** The style sheet of {@link Assessment.part} and {@link Comparison.part}. */
export const reportStyle = (): string => guarded(() => wasm.reportStyle());

/** A profile with its rule set: which inputs, which rules, when to warn. */
export class Profile {
  /** @internal */
  constructor(readonly inner: wasm.Profile) {}

  /** The names of the shipped profiles; the first is the default. */
  static shipped(): string[] {
    return guarded(() => wasm.Profile.shipped());
  }

  /** A shipped profile by its name. The text of a rule set stands in for the one that it names. */
  static named(name = 'flagred', rules?: string): Profile {
    return new Profile(guarded(() => new wasm.Profile(name, undefined, rules)));
  }

  /** A profile from its text, which findings call `file`. */
  static fromText(file: string, text: string, rules?: string): Profile {
    return new Profile(guarded(() => new wasm.Profile(file, text, rules)));
  }

  get name(): string {
    return guarded(() => this.inner.name);
  }

  get text(): string {
    return guarded(() => this.inner.text);
  }

  /** What does not keep it from being used, drawn in its text. */
  get warnings(): string {
    return guarded(() => this.inner.warnings);
  }

  /** The signals that have to be read of a log to assess it with this profile and to draw the report. */
  get signals(): string[] {
    return guarded(() => this.inner.signals);
  }

  get verdict(): VerdictSettings {
    return JSON.parse(guarded(() => this.inner.verdict)) as VerdictSettings;
  }

  /** The same profile with other thresholds and times. They are written into its text; what else stands there stays. */
  withVerdict(changes: VerdictChanges): Profile {
    return new Profile(guarded(() => this.inner.withVerdict(JSON.stringify(changes))));
  }

  /** Gives its memory back. */
  free(): void {
    this.inner.free();
  }
}

/** A flight that was read from a log. */
export class Flight {
  private constructor(private readonly inner: wasm.Flight) {}

  /**
   * Reads a log from front to back, plain or gzipped, in pieces of a megabyte. `name` is what messages and reports call it.
   * Of the signals beside the motors only those named are kept ({@link Profile.signals}), or all.
   */
  static read(name: string, read: Read, signals?: string[]): Flight {
    return new Flight(guarded(() => new wasm.Flight(name, read, signals)));
  }

  /** Reads a log that is in memory. */
  static fromBytes(name: string, bytes: Uint8Array, signals?: string[]): Flight {
    return Flight.read(name, (offset, length) => bytes.subarray(offset, offset + length), signals);
  }

  /** Reads a file that the user chose: in a worker, where files can be read in turn. `progress` hears the share that is read. */
  static fromFile(file: File, signals?: string[], progress?: (share: number) => void): Flight {
    const reader = new FileReaderSync();
    const read: Read = (offset, length) => {
      progress?.(file.size > 0 ? Math.min(1, offset / file.size) : 1);
      return new Uint8Array(reader.readAsArrayBuffer(file.slice(offset, offset + length)));
    };
    return Flight.read(file.name, read, signals);
  }

  /** Whether all signals were read that a profile needs. */
  serves(profile: Profile): boolean {
    return guarded(() => this.inner.serves(profile.inner));
  }

  assess(profile: Profile): Assessment {
    return new Assessment(guarded(() => this.inner.assess(profile.inner)));
  }

  /** Gives the flight as flight CSV to `write`, piece by piece: all signals that were read. */
  writeCsv(write: (piece: Uint8Array<ArrayBuffer>) => void): void {
    guarded(() => this.inner.writeCsv(write));
  }

  /** What is lost in the CSV: the part that is damaged, and what a log has too much of. */
  get warnings(): string[] {
    return guarded(() => this.inner.warnings());
  }

  /** Gives its memory back. */
  free(): void {
    this.inner.free();
  }
}

/** What is said of a flight. */
export class Assessment {
  /** @internal */
  constructor(readonly inner: wasm.Assessment) {}

  /** What `flagred assess --json` prints, to the byte. */
  json(): string {
    return guarded(() => this.inner.json());
  }

  /** The same without the steps, which may be many. */
  brief(): Brief {
    return JSON.parse(guarded(() => this.inner.brief())) as Brief;
  }

  /** What `flagred assess --csv` prints, in UTF-8. */
  csv(): Uint8Array<ArrayBuffer> {
    return guarded(() => this.inner.csv()) as Uint8Array<ArrayBuffer>;
  }

  /** What `flagred assess --html` writes: a page that needs nothing beside it. */
  html(): string {
    return guarded(() => this.inner.html());
  }

  /** What `flagred assess --svg` writes; nothing where no risk is known. */
  svg(): string | undefined {
    return guarded(() => this.inner.svg());
  }

  /** The time that the report shows. */
  get stretch(): Stretch {
    const [start_s = 0, end_s = 0] = guarded(() => this.inner.stretch());
    return { start_s, end_s };
  }

  /** A part of the report as HTML, in which every text is escaped; empty where there is nothing to show. */
  part(part: Part, stretch?: Stretch): string {
    return guarded(() => this.inner.part(part, stretch?.start_s, stretch?.end_s));
  }

  /** What was known at a time, and which rules fire there. */
  moment(t_s: number): Moment {
    return JSON.parse(guarded(() => this.inner.moment(t_s))) as Moment;
  }

  /** Gives its memory back. */
  free(): void {
    this.inner.free();
  }
}

/** Flights that were assessed with one profile, side by side. */
export class Comparison {
  private readonly inner: wasm.Comparison;

  constructor(assessments: Iterable<Assessment>) {
    this.inner = guarded(() => new wasm.Comparison());
    for (const assessment of assessments) guarded(() => this.inner.add(assessment.inner));
  }

  /** What `flagred assess --json` prints of these logs. */
  json(): string {
    return guarded(() => this.inner.json());
  }

  /** What `flagred assess --csv` prints of these logs. */
  csv(): Uint8Array<ArrayBuffer> {
    return guarded(() => this.inner.csv()) as Uint8Array<ArrayBuffer>;
  }

  /** What `flagred assess --html` writes of these logs. */
  html(): string {
    return guarded(() => this.inner.html());
  }

  /** The body of that page; of a stretch of time since each flight began, or of all of it. */
  part(stretch?: Stretch): string {
    return guarded(() => this.inner.part(stretch?.start_s, stretch?.end_s));
  }

  /** How long the longest of the flights is, in seconds. */
  get length_s(): number {
    return guarded(() => this.inner.length_s());
  }

  /** Gives its memory back. */
  free(): void {
    this.inner.free();
  }
}
