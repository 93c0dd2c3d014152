/** Pointer gestures on a chart: point at a time, select a stretch, zoom with two fingers or the wheel. */

export interface Gestures {
  /** Points at a position on the chart, from 0 at its left edge to 1. */
  point(share: number): void;
  /** Zooms to the part between two positions. If these are outside the chart, it zooms out. */
  zoom(from: number, to: number): void;
  /** A selection changed; `undefined` when it ended. */
  select(area: HTMLElement, ends: [number, number] | undefined): void;
}

/** The minimum movement of a selection, in pixels. */
const MIN_PX = 8;

/**
 * Handles the pointers on all charts in an element. `areaOf` returns the area of the chart in which an event
 * happened. If the charts are in a shadow root, the element is its host, because browsers do not always pass wheel events to listeners of a shadow
 * root.
 */
export function gestures(element: HTMLElement, areaOf: (event: Event) => HTMLElement | undefined, on: Gestures): void {
  /** The pointers that are pressed on one area. */
  let area: HTMLElement | undefined;
  const down = new Map<number, { from: number; now: number }>();

  const shareOf = (event: MouseEvent, of: HTMLElement) => {
    const box = of.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };

  const listen = <E extends Event>(name: string, take: (event: E) => void, options?: AddEventListenerOptions) =>
    element.addEventListener(name, take as EventListener, options);

  listen<PointerEvent>('pointerdown', (event) => {
    const touched = areaOf(event);
    if (!touched || event.button !== 0) return;
    if (area !== touched) down.clear();
    area = touched;
    const share = shareOf(event, touched);
    down.set(event.pointerId, { from: share, now: share });
    touched.setPointerCapture(event.pointerId);
    on.point(share);
  });

  listen<PointerEvent>('pointermove', (event) => {
    const held = down.get(event.pointerId);
    const over = held ? area : areaOf(event);
    if (!over) return;
    const share = shareOf(event, over);
    if (held) held.now = share;
    if (down.size < 2) on.point(share);
    if (held && event.pointerType === 'mouse') on.select(over, [held.from, held.now]);
  });

  const end = (event: PointerEvent, isGivenUp: boolean) => {
    const held = down.get(event.pointerId);
    if (!held || !area) return;
    const fingers = [...down.values()];
    down.delete(event.pointerId);
    on.select(area, undefined);
    if (isGivenUp) return;
    const width = area.getBoundingClientRect().width;
    const [one, other] = fingers;
    if (one && other) {
      down.clear();
      pinch(one, other);
    } else if (event.pointerType === 'mouse' && Math.abs(held.now - held.from) * width >= MIN_PX) {
      on.zoom(Math.min(held.from, held.now), Math.max(held.from, held.now));
    }
  };
  listen<PointerEvent>('pointerup', (event) => end(event, false));
  listen<PointerEvent>('pointercancel', (event) => end(event, true));

  /** The part between the fingers stays between them. */
  function pinch(one: { from: number; now: number }, other: { from: number; now: number }): void {
    const [apart, before] = [other.now - one.now, other.from - one.from];
    if (Math.abs(apart) < 0.02 || Math.abs(before) < 0.02) return;
    const scale = before / apart;
    const at = (share: number) => one.from + (share - one.now) * scale;
    if (scale > 0) on.zoom(at(0), at(1));
  }

  listen<WheelEvent>(
    'wheel',
    (event) => {
      const over = areaOf(event);
      if (!over) return;
      const isZoom = event.ctrlKey || event.metaKey;
      const along = event.shiftKey && !event.deltaX ? event.deltaY : event.deltaX;
      if (isZoom) {
        const share = shareOf(event, over);
        const scale = Math.exp(Math.min(1, Math.max(-1, event.deltaY / 200)));
        on.zoom(share - share * scale, share + (1 - share) * scale);
      } else if (Math.abs(along) > Math.abs(event.shiftKey ? 0 : event.deltaY)) {
        const move = along / over.getBoundingClientRect().width;
        on.zoom(move, 1 + move);
      } else return;
      event.preventDefault();
    },
    { passive: false },
  );
}
