/** The flight room: logs are dropped, assessed and looked at. */

import './flight.css';
import type { Part, Stretch, VerdictChanges } from 'flagred';
import type { App, Room } from '../app';
import { add, download, fill, h } from '../dom';
import { Cancelled, Trapped } from '../engine';
import type { Download, ProfileFacts, ProfileSource } from './calls';
import { badge, logList, verdictClass, type Entry } from './logs';
import { momentPanel } from './moment';
import { report as makeReport, type Report } from './report';
import { timeBar } from './timebar';
import { latest, within, zoomed } from './time';
import { isUnchanged, whatIf } from './whatif';

/** The parts of a report that change with the stretch of time. */
const OVER_TIME: readonly Part[] = ['risk', 'inputs', 'motors', 'attitude'];

const FORMATS = 'ArduPilot .bin and .log, PX4 .ulg, MAVLink .tlog, flight CSV; plain or gzipped';

/** Opens the room. */
export function open(root: HTMLElement, app: App): Room {
  const { engine } = app;
  const address = app.parameters();
  const entries: Entry[] = [];
  let current: Entry | undefined;
  let isComparing = false;
  let base: ProfileSource = { name: address.get('profile') ?? 'flagred' };
  let changes: VerdictChanges = changesIn(address);
  let facts: ProfileFacts | undefined;
  /** What can be shown, what is shown of it, and what the charts were drawn for: in seconds. */
  let whole: Stretch = { start_s: 0, end_s: 1 };
  let shown: Stretch | undefined = stretchIn(address);
  let drawn: Stretch = whole;
  let cursor_s = Number(address.get('t') ?? NaN);
  let example = address.get('example');
  let next = 0;
  let report: Report | undefined;

  const heading = h('h1', {}, 'How risky was this flight?');
  const status = h('p', { class: 'visually-hidden', role: 'status' });
  const message = h('div', { class: 'message', role: 'alert', hidden: true });
  const place = h('div', { class: 'place' });
  const list = logList({ choose: (entry) => void choose(entry), remove });
  const moments = momentPanel();
  const thresholds = whatIf((changed) => retry(changed));
  const bar = timeBar({
    point: (share) => pointAt(view().start_s + share * lengthOf(view())),
    zoom: (from, to) => show(zoomed(view(), from, to, whole)),
    reset: () => show(undefined),
  });
  const profiles = h('select', { 'aria-label': 'Profile' });
  const profileFile = h('input', { type: 'file', accept: '.yaml,.yml', multiple: true, 'aria-label': 'Profile from a file', hidden: true });
  const compareButton = h('button', { type: 'button', 'aria-pressed': 'false' }, 'Compare');
  const downloads = h('div', { class: 'menu-body' });
  const downloadMenu = h('details', { class: 'menu' }, h('summary', { class: 'button' }, 'Download'), downloads);
  const tools = h(
    'div',
    { class: 'tools' },
    h('label', {}, h('span', { class: 'soft' }, 'Profile '), profiles),
    profileFile,
    compareButton,
    downloadMenu,
  );
  const aside = h('div', { class: 'aside' }, thresholds.element, moments.element);
  const view_ = h('div', { class: 'flight-view', hidden: true }, tools, bar.element, h('div', { class: 'columns' }, place, aside));
  const drop = dropZone();
  add(root, heading, status, h('div', { class: 'top' }, list.element, drop), message, view_);

  for (const [kind, words] of [
    ['html', 'Report (HTML)'],
    ['csv', 'Steps (CSV)'],
    ['json', 'JSON'],
    ['flight', 'Flight CSV'],
  ] as const) {
    const button = h('button', { type: 'button', 'data-kind': kind }, words);
    button.addEventListener('click', () => {
      downloadMenu.open = false;
      quiet(save(kind));
    });
    downloads.append(button);
  }
  compareButton.addEventListener('click', () => quiet(compare(!isComparing)));
  profiles.addEventListener('change', () => {
    if (profiles.value === '') profileFile.click();
    else quiet(useProfile({ name: profiles.value }, {}));
  });
  profileFile.addEventListener('change', async () => {
    const chosen = [...(profileFile.files ?? [])];
    profileFile.value = '';
    if (chosen.length > 0) quiet(useProfile(await profileIn(chosen), {}));
  });
  document.addEventListener('click', (event) => {
    if (!event.composedPath().includes(downloadMenu)) downloadMenu.open = false;
  });
  document.addEventListener('keydown', (event) => {
    const isTyping = event.composedPath().some((target) => target instanceof Element && target.matches('input, select, textarea'));
    if (isTyping || root.hidden || view_.hidden || event.ctrlKey || event.metaKey || event.altKey) return;
    const share = (cursor_s - view().start_s) / lengthOf(view());
    const act: Record<string, () => void> = {
      ArrowLeft: () => pointAt(cursor_s - lengthOf(view()) * (event.shiftKey ? 0.02 : 0.002)),
      ArrowRight: () => pointAt(cursor_s + lengthOf(view()) * (event.shiftKey ? 0.02 : 0.002)),
      '+': () => show(zoomed(view(), share / 2, (1 + share) / 2, whole)),
      '-': () => show(zoomed(view(), -share, 2 - share, whole)),
      '0': () => show(undefined),
      Escape: () => (downloadMenu.open = false),
    };
    const wanted = act[event.key];
    if (!wanted) return;
    event.preventDefault();
    wanted();
  });

  function dropZone(): HTMLElement {
    const input = h('input', { type: 'file', multiple: true, 'aria-label': 'Flight logs', class: 'visually-hidden' });
    input.addEventListener('change', () => {
      take([...(input.files ?? [])]);
      input.value = '';
    });
    const tryOne = h('button', { type: 'button' }, 'Try an example');
    tryOne.addEventListener('click', () => quiet(takeExample('gust')));
    const zone = h(
      'div',
      { class: 'drop' },
      h('p', { class: 'invitation' }, 'Drop flight logs here'),
      h('p', { class: 'buttons' }, h('label', { class: 'button main' }, h('span', { class: 'first' }, 'Choose logs'), h('span', { class: 'more' }, '+ Add logs'), input), tryOne),
      h('p', { class: 'soft' }, `${FORMATS}.`),
      h('p', { class: 'soft' }, 'They are read in this browser. Nothing is sent anywhere.'),
    );
    const isOver = (event: DragEvent) => !root.hidden && event.dataTransfer?.types.includes('Files');
    document.addEventListener('dragover', (event) => {
      if (!isOver(event)) return;
      event.preventDefault();
      root.classList.add('dragging');
    });
    for (const end of ['dragleave', 'drop'] as const) document.addEventListener(end, () => root.classList.remove('dragging'));
    document.addEventListener('drop', (event) => {
      if (!isOver(event)) return;
      event.preventDefault();
      take([...(event.dataTransfer?.files ?? [])]);
    });
    return zone;
  }

  /** What is given up needs no words; whatever else goes wrong is told. */
  function quiet(work: Promise<unknown>): void {
    work.catch((error: Error) => {
      if (!(error instanceof Cancelled)) app.say(told(error));
    });
  }

  const source = (): ProfileSource => (isUnchanged(changes) || !facts ? base : { ...base, text: facts.text });
  const view = (): Stretch => shown ?? whole;
  const done = (): Entry[] => entries.filter((entry) => entry.state === 'done');
  const compared = (): Entry[] => (isComparing ? done() : current ? [current] : []);

  async function takeExample(name: string): Promise<void> {
    const { example: load } = await import('./example');
    example = name;
    take([load()]);
  }

  function take(files: File[]): void {
    for (const file of files) entries.push({ log: { id: next++, file }, state: 'waiting', share: 0 });
    list.show(entries, isComparing ? undefined : current);
    void pump();
  }

  let isPumping = false;
  /** Reads the logs that wait, one after the other. */
  async function pump(): Promise<void> {
    if (isPumping) return;
    isPumping = true;
    await ready;
    for (let entry; (entry = entries.find(({ state }) => state === 'waiting')); ) await read(entry);
    isPumping = false;
  }

  async function read(entry: Entry): Promise<void> {
    entry.state = 'reading';
    list.show(entries, isComparing ? undefined : current);
    const progress = (share: number) => {
      entry.share = share;
      list.show(entries, isComparing ? undefined : current);
    };
    try {
      if (!isUnchanged(changes)) {
        const { brief } = await engine.follow(progress, 'assessLog', entry.log, base);
        entry.unchanged = brief.verdict;
      }
      Object.assign(entry, await engine.follow(progress, 'assessLog', entry.log, source()));
      entry.state = 'done';
      if (isUnchanged(changes)) entry.unchanged = entry.brief?.verdict;
    } catch (error) {
      if (error instanceof Cancelled) {
        // Another log was given up, and the worker with it.
        entry.state = 'waiting';
        entry.share = 0;
        return;
      }
      entry.state = 'refused';
      entry.refusal = told(error as Error);
    }
    if (!entries.includes(entry)) return;
    if (!current || current.state === 'refused' || (current === entry)) await choose(entry);
    else list.show(entries, isComparing ? undefined : current);
    compareButton.disabled = done().length < 2;
    if (isComparing) quiet(redraw(true));
  }

  function remove(entry: Entry): void {
    const isBusy = entry.state === 'reading';
    entries.splice(entries.indexOf(entry), 1);
    if (isBusy) engine.restart();
    else quiet(engine.call('forgetLog', entry.log.id));
    if (current === entry) {
      current = undefined;
      const [other] = [...done(), ...entries];
      if (other) void choose(other);
      else clear();
    }
    if (done().length < 2) isComparing = false;
    compareButton.disabled = done().length < 2;
    list.show(entries, isComparing ? undefined : current);
    app.say(isBusy ? `Cancelled: ${entry.log.file.name}` : '');
  }

  function clear(): void {
    report?.clear();
    view_.hidden = true;
    message.hidden = true;
    heading.classList.remove('visually-hidden');
    drop.classList.remove('small');
    example = null;
    shown = undefined;
    write();
  }

  async function choose(entry: Entry): Promise<void> {
    const isOther = current !== undefined && current !== entry;
    if (isOther || isComparing) {
      shown = undefined;
      cursor_s = NaN;
    }
    current = entry;
    isComparing = false;
    list.show(entries, isComparing ? undefined : current);
    heading.classList.add('visually-hidden');
    drop.classList.add('small');
    if (entry.state === 'refused') {
      view_.hidden = true;
      message.hidden = false;
      fill(message, h('b', {}, `${entry.log.file.name} cannot be used`), h('pre', {}, entry.refusal ?? ''));
      return;
    }
    if (entry.state !== 'done' || !entry.stretch) return;
    message.hidden = true;
    view_.hidden = false;
    whole = entry.stretch;
    if (shown) shown = within(shown, whole);
    if (!Number.isFinite(cursor_s)) cursor_s = entry.brief?.summary.risk_max?.t_s ?? (whole.start_s + whole.end_s) / 2;
    tellVerdict();
    await redraw(true).catch((error: Error) => quiet(Promise.reject(error)));
  }

  async function compare(on: boolean): Promise<void> {
    isComparing = on;
    shown = undefined;
    list.show(entries, isComparing ? undefined : current);
    if (!on && current) return choose(current);
    cursor_s = NaN;
    await redraw(true);
  }

  /** Draws the report, or of it what changes with the stretch of time. What is asked for meanwhile is drawn after. */
  const redraw = (isAll: boolean): Promise<void> => {
    isStale ||= isAll;
    return drawAgain();
  };
  let isStale = false;
  const drawAgain = latest(async () => {
    if (!report) return;
    const wanted = shown;
    const isAll = isStale;
    isStale = false;
    compareButton.setAttribute('aria-pressed', String(isComparing));
    aside.hidden = isComparing;
    if (isComparing) {
      const { html, length_s } = await engine.call('compareLogs', done().map(({ log }) => log), source(), wanted);
      whole = { start_s: 0, end_s: length_s };
      if (!Number.isFinite(cursor_s)) cursor_s = length_s / 2;
      drawn = wanted ?? whole;
      await report.draw([['comparison', html]], true);
    } else if (current?.state === 'done') {
      const parts = await engine.call('reportParts', current.log, source(), isAll ? undefined : OVER_TIME, wanted);
      drawn = wanted ?? whole;
      await report.draw(parts, isAll);
    }
    pointAt(cursor_s);
  });

  function show(stretch: Stretch | undefined): void {
    shown = stretch;
    const { start_s, end_s } = view();
    const length_s = lengthOf(drawn);
    report?.preview((start_s - drawn.start_s) / length_s, (end_s - drawn.start_s) / length_s);
    pointAt(cursor_s);
    quiet(redraw(false));
  }

  function pointAt(t_s: number): void {
    // Another flight was chosen, and is not drawn yet.
    if (!Number.isFinite(t_s)) return;
    const { start_s, end_s } = view();
    cursor_s = Math.min(end_s, Math.max(start_s, t_s));
    report?.point((cursor_s - drawn.start_s) / lengthOf(drawn));
    bar.show(view(), whole, (cursor_s - start_s) / lengthOf(view()));
    bar.say(`${cursor_s.toFixed(1)} s`);
    quiet(follow());
    write();
  }

  /** Asks what was known at the cursor; of many places that it passes only the last counts. */
  const follow = latest(async () => {
    if (isComparing || current?.state !== 'done') return;
    const entry = current;
    const moment = await engine.call('momentOf', entry.log, source(), cursor_s);
    if (entry !== current || isComparing) return;
    moments.show(moment, report?.near((cursor_s - drawn.start_s) / lengthOf(drawn)) ?? []);
    const risk = moment.step?.risk;
    const words = [`${moment.t_s.toFixed(1)} s`, moment.mode, typeof risk === 'number' ? `risk ${risk.toFixed(0)} %` : 'risk unknown'];
    bar.say(words.filter(Boolean).join(', '));
  });

  function tellVerdict(): void {
    const { brief, unchanged } = current ?? {};
    if (!brief) return;
    const findings = brief.findings.length === 1 ? '1 finding' : `${brief.findings.length} findings`;
    status.textContent = `${brief.verdict}: ${brief.log.path}, ${findings}`;
    if (isUnchanged(changes)) thresholds.tell('The verdict is ', badge(brief.verdict), '.');
    else if (unchanged) thresholds.tell('With the profile ', badge(unchanged), ', with these thresholds ', badge(brief.verdict), '.');
    view_.dataset['verdict'] = verdictClass(brief.verdict);
  }

  let timer = 0;
  function retry(changed: VerdictChanges): void {
    changes = changed;
    clearTimeout(timer);
    timer = window.setTimeout(() => quiet(useProfile(base, changes)), 60);
  }

  /** Takes another profile, or other thresholds of it, and assesses all logs again: the one that is looked at first. */
  const useProfile = latest(async (wanted: ProfileSource, changed: VerdictChanges) => {
    try {
      const plain = await engine.call('profileFacts', wanted);
      facts = isUnchanged(changed) ? plain : await engine.call('profileFacts', wanted, changed);
      const isOther = wanted !== base;
      base = wanted;
      changes = changed;
      thresholds.set(plain.verdict, changes);
      if (isOther) for (const entry of entries) delete entry.unchanged;
    } catch (error) {
      if (error instanceof Cancelled) throw error;
      if (wanted === base) thresholds.refuse((error as Error).message);
      else {
        message.hidden = false;
        fill(message, h('b', {}, `${wanted.name} cannot be used`), h('pre', {}, (error as Error).message));
      }
      listProfiles();
      return;
    }
    listProfiles();
    write();
    message.hidden = current?.state !== 'refused';
    const first = current?.state === 'done' ? [current] : [];
    for (const entry of [...first, ...done().filter((entry) => entry !== current)]) {
      Object.assign(entry, await engine.call('assessLog', entry.log, source()));
      if (isUnchanged(changes)) entry.unchanged = entry.brief?.verdict;
      list.show(entries, isComparing ? undefined : current);
      if (entry !== current) continue;
      tellVerdict();
      if (!isComparing) await redraw(true);
    }
    if (isComparing) await redraw(true);
  });

  let shipped: string[] = [];
  function listProfiles(): void {
    const names = base.text === undefined ? shipped : [...shipped, base.name];
    const option = (value: string, words: string, selected: boolean) => h('option', { value, selected }, words);
    fill(profiles, ...names.map((name) => option(name, name, name === base.name)), option('', 'from a file, or with its rules …', false));
  }

  async function save(kind: Download | 'flight'): Promise<void> {
    const logs = compared().map(({ log }) => log);
    const [first] = logs;
    if (!first) return;
    const stem = isComparing ? 'comparison' : first.file.name.replace(/(\.(bin|log|ulg|tlog|csv|gz))+$/i, '');
    if (kind !== 'flight') {
      const name = kind === 'csv' ? `${stem}.steps.csv` : `${stem}.${kind}`;
      download(name, await engine.call('downloadLogs', logs, source(), kind), '');
      return;
    }
    const { csv, warnings } = await engine.call('convertLog', first);
    download(`${stem}.csv`, csv, '');
    app.say(warnings.join('; '));
  }

  let written = 0;
  /** Says in the address what is looked at, but not with every move of the pointer. */
  function write(): void {
    clearTimeout(written);
    written = window.setTimeout(() => {
      const said = new URLSearchParams();
      if (example) said.set('example', example);
      if (base.text === undefined && base.name !== 'flagred') said.set('profile', base.name);
      if (!isUnchanged(changes)) said.set('verdict', JSON.stringify(changes));
      if (current && !isComparing) said.set('t', cursor_s.toFixed(2));
      if (shown) {
        said.set('from', shown.start_s.toFixed(2));
        said.set('to', shown.end_s.toFixed(2));
      }
      app.navigate(said);
    }, 300);
  }

  const ready = (async () => {
    const begun = await engine.call('beginFlights');
    shipped = begun.shipped;
    if (!shipped.includes(base.name)) base = { name: shipped[0] ?? 'flagred' };
    report = makeReport(begun.style, {
      onPoint: (share) => pointAt(view().start_s + share * lengthOf(view())),
      onZoom: (from, to) => show(zoomed(view(), from, to, whole)),
      onFlight: (placed) => {
        const entry = done()[placed];
        if (entry) void choose(entry);
      },
    });
    place.append(report.element);
    await useProfile(base, changes);
  })();
  quiet(ready);
  if (example) quiet(takeExample(example));
  compareButton.disabled = true;
  return {
    shown(parameters) {
      const wanted = parameters.get('example');
      if (wanted && wanted !== example) quiet(takeExample(wanted));
      const name = parameters.get('profile') ?? shipped[0];
      const tried = changesIn(parameters);
      const isOther = base.text === undefined && name !== undefined && name !== base.name;
      if (isOther || JSON.stringify(tried) !== JSON.stringify(changes)) quiet(useProfile(isOther ? { name } : base, tried));
      if (view_.hidden) return;
      const stretch = stretchIn(parameters);
      const [t_s, now] = [Number(parameters.get('t') ?? NaN), view()];
      if (stretch && Math.abs(stretch.start_s - now.start_s) + Math.abs(stretch.end_s - now.end_s) > 0.02) show(within(stretch, whole));
      if (Math.abs(t_s - cursor_s) > 0.01) pointAt(t_s);
    },
  };
}

