/** The interface between a room and the page around it. */

import type { Engine } from './engine';

/** The file on disk that the page edits, if it is served by `flagred studio FILE`. */
export interface BackingFile {
  name: string;
  readOnly: boolean;
  /** Reads the current text of the file. */
  read(): Promise<string>;
  /** Writes the file if it still contains `over`, a text that was read or written before. */
  write(text: string, over: string): Promise<void>;
}

export interface App {
  /** The worker of the room. */
  engine: Engine;
  /** Creates a worker for rows of data, and loads its module. */
  data(): Engine;
  /** The parameters of the room in the address. */
  parameters(): URLSearchParams;
  /** Sets the parameters of the room in the address. */
  navigate(parameters: URLSearchParams): void;
  /** Shows a message to the user, and announces it to screen readers. */
  say(words: string): void;
  file: BackingFile | undefined;
}

/** An opened room. It stays open, but hidden, while another room is shown. */
export interface Room {
  /** Called when the address changes, or when the room is shown again. */
  shown?(parameters: URLSearchParams): void;
}
