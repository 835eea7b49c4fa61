// Images of signed event counts: their pictures, and the histogram around a point.
import { diverging, drawColours } from './colour_map';
import { canvas, context2d, element } from './dom';

export interface CountImage {
  width: number;
  height: number;
  counts: Int16Array; // [y, x]
}

export const mostLimit = 16;

/** Returns the default number of events with full colour, which one pixel in 50 exceeds. */
export function suitableLimit(counts: Int16Array): number {
  const pixels = new Array<number>(mostLimit + 1).fill(0);
  for (const count of counts) pixels[Math.min(Math.abs(count), mostLimit)]! += 1;
  let above = 0;
  for (let limit = mostLimit; limit > 1; --limit) {
    above += pixels[limit]!;
    if (above * 50 > counts.length) return limit;
  }
  return 1;
}

export const limitText = (limit: number): string => (limit >= 1 ? `${limit} events` : 'automatic');

/** Draws an image in which `chosen` events have the full colour, 0 = automatic. Returns the number used. */
export function drawCounts(target: HTMLCanvasElement, image: CountImage, chosen: number, isDark: boolean): number {
  const limit = chosen >= 1 ? Math.min(chosen, 1000) : suitableLimit(image.counts);
  const most = Math.max(1, Math.ceil(limit));
  const colours = new Uint32Array(2 * most + 1);
  for (let i = 0; i <= 2 * most; ++i) {
    const [red, green, blue] = diverging((i - most) / limit, isDark).map(Math.round) as [number, number, number];
    colours[i] = (255 << 24) | (blue << 16) | (green << 8) | red;
  }
  target.width = image.width;
  target.height = image.height;
  const picture = new ImageData(image.width, image.height);
  const pixels = new Uint32Array(picture.data.buffer);
  image.counts.forEach((count, i) => {
    pixels[i] = colours[Math.min(Math.max(count, -most), most) + most]!;
  });
  context2d(target).putImageData(picture, 0, 0);
  return limit;
}

/** The legend of the colours, from OFF to ON. */
export class CountLegend {
  private readonly bar = canvas('Colours of the signed event counts, from OFF to ON', 'bar');
  private readonly off = element('span');
  private readonly on = element('span');
  readonly root = element('div', {}, this.bar, element('p', { class: 'figures ends' }, this.off, this.on));

  /** Shows the legend for `limit` events with the full colour. */
  show(limit: number, isDark: boolean): void {
    drawColours(this.bar, (share) => diverging(2 * share - 1, isDark));
    this.off.textContent = `${limit} OFF`;
    this.on.textContent = `${limit} ON`;
  }
}

const reach = 16; // of the window, px to each side
const mostShown = 8;

export class Histogram {
  readonly root: HTMLElement;
  private readonly canvas = element('canvas', { role: 'img', width: '480', height: '200', class: 'histogram' });
  private readonly text = element('p', { class: 'figures' });

  constructor() {
    this.root = element('div', {}, this.canvas, this.text, element('p', { class: 'figures' }, 'Horizontal axis: signed events of a pixel. Vertical axis: number of pixels, logarithmic.'));
  }

  /** Shows the histogram around a pixel, or that of the whole image if `at` is null. */
  show(image: CountImage, at: { x: number; y: number } | null): void {
    const x0 = at ? Math.max(at.x - reach, 0) : 0;
    const y0 = at ? Math.max(at.y - reach, 0) : 0;
    const x1 = at ? Math.min(at.x + reach + 1, image.width) : image.width;
    const y1 = at ? Math.min(at.y + reach + 1, image.height) : image.height;
    const bins = new Array<number>(2 * mostShown + 1).fill(0);
    let sum = 0;
    for (let y = y0; y < y1; ++y) {
      for (let x = x0; x < x1; ++x) {
        const count = image.counts[y * image.width + x]!;
        sum += Math.abs(count);
        bins[Math.min(Math.max(count, -mostShown), mostShown) + mostShown]! += 1;
      }
    }
    const pixels = (x1 - x0) * (y1 - y0);
    this.draw(bins);
    const where = at ? `${x1 - x0}x${y1 - y0} px around x ${at.x}, y ${at.y}: ` : 'whole image: ';
    const here = at ? `; here ${image.counts[at.y * image.width + at.x]}` : '';
    this.text.textContent = `${where}${(sum / pixels).toFixed(2)} events per pixel${here}`;
    this.canvas.setAttribute('aria-label', `Histogram of the signed event counts, ${this.text.textContent}`);
  }

  private draw(bins: number[]): void {
    const context = context2d(this.canvas);
    const { width, height } = this.canvas;
    const styles = getComputedStyle(this.canvas);
    const most = Math.log1p(Math.max(...bins));
    const step = width / bins.length;
    context.clearRect(0, 0, width, height);
    context.font = '18px sans-serif';
    context.textAlign = 'center';
    bins.forEach((count, i) => {
      const value = i - mostShown;
      const bar = most > 0 ? (Math.log1p(count) / most) * (height - 30) : 0;
      context.fillStyle = styles.getPropertyValue(value > 0 ? '--on' : value < 0 ? '--off' : '--dim');
      context.fillRect(i * step + 1, height - 24 - bar, step - 2, bar);
      context.fillStyle = styles.getPropertyValue('--dim');
      const more = Math.abs(value) < mostShown ? '' : value > 0 ? '\u2265' : '\u2264';
      if (value % 2 === 0) context.fillText(more + (value > 0 && more === '' ? `+${value}` : String(value)), (i + 0.5) * step, height - 4);
    });
  }
}
