/** Creates elements and text. Content of logs and rule sets is only inserted as text. */

export type Child = Node | string | number | null | undefined | false;
type Value = string | number | boolean | null | undefined | ((event: never) => void);

/**
 * Creates an element. An attribute that is a function becomes a listener of the event in its name, such as `onclick`;
 * `true` becomes an attribute without a value.
 */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, Value> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name.slice(2), value as EventListener);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  add(element, ...children);
  return element;
}

/** Adds nodes; strings are added as text. */
export function add(parent: Node, ...children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    parent.appendChild(child instanceof Node ? child : document.createTextNode(String(child)));
  }
}

/** Replaces the content of an element by these nodes. */
export function fill(parent: Element, ...children: Child[]): void {
  parent.replaceChildren();
  add(parent, ...children);
}

/**
 * Parses markup written by flagred itself, in which all text is escaped. The policy allows no style attributes in
 * markup; they are set one by one instead.
 */
export function fragment(markup: string): DocumentFragment {
  const parsed = new DOMParser().parseFromString(
    `<!doctype html><body>${markup.replaceAll(' style="', ' data-style="')}`,
    'text/html',
  );
  const made = document.createDocumentFragment();
  made.append(...parsed.body.childNodes);
  for (const element of made.querySelectorAll<HTMLElement | SVGElement>('[data-style]')) {
    element.style.cssText = element.dataset['style'] ?? '';
    delete element.dataset['style'];
  }
  return made;
}

/** Creates an image from an SVG picture, which keeps its own styles. */
export function picture(svg: string, description: string): HTMLImageElement {
  const url = URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' }));
  const image = h('img', { alt: description, src: url });
  image.addEventListener('load', () => URL.revokeObjectURL(url), { once: true });
  return image;
}

/** Downloads a file. */
export function download(name: string, content: BlobPart, type: string): void {
  const url = URL.createObjectURL(new Blob([content], { type }));
  h('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
