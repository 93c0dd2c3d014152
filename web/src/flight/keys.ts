/** The keys that move the cursor and zoom, wherever the focus is outside of fields. */

import type { Stretch } from 'flagred';
import { zoomed } from './time';

interface Actions {
  isActive(): boolean;
  /** The stretch that is shown, the whole one, and the time of the cursor. */
  state(): { shown: Stretch; whole: Stretch; t_s: number };
  move(steps: number): void;
  show(stretch: Stretch | undefined): void;
}

export function keys({ isActive, state, move, show }: Actions): void {
  document.addEventListener('keydown', (event) => {
    const isTyping = event.composedPath().some((target) => target instanceof Element && target.matches('input, select, textarea'));
    if (isTyping || !isActive() || event.ctrlKey || event.metaKey || event.altKey) return;
    const { shown, whole, t_s } = state();
    const share = (t_s - shown.start_s) / Math.max(shown.end_s - shown.start_s, 1e-6);
    const act: Record<string, () => void> = {
      ArrowLeft: () => move(event.shiftKey ? -5 : -1),
      ArrowRight: () => move(event.shiftKey ? 5 : 1),
      '+': () => show(zoomed(shown, share / 2, (1 + share) / 2, whole)),
      '-': () => show(zoomed(shown, -share, 2 - share, whole)),
      '0': () => show(undefined),
    };
    const wanted = act[event.key];
    if (!wanted) return;
    event.preventDefault();
    wanted();
  });
}
