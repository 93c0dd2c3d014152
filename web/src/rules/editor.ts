/** The editor: CodeMirror with flagred's own findings, completion and hover. */

import { autocompletion, completionKeymap, type CompletionContext, type CompletionResult } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, isolateHistory, redo, redoDepth, undo, undoDepth } from '@codemirror/commands';
import { yaml } from '@codemirror/lang-yaml';
import { HighlightStyle, bracketMatching, indentOnInput, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics, type Diagnostic as Mark } from '@codemirror/lint';
import { highlightSelectionMatches, searchKeymap } from '@codemirror/search';
import { EditorState, Transaction } from '@codemirror/state';
import {
  EditorView,
  drawSelection,
  highlightActiveLine,
  highlightActiveLineGutter,
  hoverTooltip,
  keymap,
  lineNumbers,
} from '@codemirror/view';
import { tags } from '@lezer/highlight';
import type { Completion, Diagnostic, Edit, Hover } from 'flagred';
import { h } from '../dom';
import { markdown } from './markdown';

/** The services that the editor calls. */
export interface Service {
  completions(text: string, at: number): Promise<Completion[]>;
  hover(text: string, at: number): Promise<Hover | null>;
  definition(text: string, at: number): Promise<number | undefined>;
  changed(text: string): void;
  save(): void;
  format(): void;
  rename(): void;
}

export interface Editor {
  text(): string;
  /** Replaces the whole text; undo restores the old one. */
  replace(text: string): void;
  /** Replaces the text by one with a small difference, without an entry for undo. */
  follow(text: string): void;
  /** Combines all changes by `follow` since `before` into one entry for undo. */
  conclude(before: string): void;
  apply(edits: Edit[]): void;
  show(findings: Diagnostic[]): void;
  /** Selects a part and scrolls it into view. */
  select(from: number, to: number): void;
  cursor(): number;
  undo(): void;
  redo(): void;
  can(): { undo: boolean; redo: boolean };
  focus(): void;
}

const look = EditorView.theme({
  '&': { height: '100%', color: 'var(--ink)', backgroundColor: 'var(--paper)', fontSize: '14px' },
  '.cm-scroller': { fontFamily: 'ui-monospace, SFMono-Regular, Menlo, Consolas, monospace', lineHeight: '1.5' },
  '.cm-gutters': { backgroundColor: 'var(--shade)', color: 'var(--soft)', borderRight: '1px solid var(--rule)' },
  '.cm-activeLine': { backgroundColor: 'color-mix(in srgb, var(--accent) 7%, transparent)' },
  '.cm-activeLineGutter': { backgroundColor: 'var(--grid)' },
  '.cm-cursor': { borderLeftColor: 'var(--ink)' },
  '&.cm-focused': { outline: '2px solid var(--accent)', outlineOffset: '-2px' },
  '.cm-selectionBackground, &.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground': {
    backgroundColor: 'color-mix(in srgb, var(--accent) 28%, transparent)',
  },
  '.cm-matchingBracket': { backgroundColor: 'var(--grid) !important' },
  '.cm-selectionMatch': { backgroundColor: 'color-mix(in srgb, var(--warn) 22%, transparent)' },
  '.cm-tooltip': {
    backgroundColor: 'var(--paper)', color: 'var(--ink)', border: '1px solid var(--rule)', borderRadius: '.4rem',
    boxShadow: '0 4px 16px rgb(0 0 0 / .18)', maxWidth: 'min(34rem, 92vw)', fontFamily: 'system-ui, sans-serif',
  },
  '.cm-tooltip-autocomplete ul li[aria-selected]': { backgroundColor: 'var(--accent)', color: 'var(--paper)' },
  '.cm-completionDetail': { color: 'inherit', marginLeft: '1em' },
  '.cm-hover': { padding: '.4rem .7rem' },
  '.cm-hover p': { margin: '.2rem 0' },
  '.cm-hover code': { fontFamily: 'ui-monospace, monospace' },
  '.cm-diagnostic': { padding: '.35rem .7rem', borderLeftWidth: '4px', whiteSpace: 'pre-wrap' },
  '.cm-diagnostic-error': { borderLeftColor: 'var(--fail)' },
  '.cm-diagnostic-warning': { borderLeftColor: 'var(--warn)' },
  '.cm-diagnostic-info': { borderLeftColor: 'var(--accent)' },
  '.cm-lintRange': { backgroundImage: 'none', textDecorationLine: 'underline', textDecorationStyle: 'wavy', textDecorationSkipInk: 'none' },
  '.cm-lintRange-error': { backgroundImage: 'none', textDecorationColor: 'var(--fail)' },
  '.cm-lintRange-warning': { backgroundImage: 'none', textDecorationColor: 'var(--warn)' },
  '.cm-lintRange-info': { backgroundImage: 'none', textDecorationColor: 'var(--accent)' },
  '.cm-panels': { backgroundColor: 'var(--shade)', color: 'var(--ink)' },
  '.cm-panels input, .cm-panels button': {
    font: 'inherit', color: 'var(--ink)', background: 'var(--paper)', border: '1px solid var(--rule)', borderRadius: '.3rem',
  },
  '.cm-searchMatch': { backgroundColor: 'color-mix(in srgb, var(--warn) 35%, transparent)' },
});

const colours = HighlightStyle.define([
  { tag: tags.comment, color: 'var(--good)' },
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: 'var(--accent)' },
  { tag: [tags.string, tags.special(tags.string)], color: 'var(--ink)' },
  { tag: [tags.punctuation, tags.separator, tags.bracket], color: 'var(--soft)' },
]);

