/** Renders the Markdown of hovers as nodes: paragraphs, `**bold**` and `` `code` ``. */

import { add, h } from '../dom';

export function markdown(text: string): DocumentFragment {
  const made = document.createDocumentFragment();
  for (const paragraph of text.split('\n\n')) made.append(h('p', {}, inline(paragraph)));
  return made;
}

function inline(text: string): DocumentFragment {
  const made = document.createDocumentFragment();
  for (const part of text.split(/(\*\*[^*]+\*\*|`[^`]+`)/)) {
    if (part.startsWith('**')) add(made, h('b', {}, part.slice(2, -2)));
    else if (part.startsWith('`')) add(made, h('code', {}, part.slice(1, -1)));
    else add(made, part);
  }
  return made;
}
