/** The flight room, where logs are dropped, assessed and displayed. */

import type { Part, Stretch, VerdictChanges } from 'flagred';
import type { App, Room } from '../app';
import { add, download, fill, h } from '../dom';
import { Cancelled, Trapped } from '../engine';
import { latest } from '../latest';
import { placeIn, said } from './address';
import type { ProfileFacts, ProfileSource } from './calls';
import { ENDINGS, downloadMenu, type Kind } from './download';
import { dropZone } from './drop';
import { keys } from './keys';
import { badge, logList, verdictClass, type Entry } from './logs';
import { momentPanel } from './moment';
import { picker } from './picker';
import { profiles } from './profiles';
import { report as makeReport, type Report } from './report';
import { timeBar } from './timebar';
import { minutes, within, zoomed } from './time';
import { isUnchanged, whatIf } from './whatif';

/** The parts of a report that depend on the stretch of time. */
const OVER_TIME: readonly Part[] = ['risk', 'signals', 'inputs', 'motors', 'attitude'];

/** Opens the room. */
export function open(root: HTMLElement, app: App): Room {
  const { engine } = app;
  const begun = placeIn(app.parameters());
  const entries: Entry[] = [];
  let current: Entry | undefined;
  let isComparing = false;
  let base: ProfileSource = { name: begun.profile ?? 'flagred' };
  let changes: VerdictChanges = begun.changes;
  let facts: ProfileFacts | undefined;
  /** The stretch of the whole flight. */
  let whole: Stretch = { start_s: 0, end_s: 1 };
  /** The stretch that is shown. */
  let shown = begun.stretch;
  /** The stretch for which the charts were drawn. */
  let drawn: Stretch = whole;
  let cursor_s = begun.t_s ?? NaN;
  let signals = begun.signals;
  let example = begun.example;
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
    seek,
    move,
    zoom: (from, to) => show(zoomed(view(), from, to, whole)),
    reset: () => show(undefined),
  });
  const profile = profiles((source) => quiet(useProfile(source, {})));
  const compareButton = h('button', { type: 'button', 'aria-pressed': 'false' }, 'Compare');
  const closeButton = h('button', { type: 'button', 'aria-label': 'Close' }, h('span', { class: 'wide' }, 'Close'), h('span', { class: 'narrow' }, '×'));
  const downloads = downloadMenu((kind) => quiet(save(kind)));
  const plotted = picker((names) => {
    signals = names;
    quiet(redraw(false));
  });
  const tools = h('div', { class: 'tools', slot: 'tools' }, profile.element, plotted.element, compareButton, downloads, closeButton);
  const aside = h('div', { class: 'aside' }, moments.element, thresholds.element);
  const viewer = h('div', { class: 'flight-view', hidden: true }, h('div', { class: 'columns' }, place, aside));
  const drop = dropZone(root, { take, takeExample: () => quiet(takeExample('gust')) });
  const top = h('div', { class: 'top' }, drop);
  add(root, heading, status, list.element, top, message, viewer);

  compareButton.addEventListener('click', () => quiet(compare(!isComparing)));
  closeButton.addEventListener('click', () => current && remove(current));
  keys({
    isActive: () => !root.hidden && !viewer.hidden,
    state: () => ({ shown: view(), whole, t_s: cursor_s }),
    move,
    show,
  });

  /** Shows or hides the flight. The button that adds logs is one of its controls while it is shown. */
  function reveal(isShown: boolean): void {
    viewer.hidden = !isShown;
    (isShown ? tools : top).prepend(drop);
  }

  /** Reports errors of some work, except cancellation. */
  function quiet(work: Promise<unknown>): void {
    work.catch((error: Error) => {
      if (!(error instanceof Cancelled)) app.say(told(error));
    });
  }

  const listLogs = (): void => {
    list.show(entries, isComparing ? undefined : current);
    // If there are several logs, the table has a button to remove each of them.
    closeButton.hidden = entries.length > 1;
  };
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
    listLogs();
    void pump();
  }

  let isPumping = false;
  /** Reads the waiting logs one after another. */
  async function pump(): Promise<void> {
    if (isPumping) return;
    isPumping = true;
    await ready;
    for (let entry; (entry = entries.find(({ state }) => state === 'waiting')); ) await read(entry);
    isPumping = false;
  }

  async function read(entry: Entry): Promise<void> {
    entry.state = 'reading';
    listLogs();
    const progress = (share: number) => {
      entry.share = share;
      listLogs();
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
        // Another log was cancelled, which ended the worker.
        entry.state = 'waiting';
        entry.share = 0;
        return;
      }
      refuse(entry, error as Error);
    }
    if (!entries.includes(entry)) return;
    countLogs();
    if (isComparing) quiet(redraw(true));
    else if (!current || current.state === 'refused' || current === entry) await choose(entry);
    listLogs();
  }

  function countLogs(): void {
    compareButton.hidden = done().length < 2;
  }

  function refuse(entry: Entry, error: Error): void {
    entry.state = 'refused';
    entry.refusal = told(error);
  }

  function remove(entry: Entry): void {
    const isBusy = entry.state === 'reading';
    entries.splice(entries.indexOf(entry), 1);
    if (isBusy) engine.restart();
    else quiet(engine.call('forgetLog', entry.log.id));
    const wasSeen = current === entry || (isComparing && entry.state === 'done');
    if (current === entry) current = done()[0] ?? entries[0];
    countLogs();
    if (!current) clear();
    else if (isComparing && done().length > 1) quiet(redraw(true));
    else if (wasSeen) void choose(current);
    listLogs();
    app.say(isBusy ? `Cancelled: ${entry.log.file.name}` : '');
  }

  function clear(): void {
    report?.clear();
    reveal(false);
    message.hidden = true;
    heading.classList.remove('visually-hidden');
    drop.classList.remove('small');
    example = undefined;
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
    listLogs();
    heading.classList.add('visually-hidden');
    drop.classList.add('small');
    if (entry.state === 'refused') {
      reveal(false);
      message.hidden = false;
      fill(message, h('b', {}, `${entry.log.file.name} cannot be used`), h('pre', {}, entry.refusal ?? ''));
      return;
    }
    message.hidden = true;
    reveal(entry.state === 'done');
    if (!entry.stretch) return;
    closeButton.title = `Close ${entry.log.file.name}`;
    plotted.show(entry.signals ?? [], signals);
    whole = entry.stretch;
    if (shown) shown = within(shown, whole);
    if (!Number.isFinite(cursor_s)) cursor_s = entry.brief?.summary.risk_max?.t_s ?? (whole.start_s + whole.end_s) / 2;
    tellVerdict();
    await redraw(true).catch((error: Error) => quiet(Promise.reject(error)));
  }

  async function compare(on: boolean): Promise<void> {
    isComparing = on;
    shown = undefined;
    listLogs();
    if (!on && current) return choose(current);
    cursor_s = NaN;
    await redraw(true);
  }

  /**
   * Draws the report, or only the parts that depend on the stretch of time. A request during drawing is handled
   * afterwards.
   */
  const redraw = (isAll: boolean): Promise<void> => {
    isStale ||= isAll;
    return drawAgain();
  };
  let isStale = false;
  const drawAgain = latest(async () => {
    if (!report) return;
    const isAll = isStale;
    isStale = false;
    try {
      await draw(report, isAll);
    } catch (error) {
      isStale ||= isAll;
      throw error;
    }
    pointAt(cursor_s);
  });

  async function draw(report: Report, isAll: boolean): Promise<void> {
    const wanted = shown;
    compareButton.setAttribute('aria-pressed', String(isComparing));
    aside.hidden = plotted.element.hidden = isComparing;
    if (isComparing) {
      const { html, length_s } = await engine.call('compareLogs', done().map(({ log }) => log), source(), wanted);
      whole = { start_s: 0, end_s: length_s };
      if (!Number.isFinite(cursor_s)) cursor_s = length_s / 2;
      drawn = wanted ?? whole;
      await report.draw([['comparison', html]], true);
    } else if (current?.state === 'done') {
      const parts = await engine.call('reportParts', current.log, source(), signals, isAll ? undefined : OVER_TIME, wanted);
      drawn = wanted ?? whole;
      await report.draw(parts, isAll);
    }
  }

  function show(stretch: Stretch | undefined): void {
    shown = stretch;
    const { start_s, end_s } = view();
    const length_s = lengthOf(drawn);
    report?.preview((start_s - drawn.start_s) / length_s, (end_s - drawn.start_s) / length_s);
    pointAt(cursor_s);
    quiet(redraw(false));
  }

  /** Moves the cursor by steps of 1/500 of the shown stretch. */
  function move(steps: number): void {
    pointAt(cursor_s + (steps * lengthOf(view())) / 500);
  }

  /** Moves the cursor to a time; if it is outside the shown stretch, the stretch moves too. */
  function seek(t_s: number): void {
    const { start_s, end_s } = view();
    const half_s = lengthOf(view()) / 2;
    if (t_s < start_s || t_s > end_s) show(within({ start_s: t_s - half_s, end_s: t_s + half_s }, whole));
    pointAt(t_s);
  }

  function pointAt(t_s: number): void {
    // Another flight was chosen, and is not drawn yet.
    if (!Number.isFinite(t_s)) return;
    const { start_s, end_s } = view();
    cursor_s = Math.min(end_s, Math.max(start_s, t_s));
    report?.point((cursor_s - drawn.start_s) / lengthOf(drawn));
    bar.show(view(), whole, cursor_s);
    bar.say(`${minutes(cursor_s - whole.start_s)} min`);
    quiet(follow());
    write();
  }

  /** Requests the state at the cursor; while the cursor moves, only its latest position counts. */
  const follow = latest(async () => {
    if (isComparing || current?.state !== 'done') return;
    const entry = current;
    const moment = await engine.call('momentOf', entry.log, source(), cursor_s);
    if (entry !== current || isComparing) return;
    moments.show(moment, whole.start_s, report?.near((cursor_s - drawn.start_s) / lengthOf(drawn)) ?? []);
    const risk = moment.step?.risk;
    const words = [`${minutes(moment.t_s - whole.start_s)} min`, moment.mode, typeof risk === 'number' ? `risk ${risk.toFixed(0)} %` : 'risk unknown'];
    bar.say(words.filter(Boolean).join(', '));
  });

  function tellVerdict(): void {
    const { brief, unchanged } = current ?? {};
    if (!brief) return;
    const findings = brief.findings.length === 1 ? '1 finding' : `${brief.findings.length} findings`;
    status.textContent = `${brief.verdict}: ${brief.log.path}, ${findings}`;
    if (isUnchanged(changes)) thresholds.tell('The verdict is ', badge(brief.verdict), '.');
    else if (unchanged) thresholds.tell('With the profile ', badge(unchanged), ', with these thresholds ', badge(brief.verdict), '.');
    viewer.dataset['verdict'] = verdictClass(brief.verdict);
  }

  let timer = 0;
  function retry(changed: VerdictChanges): void {
    changes = changed;
    clearTimeout(timer);
    timer = window.setTimeout(() => quiet(useProfile(base, changes)), 60);
  }

  /** Uses another profile, or other thresholds of it, and assesses all logs again, beginning with the displayed one. */
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
      try {
        Object.assign(entry, await engine.call('assessLog', entry.log, source()));
      } catch (error) {
        // The file may be gone.
        if (error instanceof Cancelled) throw error;
        refuse(entry, error as Error);
      }
      if (isUnchanged(changes)) entry.unchanged = entry.brief?.verdict;
      listLogs();
      if (entry !== current) continue;
      if (entry.state === 'refused') {
        await choose(entry);
        continue;
      }
      tellVerdict();
      if (!isComparing) await redraw(true);
    }
    if (isComparing) await redraw(true);
  });

  let shipped: string[] = [];
  const listProfiles = (): void => profile.show(shipped, base);

  async function save(kind: Kind): Promise<void> {
    const logs = compared().map(({ log }) => log);
    const [first] = logs;
    if (!first) return;
    const stem = isComparing ? 'comparison' : first.file.name.replace(/(\.(bin|log|ulg|tlog|csv|gz))+$/i, '');
    if (kind !== 'flight') {
      download(stem + ENDINGS[kind], await engine.call('downloadLogs', logs, source(), kind), '');
      return;
    }
    const { csv, warnings } = await engine.call('convertLog', first);
    download(stem + ENDINGS[kind], csv, '');
    app.say(warnings.join('; '));
  }

  let written = 0;
  /** Writes the state of the room into the address, but not with every movement of the pointer. */
  function write(): void {
    clearTimeout(written);
    const profile = base.text === undefined && base.name !== shipped[0] ? base.name : undefined;
    const t_s = current && !isComparing ? cursor_s : undefined;
    written = window.setTimeout(() => app.navigate(said({ example, profile, changes, signals, t_s, stretch: shown })), 300);
  }

  const ready = (async () => {
    const { shipped: names, style } = await engine.call('beginFlights');
    shipped = names;
    if (!shipped.includes(base.name)) base = { name: shipped[0] ?? 'flagred' };
    report = makeReport(style, {
      onPoint: (share) => pointAt(view().start_s + share * lengthOf(view())),
      onZoom: (from, to) => show(zoomed(view(), from, to, whole)),
      onFlight: (placed) => {
        const entry = done()[placed];
        if (entry) void choose(entry);
      },
    });
    report.element.append(tools, bar.element);
    place.append(report.element);
    await useProfile(base, changes);
  })();
  quiet(ready);
  if (example) quiet(takeExample(example));
  countLogs();
  return {
    shown(parameters) {
      const wanted = placeIn(parameters);
      if (wanted.example && wanted.example !== example) quiet(takeExample(wanted.example));
      const name = wanted.profile ?? shipped[0];
      const isOther = base.text === undefined && name !== undefined && name !== base.name;
      const isTried = JSON.stringify(wanted.changes) !== JSON.stringify(changes);
      if (isOther || isTried) quiet(useProfile(isOther ? { name } : base, wanted.changes));
      if (viewer.hidden) return;
      const { stretch, t_s } = wanted;
      if (wanted.signals.join() !== signals.join()) {
        signals = wanted.signals;
        plotted.show(current?.signals ?? [], signals);
        quiet(redraw(false));
      }
      const apart_s = stretch ? Math.abs(stretch.start_s - view().start_s) + Math.abs(stretch.end_s - view().end_s) : 0;
      if (stretch && apart_s > 0.02) show(within(stretch, whole));
      if (t_s !== undefined && Math.abs(t_s - cursor_s) > 0.01) seek(t_s);
    },
  };
}

/** The message for an error; bugs are distinguished from refusals. */
const told = (error: Error): string => (error instanceof Trapped ? `flagred has a defect: ${error.message}` : error.message);

const lengthOf = ({ start_s, end_s }: Stretch) => Math.max(end_s - start_s, 1e-6);
