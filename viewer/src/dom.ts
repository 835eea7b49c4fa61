// Helpers that create elements and controls. Each control follows the state and has an accessible name.
import type { Key, State, Values } from './state';

type NumberKey = { [K in Key]: Values[K] extends number ? K : never }[Key];
type TextKey = { [K in Key]: Values[K] extends string ? K : never }[Key];

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Creates a canvas; `label` describes its content. */
export function canvas(label: string, className = ''): HTMLCanvasElement {
  return element('canvas', { role: 'img', 'aria-label': label, class: className });
}

export const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);

/** Returns the 2D context of a canvas. */
export function context2d(target: HTMLCanvasElement): CanvasRenderingContext2D {
  return target.getContext('2d')!;
}

/** Returns the position of a pointer on an element, in shares of its size. */
export function placeOn(target: HTMLElement, event: MouseEvent): { x: number; y: number } {
  const box = target.getBoundingClientRect();
  return { x: (event.clientX - box.left) / box.width, y: (event.clientY - box.top) / box.height };
}

/** A list of names and values, which show() replaces. */
export class FigureList {
  readonly root = element('dl', { class: 'list' });

  show(rows: [name: string, value: string][]): void {
    this.root.replaceChildren(...rows.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
  }
}

export interface SliderOptions {
  low: number;
  high: number;
  step: number;
  text?: (value: number) => string;
}

/** The controls of a screen, in groups. They are updated when the state changes. */
export class Panel {
  private followers: (() => void)[] = [];

  constructor(
    readonly root: HTMLElement,
    private readonly state: State,
  ) {
    root.replaceChildren();
  }

  follow(): void {
    for (const follower of this.followers) follower();
  }

  group(title: string, ...children: Node[]): HTMLFieldSetElement {
    const made = element('fieldset', {}, element('legend', {}, title), ...children);
    this.root.append(made);
    return made;
  }

  slider(key: NumberKey, name: string, options: SliderOptions): HTMLElement {
    const input = element('input', {
      type: 'range',
      min: String(options.low),
      max: String(options.high),
      step: String(options.step),
      name: key,
      'aria-label': name,
    });
    const output = element('output');
    const text = options.text ?? ((value: number) => value.toFixed(2));
    input.addEventListener('input', () => this.state.set(key, Number(input.value)));
    this.followers.push(() => {
      const value = this.state.get(key);
      input.value = String(value);
      output.textContent = text(value);
      input.setAttribute('aria-valuetext', text(value));
    });
    return element('label', { class: 'slider' }, element('span', {}, name), input, output);
  }

  choice(key: TextKey, name: string, options: Record<string, string>): HTMLElement {
    const select = element('select', { name: key });
    for (const [value, text] of Object.entries(options)) select.append(element('option', { value }, text));
    select.addEventListener('change', () => this.state.set(key, select.value));
    this.followers.push(() => {
      select.value = this.state.get(key);
    });
    return element('label', { class: 'choice' }, element('span', {}, name), select);
  }

  button(name: string, action: () => void): HTMLElement {
    const made = element('button', { type: 'button' }, name);
    made.addEventListener('click', action);
    return made;
  }
}
