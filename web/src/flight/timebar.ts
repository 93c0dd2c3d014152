/** The bar above the charts: the time of the cursor, and the stretch of the flight that is shown. */

import type { Stretch } from 'flagred';
import { h } from '../dom';
import { minutes } from './time';

export interface TimeBar {
  element: HTMLElement;
  /** Sets the stretch that is shown, the whole stretch, and the time of the cursor. */
  show(shown: Stretch, whole: Stretch, t_s: number): void;
  /** Sets the label of the cursor's time. */
  say(words: string): void;
}

interface Actions {
  /** Moves the cursor to a time, in seconds. */
  seek(t_s: number): void;
  /** Moves the cursor, in steps. */
  move(steps: number): void;
  /** Zooms to the part between two positions of the shown stretch, as on the charts. */
  zoom(from: number, to: number): void;
  reset(): void;
}

export function timeBar(actions: Actions): TimeBar {
  /** The position of the cursor in the shown stretch, from 0 to 1. */
  let share = 0.5;
  const slider = h('input', { type: 'range', step: 'any', 'aria-label': 'Time' });
  slider.addEventListener('input', () => actions.seek(slider.valueAsNumber));
  slider.addEventListener('keydown', (event) => {
    const steps = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
    if (!steps) return;
    event.preventDefault();
    actions.move(event.shiftKey ? 5 * steps : steps);
  });
  const span = h('span', { class: 'span soft' });
  const overview = h('span', { class: 'shown', 'aria-hidden': 'true' });
  const button = (words: string, label: string, act: () => void) => {
    const made = h('button', { type: 'button', 'aria-label': label, title: label }, words);
    made.addEventListener('click', act);
    return made;
  };
  /** Zooms around the cursor, which stays at its position on the screen. */
  const about = (scale: number) => actions.zoom(share - share * scale, share + (1 - share) * scale);
  const closer = button('+', 'Zoom in', () => about(0.5));
  const farther = button('−', 'Zoom out', () => about(2));
  const earlier = button('‹', 'Earlier', () => actions.zoom(-0.5, 0.5));
  const later = button('›', 'Later', () => actions.zoom(0.5, 1.5));
  const all = button('All', 'All of the flight', actions.reset);
  const element = h(
    'div',
    { class: 'timebar', role: 'group', 'aria-label': 'Time', slot: 'bar', title: 'Drag over a chart to zoom.' },
    h('div', { class: 'slider' }, slider, h('span', { class: 'overview' }, overview)),
    h('div', { class: 'zoom' }, span, earlier, farther, all, closer, later),
  );
  return {
    element,
    show(shown, whole, t_s) {
      share = (t_s - shown.start_s) / Math.max(shown.end_s - shown.start_s, 1e-6);
      slider.min = String(whole.start_s);
      slider.max = String(whole.end_s);
      slider.value = String(t_s);
      const length_s = Math.max(whole.end_s - whole.start_s, 1e-3);
      const isAll = shown.end_s - shown.start_s > length_s * 0.999;
      overview.style.left = `${(100 * (shown.start_s - whole.start_s)) / length_s}%`;
      overview.style.width = `${(100 * (shown.end_s - shown.start_s)) / length_s}%`;
      const ends = [shown.start_s, shown.end_s].map((t_s) => minutes(t_s - whole.start_s));
      span.textContent = `${ends.join(' to ')} min`;
      farther.disabled = all.disabled = isAll;
      overview.hidden = isAll;
      earlier.disabled = shown.start_s <= whole.start_s;
      later.disabled = shown.end_s >= whole.end_s;
    },
    say(words) {
      slider.setAttribute('aria-valuetext', words);
    },
  };
}
