// The event rate of a recording over time: ON above the line, OFF below it, triggers as ticks, cycles shaded, and the
// displayed frame as a bar. Dragging selects the frame, the wheel and two fingers zoom, a horizontal wheel scrolls.
import type { RecordingItem } from './document';
import { canvas, clamp, context2d, placeOn } from './dom';
import { followPinch } from './pinch';
import type { State } from './state';

const leastShare = 1e-3; // the smallest share of the recording that the axis shows
const footPx = 22;
const tickPx = 64; // least distance of two numbers

/** Formats events per second with three digits: 3.85e8 is "385 M". */
export function rateText(perSecond: number): string {
  const power = Math.min(Math.max(Math.floor(Math.log10(Math.max(perSecond, 1)) / 3), 0), 3);
  const value = perSecond / 1000 ** power;
  return `${value.toFixed(value < 10 ? 2 : value < 100 ? 1 : 0)} ${['', 'k ', 'M ', 'G '][power]}events/s`;
}

export class TimeAxis {
  readonly canvas: HTMLCanvasElement;
  private readonly beginUs: number;
  private readonly lengthUs: number;

  constructor(
    private readonly item: RecordingItem,
    private readonly state: State,
    onTime: (timeUs: number) => void,
  ) {
    const { rate, frames } = item;
    this.beginUs = frames[0]?.begin_us ?? rate.begin_us;
    this.lengthUs = Math.max((frames.at(-1)?.end_us ?? rate.begin_us + rate.bin_us * rate.on.length) - this.beginUs, 1);
    this.canvas = canvas('Event rate over time with triggers and cycles. Drag to choose a time, turn the wheel to zoom.', 'axis');
    const isPinching = followPinch(this.canvas, (factor, middle, moved) => {
      this.zoom(1 / factor, middle.x);
      this.move(-moved.x);
    });
    this.canvas.addEventListener('pointerdown', (event) => {
      if (isPinching()) return;
      this.canvas.setPointerCapture(event.pointerId);
      onTime(this.timeAt(placeOn(this.canvas, event).x));
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (!isPinching() && this.canvas.hasPointerCapture(event.pointerId)) onTime(this.timeAt(placeOn(this.canvas, event).x));
    });
    this.canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const isSideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
      if (isSideways) this.move(0.1 * Math.sign(event.deltaX || event.deltaY));
      else this.zoom(event.deltaY > 0 ? 1.25 : 0.8, placeOn(this.canvas, event).x);
    }, { passive: false });
  }

  zoom(factor: number, at: number): void {
    const { from, to } = this.range();
    const length = clamp((to - from) * factor, leastShare, 1);
    const begin = clamp(from + at * (to - from - length), 0, 1 - length);
    this.state.set('from', begin);
    this.state.set('to', begin + length);
  }

  /** Zooms around a time of the recording. */
  zoomAround(factor: number, timeUs: number): void {
    const { from, to } = this.range();
    this.zoom(factor, clamp((this.shareOf(timeUs) - from) / (to - from), 0, 1));
  }

  /** Scrolls by a share of the displayed interval. */
  private move(by: number): void {
    const { from, to } = this.range();
    this.begin(from + by * (to - from));
  }

  /** Scrolls a time that is outside of the axis to its middle. */
  reveal(timeUs: number): void {
    const { from, to } = this.range();
    const share = this.shareOf(timeUs);
    if (share < from || share >= to) this.begin(share - (to - from) / 2);
  }

  private begin(at: number): void {
    const { from, to } = this.range();
    const begin = clamp(at, 0, 1 - (to - from));
    this.state.set('from', begin);
    this.state.set('to', begin + (to - from));
  }

  private shareOf(timeUs: number): number {
    return (timeUs - this.beginUs) / this.lengthUs;
  }

  private range(): { from: number; to: number } {
    const from = clamp(this.state.get('from'), 0, 1 - leastShare);
    return { from, to: clamp(this.state.get('to'), from + leastShare, 1) };
  }

  private timeAt(share: number): number {
    const { from, to } = this.range();
    return this.beginUs + (from + share * (to - from)) * this.lengthUs;
  }

  draw(frame: number): void {
    const ratio = Math.min(devicePixelRatio, 2);
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
    const context = context2d(this.canvas);
    context.scale(ratio, ratio);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight - footPx];
    const { from, to } = this.range();
    const x = (timeUs: number) => (((timeUs - this.beginUs) / this.lengthUs - from) / (to - from)) * width;
    const style = (name: string) => getComputedStyle(this.canvas).getPropertyValue(name);
    this.drawCycles(context, x, height, style);
    this.drawRate(context, x, width, height, style);
    this.drawNumbers(context, x, style);
    context.fillStyle = style('--ink');
    for (const [timeUs] of this.item.triggers) context.fillRect(x(timeUs), height - 6, 1, 6);
    const shown = this.item.frames[frame];
    if (shown) {
      context.fillStyle = style('--accent');
      context.globalAlpha = 0.45;
      context.fillRect(x(shown.begin_us), 0, Math.max(x(shown.end_us) - x(shown.begin_us), 2), height);
      context.globalAlpha = 1;
    }
    this.drawTicks(context, x, from, to, width, height, style);
  }

  private drawCycles(context: CanvasRenderingContext2D, x: (timeUs: number) => number, height: number, style: (name: string) => string): void {
    context.fillStyle = style('--raised');
    for (const cycle of this.item.cycles) {
      for (const [begin, end] of cycle.slices) context.fillRect(x(begin), 0, Math.max(x(end) - x(begin) - 1, 1), height);
    }
  }

  /** Draws the numbers of the cycles above the bars if there is room. */
  private drawNumbers(context: CanvasRenderingContext2D, x: (timeUs: number) => number, style: (name: string) => string): void {
    for (const cycle of this.item.cycles) {
      const first = cycle.slices[0];
      const last = cycle.slices.at(-1);
      if (!first || !last || x(last[1]) - x(first[0]) <= 24) continue;
      this.drawText(context, String(cycle.number), (x(first[0]) + x(last[1])) / 2, 0, style);
    }
  }

  /** Draws a label in a line from the top on its own background. */
  private drawText(context: CanvasRenderingContext2D, text: string, middle: number, line: number, style: (name: string) => string): void {
    context.font = '11px sans-serif';
    context.textAlign = 'center';
    const width = context.measureText(text).width + 8;
    context.fillStyle = style('--surface');
    context.fillRect(middle - width / 2, 17 * line, width, 17);
    context.fillStyle = style('--ink');
    context.fillText(text, middle, 17 * line + 13);
  }

  private drawRate(context: CanvasRenderingContext2D, x: (timeUs: number) => number, width: number, height: number, style: (name: string) => string): void {
    const { begin_us, bin_us, on, off } = this.item.rate;
    const most = Math.max(1, ...on, ...off);
    const middle = height / 2;
    const barWidth = Math.max(x(begin_us + bin_us) - x(begin_us), 1);
    for (let i = 0; i < on.length; ++i) {
      const left = x(begin_us + i * bin_us);
      if (left + barWidth < 0 || left > width) continue;
      context.fillStyle = style('--on');
      context.fillRect(left, middle - (on[i]! / most) * middle, barWidth, (on[i]! / most) * middle);
      context.fillStyle = style('--off');
      context.fillRect(left, middle, barWidth, (off[i]! / most) * middle);
    }
    context.fillStyle = style('--dim');
    context.fillRect(0, middle, width, 1);
    const text = `${rateText((most / bin_us) * 1e6)} at the edges`;
    context.font = '11px sans-serif';
    this.drawText(context, text, width - context.measureText(text).width / 2 - 6, 1, style);
  }

  private drawTicks(context: CanvasRenderingContext2D, x: (timeUs: number) => number, from: number, to: number, width: number, height: number, style: (name: string) => string): void {
    const spanUs = (to - from) * this.lengthUs;
    const rough = (spanUs * tickPx) / width;
    const power = 10 ** Math.floor(Math.log10(rough));
    const stepUs = [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough)!;
    context.fillStyle = style('--dim');
    context.textAlign = 'center';
    const firstTick = Math.ceil((this.beginUs + from * this.lengthUs) / stepUs);
    for (let tick = firstTick; tick * stepUs <= this.beginUs + to * this.lengthUs; ++tick) {
      context.fillRect(x(tick * stepUs), height, 1, 4);
      const text = `${+((tick * stepUs) / 1000).toFixed(3)} ms`;
      context.fillText(text, clamp(x(tick * stepUs), 24, width - 24), height + 16);
    }
  }
}
