/**
 * Draws the report of a flight, or the comparison of several, part by part, with a cursor and a zoom that its charts
 * share.
 */

import type { Part } from 'flagred';
import { fragment, h } from '../dom';
import { chartsIn, curvesOf, locate, mapIn, held, point, type Chart, type DecisionMap } from './charts';
import { gestures } from './gestures';
import { pointTrack, trackIn, type Track } from './track';

/** Handles events on the charts. */
export interface Listener {
  /** The cursor was moved; 0 is the left edge of the charts, 1 the right one. */
  onPoint(share: number): void;
  /** The part between two positions of the charts is requested; they may be outside. */
  onZoom(from: number, to: number): void;
  /** A flight of a comparison was chosen, by its index. */
  onFlight(place: number): void;
}

export interface Report {
  element: HTMLElement;
  /** Draws parts; those that are not named do not change. Returns `false` if another drawing started meanwhile. */
  draw(parts: readonly (readonly [Part | 'comparison', string])[], isAll: boolean): Promise<boolean>;
  /** Removes everything. */
  clear(): void;
  /** Shows the charts with another stretch of time until they are drawn again, given the positions of its ends. */
  preview(from: number, to: number): void;
  /** Moves the cursor of all charts. */
  point(share: number): void;
  /** Returns the messages of the log near a position. */
  near(share: number): string[];
}

interface Section {
  element: HTMLElement;
  charts: Chart[];
  /** Whether the section is empty even for the whole flight. */
  isEmpty: boolean;
}

/** Styles that the style sheet of the report lacks, because it is written for a page. */
const STYLE = `
:host{display:block;min-width:0}
section{content-visibility:auto;contain-intrinsic-size:auto 20rem;min-width:0}
section[data-part=head],section[data-part=about],section[data-part=risk],section[data-part=signals]{content-visibility:visible}
section[data-part=head] h1{margin-top:0}
.rest{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:0 1.6rem}
section{grid-column:1/-1}
@media(min-width:64.01rem){section[data-part=track]:not(:empty),section[data-part=track]:not(:empty)+section[data-part=map]{grid-column:auto}}
section[data-part=track] figure,section[data-part=map] figure{margin-left:0}
section[data-part=risk] h2{display:none}
.cursor{position:absolute;inset:0;border-left:1px solid var(--ink);opacity:.65;pointer-events:none;will-change:transform}
.area{cursor:crosshair;touch-action:pan-y;user-select:none;-webkit-user-select:none}
.selection{position:absolute;top:0;bottom:0;background:var(--accent);opacity:.18;pointer-events:none}
.preview .times,.preview .phase{visibility:hidden}
a{color:var(--accent)}
@media(max-width:40rem){.map .y{font-size:.65rem}}
.nothing{color:var(--soft);font-size:.9rem}
@media print{:host{font-size:10pt;-webkit-print-color-adjust:exact;print-color-adjust:exact}section{content-visibility:visible}.cursor{display:none}}
`;

const nextTask = () => new Promise<void>((resolve) => setTimeout(resolve));

