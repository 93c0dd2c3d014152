/** The messages between the page and its workers. */

import type * as flight from './flight/calls';
import type * as rules from './rules/calls';

/**
 * All functions that can be called. Each runs in a worker, and receives a function for reporting progress as its first
 * argument.
 */
export type Calls = typeof flight & typeof rules;
export type Name = keyof Calls;
export type Tell = (progress: number) => void;
export type Arguments<K extends Name> = Parameters<Calls[K]> extends [Tell, ...infer A] ? A : never;
export type Answer<K extends Name> = Awaited<ReturnType<Calls[K]>>;

/** The first message: the room of the worker, and its module. */
export interface Begin {
  room: 'flight' | 'rules';
  module: WebAssembly.Module;
}

export interface Request {
  id: number;
  call: string;
  args: unknown[];
}

export type Reply =
  | { id: number; progress: number }
  | { id: number; answer: unknown }
  | { id: number; refused: string }
  | { id: number; trapped: string };
