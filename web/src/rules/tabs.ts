/** Tabs: several views of the same content, of which one is shown. */

import { h } from '../dom';

export interface Tabs {
  /** The tabs. */
  list: HTMLElement;
  /** The element that contains the shown view. */
  panel: HTMLElement;
}

/** Creates tabs. `views` are names and elements; the first is shown. `chosen` is called when the user shows another. */
export function tabs(label: string, views: [name: string, element: HTMLElement][], chosen: () => void): Tabs {
  const id = `${label.replace(/\W+/g, '-')}-panel`;
  const buttons = views.map(([name]) =>
    h('button', { type: 'button', role: 'tab', id: `${id}-${name}`, 'aria-controls': id, onclick: () => choose(name), onkeydown: move }, name),
  );
  const panel = h('div', { role: 'tabpanel', id }, ...views.map(([, element]) => element));

  function choose(name: string): void {
    views.forEach(([other, element], i) => {
      const is = other === name;
      buttons[i]!.setAttribute('aria-selected', String(is));
      buttons[i]!.tabIndex = is ? 0 : -1;
      element.hidden = !is;
      if (is) panel.setAttribute('aria-labelledby', buttons[i]!.id);
    });
    chosen();
  }

  function move(event: KeyboardEvent): void {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    const at = buttons.indexOf(event.currentTarget as HTMLButtonElement);
    const next = buttons[(at + by + buttons.length) % buttons.length]!;
    next.click();
    next.focus();
  }

  const list = h('div', { class: 'tabs', role: 'tablist', 'aria-label': label }, ...buttons);
  choose(views[0]![0]);
  return { list, panel };
}
