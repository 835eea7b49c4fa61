// A model: its aperture patterns, and the output of `e2lf model info`, whose JSON is folded.
import type { ModelItem } from '../document';
import { element } from '../dom';
import { patternFigure } from '../patterns';
import type { Context, Screen } from '../screen';

/** Returns a line of the output. */
function lineOf(line: string): HTMLElement {
  const [, name, json] = /^\s*(\S.*?)\s+(\{.*\})$/.exec(line) ?? [];
  if (!json) return element('pre', {}, line || ' ');
  return element('details', {}, element('summary', {}, name!), element('pre', {}, JSON.stringify(JSON.parse(json), null, 2)));
}

export class ModelScreen implements Screen {
  readonly keys: [string, string][] = [];
  private readonly patterns: HTMLElement;

  constructor(context: Context, item: ModelItem) {
    const figures = item.codes?.patterns.map((_, number) => patternFigure(item.codes!, number, 180)) ?? [];
    const none = figures.length === 0 ? [element('p', {}, 'This model contains no aperture patterns, because they belong to a camera.')] : [];
    this.patterns = element('div', { class: 'patterns' }, ...figures, ...none);
    // The patterns are drawn above.
    const text = item.codes ? item.text.replace(/\ncodes\s[^]*$/, '') : item.text;
    context.stage.append(element('div', { class: 'model' }, this.patterns, ...text.trimEnd().split('\n').map(lineOf)));
  }

  follow(): void {}
  layout(): void {}
  press(): boolean {
    return false;
  }
  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [...this.patterns.querySelectorAll('canvas')].map((canvas, i) => ({ name: `pattern-${i + 1}`, canvas }));
  }
  close(): void {}
}
