// A zoomable image of signed event counts, with the legend of its colours and the histogram under the cursor.
import { CountLegend, drawCounts, Histogram, limitText, mostLimit, type CountImage } from './counts';
import { canvas, clamp, placeOn } from './dom';
import { fit, type Context } from './screen';
import type { Key } from './state';
import { isDark } from './theme';
import { keysOfPart, ZoomBox, zoomKeys } from './zoom';

export const countKeys: [keys: string, does: string][] = [['[ and ]', 'stronger and weaker colours'], ...zoomKeys];

export class CountPicture {
  readonly canvas: HTMLCanvasElement;
  readonly controls: HTMLElement[]; // of the colours
  private readonly zoom: ZoomBox;
  private readonly histogram = new Histogram();
  private readonly legend = new CountLegend();
  private image: CountImage | null = null;
  private cursor: { x: number; y: number } | null = null;

  constructor(private readonly context: Context, label: string, private readonly size: { width: number; height: number }) {
    this.canvas = canvas(label, 'counts');
    this.zoom = new ZoomBox(context.state, size.width, this.canvas);
    this.controls = [context.panel.slider('limit', 'Full colour at', { low: 0, high: mostLimit, step: 1, text: limitText }), this.legend.root];
    this.canvas.addEventListener('pointerdown', (event) => this.point(event));
    this.canvas.addEventListener('pointermove', (event) => this.point(event));
    // A lifted finger also leaves the element; the selected point is kept then.
    this.canvas.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && this.point(null));
  }

  get root(): HTMLElement {
    return this.zoom.root;
  }

  addHistogram(): void {
    this.context.panel.group('Histogram under the cursor', this.histogram.root);
  }

  layout(boxWidth: number, boxHeight: number): void {
    this.zoom.layout(...fit(this.size.width, this.size.height, boxWidth, boxHeight));
  }

  show(image: CountImage): void {
    this.image = image;
    this.legend.show(drawCounts(this.canvas, image, this.context.state.get('limit'), isDark()), isDark());
    this.zoom.show();
    this.histogram.show(image, this.cursor);
  }

  /** Returns true if a change of `key` concerns only the part that is shown. */
  follow(key: Key): boolean {
    if (!keysOfPart.includes(key)) return false;
    this.zoom.show();
    return true;
  }

  press(key: string): boolean {
    const { state } = this.context;
    switch (key) {
      case '[': state.set('limit', Math.max(state.get('limit') - 1, 0)); return true;
      case ']': state.set('limit', Math.min(state.get('limit') + 1, mostLimit)); return true;
      default: return this.zoom.press(key);
    }
  }

  private point(event: PointerEvent | null): void {
    if (!this.image || this.zoom.isPinching()) return;
    const { width, height } = this.size;
    const place = event && placeOn(this.canvas, event);
    this.cursor = place && { x: clamp(Math.floor(place.x * width), 0, width - 1), y: clamp(Math.floor(place.y * height), 0, height - 1) };
    this.histogram.show(this.image, this.cursor);
  }
}
