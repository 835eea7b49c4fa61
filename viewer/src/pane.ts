// One picture of a light field with its two EPIs: the row under the cursor in one row of views (below the picture), and
// the column in one column of views (to its right). Dragging moves the viewpoint, a click focuses on the point, and the
// wheel with shift changes the focus. As a relief, which has no EPIs, dragging turns it.
import { nearestViewpoint } from './aperture';
import { canvas, clamp, element, placeOn } from './dom';
import { maxDisparity } from './light_field';
import { turnRelief } from './relief';
import { fit, setSize } from './screen';
import type { State } from './state';
import { ZoomBox } from './zoom';

const mostEpiPx = 72;
const gapPx = 6;
const captionPx = 22;
const clickPx = 4; // a smaller motion of the pointer is a click

export interface PaneSize {
  width: number;
  height: number;
  views: [number, number];
  disparity?: unknown; // a map, along which single views are interpolated
}

/** The EPIs for which there is room. */
export interface Epis {
  row: boolean;
  column: boolean;
}
const bothEpis: Epis = { row: true, column: true };

export class Pane {
  readonly root: HTMLElement;
  readonly picture: HTMLCanvasElement;
  readonly rowEpi: HTMLCanvasElement;
  readonly columnEpi: HTMLCanvasElement;
  private readonly rowLine = element('div', { class: 'line row' });
  private readonly columnLine = element('div', { class: 'line column' });
  readonly splitLine = element('div', { class: 'split', hidden: '' });
  readonly caption = element('figcaption');
  readonly zoom: ZoomBox;
  private isRelief = false;

  constructor(
    name: string,
    private readonly size: PaneSize,
    private readonly state: State,
    private readonly focusAt: (x: number, y: number) => void,
  ) {
    this.picture = canvas(`${name}: drag to move the viewpoint, press on a point to focus on it`, 'picture');
    this.rowEpi = canvas(`${name}: EPI of the row under the cursor`, 'epi');
    this.columnEpi = canvas(`${name}: EPI of the column under the cursor`, 'epi');
    this.zoom = new ZoomBox(state, size.width, this.picture, this.rowLine, this.columnLine);
    this.zoom.root.append(this.splitLine);
    this.caption.textContent = name;
    this.root = element('figure', { class: 'pane' }, this.caption, this.zoom.root, this.columnEpi, this.rowEpi);
    this.listen();
  }

  /** A single view has no EPIs. */
  private hasEpis(): boolean {
    return !this.isRelief && this.size.views[0] * this.size.views[1] > 1;
  }

  /** Returns the size of the picture in a box, and the height of its EPIs. */
  sizesIn(boxWidth: number, boxHeight: number, epis = bothEpis): { width: number; height: number; epiPx: number } {
    const epiPx = clamp(Math.round(Math.min(boxWidth, boxHeight) / 6), mostEpiPx / 2, mostEpiPx);
    const extra = (hasOne: boolean) => (hasOne && this.hasEpis() ? epiPx : 0) + gapPx; // the gap stays
    const [width, height] = fit(this.size.width, this.size.height, boxWidth - extra(epis.column), boxHeight - extra(epis.row) - captionPx);
    return { width, height, epiPx };
  }

  layout(boxWidth: number, boxHeight: number, isRelief: boolean, epis = bothEpis): void {
    this.isRelief = isRelief;
    const { width, height, epiPx } = this.sizesIn(boxWidth, boxHeight, epis);
    for (const part of [this.rowEpi, this.rowLine]) part.hidden = !this.hasEpis() || !epis.row;
    for (const part of [this.columnEpi, this.columnLine]) part.hidden = !this.hasEpis() || !epis.column;
    this.zoom.layout(width, height);
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
    if (this.isRelief) this.zoom.showWhole();
    else this.zoom.show();
    this.rowLine.style.top = `${(100 * (row + 0.5)) / this.size.height}%`;
    this.columnLine.style.left = `${(100 * (column + 0.5)) / this.size.width}%`;
    this.splitLine.hidden = split === null;
    if (split !== null) this.splitLine.style.left = `${100 * split}%`;
  }

  private listen(): void {
    let from: { x: number; y: number; first: [number, number]; isDrag: boolean } | null = null;
    this.picture.addEventListener('pointerdown', (event) => {
      if (this.zoom.isPinching() || event.button !== 0) return;
      this.picture.setPointerCapture(event.pointerId);
      const first: [number, number] = this.isRelief ? [this.state.get('turn'), this.state.get('tip')] : [this.state.get('x'), this.state.get('y')];
      from = { x: event.clientX, y: event.clientY, first, isDrag: false };
    });
    this.picture.addEventListener('pointermove', (event) => {
      if (this.zoom.isPinching()) {
        from = null;
        return;
      }
      if (!from) return this.point(event);
      const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
      from.isDrag ||= Math.hypot(dx, dy) >= clickPx;
      if (from.isDrag) this.drag(from.first, dx, dy);
    });
    this.picture.addEventListener('pointerup', (event) => {
      if (from && !from.isDrag && !this.isRelief) {
        this.point(event);
        const { x, y } = this.pixel(event);
        this.focusAt(x, y);
      }
      from = null;
    });
    this.picture.addEventListener('pointercancel', () => (from = null));
    this.picture.addEventListener('wheel', (event) => {
      if (!event.shiftKey) return;
      event.preventDefault();
      this.moveFocus(-Math.sign(event.deltaY || event.deltaX) * 0.05);
    }, { passive: false });
    this.splitLine.addEventListener('pointerdown', (event) => this.splitLine.setPointerCapture(event.pointerId));
    this.splitLine.addEventListener('pointermove', (event) => {
      if (this.splitLine.hasPointerCapture(event.pointerId)) this.state.set('split', clamp(placeOn(this.zoom.root, event).x, 0, 1));
    });
  }

  private moveFocus(by: number): void {
    this.state.set('focus', clamp(this.state.get('focus') + by, -maxDisparity, maxDisparity));
  }

  /** Half the width of the box corresponds to the whole grid. Points nearer than the focus follow the pointer. */
  private drag([first, second]: [number, number], dx: number, dy: number): void {
    const [rows, columns] = this.size.views;
    const box = this.zoom.root.getBoundingClientRect();
    if (this.isRelief) return turnRelief(this.state, first + (3 * dx) / box.width, second + (3 * dy) / box.height);
    const moved = (value: number, share: number, count: number) =>
      nearestViewpoint(value + 2 * share * (count - 1), count, this.state.get('size'), this.size.disparity !== undefined);
    this.state.set('x', moved(first, dx / box.width, columns));
    this.state.set('y', moved(second, dy / box.height, rows));
  }

  private pixel(event: MouseEvent): { x: number; y: number } {
    const { x, y } = placeOn(this.picture, event);
    return { x: clamp(x, 0, 1) * this.size.width, y: clamp(y, 0, 1) * this.size.height };
  }

  private point(event: MouseEvent): void {
    if (this.isRelief) return;
    const { x, y } = this.pixel(event);
    this.state.set('column', clamp(Math.floor(x), 0, this.size.width - 1));
    this.state.set('row', clamp(Math.floor(y), 0, this.size.height - 1));
  }
}
