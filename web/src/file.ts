/** The file that `flagred studio FILE` lends to the page. */

import type { BackingFile } from './app';
import { isOneFile } from './parts';

const ADDRESS = 'api/file';

/** The file, where the page is served with one. */
export async function backingFile(): Promise<BackingFile | undefined> {
  if (!isOneFile || !location.protocol.startsWith('http')) return undefined;
  const first = await fetch(ADDRESS, { cache: 'no-store' });
  // 204 where there is none.
  if (first.status !== 200) return undefined;
  let tag = first.headers.get('ETag') ?? '';
  // An editor ends lines by \n alone; the file keeps its own ends.
  let end = '\n';
  return {
    name: decodeURIComponent(first.headers.get('X-File-Name') ?? 'the file'),
    readOnly: first.headers.get('X-Read-Only') === 'true',
    async read() {
      const answer = await fetch(ADDRESS, { cache: 'no-store' });
      if (!answer.ok) throw new Error(await answer.text());
      tag = answer.headers.get('ETag') ?? '';
      const text = await answer.text();
      end = text.includes('\r\n') && !/(^|[^\r])\n/.test(text) ? '\r\n' : '\n';
      return text.replaceAll('\r\n', '\n');
    },
    async write(text) {
      const answer = await fetch(ADDRESS, { method: 'PUT', body: text.replaceAll('\n', end), headers: { 'If-Match': tag } });
      if (!answer.ok) throw new Error(await answer.text());
      tag = answer.headers.get('ETag') ?? '';
    },
  };
}
