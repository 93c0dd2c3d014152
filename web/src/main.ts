/** The page: two rooms with one address. `#/flight?...` and `#/rules?...` can be linked to. */

import './page.css';
import './flight/flight.css';
import './rules/rules.css';
import type { App, BackingFile, Room } from './app';
import { h } from './dom';
import { engine } from './engine';
import { backingFile } from './file';
import { isOneFile, module, worker } from './parts';

const rooms = {
  flight: () => import('./flight/room'),
  rules: () => import('./rules/room'),
};
type Name = keyof typeof rooms;

const main = document.querySelector('main')!;
const said = document.getElementById('said')!;
const opened = new Map<Name, { root: HTMLElement; room: Promise<Room> }>();
/** The last address of each room, which is restored when the user returns to it. */
const addresses = new Map<Name, string>();

/** How long a message is shown. */
const SAID_MS = 8_000;
let saying: ReturnType<typeof setTimeout> | undefined;

function say(words: string): void {
  said.textContent = words;
  clearTimeout(saying);
  saying = setTimeout(() => (said.textContent = ''), SAID_MS);
}

function place(): { name: Name; parameters: URLSearchParams } | undefined {
  const [, name, query] = /^#\/(\w+)(?:\?(.*))?$/s.exec(location.hash) ?? [];
  return name && name in rooms ? { name: name as Name, parameters: new URLSearchParams(query) } : undefined;
}

function address(name: Name, parameters: URLSearchParams): string {
  const query = parameters.toString();
  return `#/${name}${query ? `?${query}` : ''}`;
}

async function open(name: Name, root: HTMLElement, file: BackingFile | undefined): Promise<Room> {
  const app: App = {
    engine: engine(worker, module(name).then((module) => ({ room: name, module }))),
    data: () => engine(worker, module('data').then((module) => ({ room: 'data', module }))),
    parameters: () => place()?.parameters ?? new URLSearchParams(),
    navigate(parameters) {
      addresses.set(name, address(name, parameters));
      if (place()?.name === name) history.replaceState(null, '', address(name, parameters));
      link();
    },
    say,
    file: name === 'rules' ? file : undefined,
  };
  return (await rooms[name]()).open(root, app);
}

/** Sets the links to the rooms to their last addresses. */
function link(): void {
  const shown = place()?.name;
  for (const anchor of document.querySelectorAll('nav a')) {
    const name = anchor.textContent!.toLowerCase() as Name;
    anchor.setAttribute('href', addresses.get(name) ?? `#/${name}`);
    if (name === shown) anchor.setAttribute('aria-current', 'page');
    else anchor.removeAttribute('aria-current');
  }
}

async function show(file: BackingFile | undefined): Promise<void> {
  const there = place() ?? { name: file ? ('rules' as const) : ('flight' as const), parameters: new URLSearchParams() };
  if (!place()) history.replaceState(null, '', address(there.name, there.parameters));
  addresses.set(there.name, address(there.name, there.parameters));
  link();
  document.title = there.name === 'flight' ? 'Flight - flagred' : 'Rules - flagred';
  const isNew = !opened.has(there.name);
  if (isNew) {
    const root = h('div', { class: `room ${there.name}` });
    main.append(root);
    opened.set(there.name, { root, room: open(there.name, root, file) });
  }
  for (const [name, { root }] of opened) root.hidden = name !== there.name;
  const room = await opened.get(there.name)!.room;
  if (!isNew) room.shown?.(there.parameters);
}

/** Reports an error that nothing else handles, so that the page never fails without a message. */
function broken(error: unknown): void {
  clearTimeout(saying);
  said.textContent = `The page has a defect: ${error instanceof Error ? error.message : String(error)}`;
}

addEventListener('unhandledrejection', (event) => broken(event.reason));
addEventListener('error', (event) => broken(event.message));
const file = await backingFile();
addEventListener('hashchange', () => void show(file));
await show(file);
performance.mark('interactive');
if (!isOneFile && 'serviceWorker' in navigator && isSecureContext) void navigator.serviceWorker.register('offline.js');
