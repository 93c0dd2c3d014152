/** The interface between a room and the page around it. */

import type { Engine } from './engine';

/** The file on disk that the page edits, if it is served by `flagred studio FILE`. */
export interface BackingFile {
  name: string;
  readOnly: boolean;
  /** Reads its current text. */
  read(): Promise<string>;
  /** Writes it if the file still contains `over`, a text that was read or written before. */
  write(text: string, over: string): Promise<void>;
}

export interface App {
  /** The worker of the room. */
  engine: Engine;
  /** A worker for rows of data; its module is loaded now. */
  data(): Engine;
  /** What the address says of the room. */
  parameters(): URLSearchParams;
  /** Sets the parameters of the room in the address. */
  navigate(parameters: URLSearchParams): void;
  /** Shows a message to the user, and announces it to screen readers. */
  say(words: string): void;
  file: BackingFile | undefined;
}

/** An opened room; it is only hidden while another is shown. */
export interface Room {
  /** Called when the address changes, or when the room is shown again. */
  shown?(parameters: URLSearchParams): void;
}
