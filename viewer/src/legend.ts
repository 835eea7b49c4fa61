// Colour bars with numbers, and what both screens with disparities have in common.
import { disparityColour, drawColours, type Colour } from './colour_map';
import { canvas, element, type Panel } from './dom';

/** A colour bar with numbers along it. */
export function colourBar(name: string, colourOf: (share: number) => Colour, ...numbers: HTMLElement[]): HTMLElement {
  const bar = canvas(name, 'bar');
  drawColours(bar, colourOf);
  return element('div', {}, bar, element('p', { class: 'figures ends' }, ...numbers));
}

/** The colours of disparities from near to far, with their numbers and unit, as picture_with_scale() of e2lf depth. */
export class DisparityLegend {
  private readonly numbers = [0, 0.25, 0.5, 0.75, 1].map(() => element('span'));
  readonly root = element('div', {}, colourBar('Colours of disparity from near to far', disparityColour, ...this.numbers),
    element('p', { class: 'figures ends' }, element('span', {}, 'near'), element('span', {}, 'px per view step'), element('span', {}, 'far')));

  show([near, far]: [number, number]): void {
    this.numbers.forEach((number, i) => (number.textContent = (near + (i / 4) * (far - near)).toFixed(2)));
  }
}

export const sureSlider = (panel: Panel): HTMLElement =>
  panel.slider('sure', 'Left out below a confidence of', { low: 0, high: 1, step: 0.01 });
