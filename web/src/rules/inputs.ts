/** The inputs as sliders, which set the explained point. The map uses them for inputs that are not its axes. */

import type { Variable } from 'flagred';
import { h, fill } from '../dom';
import { clamp, step } from './numbers';

export interface Inputs {
  element: HTMLElement;
  /** Shows these inputs at a point; `isWhole` is whether sliders cover whole ranges. */
  show(inputs: Variable[], axes: number[], point: number[], isWhole: boolean): void;
}

interface Row {
  row: HTMLElement;
  slider: HTMLInputElement;
  number: HTMLInputElement;
  role: HTMLElement;
}

export function inputs(moved: (input: number, value: number) => void): Inputs {
  const element = h('div', { class: 'inputs', role: 'group', 'aria-label': 'Inputs' });
  let rows: Row[] = [];
  let names = '';

  function row({ name, unit, description }: Variable, i: number): Row {
    const slider = h('input', { type: 'range', 'aria-label': unit ? `${name} in ${unit}` : name });
    const number = h('input', { type: 'number', 'aria-label': `${name}, as a number` });
    slider.addEventListener('input', () => moved(i, slider.valueAsNumber));
    number.addEventListener('change', () => {
      const value = clamp(number.valueAsNumber, Number(number.min), Number(number.max));
      if (Number.isFinite(value)) moved(i, value);
    });
    // A box that is empty or contains no number returns to the current value when it loses the focus.
    number.addEventListener('blur', () => (number.value = written(slider.dataset['value'])));
    const role = h('span', { class: 'role soft' });
    const label = h('span', { class: 'name', title: description }, name, unit && h('span', { class: 'soft' }, ` ${unit}`));
    return { row: h('div', { class: 'input' }, label, slider, number, role), slider, number, role };
  }

  return {
    element,
    show(inputs, axes, point, isWhole) {
      const now = JSON.stringify(inputs.map(({ name, unit }) => [name, unit]));
      if (now !== names) {
        names = now;
        rows = inputs.map(row);
        fill(element, ...rows.map((one) => one.row));
      }
      inputs.forEach((input, i) => {
        const { slider, number, role } = rows[i]!;
        const value = point[i]!;
        // A value outside the shown part needs the whole range; otherwise its slider would be at the end of the part.
        const isPart = !isWhole && value >= input.shown[0] && value <= input.shown[1];
        const [low, high] = isPart ? input.shown : [input.low, input.high];
        [slider.min, slider.max] = [String(low), String(high)];
        slider.dataset['value'] = String(value);
        slider.step = String(step(low, high));
        slider.value = String(value);
        [number.min, number.max, number.step] = [String(input.low), String(input.high), 'any'];
        if (document.activeElement !== number) number.value = written(value);
        role.textContent = ['across', 'up'][axes.indexOf(i)] ?? 'held';
      });
    },
  };
}

const written = (value: number | string | undefined): string => String(Number(Number(value).toPrecision(6)));
