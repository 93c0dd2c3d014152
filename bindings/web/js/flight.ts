/** Reads, assesses, explains and compares flight logs. */

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

/** Loads the module for flight logs, from the file next to this one or from `source`. Later calls do nothing. */
export async function startFlight(source?: Source): Promise<void> {
  await wasm.default({ module_or_path: source ?? (await beside(new URL('./wasm/flight_bg.wasm', import.meta.url))) });
}

/** Available only in workers. */
declare const FileReaderSync: new () => { readAsArrayBuffer(blob: Blob): ArrayBuffer };

/** Returns `length` bytes of a log from `offset` on: fewer near the end of the log, none at its end. */
export type Read = (offset: number, length: number) => Uint8Array;

/** Changed thresholds and times; omitted ones keep their values. */
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

/** The assessment of a flight without its steps. `docs/json.md` describes it. */
export type Brief = Omit<FlightDocument, 'steps'>;

/** A stretch of time on the log's clock, in seconds; for a comparison, since the start of each flight. */
export interface Stretch {
  start_s: number;
  end_s: number;
}

/** The parts of a report, in their order. */
export const PARTS = [
  'head',
  'about',
  'risk',
  'track',
  'map',
  'inputs',
  'rules',
  'motors',
  'attitude',
  'events',
  'signals',
  'sources',
  'texts',
] as const;
export type Part = (typeof PARTS)[number];

/** A signal of a log. */
export interface SignalLabel {
  name: string;
  /** The unit; empty if the signal has none or it is unknown. */
  unit: string;
  /** The message and field that contain it. */
  source: string;
}

/** Returns the style sheet of {@link Assessment.part} and {@link Comparison.part}. */
export const reportStyle = (): string => guarded(() => wasm.reportStyle());

/** A profile with its rule set. It defines the inputs and the conditions for warnings. */
export class Profile {
  /** @internal */
  constructor(readonly inner: wasm.Profile) {}

  /** Returns the names of the shipped profiles; the first is the default. */
  static shipped(): string[] {
    return guarded(() => wasm.Profile.shipped());
  }

  /**
   * Creates a shipped profile by its name. If the text `rules` is given, it replaces the rule set that the profile
   * names.
   */
  static named(name = 'flagred', rules?: string): Profile {
    return new Profile(guarded(() => new wasm.Profile(name, undefined, rules)));
  }

  /** Creates a profile from its text. `file` is its name in findings. */
  static fromText(file: string, text: string, rules?: string): Profile {
    return new Profile(guarded(() => new wasm.Profile(file, text, rules)));
  }

  get name(): string {
    return guarded(() => this.inner.name);
  }

  get text(): string {
    return guarded(() => this.inner.text);
  }

  /** The warnings about the profile, with the lines of its text that they refer to; empty if there are none. */
  get warnings(): string {
    return guarded(() => this.inner.warnings);
  }

  /**
   * The signals that must be read from a log to assess it with this profile. If a flight was read with these signals
   * only, its report contains no others; if it was read with all signals, the report offers all of them.
   */
  get signals(): string[] {
    return guarded(() => this.inner.signals);
  }

  get verdict(): VerdictSettings {
    return JSON.parse(guarded(() => this.inner.verdict)) as VerdictSettings;
  }

  /**
   * Returns the same profile with other thresholds and times. They are written into its text, which otherwise does not
   * change.
   */
  withVerdict(changes: VerdictChanges): Profile {
    return new Profile(guarded(() => this.inner.withVerdict(JSON.stringify(changes))));
  }

  /** Frees its memory. */
  free(): void {
    guarded(() => this.inner.free());
  }
}

/** A flight that was read from a log. */
export class Flight {
  private constructor(private readonly inner: wasm.Flight) {}

  /**
   * Reads a log from front to back, plain or gzipped, in pieces of a megabyte. `name` is its name in messages and
   * reports. Signals other than motor commands are kept only if `signals` contains them ({@link Profile.signals}); by
   * default, all are kept.
   */
  static read(name: string, read: Read, signals?: string[]): Flight {
    return new Flight(guarded(() => new wasm.Flight(name, read, signals)));
  }

  /** Reads a log from memory. */
  static fromBytes(name: string, bytes: Uint8Array, signals?: string[]): Flight {
    return Flight.read(name, (offset, length) => bytes.subarray(offset, offset + length), signals);
  }

