/** What a room gets from the page around it. */

import type { Engine } from './engine';

/** The file on disk that the page edits, where `flagred studio FILE` serves it. */
export interface BackingFile {
  name: string;
  readOnly: boolean;
  /** Its text now. */
  read(): Promise<string>;
  /** Writes it over a text that was read or written before, if that is what is still there. */
  write(text: string, over: string): Promise<void>;
}

export interface App {
  /** The room's own worker. */
  engine: Engine;
  /** A worker for rows of data; its module is loaded now. */
  data(): Engine;
  /** What the address says of the room. */
  parameters(): URLSearchParams;
  /** Says it in the address. */
  navigate(parameters: URLSearchParams): void;
  /** Tells the user something, aloud too. */
  say(words: string): void;
  file: BackingFile | undefined;
}

/** A room that was opened stays; it is hidden while another is shown. */
export interface Room {
  /** The address changed, or the room is shown again. */
  shown?(parameters: URLSearchParams): void;
}
