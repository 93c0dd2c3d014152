/** What the flight room asks of its worker. */

import { verdictOf } from 'flagred';
import type { Tell } from '../calls';

/** The verdict of a log. */
export async function verdict(tell: Tell, file: File, profile: string): Promise<string> {
  const log = new Uint8Array(await file.arrayBuffer());
  tell(0.5);
  return verdictOf(log, profile);
}
