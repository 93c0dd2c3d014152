/**
 * The rules room: an editor, the findings, the decision map, the explanation of a value, and the shapes of the terms.
 */

import type { About, Diagnostic, Edit, Format, Start, View } from 'flagred';
import type { App, Room } from '../app';
import { add, fill, h } from '../dom';
import { Trapped } from '../engine';
import { latest } from '../latest';
import { backing, type Backing } from './backing';
import type { Opened, Picture, Place } from './calls';
import { KINDS, read, settle, view as viewOf, written, type Choice } from './choice';
import { editor, type Editor } from './editor';
import { data } from './data';
import { drawn, opened as openedFile, saved } from './exchange';
import { explain } from './explanation';
import { inputs } from './inputs';
import { decisionMap, type Kind } from './map';
import { problems } from './problems';
import { LONGEST, pack, unpack } from './share';
import { before, keep, kept, setAside } from './store';
import { table } from './table';
import { tabs } from './tabs';
import { terms } from './terms';
import { viewer } from './viewer';

const ADDRESS_MS = 300;
const REASON_MS = 80;
const FORMATS = ['FIS', 'FLL', 'FCL', 'FML'] as const;

/** Opens the room. */
export async function open(root: HTMLElement, app: App): Promise<Room> {
  const { engine } = app;
  const [colours, starts] = await Promise.all([engine.call('rulesColours'), engine.call('rulesStarts')]);

  /** The meaning of the editor's text. */
  let opened: Opened | undefined;
  /** The last text without errors and its meaning, for the map. */
  let good: { text: string; about: About } | undefined;
  const choice: Choice = { output: '', x: '', y: '', kind: 'map', isWhole: false };
  /** The value of each input that was ever set or held, by name. */
  const values = new Map<string, number>();
  /** The text at the start of a drag. */
  let base: string | undefined;
  let start: string | undefined;
  /** A text that crashes flagred, which is not tried again. */
  let poison: string | undefined;

  // Bugs of flagred are reported, and do not end the page.
  async function guarded(text: string, run: () => Promise<void>): Promise<void> {
    if (text === poison) return;
    try {
      await run();
    } catch (error) {
      if (error instanceof Trapped) poison = text;
      refused(error as Error);
    }
  }
  function refused(error: Error): void {
    app.say(error instanceof Trapped ? `flagred has a defect, but continues: ${error.message}` : error.message);
  }
  // Deferred until `guarded` has stored the text that caused the crash.
  engine.onRestart = () => setTimeout(() => edit.text() !== poison && changed(edit.text()));

  // The parts of the room.
  const map = decisionMap(colours, { at: (input) => (good ? point(good.about)[input]! : 0), move: (input, value) => move(input, value) });
  const sliders = inputs((input, value) => move(input, value));
  const shapes = terms(colours, {
    begin: () => (base ??= edit.text()),
    move: (place, x, degree) => base !== undefined && drag(base, place, x, degree),
    end: () => void drag.settled().then(concluded),
  });
  const found = problems((from, to) => edit.select(from, to));
  const why = h('div', { class: 'why' });
  const ruleViewer = viewer((input, value) => move(input, value));
  const rows = data(app, {
    text: () => edit.text(),
    replace(text) {
      const before = edit.text();
      edit.follow(text);
      edit.conclude(before);
      changed(text);
    },
    visit: (point) => point.forEach((value, input) => move(input, value)),
  });
  const edits = (change: (text: string) => Promise<Edit[]>) => change(edit.text());
  const forms = table(
    {
      rename: (at, name) => edits((text) => engine.call('rulesRename', text, at, name)),
      addVariable: (...variable) => edits((text) => engine.call('rulesAddVariable', text, ...variable)),
      addTerm: (...term) => edits((text) => engine.call('rulesAddTerm', text, ...term)),
      removeNamed: (...named) => edits((text) => engine.call('rulesRemoveNamed', text, ...named)),
      setRange: (...range) => edits((text) => engine.call('rulesSetRange', text, ...range)),
      setUnit: (...unit) => edits((text) => engine.call('rulesSetUnit', text, ...unit)),
      setShape: (...shape) => edits((text) => engine.call('rulesSetShape', text, ...shape)),
      setParameters: (...parameters) => edits((text) => engine.call('rulesSetParameters', text, ...parameters)),
      addRule: (rule) => edits((text) => engine.call('rulesAddRule', text, rule)),
      changeRule: (...rule) => edits((text) => engine.call('rulesChangeRule', text, ...rule)),
      removeRule: (rule) => edits((text) => engine.call('rulesRemoveRule', text, rule)),
    },
    async (run) => {
      const text = edit.text();
      try {
        if (app.file?.readOnly) throw new Error(`${app.file.name} is read-only`);
        const change = await run();
        if (edit.text() !== text) return 'the text has changed meanwhile; try again';
        edit.apply(change);
        return undefined;
      } catch (error) {
        if (error instanceof Trapped) refused(error);
        return (error as Error).message;
      }
    },
    app.say,
  );
  const stale = h('p', { class: 'stale', hidden: true }, 'The text has errors. This part of the page shows the last text without errors.');
  const legend = h('ul', { class: 'legend rules', hidden: true });
  const selects = {
    output: h('select', { 'aria-label': 'Output', onchange: chosen }),
    x: h('select', { 'aria-label': 'Input across', onchange: chosen }),
    y: h('select', { 'aria-label': 'Input up', onchange: chosen }),
    kind: h('select', { 'aria-label': 'Show', onchange: chosen }, ...KINDS.map(([value, words]) => h('option', { value }, words))),
  };
  const whole = h('input', { type: 'checkbox', onchange: chosen });
  const labelled = (words: string, select: HTMLElement) => h('label', {}, h('span', { class: 'soft' }, words), select);

  // Actions on the text.
  const startFrom = h('select', { 'aria-label': 'Start from an example', onchange: startChosen });
  add(
    startFrom,
    h('option', { value: '' }, 'Start from ...'),
    h('option', { value: 'before' }, 'the text I had before'),
    ...starts.map(({ name, about }, i) => h('option', { value: i }, `${name}: ${about}`)),
  );
  const file = h('input', { type: 'file', hidden: true, accept: '.yaml,.yml,.json,.fis,.fll,.fcl,.fml,.xml', 'aria-label': 'Rule set' });
  file.addEventListener('change', () => {
    const [first] = file.files ?? [];
    file.value = '';
    if (first) void take(first);
  });
  const save = h('select', { 'aria-label': 'Download', onchange: saveChosen });
  add(
    save,
    h('option', { value: '' }, 'Download ...'),
    h('option', { value: 'YAML' }, 'Rule set in YAML'),
    ...FORMATS.map((format) => h('option', { value: format }, `Rule set in ${format}`)),
    ...[['map', 'Map'], ['surface', 'Surface'], ['rules', 'Strongest rules'], ['terms', 'Terms'], ['explanation', 'Explanation']].map(([value, words]) =>
      h('option', { value }, `${words} as SVG`),
    ),
  );
  const button = (words: string, title: string, run: () => void) => h('button', { type: 'button', title, onclick: run }, words);
  const sign = (sign: string, words: string, key: string, run: () => void) =>
    h('button', { type: 'button', class: 'sign', title: `${words} (${key})`, 'aria-label': words, onclick: run }, sign);
  const undo = sign('\u21b6', 'Undo', 'Ctrl+Z', () => edit.undo());
  const redo = sign('\u21b7', 'Redo', 'Ctrl+Y', () => edit.redo());
  const group = (...children: HTMLElement[]) => h('div', { class: 'group' }, ...children);
  const bar = h(
    'div',
    { class: 'bar-of-tools', role: 'toolbar', 'aria-label': 'Rule set' },
    group(startFrom, button('Open', 'Open a rule set in YAML, FIS, FLL, FCL or FML', () => file.click()), file, save),
    group(undo, redo, button('Format', 'Format the text (Shift+Alt+F)', format)),
    group(button('Copy link', 'Copy a link that contains this rule set', () => void share())),
  );
  const paper = h('div', { class: 'editor' });
  const heading = h('h1', {}, 'Rules');
  const writing = tabs('Edit as', [['Text', paper], ['Table', forms.element]], () => {
    if (opened && !forms.element.hidden) forms.show(opened.parts, opened.variables);
  });
  fill(
    root,
    h('div', { class: 'head' }, heading, bar),
    h(
      'div',
      { class: 'columns' },
      h('div', { class: 'writing' }, writing.list, writing.panel, found.element),
      h(
        'div',
        { class: 'seeing' },
        h(
          'section',
          { class: 'map', 'aria-label': 'Decision map' },
          h('div', { class: 'choices' }, labelled('output', selects.output), labelled('across', selects.x), labelled('up', selects.y), h('span', {}, selects.kind), h('label', { class: 'check' }, whole, ' whole ranges')),
          stale,
          map.element,
          legend,
          sliders.element,
        ),
        h('section', { class: 'explanation', 'aria-label': 'Explanation' }, h('h2', {}, 'Why'), why),
      ),
      h('section', { class: 'reading', 'aria-label': 'Rule viewer' }, h('h2', {}, 'Rules ', h('span', { class: 'soft' }, 'the degree of each condition at this point; drag the line of an input')), ruleViewer.element),
      h('section', { class: 'shapes', 'aria-label': 'Terms' }, h('h2', {}, 'Terms ', h('span', { class: 'soft' }, 'drag a point, or move it with the arrow keys')), shapes.element),
      rows.element,
    ),
  );

  // Reactions to changes of the text.
  const refresh = latest((text: string) => guarded(text, async () => show(await engine.call('rulesOpen', text))));
  const examine = latest((text: string) =>
    guarded(text, async () => {
      const findings = await engine.call('rulesFindings', text);
      if (text === edit.text()) shown(findings);
    }),
  );
  const drag = latest((text: string, place: Place, x: number, degree: number) =>
    guarded(text, async () => {
      try {
        const next = await engine.call('rulesDrag', text, place, x, degree);
        if (base !== text) return;
        edit.follow(next.text);
        await show(next);
      } catch (error) {
        if (error instanceof Trapped) throw error;
        app.say((error as Error).message);
      }
    }),
  );
  const drawMap = latest(() => guarded(good?.text ?? '', mapped));
  const reason = latest(() =>
    guarded(good?.text ?? '', async () => {
      const now = good;
      if (!now) return;
      const at = point(now.about);
      const reasons = await engine.call('rulesExplain', now.text, at);
      explain(why, now.about, reasons.explanation);
      ruleViewer.show(reasons, at);
      // Nobody can read a text that changes faster, and its layout would take time that the map and the shapes need.
      await new Promise((done) => setTimeout(done, REASON_MS));
    }),
  );

  function changed(text: string): void {
    [undo.disabled, redo.disabled] = [!edit.can().undo, !edit.can().redo];
    if (base !== undefined) return;
    store(text);
    refresh(text);
    examine(text);
  }

  function store(text: string): void {
    disk?.changed(text);
    if (text !== starts.find(({ name }) => name === start)?.text) start = undefined;
    if (!disk && !keep(text)) app.say('This browser cannot store the rule set: download it, or copy its link, before you leave.');
    address();
  }

  function shown(findings: Diagnostic[]): void {
    edit.show(findings);
    found.show(findings);
  }

  async function show(next: Opened): Promise<void> {
    opened = next;
    shapes.show(next.variables, choice.isWhole);
    if (!forms.element.hidden) forms.show(next.parts, next.variables);
    stale.hidden = next.about !== undefined || !good;
    map.element.classList.toggle('old', !stale.hidden);
    if (!next.about) return;
    good = { text: next.text, about: next.about };
    heading.textContent = next.about.name;
    rows.show(next.text, next.about.inputs.map(({ name }) => name));
    await hold(good.about);
    options(good.about);
    follow();
  }

  /** Sets a value for each input that has none yet. */
  async function hold(about: About): Promise<void> {
    settle(choice, about);
    const names = about.inputs.map(({ name }) => name);
    for (const { name, low, high } of about.inputs) {
      const value = values.get(name);
      if (value !== undefined && (value < low || value > high)) values.delete(name);
    }
    if (names.every((name) => values.has(name))) return;
    const { output, axes } = chosenView(about);
    const fixed = about.inputs.map(({ name }) => values.get(name) ?? null);
    const held = await engine.call('rulesHeld', good!.text, output, axes.map(({ input }) => input), fixed);
    about.inputs.forEach(({ name, shown: [low, high] }, i) => {
      const isAxis = axes.some(({ input }) => input === i);
      if (!values.has(name)) values.set(name, isAxis ? (low + high) / 2 : held[i]!);
    });
  }

  const point = (about: About) => about.inputs.map(({ name, low }) => values.get(name) ?? low);

  const chosenView = (about: About): View => viewOf(choice, about, point(about));
  const view = () => good && chosenView(good.about);

  /** Updates the map, the sliders and the explanation for the current model and choice. */
  function follow(): void {
    const about = good!.about;
    const { axes, held } = chosenView(about);
    sliders.show(about.inputs, axes.map(({ input }) => input), held, choice.isWhole);
    shapes.mark(held);
    reason();
    drawMap();
  }

  async function mapped(): Promise<void> {
    const now = good;
    if (!now) return;
    const view = chosenView(now.about);
    const cells = await engine.call('rulesMap', now.text, view);
    const { inputs, outputs } = now.about;
    const [x, y] = view.axes.map(({ input }) => inputs[input]!);
    if (!x) return;
    map.draw({ kind: choice.kind, view, cells, x, y, output: outputs[view.output]!, point: point(now.about) });
    named(now.about, cells.dominantRules);
  }

  /** Shows which colour belongs to which rule. */
  function named(about: About, rules: Float64Array): void {
    legend.hidden = choice.kind !== 'rules' || !choice.y;
    if (legend.hidden) return;
    const there = [...new Set(rules)].filter((rule) => !Number.isNaN(rule)).sort((a, b) => a - b);
    fill(
      legend,
      ...there.map((rule) => {
        const swatch = h('span', { class: 'swatch', 'aria-hidden': 'true' });
        const at = 3 * ((rule - 1) % (colours.distinct.length / 3));
        swatch.style.backgroundColor = `rgb(${colours.distinct[at]} ${colours.distinct[at + 1]} ${colours.distinct[at + 2]})`;
        return h('li', {}, swatch, `${rule}: ${about.rules[rule - 1]}`);
      }),
    );
  }

  function move(input: number, value: number): void {
    const name = good?.about.inputs[input]?.name;
    if (!name) return;
    values.set(name, value);
    follow();
    address();
  }

  function concluded(): void {
    if (base === undefined) return;
    const before = base;
    base = undefined;
    const after = edit.text();
    edit.conclude(before);
    if (after !== before) changed(after);
  }

  // The choice of output and axes.
  function options(about: About): void {
    const put = (select: HTMLSelectElement, names: string[], value: string) => {
      const now = JSON.stringify(names);
      if (select.dataset['names'] !== now) {
        select.dataset['names'] = now;
        fill(select, ...names.map((name) => h('option', { value: name }, name)));
      }
      select.value = value;
    };
    const names = about.inputs.map(({ name }) => name);
    put(selects.output, about.outputs.map(({ name }) => name), choice.output);
    put(selects.x, names, choice.x);
    put(selects.y, names.length > 1 ? names : [], choice.y);
    selects.y.parentElement!.hidden = selects.kind.parentElement!.hidden = names.length < 2;
    selects.output.parentElement!.hidden = about.outputs.length < 2;
    selects.kind.value = choice.kind;
    whole.checked = choice.isWhole;
  }

  function chosen(): void {
    const [x, y] = [selects.x.value, selects.y.value];
    // If the other axis already shows this input, the two axes are swapped.
    Object.assign(choice, { output: selects.output.value, ...(x === y ? { x: choice.y, y: choice.x } : { x, y }) });
    choice.kind = selects.kind.value as Kind;
    choice.isWhole = whole.checked;
    if (opened) shapes.show(opened.variables, choice.isWhole);
    if (good) {
      options(good.about);
      follow();
    }
    address();
  }

  // Actions on the text.
  function put(text: string, from?: string): void {
    start = from;
    values.clear();
    // The axes that were chosen for another rule set do not apply.
    choice.output = choice.x = choice.y = '';
    edit.replace(text);
    if (from) store(text);
  }

  function startChosen(): void {
    const value = startFrom.value;
    startFrom.value = '';
    if (value === 'before') {
      const text = before();
      if (text === undefined) return app.say('There is no earlier rule set to restore.');
      setAside();
      return put(text);
    }
    const one: Start | undefined = value === '' ? undefined : starts[Number(value)];
    if (!one) return;
    if (start === undefined) setAside();
    put(one.text, one.name);
    app.say(`${one.name} is open. Undo restores your previous text.`);
  }

  async function take(file: File): Promise<void> {
    try {
      const text = await openedFile(app, file);
      if (text === undefined) return;
      setAside();
      put(text);
    } catch (error) {
      if (error instanceof TypeError) app.say(`\`${file.name}\` is not a text file`);
      else refused(error as Error);
    }
  }

  function saveChosen(): void {
    const value = save.value;
    save.value = '';
    const now = view();
    const name = (good?.about.name ?? 'rules').replace(/[^\w-]+/g, '-') || 'rules';
    const isFormat = value === 'YAML' || FORMATS.some((format) => format === value);
    const work = isFormat
      ? saved(app, name, edit.text(), value as Format | 'YAML')
      : good && now ? drawn(app, name, good.text, value as Picture, now) : Promise.reject(new Error('a rule set with errors has no picture'));
    work.catch(refused);
  }

  async function share(): Promise<void> {
    const parameters = said();
    parameters.delete('start');
    parameters.set('text', await pack(edit.text()));
    // An address without the text, which a recent change has scheduled, must not replace the link.
    clearTimeout(telling);
    app.navigate(parameters);
    const link = location.href;
    if (link.length > LONGEST) app.say('The link in the address bar is so long that some programs truncate it. A file is safer.');
    else {
      const isCopied = await navigator.clipboard?.writeText(link).then(() => true, () => false);
      app.say(isCopied ? 'The link is copied. It contains the rule set.' : 'The link is in the address bar: copy it from there.');
    }
  }

  function format(): void {
    const text = edit.text();
    engine.call('rulesFormat', text).then(
      (formatted) => {
        if (edit.text() !== text) return;
        const before = edit.text();
        edit.follow(formatted);
        edit.conclude(before);
      },
      refused,
    );
  }

  function rename(): void {
    const [text, at] = [edit.text(), edit.cursor()];
    const name = prompt('The new name, which replaces the old one everywhere in the rule set:');
    if (!name) return;
    engine.call('rulesRename', text, at, name).then(
      (edits) => edit.text() === text && edit.apply(edits),
      refused,
    );
  }

  // The address: the open text and the choice.
  function said(): URLSearchParams {
    const parameters = written(choice, good && point(good.about));
    if (start) parameters.set('start', start);
    return parameters;
  }

  let telling: ReturnType<typeof setTimeout> | undefined;
  function address(): void {
    clearTimeout(telling);
    telling = setTimeout(() => app.navigate(said()), ADDRESS_MS);
  }

  /** Returns the text that an address contains, if any. */
  async function textOf(parameters: URLSearchParams): Promise<string | undefined> {
    const packed = parameters.get('text');
    if (packed === null) {
      start = parameters.get('start') ?? undefined;
      const known = starts.find(({ name }) => name === start);
      if (start && !known) app.say(`there is no example \`${start}\``);
      return known?.text;
    }
    try {
      return await unpack(packed);
    } catch {
      app.say('The link is damaged: the rule set in it cannot be read.');
      return undefined;
    }
  }

  /** Sets the view of a text from an address. */
  async function look(parameters: URLSearchParams, text: string): Promise<void> {
    const at = read(choice, parameters);
    const { about } = await engine.call('rulesOpen', text).catch(() => ({ about: undefined }));
    if (at?.length !== about?.inputs.length) return;
    about?.inputs.forEach(({ name }, i) => values.set(name, at![i]!));
  }

  // Start.
  const asked = app.parameters();
  const linked = await textOf(asked);
  let disk: Backing | undefined;
  if (app.file) disk = await backing(app.file, app.say, (text) => edit.replace(text));
  const text = disk?.text ?? linked ?? kept() ?? starts[0]!.text;
  // A link from somebody else must not replace the user's own text.
  if (!disk && linked !== undefined && !starts.some((one) => one.text === kept())) setAside();
  if (!disk && linked === undefined && text === starts[0]!.text) start = starts[0]!.name;
  await look(asked, text);
  if (disk) bar.prepend(disk.element);
  const edit: Editor = editor(paper, text, app.file?.readOnly ?? false, {
    completions: (text, at) => engine.call('rulesCompletions', text, at),
    hover: (text, at) => engine.call('rulesHover', text, at),
    definition: (text, at) => engine.call('rulesDefinition', text, at),
    changed: (text) => changed(text),
    save: () => void (disk ? disk.save(edit.text()) : saved(app, good?.about.name ?? 'rules', edit.text(), 'YAML')),
    format,
    rename,
  });
  root.addEventListener('dragover', (event) => event.preventDefault());
  root.addEventListener('drop', (event) => {
    const [first] = event.dataTransfer?.files ?? [];
    if (!first) return;
    event.preventDefault();
    event.stopPropagation();
    void (/\.(csv|tsv)$/i.test(first.name) ? rows.take(first) : take(first));
  }, true);
  [undo.disabled, redo.disabled] = [true, true];
  refresh(text);
  examine(text);
  await refresh.settled();

  return {
    async shown(parameters) {
      if (parameters.toString() === said().toString()) return;
      const text = await textOf(parameters);
      if (text === undefined || text === edit.text()) {
        await look(parameters, edit.text());
        return changed(edit.text());
      }
      setAside();
      values.clear();
      await look(parameters, text);
      edit.replace(text);
    },
  };
}
