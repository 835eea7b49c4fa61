// The disparity map of a light field: its values, and a texture for the shaders of pictures and reliefs.
import { inflateCounts, type Disparity, type Source } from './document';
import type { Painter, Uniform } from './painter';

const unknown = -32768;
const far = 1e4; // the value that the shader treats as unknown

export class DisparityMap {
  /** Nearest and farthest, px per view: the ends of the colours. */
  range: [number, number] = [0, 1];
  version = 0; // counts the changes of the map
  private milli = new Int16Array();
  private readonly texture: WebGLTexture;
  private cycle = -1;
  private loading = 0;

  /** `view` is the one (row, column) whose pixels these are, `views` their number. */
  constructor(private readonly painter: Painter, readonly size: [number, number], private readonly views: [number, number], private readonly view: [number, number]) {
    this.texture = painter.numbers(null, 1, 1, new Float32Array([far]));
  }

  get isKnown(): boolean {
    return this.milli.length > 0;
  }

  /** Loads the map of a cycle unless it is loaded. */
  async load(cycle: number, { maps }: Disparity, source: Source): Promise<void> {
    const number = Math.min(Math.max(Math.round(cycle), 0), maps.length - 1);
    if (number === this.cycle) return;
    this.cycle = number;
    const turn = ++this.loading;
    const milli = await inflateCounts(await source.part(maps[number]!));
    if (turn === this.loading) this.set(milli); // otherwise, another cycle was requested meanwhile
  }

  /** Sets the map [y, x] in thousandths of a px per view; -32768 = unknown. */
  set(milli: Int16Array): void {
    this.milli = milli;
    ++this.version;
    this.painter.numbers(this.texture, ...this.size, Float32Array.from(milli, (value) => (value === unknown ? far : value / 1000)));
  }

  /** Returns the disparity in px per view step at a pixel of the view of the map; null if it is unknown. */
  at(x: number, y: number): number | null {
    const value = this.milli[y * this.size[0] + x];
    return value === undefined || value === unknown ? null : value / 1000;
  }

  /** Sets the uniforms of the shaders. `viewpoint` is in view steps from the middle of the grid. */
  uniforms(opacity: number, viewpoint: { x: number; y: number }): Record<string, Uniform> {
    const [[rows, columns], [row, column]] = [this.views, this.view];
    return {
      disparities: this.texture,
      overlay: this.isKnown ? opacity : 0,
      overlayRange: this.range,
      viewpoint: [viewpoint.x, viewpoint.y],
      mapView: [column - (columns - 1) / 2, row - (rows - 1) / 2],
      layer: row * columns + column,
    };
  }

  close(): void {
    this.painter.gl.deleteTexture(this.texture);
  }
}
