// The disparity map of a light field: as numbers, and as a texture that the picture shader colours.
import { css, nearToFar } from './colour_map';
import { inflateCounts, type LightFieldItem, type Source } from './document';
import { context2d } from './dom';
import type { Painter, Uniform } from './painter';

const unknown = -32768;
const far = 1e4; // what the shader takes for unknown

/** A bar of the colours, near at its left. */
export function drawBar(bar: HTMLCanvasElement): void {
  bar.width = 256;
  bar.height = 1;
  const gradient = context2d(bar).createLinearGradient(0, 0, bar.width, 0);
  nearToFar.forEach((colour, i) => gradient.addColorStop(i / (nearToFar.length - 1), css(colour)));
  context2d(bar).fillStyle = gradient;
  context2d(bar).fillRect(0, 0, bar.width, 1);
}

export class DisparityMap {
  private milli = new Int16Array();
  private readonly texture: WebGLTexture;
  private cycle = -1;
  private loading = 0;

  constructor(
    private readonly item: LightFieldItem,
    private readonly source: Source,
    private readonly painter: Painter,
  ) {
    this.texture = painter.numbers(null, 1, 1, new Float32Array([0]));
  }

  get range(): [number, number] {
    return this.item.disparity!.range;
  }

  async load(cycle: number): Promise<void> {
    const parts = this.item.disparity!.maps;
    const number = Math.min(Math.max(Math.round(cycle), 0), parts.length - 1);
    if (number === this.cycle) return;
    this.cycle = number;
    const turn = ++this.loading;
    const milli = await inflateCounts(await this.source.part(parts[number]!));
    if (turn !== this.loading) return; // another cycle was asked for meanwhile
    this.milli = milli;
    const numbers = Float32Array.from(milli, (value) => (value === unknown ? far : value / 1000));
    this.painter.numbers(this.texture, this.item.width, this.item.height, numbers);
  }

  /** px per view at a pixel of the view that the map is of; null where it is not known. */
  at(x: number, y: number): number | null {
    const value = this.milli[y * this.item.width + x];
    return value === undefined || value === unknown ? null : value / 1000;
  }

  /** For the picture shader; `viewpoint` and the map's view are in view steps from the middle of the grid. */
  uniforms(opacity: number, viewpoint: { x: number; y: number }): Record<string, Uniform> {
    const { views: [rows, columns], disparity } = this.item;
    const [row, column] = disparity!.view;
    return {
      disparities: this.texture,
      overlay: this.milli.length > 0 ? opacity : 0,
      overlayRange: this.range,
      viewpoint: [viewpoint.x, viewpoint.y],
      mapView: [column - (columns - 1) / 2, row - (rows - 1) / 2],
    };
  }

  close(): void {
    this.painter.gl.deleteTexture(this.texture);
  }
}
