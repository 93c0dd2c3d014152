/** Rows of measured values: the error of the rule set on them, and rules and numbers that are learned from them. */

import type { Errors, Made } from 'flagred/data';
import type { App } from '../app';
import { fill, h } from '../dom';
import { Cancelled, Trapped, type Engine } from '../engine';
import { latest } from '../latest';
import type { Csv } from './datacalls';
import { short, told } from './numbers';

const LARGEST_BYTES = 50_000_000;

export interface Data {
  element: HTMLElement;
  /** Reads a table. */
  take(file: File): Promise<void>;
  /** Shows the error of another text, which must be usable. */
  show(text: string, inputs: string[]): void;
}

/** The functions of the room that the section uses. */
export interface Place {
  text(): string;
  /** Replaces the text by one that was made from rows; undo restores the old text. */
  replace(text: string): void;
  /** Moves the point that is explained. */
  visit(point: number[]): void;
}

export function data(app: App, place: Place): Data {
  let engine: Engine | undefined;
  const worker = () => (engine ??= app.data());
  let csv: Csv | undefined;
  let inputs: string[] = [];
  /** The text from which the running search started, and the best text that it has found so far. */
  let search: { text: string; found?: string } | undefined;

  const file = h('input', { type: 'file', hidden: true, accept: '.csv,.tsv,.txt', 'aria-label': 'Rows of data' });
  file.addEventListener('change', () => {
    const [first] = file.files ?? [];
    file.value = '';
    if (first) void made.take(first);
  });
  const choose = h('button', { type: 'button', onclick: () => file.click() }, 'Choose a CSV');
  const hint = h('p', { class: 'soft hint' });
  const report = h('div', { class: 'errors' });
  const complete = h('input', { type: 'checkbox' });
  const tune = h('button', { type: 'button', class: 'main', title: 'Adjust the numbers of the terms to reduce the error' }, 'Tune');
  const learn = h('button', { type: 'button', title: 'Replace the rules by rules learned from the rows' }, 'Learn rules');
  const stop = h('button', { type: 'button', hidden: true, title: 'Stop, and keep the best rule set so far' }, 'Stop');
  const progress = h('progress', { 'aria-label': 'Search', hidden: true });
  const state = h('p', { role: 'status', class: 'state' });
  const tools = h('div', { class: 'acts', hidden: true }, tune, learn, h('label', { class: 'check soft' }, complete, ' also rules for combinations without rows'), stop, progress);
  const element = h('section', { class: 'data', 'aria-label': 'Data' }, h('h2', {}, 'Data'), h('div', { class: 'acts' }, choose, file, hint), report, tools, state);

  const compare = latest(async (text: string) => {
    const now = csv;
    if (!now || search) return;
    try {
      const errors = await worker().call('dataErrors', now, text);
      if (now === csv) shown(now, errors);
    } catch (error) {
      if (!(error instanceof Cancelled)) fill(report, h('p', { class: 'refusal' }, (error as Error).message));
    }
  });

  function shown({ name }: Csv, { output, unit, rows, refused, refusedCount, withoutValue, rms, mean, largest, worst }: Errors): void {
    const figure = (words: string, value: number | null) => h('div', {}, h('dt', {}, words), h('dd', {}, told(value, unit)));
    fill(
      report,
      h('p', {}, h('b', {}, name), h('span', { class: 'soft' }, ` ${rows} ${rows === 1 ? 'row' : 'rows'} with values of ${output}`)),
      h('dl', {}, figure('RMS error', rms), figure('Mean error', mean), figure('Largest error', largest)),
      refusedCount > 0 && h('details', {}, h('summary', {}, `${refusedCount} ${refusedCount === 1 ? 'row is' : 'rows are'} not used`), h('ul', {}, ...refused.map((line) => h('li', {}, line)), refusedCount > refused.length && h('li', {}, `and ${refusedCount - refused.length} more`))),
      withoutValue > 0 && h('p', { class: 'soft' }, `No rule fires in ${withoutValue} of the rows, so the rule set has no value there.`),
      worst.length > 0 &&
        h(
          'div',
          { class: 'wide', tabindex: 0, role: 'region', 'aria-label': 'Rows with the largest errors' },
          h(
            'table',
            {},
            h('thead', {}, h('tr', {}, ...['Line', ...inputs, 'Measured', 'Computed', 'Error'].map((words) => h('th', { scope: 'col' }, words)), h('td', {}))),
            h(
              'tbody',
              {},
              ...worst.map(({ line, point, measured, computed }) =>
                h('tr', {}, ...[line, ...[...point, measured, computed, computed - measured].map(short)].map((cell) => h('td', {}, cell)), h('td', {}, h('button', { type: 'button', class: 'small', 'aria-label': `Show line ${line}`, onclick: () => place.visit(point) }, 'Show'))),
              ),
            ),
          ),
        ),
    );
  }

  function busy(is: boolean): void {
    [tune.disabled, learn.disabled, choose.disabled] = [is, is, is];
    [stop.hidden, progress.hidden] = [!is, !is];
  }

  /** Runs a search. If it is stopped, the best text that it has found is used. */
  async function run(words: string, work: (csv: Csv, text: string) => Promise<Made>): Promise<void> {
    if (!csv || search) return;
    const mine: { text: string; found?: string } = { text: place.text() };
    search = mine;
    busy(true);
    state.textContent = words;
    try {
      const { text, words, details } = await work(csv, mine.text);
      finish(mine.text, text, `${words}.`, details);
    } catch (error) {
      if (!(error instanceof Cancelled)) state.textContent = error instanceof Trapped ? `flagred has a defect: ${error.message}` : (error as Error).message;
      else if (mine.found === undefined) state.textContent = 'Stopped; nothing was changed.';
      else finish(mine.text, mine.found, 'Stopped; the best rule set so far is in the editor.', []);
    } finally {
      search = undefined;
      busy(false);
      void compare(place.text());
    }
  }

  function finish(before: string, after: string, words: string, details: string[]): void {
    if (place.text() !== before) {
      state.textContent = 'The text was edited meanwhile, so the result was dropped.';
      return;
    }
    place.replace(after);
    fill(state, h('b', {}, words), ' Undo restores the previous rule set.', details.length > 0 && h('span', { class: 'soft' }, ` ${details.slice(0, 12).join('; ')}${details.length > 12 ? `; and ${details.length - 12} more` : ''}.`));
  }

  tune.addEventListener('click', () =>
    void run('Tuning ...', (csv, text) =>
      worker().follow(
        (step, found) => {
          const { error, text } = found as { error: number; text: string };
          if (search) search.found = text;
          state.textContent = `Step ${step}: RMS error ${short(error)}`;
        },
        'dataTune', csv, text,
      ),
    ),
  );
  learn.addEventListener('click', () => void run('Learning ...', (csv, text) => worker().call('dataLearn', csv, text, complete.checked)));
  stop.addEventListener('click', () => worker().restart());

  const made: Data = {
    element,
    async take(file) {
      if (search) return app.say('Tuning or learning is running: stop it first.');
      try {
        if (file.size > LARGEST_BYTES) throw new Error(`\`${file.name}\` is larger than 50 MB: use fewer rows`);
        csv = { name: file.name, text: new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer()) };
      } catch (error) {
        return app.say(error instanceof TypeError ? `\`${file.name}\` is not a text file` : (error as Error).message);
      }
      tools.hidden = false;
      state.textContent = '';
      fill(report, h('p', { class: 'soft' }, `Reading ${file.name} ...`));
      element.scrollIntoView({ block: 'nearest' });
      await compare(place.text());
    },
    show(text, names) {
      inputs = names;
      hint.textContent = `or drop one here: a column for each input (${names.join(', ')}) and one for the output. It stays in this browser.`;
      if (csv) void compare(text);
    },
  };
  return made;
}
