// The disparity map of a light field: its values, and a texture for the picture shader.
import { inflateCounts, type LightFieldItem, type Source } from './document';
import type { Painter, Uniform } from './painter';

const unknown = -32768;
const far = 1e4; // the value that the shader treats as unknown

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
    if (turn !== this.loading) return; // another cycle was requested meanwhile
    this.milli = milli;
    const numbers = Float32Array.from(milli, (value) => (value === unknown ? far : value / 1000));
    this.painter.numbers(this.texture, this.item.width, this.item.height, numbers);
  }

  /** Returns the disparity in px per view step at a pixel of the view of the map; null if it is unknown. */
  at(x: number, y: number): number | null {
    const value = this.milli[y * this.item.width + x];
    return value === undefined || value === unknown ? null : value / 1000;
  }

  /** Sets the uniforms of the picture shader. `viewpoint` is in view steps from the middle of the grid. */
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