const severities = { error: 'error', warning: 'warning', note: 'info' } as const;
const kinds = { keyword: 'keyword', variable: 'variable', choice: 'enum', key: 'property', signal: 'constant' } as const;

/**
 * Creates the editor inside `place`. It is in a shadow root, where its styles are style sheets, not elements, as the
 * policy requires.
 */
export function editor(place: HTMLElement, text: string, readOnly: boolean, service: Service): Editor {
  const root = place.attachShadow({ mode: 'open' });

  async function complete(context: CompletionContext): Promise<CompletionResult | null> {
    const word = context.matchBefore(/[\w-]*/);
    const before = context.state.sliceDoc(Math.max(0, context.pos - 1), context.pos);
    if (!context.explicit && !word?.text && !' :[{,'.includes(before)) return null;
    const found = await service.completions(context.state.doc.toString(), context.pos);
    if (found.length === 0) return null;
    return {
      from: word?.from ?? context.pos,
      validFor: /^[\w-]*$/,
      // The order is that of the service, which puts likely completions first.
      options: found.map(({ label, text, kind, detail }, i) => ({
        label, apply: text, type: kinds[kind], boost: Math.max(99 - i, -99), ...(detail ? { detail } : {}),
      })),
    };
  }

  const hover = hoverTooltip(async (view, at) => {
    const found = await service.hover(view.state.doc.toString(), at);
    if (!found) return null;
    const dom = h('div', { class: 'cm-hover' }, markdown(found.markdown));
    return { pos: found.from, end: found.to, above: true, create: () => ({ dom }) };
  });

  function toDefinition(view: EditorView): boolean {
    const doc = view.state.doc;
    void service.definition(doc.toString(), view.state.selection.main.head).then((at) => {
      if (at !== undefined && view.state.doc === doc) made.select(at, at);
    });
    return true;
  }

  const view = new EditorView({
    parent: root,
    root,
    state: EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        lintGutter(),
        highlightActiveLine(),
        highlightActiveLineGutter(),
        history(),
        drawSelection(),
        indentOnInput(),
        bracketMatching(),
        highlightSelectionMatches(),
        EditorState.allowMultipleSelections.of(true),
        EditorState.readOnly.of(readOnly),
        EditorView.lineWrapping,
        EditorView.contentAttributes.of({ 'aria-label': 'Rule set in YAML', tabindex: '0', spellcheck: 'false', autocapitalize: 'off' }),
        yaml(),
        syntaxHighlighting(colours),
        autocompletion({ override: [complete], icons: false }),
        hover,
        look,
        keymap.of([
          { key: 'Mod-s', preventDefault: true, run: () => (service.save(), true) },
          { key: 'Shift-Alt-f', preventDefault: true, run: () => (service.format(), true) },
          { key: 'F2', preventDefault: true, run: () => (service.rename(), true) },
          { key: 'F12', preventDefault: true, run: toDefinition },
          ...completionKeymap,
          ...searchKeymap,
          ...historyKeymap,
          ...defaultKeymap,
        ]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) service.changed(update.state.doc.toString());
        }),
      ],
    }),
  });

  view.dispatch({ effects: toContent(text) });

  const made: Editor = {
    text: () => view.state.doc.toString(),
    replace(text) {
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: text }, selection: { anchor: 0 }, effects: toContent(text) });
    },
    follow(text) {
      const changes = difference(made.text(), text);
      if (changes) view.dispatch({ changes, annotations: Transaction.addToHistory.of(false) });
    },
    conclude(before) {
      const after = made.text();
      const changes = difference(before, after);
      if (!changes) return;
      made.follow(before);
      view.dispatch({ changes, userEvent: 'drag', annotations: isolateHistory.of('full') });
    },
    apply(edits) {
      view.dispatch({ changes: edits, annotations: isolateHistory.of('full') });
    },
    show(findings) {
      const length = view.state.doc.length;
      const diagnostics = findings.map((finding): Mark => {
        const from = Math.min(finding.from, length);
        return {
          from,
          to: Math.min(Math.max(finding.to, from), length),
          severity: severities[finding.severity],
          message: finding.help ? `${finding.message}\nhelp: ${finding.help}` : finding.message,
          source: finding.code,
        };
      });
      view.dispatch(setDiagnostics(view.state, diagnostics));
    },
    select(from, to) {
      const length = view.state.doc.length;
      const [anchor, head] = [Math.min(from, length), Math.min(to, length)];
      view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: 'center' }) });
      view.focus();
    },
    cursor: () => view.state.selection.main.head,
    undo: () => void undo(view),
    redo: () => void redo(view),
    can: () => ({ undo: undoDepth(view.state) > 0, redo: redoDepth(view.state) > 0 }),
    focus: () => view.focus(),
  };
  return made;
}

/** Scrolls past the comments at the head of a text, which are about the command line. */
const toContent = (text: string) => EditorView.scrollIntoView(/^(?:#[^\n]*\n)*/.exec(text)![0].length, { y: 'start', yMargin: 0 });

/** The part in which two texts differ, from the first difference to the last. */
function difference(before: string, after: string): { from: number; to: number; insert: string } | undefined {
  if (before === after) return undefined;
  const shorter = Math.min(before.length, after.length);
  let start = 0;
  while (start < shorter && before[start] === after[start]) start++;
  let end = 0;
  while (end < shorter - start && before[before.length - 1 - end] === after[after.length - 1 - end]) end++;
  return { from: start, to: before.length - end, insert: after.slice(start, after.length - end) };
}
