// A box that shows a part of a picture, down to single pixels. The wheel and two fingers zoom at their position, two
// fingers and a drag with shift or the middle button move the part. All pictures of a page show the same part.
import { clamp, element, placeOn } from './dom';
import { followPinch } from './pinch';
import { setSize } from './screen';
import type { Key, State } from './state';

const mostPixelPx = 48; // the largest size of a pixel of the picture on the screen
const sharpPixelPx = 2; // from this size on, pixels have edges
const wheelZoom = 1.2;

/** What the part that is shown depends on. */
export const keysOfPart: Key[] = ['zoom', 'panx', 'pany'];

export const zoomKeys: [keys: string, does: string][] = [
  ['z and Z', 'zoom in and out, as the wheel and two fingers do'],
  ['shift and arrows', 'move the part that is shown, as dragging with shift or the middle button does'],
];

/** Returns the left top corner and the size of the part that is shown, in shares of the picture. */
export function partOf(state: State): { x: number; y: number; size: number } {
  const size = 1 / Math.max(state.get('zoom'), 1);
  const begin = (middle: number) => clamp(middle - size / 2, 0, 1 - size);
  return { x: begin(state.get('panx')), y: begin(state.get('pany')), size };
}

/** Sets the middle of the part that is shown, as far as there is picture. */
function panTo(state: State, x: number, y: number): void {
  const half = 0.5 / state.get('zoom');
  state.set('panx', clamp(x, half, 1 - half));
  state.set('pany', clamp(y, half, 1 - half));
}

export class ZoomBox {
  readonly root: HTMLElement;
  readonly isPinching: () => boolean;
  private readonly inner: HTMLElement;
  private box: [number, number] = [1, 1];
  private drag: { x: number; y: number; panx: number; pany: number } | null = null;

  /** `width` is that of the picture in px; `children` cover it. */
  constructor(private readonly state: State, private readonly width: number, private readonly picture: HTMLCanvasElement, ...children: HTMLElement[]) {
    this.inner = element('div', { class: 'zoomed' }, picture, ...children);
    this.root = element('div', { class: 'frame' }, this.inner);
    this.isPinching = followPinch(this.root, (factor, middle, moved) => {
      this.zoomAt(factor, middle);
      const zoom = state.get('zoom');
      panTo(state, state.get('panx') - moved.x / zoom, state.get('pany') - moved.y / zoom);
    });
    this.root.addEventListener('wheel', (event) => {
      if (event.shiftKey) return;
      event.preventDefault();
      this.zoomAt(wheelZoom ** -Math.sign(event.deltaY || event.deltaX), placeOn(this.root, event));
    }, { passive: false });
    this.root.addEventListener('pointerdown', (event) => this.beginDrag(event), { capture: true });
    this.root.addEventListener('pointermove', (event) => this.follow(event), { capture: true });
    for (const name of ['pointerup', 'pointercancel'] as const) this.root.addEventListener(name, () => (this.drag = null));
  }

  layout(width: number, height: number): void {
    this.box = [width, height];
    setSize(this.root, width, height);
    this.show();
  }

  /** Shows the part that the state states. */
  show(): void {
    const { x, y, size } = partOf(this.state);
    setSize(this.inner, this.box[0] / size, this.box[1] / size);
    this.inner.style.left = `${(-x * this.box[0]) / size}px`;
    this.inner.style.top = `${(-y * this.box[1]) / size}px`;
    this.picture.classList.toggle('is-sharp', this.box[0] / size / this.width >= sharpPixelPx);
  }

  /** A relief shows the part with its camera. */
  showWhole(): void {
    setSize(this.inner, ...this.box);
    this.inner.style.left = this.inner.style.top = '0';
  }

  press(key: string): boolean {
    const { state } = this;
    const step = 0.1 / state.get('zoom');
    const pan = (x: number, y: number) => panTo(state, state.get('panx') + x * step, state.get('pany') + y * step);
    switch (key) {
      case 'z': this.zoomAt(1.5, { x: 0.5, y: 0.5 }); return true;
      case 'Z': this.zoomAt(1 / 1.5, { x: 0.5, y: 0.5 }); return true;
      case 'Shift+ArrowLeft': pan(-1, 0); return true;
      case 'Shift+ArrowRight': pan(1, 0); return true;
      case 'Shift+ArrowUp': pan(0, -1); return true;
      case 'Shift+ArrowDown': pan(0, 1); return true;
      default: return false;
    }
  }

  private most(): number {
    return Math.max((mostPixelPx * this.width) / this.box[0], 1);
  }

  /** The point of the picture at a place in the box, in shares of its size, stays where it is. */
  private zoomAt(factor: number, { x, y }: { x: number; y: number }): void {
    const { state } = this;
    const before = state.get('zoom');
    const after = clamp(before * factor, 1, this.most());
    const moved = 1 / before - 1 / after;
    state.set('zoom', after);
    panTo(state, state.get('panx') + (x - 0.5) * moved, state.get('pany') + (y - 0.5) * moved);
  }

  private beginDrag(event: PointerEvent): void {
    if (!(event.button === 1 || (event.button === 0 && event.shiftKey))) return;
    event.preventDefault();
    event.stopPropagation();
    this.root.setPointerCapture(event.pointerId);
    this.drag = { x: event.clientX, y: event.clientY, panx: this.state.get('panx'), pany: this.state.get('pany') };
  }

  private follow(event: PointerEvent): void {
    if (!this.drag) return;
    event.stopPropagation();
    const zoom = this.state.get('zoom');
    panTo(this.state, this.drag.panx - (event.clientX - this.drag.x) / (this.box[0] * zoom), this.drag.pany - (event.clientY - this.drag.y) / (this.box[1] * zoom));
  }
}
