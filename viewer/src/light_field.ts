// The views of one cycle of a light field on the graphics card, and the pictures rendered from them.
import { apertureTaps, apertureWeights, nearestViewpoint } from './aperture';
import type { LightFieldItem, Source } from './document';
import type { Painter, Pictures, Uniform } from './painter';
import { matchShader } from './shaders';
import type { State } from './state';

/** The range of the focus, in px per view step. */
export const maxDisparity = 5;

const atOnce = 4; // number of views that are fetched and decoded at a time

/** Returns the numbers of the views from the middle of the grid outwards, because the first picture needs the middle. */
function middleFirst([rows, columns]: [number, number]): number[] {
  const far = (view: number) => Math.hypot((view % columns) - (columns - 1) / 2, Math.floor(view / columns) - (rows - 1) / 2);
  return Array.from({ length: rows * columns }, (_, view) => view).sort((a, b) => far(a) - far(b));
}

export class LightFieldViews {
  private pictures: Pictures;
  private cycle = -1;
  private loading = 0;

  constructor(
    readonly item: LightFieldItem,
    private readonly source: Source,
    private readonly painter: Painter,
  ) {
    this.pictures = painter.pictures(item.width, item.height, item.views[0] * item.views[1], item.channels === 1);
  }

  get texture(): WebGLTexture {
    return this.pictures.texture;
  }
  get isGrey(): boolean {
    return this.pictures.isGrey;
  }

  /** Ends loading. */
  close(): void {
    ++this.loading;
    this.painter.gl.deleteTexture(this.texture);
  }

  /** Loads a cycle unless it is loaded. `onProgress` is called repeatedly and at the end. */
  async load(cycle: number, onProgress: (share: number) => void): Promise<void> {
    const number = Math.min(Math.max(Math.round(cycle), 0), this.item.cycles.length - 1);
    if (number === this.cycle) return;
    this.cycle = number;
    const turn = ++this.loading;
    const parts = this.item.cycles[number]!.views;
    const order = middleFirst(this.item.views);
    let done = 0;
    const loadNext = async (): Promise<void> => {
      for (let view = order.shift(); view !== undefined; view = order.shift()) {
        const part = await this.source.part(parts[view]!);
        const bitmap = await createImageBitmap(part, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
        if (turn === this.loading) this.painter.put(this.pictures, view, bitmap);
        bitmap.close();
        if (turn !== this.loading) return; // another cycle was requested meanwhile
        ++done;
        if (done % 8 === 4 || done === parts.length) onProgress(done / parts.length);
      }
    };
    await Promise.all(Array.from({ length: atOnce }, loadNext));
  }

  /** Returns the disparity at which the views agree best around a point (px), from a sweep in 241 steps with parabolic
   *  interpolation between them. */
  disparityAt(x: number, y: number): number {
    const steps = 241;
    const costs = this.painter.read(steps, 1, matchShader, {
      ...lightFieldUniforms(this, this),
      centre: [x, y],
      low: -maxDisparity * (steps / (steps - 1)),
      high: maxDisparity * (steps / (steps - 1)),
    });
    const cost = (i: number) => costs[4 * i]! * 65536 + costs[4 * i + 1]! * 256 + costs[4 * i + 2]!;
    let best = 0;
    for (let i = 1; i < steps; ++i) if (cost(i) < cost(best)) best = i;
    let offset = 0;
    if (best > 0 && best < steps - 1) {
      const [left, middle, right] = [cost(best - 1), cost(best), cost(best + 1)];
      const bend = left - 2 * middle + right;
      if (bend > 0) offset = (0.5 * (left - right)) / bend;
    }
    return ((best + offset) / (steps - 1)) * 2 * maxDisparity - maxDisparity;
  }
}

/** The uniforms of all shaders of light fields. */
export function lightFieldUniforms(first: LightFieldViews, second: LightFieldViews): Record<string, Uniform> {
  const { width, height, views } = first.item;
  return {
    first: first.texture,
    second: second.texture,
    firstIsGrey: first.isGrey,
    secondIsGrey: second.isGrey,
    size: [width, height],
    grid: [views[1], views[0]],
    gain: 1,
    power: 1,
    secondTone: [1, 0],
  };
}

/** The same for one grey picture. */
export function toneOfGrey(texture: WebGLTexture, size: [number, number]): Record<string, Uniform> {
  return { first: texture, second: texture, firstIsGrey: true, secondIsGrey: true, size, gain: 1, power: 1, secondTone: [1, 0] };
}

/** Sets gain and gamma from the state. */
export function toneUniforms(state: State): Record<string, Uniform> {
  return { gain: state.get('gain'), power: 1 / Math.max(state.get('gamma'), 0.05) };
}

/** Returns the offset of the middle view, that of depth::middle_view(), from the middle of the grid, in view steps. */
export const middleOf = (count: number): number => Math.floor(count / 2) - (count - 1) / 2;

/** Sets viewpoint, focus and aperture of the picture shader from the state. */
export class Camera {
  weights = new Float32Array();
  numTaps = 0;
  private taps: WebGLTexture | null = null;

  constructor(private readonly painter: Painter) {}

  uniforms(state: State, views: [number, number]): Record<string, Uniform> {
    const size = state.get('size');
    // What is seen from outside the grid comes from the views at its edge.
    const [x, y] = [nearestViewpoint(state.get('x'), views[1], size, false), nearestViewpoint(state.get('y'), views[0], size, false)];
    this.weights = apertureWeights(views, { x, y, size, shape: state.get('shape') });
    const taps = apertureTaps(views, this.weights);
    this.taps = this.painter.table(this.taps, taps);
    this.numTaps = taps.length / 4;
    return { taps: this.taps, numTaps: this.numTaps, focus: [state.get('focus'), state.get('tiltx'), state.get('tilty')] };
  }
}
