// Draws aperture patterns.
import type { Codes } from './document';
import { context2d, element } from './dom';

export function patternFigure(codes: Codes, number: number, sizePx: number): HTMLElement {
  const values = codes.patterns[number]!;
  const [rows, columns] = codes.views;
  const share = values.reduce((sum, value) => sum + value, 0) / values.length;
  const text = `pattern ${number + 1}: ${(100 * share).toFixed(1)} % open`;
  const target = element('canvas', { role: 'img', 'aria-label': text, class: 'pattern', width: String(8 * columns), height: String(8 * rows) });
  target.style.width = `${sizePx}px`;
  const context = context2d(target);
  values.forEach((value, i) => {
    context.fillStyle = `rgb(${Math.round(255 * value)} ${Math.round(255 * value)} ${Math.round(255 * value)})`;
    context.fillRect((i % columns) * 8, Math.floor(i / columns) * 8, 8, 8);
  });
  return element('figure', { class: 'pattern' }, target, element('figcaption', {}, text));
}
