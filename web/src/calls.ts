/** The messages between the page and its workers. */

import type * as flight from './flight/calls';
import type * as rules from './rules/calls';
import type * as data from './rules/datacalls';

/** All functions that can be called in a worker. The first argument of each is a function that receives progress. */
export type Calls = typeof flight & typeof rules & typeof data;
export type Name = keyof Calls;
/** Receives the progress; `found` is the best result so far, if there is one. */
export type Tell = (progress: number, found?: unknown) => void;
export type Arguments<K extends Name> = Parameters<Calls[K]> extends [Tell, ...infer A] ? A : never;
export type Answer<K extends Name> = Awaited<ReturnType<Calls[K]>>;

/** The first message: the room of the worker, and its module. */
export interface Begin {
  room: 'flight' | 'rules' | 'data';
  module: WebAssembly.Module;
}

export interface Request {
  id: number;
  call: string;
  args: unknown[];
}

export type Reply =
  | { id: number; progress: number; found?: unknown }
  | { id: number; answer: unknown }
  | { id: number; refused: string }
  | { id: number; trapped: string };
