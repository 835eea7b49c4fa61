// A model: its aperture patterns, what it is in sentences, and the rows of `e2lf model info`.
import type { ModelItem } from '../document';
import { element } from '../dom';
import { sentencesOf } from '../model_sentences';
import { patternFigure } from '../patterns';
import type { Context, Screen } from '../screen';

function rowOf([name, value]: [string, string]): HTMLElement {
  return element('tr', {}, element('th', {}, name), element('td', {}, value));
}

export class ModelScreen implements Screen {
  readonly keys: [string, string][] = [];
  private readonly patterns: HTMLElement;

  constructor(context: Context, item: ModelItem) {
    const figures = item.codes?.patterns.map((_, number) => patternFigure(item.codes!, number, 180)) ?? [];
    const none = figures.length === 0 ? [element('p', {}, 'This model contains no aperture patterns, because they belong to a camera.')] : [];
    this.patterns = element('div', { class: 'patterns' }, ...figures, ...none);
    context.stage.append(element('div', { class: 'model' }, this.patterns,
      element('table', { class: 'sentences' }, ...sentencesOf(item.facts, item.is_of_depth).map(rowOf)),
      element('details', {}, element('summary', {}, 'All facts, as e2lf model info prints them'), element('table', {}, ...item.facts.map(rowOf)))));
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
