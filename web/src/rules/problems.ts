/** The findings as a list. Their number is announced to screen readers; a click selects the location. */

import type { Diagnostic } from 'flagred';
import { add, fill, h } from '../dom';

export interface Problems {
  element: HTMLElement;
  show(findings: Diagnostic[]): void;
}

const words = { error: ['error', 'errors'], warning: ['warning', 'warnings'], note: ['note', 'notes'] } as const;

/** `2 errors, 1 note`. */
export function counted(findings: Diagnostic[]): string {
  const counts = (['error', 'warning', 'note'] as const).map((severity) => {
    const count = findings.filter((finding) => finding.severity === severity).length;
    return count ? `${count} ${words[severity][count === 1 ? 0 : 1]}` : '';
  });
  return counts.filter(Boolean).join(', ') || 'no findings';
}

export function problems(lead: (from: number, to: number) => void): Problems {
  const count = h('span', { role: 'status', class: 'count' });
  const list = h('ul', {});
  const element = h('section', { class: 'problems', 'aria-label': 'Problems' }, h('h2', {}, 'Problems ', count), list);
  return {
    element,
    show(findings) {
      const said = counted(findings);
      if (count.textContent !== said) count.textContent = said;
      fill(list, ...findings.map((finding) => item(finding, lead)));
    },
  };
}

function item(finding: Diagnostic, lead: (from: number, to: number) => void): HTMLElement {
  const { severity, line, message, help, related } = finding;
  const button = h(
    'button',
    { type: 'button', class: severity, onclick: () => lead(finding.from, finding.to) },
    h('b', {}, severity),
    h('span', { class: 'soft' }, ` line ${line} `),
    message,
  );
  if (help) add(button, h('span', { class: 'help soft' }, help));
  const also = related.map((other) =>
    h('button', { type: 'button', class: 'also', onclick: () => lead(other.from, other.to) }, other.message),
  );
  return h('li', {}, button, ...also);
}