  /**
   * Reads a file that the user chose. It requires a worker, where files can be read synchronously. `progress` receives
   * the share that has been read.
   */
  static fromFile(file: File, signals?: string[], progress?: (share: number) => void): Flight {
    const reader = new FileReaderSync();
    const read: Read = (offset, length) => {
      progress?.(file.size > 0 ? Math.min(1, offset / file.size) : 1);
      return new Uint8Array(reader.readAsArrayBuffer(file.slice(offset, offset + length)));
    };
    return Flight.read(file.name, read, signals);
  }

  /** Whether all signals that a profile needs were read. */
  serves(profile: Profile): boolean {
    return guarded(() => this.inner.serves(profile.inner));
  }

  assess(profile: Profile): Assessment {
    return new Assessment(guarded(() => this.inner.assess(profile.inner)));
  }

  /** Writes the flight as flight CSV, with all signals that were read. `write` is called for each piece. */
  writeCsv(write: (piece: Uint8Array<ArrayBuffer>) => void): void {
    guarded(() => this.inner.writeCsv(write));
  }

  /** Warnings about data that the CSV lacks: damaged parts of the log, and data beyond its limits. */
  get warnings(): string[] {
    return guarded(() => this.inner.warnings());
  }

  /** Frees its memory. */
  free(): void {
    guarded(() => this.inner.free());
  }
}

/** The assessment of a flight. */
export class Assessment {
  /** @internal */
  constructor(readonly inner: wasm.Assessment) {}

  /** Returns the output of `flagred assess --json`, byte for byte. */
  json(): string {
    return guarded(() => this.inner.json());
  }

  /** Returns the document of {@link Assessment.json} without the steps, of which there may be many. */
  brief(): Brief {
    return JSON.parse(guarded(() => this.inner.brief())) as Brief;
  }

  /** Returns the output of `flagred assess --csv`, in UTF-8. */
  csv(): Uint8Array<ArrayBuffer> {
    return guarded(() => this.inner.csv()) as Uint8Array<ArrayBuffer>;
  }

  /** Returns the output of `flagred assess --html`: a self-contained page. */
  html(): string {
    return guarded(() => this.inner.html());
  }

  /** Returns the output of `flagred assess --svg`; `undefined` if no risk is known. */
  svg(): string | undefined {
    return guarded(() => this.inner.svg());
  }

  /** The stretch of time that the report shows. */
  get stretch(): Stretch {
    const [start_s = 0, end_s = 0] = guarded(() => this.inner.stretch());
    return { start_s, end_s };
  }

  /** Returns a part of the report as HTML in which all text is escaped; empty if there is nothing to show. */
  part(part: Part, stretch?: Stretch): string {
    return guarded(() => this.inner.part(part, stretch?.start_s, stretch?.end_s));
  }

  /** Returns the signals of the log that were read and have a known value. */
  signals(): SignalLabel[] {
    return JSON.parse(guarded(() => this.inner.signals())) as SignalLabel[];
  }

  /** Returns the charts of some signals as HTML, as {@link Assessment.part} does. */
  signalCharts(names: string[], stretch?: Stretch): string {
    return guarded(() => this.inner.signalCharts(names, stretch?.start_s, stretch?.end_s));
  }

  /** Returns the state at a time, and the rules that fire. */
  moment(t_s: number): Moment {
    return JSON.parse(guarded(() => this.inner.moment(t_s))) as Moment;
  }

  /** Frees its memory. */
  free(): void {
    guarded(() => this.inner.free());
  }
}

/** Several flights that were assessed with one profile, side by side. */
export class Comparison {
  private readonly inner: wasm.Comparison;

  constructor(assessments: Iterable<Assessment>) {
    this.inner = guarded(() => new wasm.Comparison());
    for (const assessment of assessments) guarded(() => this.inner.add(assessment.inner));
  }

  /** Returns the output of `flagred assess --json` for these logs. */
  json(): string {
    return guarded(() => this.inner.json());
  }

  /** Returns the output of `flagred assess --csv` for these logs. */
  csv(): Uint8Array<ArrayBuffer> {
    return guarded(() => this.inner.csv()) as Uint8Array<ArrayBuffer>;
  }

  /** Returns the output of `flagred assess --html` for these logs. */
  html(): string {
    return guarded(() => this.inner.html());
  }

  /**
   * Returns the body of the page of {@link Comparison.html}, for a stretch of time since the start of each flight, or
   * for all of it.
   */
  part(stretch?: Stretch): string {
    return guarded(() => this.inner.part(stretch?.start_s, stretch?.end_s));
  }

  /** The length of the longest flight, in seconds. */
  get length_s(): number {
    return guarded(() => this.inner.length_s());
  }

  /** Frees its memory. */
  free(): void {
    guarded(() => this.inner.free());
  }
}