/** The words of an error; those of a defect are told apart from a refusal. */
const told = (error: Error): string => (error instanceof Trapped ? `flagred has a defect: ${error.message}` : error.message);

/** A profile that was chosen, with its rule set where that was chosen, too. */
async function profileIn(files: File[]): Promise<ProfileSource> {
  const texts = await Promise.all(files.map(async (file) => ({ name: file.name, text: await file.text() })));
  const isProfile = ({ text }: { text: string }) => /^flagred\s*:/m.test(text);
  const profile = texts.find(isProfile) ?? texts[0]!;
  const rules = texts.find((other) => other !== profile)?.text;
  return rules === undefined ? profile : { ...profile, rules };
}

const lengthOf = ({ start_s, end_s }: Stretch) => Math.max(end_s - start_s, 1e-6);

function stretchIn(address: URLSearchParams): Stretch | undefined {
  const [start_s, end_s] = ['from', 'to'].map((name) => Number(address.get(name) ?? NaN));
  const isGiven = Number.isFinite(start_s) && Number.isFinite(end_s);
  return isGiven ? { start_s: start_s!, end_s: end_s! } : undefined;
}

function changesIn(address: URLSearchParams): VerdictChanges {
  try {
    const given: unknown = JSON.parse(address.get('verdict') ?? '{}');
    return typeof given === 'object' && given !== null ? (given as VerdictChanges) : {};
  } catch {
    return {};
  }
}
