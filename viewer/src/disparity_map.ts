// The disparity map of a light field: its values, their confidence, and a texture for the shaders of pictures and reliefs.
import { nearestViewpoint } from './aperture';
import { inflateCounts, type Disparity, type Source } from './document';
import type { Painter, Uniform } from './painter';
import type { State } from './state';

const unknown = -32768;
const far = 1e4; // the value that the shader treats as unknown

export class DisparityMap {
  /** Nearest and farthest, px per view: the ends of the colours. */
  range: [number, number] = [0, 1];
  version = 0; // counts the changes of the map
  readonly hasConfidence: boolean;
  private milli = new Int16Array();
  private confidence: Int16Array | null = null; // in thousandths
  private readonly texture: WebGLTexture;
  private cycle = -1;
  private loading = 0;

  /** `views` is the number of rows and columns of views. */
  constructor(private readonly painter: Painter, readonly size: [number, number], private readonly views: [number, number], private readonly about: Omit<Disparity, 'maps'>) {
    this.texture = painter.pairs(null, 1, 1, new Float32Array([far, 1]));
    this.range = about.range;
    this.hasConfidence = about.confidences !== undefined;
  }

  get isKnown(): boolean {
    return this.milli.length > 0;
  }

  /** Loads the map of a cycle unless it is loaded. */
  async load(cycle: number, { maps, confidences }: Disparity, source: Source): Promise<void> {
    const number = Math.min(Math.max(Math.round(cycle), 0), maps.length - 1);
    if (number === this.cycle) return;
    this.cycle = number;
    const turn = ++this.loading;
    const inflated = async (part: number) => inflateCounts(await source.part(part));
    const [milli, confidence] = await Promise.all([inflated(maps[number]!), confidences ? inflated(confidences[number]!) : null]);
    if (turn === this.loading) this.set(milli, confidence); // otherwise, another cycle was requested meanwhile
  }

  /** Sets the map [y, x] in thousandths of a px per view, where -32768 is unknown, and its confidence in thousandths. */
  set(milli: Int16Array, confidence: Int16Array | null = null): void {
    this.milli = milli;
    this.confidence = confidence;
    ++this.version;
    const pairs = new Float32Array(2 * milli.length).fill(1);
    milli.forEach((value, i) => (pairs[2 * i] = value === unknown ? far : value / 1000));
    confidence?.forEach((value, i) => (pairs[2 * i + 1] = value / 1000));
    this.painter.pairs(this.texture, ...this.size, pairs);
  }

  /** Returns the disparity in px per view step at a pixel of the view of the map; NaN if it is unknown. */
  valueAt(x: number, y: number): number {
    const value = this.milli[y * this.size[0] + x];
    return value === undefined || value === unknown ? NaN : value / 1000;
  }

  /** The same, or null if it is unknown. */
  at(x: number, y: number): number | null {
    const value = this.valueAt(x, y);
    return Number.isNaN(value) ? null : value;
  }

  /** Returns the confidence at a pixel; 1 if the map states none. */
  confidenceAt(x: number, y: number): number {
    return this.confidence ? this.confidence[y * this.size[0] + x]! / 1000 : 1;
  }

  /** Returns the confidence from which on points are shown. */
  leastConfidence(state: State): number {
    return this.hasConfidence ? state.get('sure') : 0;
  }

  /** Describes a pixel in words; null if its disparity is unknown. */
  textAt(x: number, y: number): string | null {
    const disparity = this.at(x, y);
    const confidence = this.confidence?.[y * this.size[0] + x];
    if (disparity === null) return null;
    return `${disparity.toFixed(3)} px per view${confidence === undefined ? '' : `, confidence ${(confidence / 1000).toFixed(2)}`}`;
  }

  /** Sets the uniforms of the shaders. */
  uniforms(state: State, opacity: number): Record<string, Uniform> {
    const [[rows, columns], [row, column]] = [this.views, this.about.view];
    const viewpointOn = (axis: 'x' | 'y', count: number) => nearestViewpoint(state.get(axis), count, state.get('size'), this.isKnown);
    return {
      disparities: this.texture,
      overlay: this.isKnown ? opacity : 0,
      followsMap: this.isKnown && state.get('size') === 0,
      overlayRange: this.range,
      leastConfidence: this.leastConfidence(state),
      viewpoint: [viewpointOn('x', columns), viewpointOn('y', rows)],
      mapView: [column - (columns - 1) / 2, row - (rows - 1) / 2],
      layer: row * columns + column,
    };
  }

  close(): void {
    this.painter.gl.deleteTexture(this.texture);
  }
}
