// Controls Firefox by WebDriver BiDi, which Firefox supports without a driver.

import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import WebSocket from 'ws';

/** The path of Firefox; `undefined` if the machine has none. */
export const executable = [process.env.FIREFOX, '/usr/bin/firefox-esr', '/usr/bin/firefox'].find((path) => path && existsSync(path));

/** How long a test waits for a condition. */
const PATIENCE_MS = 90_000;

/** Starts Firefox with a new profile, and returns the address of its remote agent. */
async function start(profile) {
  const browser = spawn(executable, ['--headless', '--no-remote', '--remote-debugging-port=0', '--profile', profile], { stdio: ['ignore', 'ignore', 'pipe'] });
  const address = await new Promise((resolve, reject) => {
    let words = '';
    browser.stderr.on('data', (piece) => {
      words += piece;
      const [, found] = /WebDriver BiDi listening on (ws:\S+)/.exec(words) ?? [];
      if (found) resolve(found);
    });
    browser.on('error', reject);
    browser.on('exit', (code) => reject(new Error(`Firefox ended with ${code}: ${words}`)));
  });
  return { browser, address };
}

/** Opens a page in a new instance of Firefox. */
export async function firefox(page) {
  const profile = mkdtempSync(join(tmpdir(), 'flagred-firefox-'));
  const { browser, address } = await start(profile);
  const socket = new WebSocket(`${address}/session`);
  await new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject));
  const waiting = new Map();
  const complaints = [];
  socket.on('message', (data) => {
    const { id, method, result, message, params } = JSON.parse(data);
    if (method === 'log.entryAdded' && ['error', 'warn'].includes(params.level)) complaints.push(params.text);
    const asked = waiting.get(id);
    waiting.delete(id);
    if (result) asked?.resolve(result);
    else asked?.reject(new Error(message));
  });
  let next = 0;
  const send = (method, params) =>
    new Promise((resolve, reject) => {
      waiting.set(++next, { resolve, reject });
      socket.send(JSON.stringify({ id: next, method, params }));
    });
  await send('session.new', { capabilities: {} });
  await send('session.subscribe', { events: ['log.entryAdded'] });
  const { contexts } = await send('browsingContext.getTree', {});
  const [{ context }] = contexts;
  await send('browsingContext.navigate', { context, url: page, wait: 'complete' });

  /** Evaluates an expression in the page; its value must be a string, a number or a boolean. */
  async function run(expression) {
    const target = { context };
    const { result, exceptionDetails } = await send('script.evaluate', { expression, target, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.text);
    return result.value;
  }

  /** Waits until an expression is true. */
  async function until(expression) {
    const end = Date.now() + PATIENCE_MS;
    while (!(await run(`Boolean(${expression})`))) {
      if (Date.now() > end) throw new Error(`it never came: ${expression}; complaints: ${complaints.join('; ')}`);
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
  }

  async function close() {
    const ended = new Promise((resolve) => browser.on('exit', resolve));
    await send('browser.close', {}).catch(() => undefined);
    socket.close();
    setTimeout(() => browser.kill('SIGKILL'), 5_000).unref();
    await ended;
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  }

  return { run, until, close, complaints };
}
