// Shared by the tests of the page: a server with the page's own policy, and Chromium.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

export const repository = fileURLToPath(new URL('../../', import.meta.url));
export const studio = join(repository, 'crates/cli/page/studio.html');
export const page = join(repository, 'target/web/page');
const types = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.wasm': 'application/wasm',
  '.svg': 'image/svg+xml',
  '.webmanifest': 'application/manifest+json',
};

/** Serves the page as any file server would. `close` ends the server, as if the network were gone. */
export async function serve(folder = page, headers = {}) {
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://page').pathname));
    const file = join(folder, path.endsWith('/') ? `${path}index.html` : path);
    const content = await readFile(file).catch(() => undefined);
    if (content === undefined) response.writeHead(404).end('not found');
    else response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream', ...headers }).end(content);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    close: () => new Promise((resolve) => (server.closeAllConnections(), server.close(resolve))),
  };
}

/** Starts the installed Chromium. */
export async function browser() {
  const known = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const executablePath = known.find((path) => path && existsSync(path));
  if (!executablePath) throw new Error('no Chromium: get it with `apt-get install chromium`, or name it in CHROMIUM');
  return chromium.launch({
    executablePath,
    args: [
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
}

/** Opens a page. `complaints` receives its errors and warnings, such as violations of the policy. */
export async function tab(chromium, address, options = {}) {
  const context = await chromium.newContext(options);
  const made = await context.newPage();
  const complaints = [];
  made.on('pageerror', (error) => complaints.push(error.message));
  made.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) complaints.push(message.text());
  });
  await made.goto(address);
  return { page: made, context, complaints };
}

/** Chromium and the page on a server, for the tests of a file; both are closed after the tests. */
export async function opened() {
  const chromium = await browser();
  const server = await serve();
  after(async () => {
    await chromium.close();
    await server.close();
  });
  return { chromium, server };
}

/** Whether times are asserted, which is only reliable on an idle machine; otherwise they are only reported. */
export const isTimed = process.env.FLAGRED_TIMED !== undefined;
