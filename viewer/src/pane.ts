// One picture of a light field with its two EPIs: the row under the cursor in one row of views (below the picture), and
// the column in one column of views (to its right). Dragging moves the viewpoint, the wheel and two fingers change the
// focus, and a click focuses on the point.
import { canvas, clamp, element, placeOn } from './dom';
import { maxDisparity } from './light_field';
import { followPinch } from './pinch';
import { fit, setSize } from './screen';
import type { State } from './state';

const mostEpiPx = 72;
const gapPx = 6;
const clickPx = 4; // a smaller motion of the pointer is a click
const pinchSpeed = 2; // change of focus in px per view when the distance of the fingers doubles

export interface PaneSize {
  width: number;
  height: number;
  views: [number, number];
}

export class Pane {
  readonly root: HTMLElement;
  readonly picture: HTMLCanvasElement;
  readonly rowEpi: HTMLCanvasElement;
  readonly columnEpi: HTMLCanvasElement;
  private readonly rowLine = element('div', { class: 'line row' });
  private readonly columnLine = element('div', { class: 'line column' });
  readonly splitLine = element('div', { class: 'split', hidden: '' });
  readonly caption = element('figcaption');
  private readonly frame: HTMLElement;

  constructor(
    name: string,
    private readonly size: PaneSize,
    private readonly state: State,
    private readonly focusAt: (x: number, y: number) => void,
  ) {
    this.picture = canvas(`${name}: drag to move the viewpoint, press on a point to focus on it`, 'picture');
    this.rowEpi = canvas(`${name}: EPI of the row under the cursor`, 'epi');
    this.columnEpi = canvas(`${name}: EPI of the column under the cursor`, 'epi');
    this.frame = element('div', { class: 'frame' }, this.picture, this.rowLine, this.columnLine, this.splitLine);
    this.caption.textContent = name;
    this.root = element('figure', { class: 'pane' }, this.caption, this.frame, this.columnEpi, this.rowEpi);
    this.listen();
  }

  layout(boxWidth: number, boxHeight: number): void {
    const epiPx = clamp(Math.round(Math.min(boxWidth, boxHeight) / 6), mostEpiPx / 2, mostEpiPx);
    const extra = epiPx + gapPx;
    const [width, height] = fit(this.size.width, this.size.height, boxWidth - extra, boxHeight - extra - 22);
    setSize(this.frame, width, height);
    setSize(this.rowEpi, width, epiPx);
    setSize(this.columnEpi, epiPx, height);
  }

  /** Returns the row and the column of the EPIs, px. */
  cut(): { row: number; column: number } {
    const place = (value: number, count: number) => (value < 0 ? Math.floor(count / 2) : Math.min(Math.round(value), count - 1));
    return { row: place(this.state.get('row'), this.size.height), column: place(this.state.get('column'), this.size.width) };
  }

  drawLines(split: number | null): void {
    const { row, column } = this.cut();
    this.rowLine.style.top = `${(100 * (row + 0.5)) / this.size.height}%`;
    this.columnLine.style.left = `${(100 * (column + 0.5)) / this.size.width}%`;
    this.splitLine.hidden = split === null;
    if (split !== null) this.splitLine.style.left = `${100 * split}%`;
  }

  private listen(): void {
    let from: { x: number; y: number; viewX: number; viewY: number; isDrag: boolean } | null = null;
    const isPinching = followPinch(this.picture, (factor) => this.moveFocus(pinchSpeed * Math.log2(factor)));
    this.picture.addEventListener('pointerdown', (event) => {
      if (isPinching()) from = null;
      if (isPinching() || event.button !== 0) return;
      this.picture.setPointerCapture(event.pointerId);
      from = { x: event.clientX, y: event.clientY, viewX: this.state.get('x'), viewY: this.state.get('y'), isDrag: false };
    });
    this.picture.addEventListener('pointermove', (event) => {
      if (isPinching()) return;
      if (!from) return this.point(event);
      const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
      from.isDrag ||= Math.hypot(dx, dy) >= clickPx;
      if (from.isDrag) this.turn(from.viewX, from.viewY, dx, dy);
    });
    this.picture.addEventListener('pointerup', (event) => {
      if (from && !from.isDrag) {
        this.point(event);
        const { x, y } = this.pixel(event);
        this.focusAt(x, y);
      }
      from = null;
    });
    this.picture.addEventListener('pointercancel', () => (from = null));
    this.picture.addEventListener('wheel', (event) => {
      event.preventDefault();
      const step = event.shiftKey ? 0.01 : 0.05;
      this.moveFocus(-Math.sign(event.deltaY || event.deltaX) * step);
    }, { passive: false });
    this.splitLine.addEventListener('pointerdown', (event) => this.splitLine.setPointerCapture(event.pointerId));
    this.splitLine.addEventListener('pointermove', (event) => {
      if (this.splitLine.hasPointerCapture(event.pointerId)) this.state.set('split', clamp(placeOn(this.frame, event).x, 0, 1));
    });
  }

  private moveFocus(by: number): void {
    this.state.set('focus', clamp(this.state.get('focus') + by, -maxDisparity, maxDisparity));
  }

  /** Half the width of the picture corresponds to the whole grid. Points nearer than the focus follow the pointer. */
  private turn(viewX: number, viewY: number, dx: number, dy: number): void {
    const [rows, columns] = this.size.views;
    const box = this.picture.getBoundingClientRect();
    const moved = (value: number, share: number, count: number) => clamp(value + 2 * share * (count - 1), -(count - 1) / 2, (count - 1) / 2);
    this.state.set('x', moved(viewX, dx / box.width, columns));
    this.state.set('y', moved(viewY, dy / box.height, rows));
  }

  private pixel(event: MouseEvent): { x: number; y: number } {
    const { x, y } = placeOn(this.picture, event);
    return { x: clamp(x, 0, 1) * this.size.width, y: clamp(y, 0, 1) * this.size.height };
  }

  private point(event: MouseEvent): void {
    const { x, y } = this.pixel(event);
    this.state.set('column', clamp(Math.floor(x), 0, this.size.width - 1));
    this.state.set('row', clamp(Math.floor(y), 0, this.size.height - 1));
  }
}