/** Creates a report with the style sheet of the command line's reports. */
export function report(style: string, listener: Listener): Report {
  const element = h('div', { class: 'report' });
  // Its style sheet is written for a whole page, so it is confined to this shadow root.
  const root = element.attachShadow({ mode: 'open' });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style.replaceAll(':root', ':host') + STYLE);
  root.adoptedStyleSheets = [sheet];
  const [top, middle, rest] = [h('div', {}), h('div', {}), h('div', { class: 'rest' })];
  const slot = (name: string) => h('slot', { name });
  // The verdict comes first, then the controls; the slider is at the charts.
  const body = h('div', {}, top, slot('tools'), middle, slot('bar'), rest);
  root.append(body);

  const sections = new Map<string, Section>();
  let map: DecisionMap | undefined;
  let track: Track | undefined;
  let share = 0.5;
  let drawing = 0;
  let frame = 0;
  const selection = h('div', { class: 'selection' });

  const charts = function* (): Iterable<Chart> {
    for (const section of sections.values()) yield* section.charts;
  };

  function section(name: string): Section {
    let known = sections.get(name);
    if (!known) {
      known = { element: h('section', { 'data-part': name }), charts: [], isEmpty: false };
      sections.set(name, known);
      (name === 'head' ? top : name === 'about' ? middle : rest).append(known.element);
    }
    return known;
  }

  /** Parses the curves step by step, and shows their values at the cursor. */
  async function read(of: Iterable<Chart>, mine: number): Promise<boolean> {
    for (const chart of of) {
      curvesOf(chart);
      point(chart, share * chart.length_s);
      await nextTask();
      if (mine !== drawing) return false;
    }
    return true;
  }

  function locateAll(): void {
    const [main] = charts();
    if (track && main) pointTrack(track, main.start_s + share * main.length_s);
    if (!map) return;
    const inputs = new Map<number, number>();
    for (const chart of charts()) {
      const [curve] = chart.input === undefined ? [] : curvesOf(chart);
      if (curve && chart.input !== undefined) inputs.set(chart.input, held(curve, share * chart.length_s));
    }
    locate(map, inputs);
  }

  const areaOf = (event: Event) =>
    event
      .composedPath()
      .find((target): target is HTMLElement => target instanceof HTMLElement && target.matches('.panel .area'));

  gestures(element, areaOf, {
    point: listener.onPoint,
    zoom: listener.onZoom,
    select(area, ends) {
      if (!ends) return selection.remove();
      selection.style.left = `${100 * Math.min(...ends)}%`;
      selection.style.width = `${100 * Math.abs(ends[1] - ends[0])}%`;
      area.append(selection);
    },
  });
  root.addEventListener('click', (event) => {
    const link = (event.target as Element).closest('a[href^="#flight"]');
    if (!link) return;
    event.preventDefault();
    listener.onFlight(Number(link.getAttribute('href')?.slice('#flight'.length)));
  });
  // The search over folded rows.
  root.addEventListener('input', ({ target }) => {
    const wanted = (target as HTMLInputElement).value.toLowerCase();
    const rows = (target as Element).closest('.searched')?.querySelectorAll('tr') ?? [];
    for (const row of rows) row.hidden = !row.textContent!.toLowerCase().includes(wanted);
  });
  root.addEventListener('pointerover', (event) => {
    const value = (event.target as Element).getAttribute('data-v');
    const output = value && map?.box.querySelector('output');
    if (output) output.textContent = `here ${value}`;
  });

  return {
    element,
    async draw(parts, isAll) {
      const mine = ++drawing;
      if (isAll) {
        const kept = new Set<string>(parts.map(([name]) => name));
        for (const [name, { element }] of sections) {
          if (kept.has(name)) continue;
          element.remove();
          sections.delete(name);
        }
        if (!kept.has('map')) map = track = undefined;
      }
      for (const [name, html] of parts) {
        const made = section(name);
        const drawn = document.createDocumentFragment();
        // One chart at a time, so that no task is long.
        for (const piece of html.split(/(?=<figure class="panel)/)) {
          drawn.append(fragment(piece));
          await nextTask();
          if (mine !== drawing) return false;
        }
        if (isAll || name === 'signals') made.isEmpty = !html;
        else if (!html && !made.isEmpty) drawn.append(h('p', { class: 'nothing' }, 'This part of the flight has no known values.'));
        // Elements that may scroll can also be scrolled by keys.
        for (const wide of drawn.querySelectorAll<HTMLElement>('pre, .scroll')) wide.tabIndex = 0;
        made.charts = chartsIn(drawn);
        if (name === 'map') map = mapIn(drawn);
        if (name === 'track') track = trackIn(drawn);
        made.element.replaceChildren(drawn);
        await nextTask();
        if (mine !== drawing) return false;
      }
      body.classList.remove('preview');
      if (!(await read(charts(), mine))) return false;
      locateAll();
      return true;
    },
    clear() {
      drawing++;
      map = undefined;
      track = undefined;
      sections.clear();
      for (const part of [top, middle, rest]) part.replaceChildren();
    },
    preview(from, to) {
      body.classList.add('preview');
      for (const { plot, length_s } of charts()) {
        const { y, height } = plot.viewBox.baseVal;
        plot.setAttribute('viewBox', `${from * length_s} ${y} ${Math.max(to - from, 1e-9) * length_s} ${height}`);
      }
    },
    point(to) {
      share = to;
      // A pointer moves more often than the screen is drawn.
      frame ||= requestAnimationFrame(() => {
        frame = 0;
        for (const chart of charts()) if (chart.curves) point(chart, share * chart.length_s);
        locateAll();
      });
    },
    near(at) {
      const [main] = charts();
      if (!main) return [];
      const x_s = at * main.length_s;
      const near = main.events.filter((event) => Math.abs(event.x_s - x_s) < main.length_s * 0.01);
      return near.slice(0, 3).map((event) => event.text);
    },
  };
}
