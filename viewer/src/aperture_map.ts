// A map of the views as cells of the aperture: their weights, the viewpoint and, if there is a ground truth, the quality
// of each view. A click on a cell moves the viewpoint there.
import { css, sequential } from './colour_map';
import { canvas, clamp, context2d, placeOn } from './dom';
import type { State } from './state';

const widthPx = 240;

export class ApertureMap {
  readonly canvas: HTMLCanvasElement;
  private psnrDb: (number | null)[] | undefined;

  constructor(
    private readonly state: State,
    private readonly views: [number, number],
    private readonly onHover: (text: string) => void,
  ) {
    this.canvas = canvas('The views and the synthetic aperture. Press on a view to look from there.', 'map');
    this.canvas.width = 2 * widthPx;
    this.canvas.height = Math.round((2 * widthPx * views[0]) / views[1]);
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.go(event);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (this.canvas.hasPointerCapture(event.pointerId)) this.go(event);
      const [row, column] = this.cell(event);
      this.onHover(this.cellText(row, column));
    });
  }

  showPsnr(psnrDb: (number | null)[] | undefined): void {
    this.psnrDb = psnrDb;
  }

  draw(weights: Float32Array): void {
    const context = context2d(this.canvas);
    const [rows, columns] = this.views;
    const cell = this.canvas.width / columns;
    const styles = getComputedStyle(this.canvas);
    const ink = styles.getPropertyValue('--accent');
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    for (let row = 0; row < rows; ++row) {
      for (let column = 0; column < columns; ++column) {
        const number = row * columns + column;
        context.fillStyle = this.cellColour(number) ?? styles.getPropertyValue('--raised');
        context.fillRect(column * cell + 1, row * cell + 1, cell - 2, cell - 2);
        this.drawWeight(context, (column + 0.5) * cell, (row + 0.5) * cell, cell, weights[number]!, ink);
      }
    }
    const x = (this.state.get('x') + columns / 2) * cell;
    const y = (this.state.get('y') + rows / 2) * cell;
    context.beginPath();
    context.arc(x, y, cell * 0.42, 0, 2 * Math.PI);
    this.outline(context);
    context.strokeStyle = ink;
    context.lineWidth = 4;
    context.stroke();
  }

  private drawWeight(context: CanvasRenderingContext2D, x: number, y: number, cell: number, weight: number, ink: string): void {
    if (weight === 0) return;
    context.globalAlpha = 0.25 + 0.75 * clamp(weight, 0, 1);
    context.fillStyle = ink;
    context.beginPath();
    context.arc(x, y, cell * 0.22, 0, 2 * Math.PI);
    this.outline(context);
    context.fill();
    context.globalAlpha = 1;
  }

  /** Some colours of the PSNR are similar to that of the marks. */
  private outline(context: CanvasRenderingContext2D): void {
    if (!this.psnrDb) return;
    context.strokeStyle = 'black';
    context.lineWidth = 8;
    context.stroke();
  }

  private cellColour(number: number): string | null {
    if (!this.psnrDb) return null;
    const value = this.psnrDb[number] ?? null;
    if (value === null) return css(sequential(1));
    const known = this.psnrDb.filter((psnr): psnr is number => psnr !== null);
    const [low, high] = [Math.min(...known), Math.max(...known)];
    return css(sequential(high > low ? (value - low) / (high - low) : 0.5));
  }

  private cellText(row: number, column: number): string {
    const psnr = this.psnrDb?.[row * this.views[1] + column];
    const quality = this.psnrDb ? `, ${psnr === null || psnr === undefined ? 'equal' : `${psnr.toFixed(2)} dB`}` : '';
    return `view ${row}, ${column}${quality}`;
  }

  private cell(event: PointerEvent): [number, number] {
    const { x, y } = placeOn(this.canvas, event);
    const [rows, columns] = this.views;
    return [clamp(Math.floor(y * rows), 0, rows - 1), clamp(Math.floor(x * columns), 0, columns - 1)];
  }

  private go(event: PointerEvent): void {
    const [row, column] = this.cell(event);
    this.state.set('x', column - (this.views[1] - 1) / 2);
    this.state.set('y', row - (this.views[0] - 1) / 2);
  }
}
