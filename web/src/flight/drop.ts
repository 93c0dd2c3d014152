/** The zone where logs are dropped or chosen. */

import { h } from '../dom';

const FORMATS = 'ArduPilot .bin and .log, PX4 .ulg, MAVLink .tlog, flight CSV; plain or gzipped';

interface Actions {
  take(files: File[]): void;
  takeExample(): void;
}

/** Creates the zone; files may be dropped anywhere in the room, which is `root`. */
export function dropZone(root: HTMLElement, actions: Actions): HTMLElement {
  const input = h('input', { type: 'file', multiple: true, 'aria-label': 'Flight logs', class: 'visually-hidden' });
  input.addEventListener('change', () => {
    actions.take([...(input.files ?? [])]);
    input.value = '';
  });
  const example = h('button', { type: 'button' }, 'Try an example');
  example.addEventListener('click', actions.takeExample);
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
    actions.take([...(event.dataTransfer?.files ?? [])]);
  });
  const words = [h('span', { class: 'first' }, 'Choose logs'), h('span', { class: 'more' }, '+ Add', h('span', { class: 'wide' }, ' logs'))];
  return h(
    'div',
    { class: 'drop' },
    h('p', { class: 'invitation' }, 'Drop flight logs here'),
    h('p', { class: 'buttons' }, h('label', { class: 'button main' }, ...words, input), example),
    h('p', { class: 'soft' }, `${FORMATS}.`),
    h('p', { class: 'soft' }, 'They are read in this browser. Nothing is sent anywhere.'),
  );
}
