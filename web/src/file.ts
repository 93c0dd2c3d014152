/** The file that `flagred studio FILE` serves to the page. */

import type { BackingFile } from './app';
import { isOneFile } from './parts';

const ADDRESS = 'api/file';

/** Returns the file, if the page is served with one. */
export async function backingFile(): Promise<BackingFile | undefined> {
  if (!isOneFile || !location.protocol.startsWith('http')) return undefined;
  const first = await fetch(ADDRESS, { cache: 'no-store' });
  // The status is 204 if there is none.
  if (first.status !== 200) return undefined;
  // The last known text.
  let known = '';
  // The tag of that text on the server.
  let tag = '';
  // The editor ends lines with \n only; the line ends of the file are preserved.
  let end = '\n';
  // Requests are made one after another, so that no answer is older than what was written.
  let last: Promise<unknown> = Promise.resolve();
  const inTurn = <T>(run: () => Promise<T>): Promise<T> => {
    const next = last.then(run, run);
    last = next;
    return next;
  };

  async function take(answer: Response): Promise<string> {
    // The known text is still current.
    if (answer.status === 304) return known;
    const text = await answer.text();
    if (!answer.ok) throw new Error(text);
    tag = answer.headers.get('ETag') ?? '';
    end = text.includes('\r\n') && !/(^|[^\r])\n/.test(text) ? '\r\n' : '\n';
    known = text.replaceAll('\r\n', '\n');
    return known;
  }

  const read = async (): Promise<string> =>
    take(await fetch(ADDRESS, { cache: 'no-store', headers: { 'If-None-Match': tag } }));

  async function write(text: string, over: string): Promise<void> {
    if (over !== known) throw new Error(`\`${name}\` was changed on disk meanwhile`);
    const answer = await fetch(ADDRESS, { method: 'PUT', body: text.replaceAll('\n', end), headers: { 'If-Match': tag } });
    if (!answer.ok) throw new Error(await answer.text());
    tag = answer.headers.get('ETag') ?? '';
    known = text;
  }

  await take(first);
  const name = decodeURIComponent(first.headers.get('X-File-Name') ?? 'the file');
  return {
    name,
    readOnly: first.headers.get('X-Read-Only') === 'true',
    read: () => inTurn(read),
    write: (text, over) => inTurn(() => write(text, over)),
  };
}
