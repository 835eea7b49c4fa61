// A disparity map as a relief in three dimensions: a surface over the pixels of a view, open at jumps.
import { clamp } from './dom';
import type { DisparityMap } from './disparity_map';
import type { Painter, Uniform } from './painter';
import { disparityColours } from './shaders';
import type { State } from './state';
import { groundColour } from './theme';

const mostVertices = 1e5; // of the surface; the picture on it has all pixels
const mostTip = 1.4;

/** Sets the turn around the vertical axis and around the horizontal one, in radians. */
export function turnRelief(state: State, turn: number, tip: number): void {
  state.set('turn', clamp(turn, -Math.PI, Math.PI));
  state.set('tip', clamp(tip, -mostTip, mostTip));
}

/** Handles a key. Returns true if it turns the relief. */
export function pressReliefKey(state: State, key: string): boolean {
  const step = 0.1;
  const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[key];
  if (by) turnRelief(state, state.get('turn') + by[0]!, state.get('tip') + by[1]!);
  return by !== undefined;
}

/** Returns the corners of two triangles for each cell of step x step pixels, except where the disparity jumps or is
 *  unknown: there, the surface would hang between two things. */
export function cellsOf(map: DisparityMap, step: number): Uint32Array {
  const [width, height] = map.size;
  const coarseness = clamp(480 / width, 1, 4); // the same slope is steeper from pixel to pixel in a smaller map
  const jump = Math.max(0.06, 0.025 * (map.range[1] - map.range[0])) * step * coarseness;
  const cells = new Uint32Array(6 * Math.floor((width - 1) / step) * Math.floor((height - 1) / step));
  let count = 0;
  for (let y = 0; y + step < height; y += step) {
    for (let x = 0; x + step < width; x += step) {
      const four = [map.at(x, y), map.at(x + step, y), map.at(x, y + step), map.at(x + step, y + step)];
      const known = four.filter((value) => value !== null);
      if (known.length < 4 || Math.max(...known) - Math.min(...known) > jump) continue;
      const first = y * width + x, below = first + step * width;
      cells.set([first, first + step, below, below, first + step, below + step], count);
      count += 6;
    }
  }
  return cells.subarray(0, count);
}

export class Relief {
  private mesh: { buffer: WebGLBuffer; count: number; step: number; version: number } | null = null;

  constructor(private readonly painter: Painter, private readonly map: DisparityMap) {}

  /** Paints at a scale of the resolution. `picture` has the uniforms of light fields, of which the first is shown. */
  paint(target: HTMLCanvasElement, state: State, scale: number, picture: Record<string, Uniform>): void {
    const [width, height] = this.map.size;
    const step = Math.max(Math.ceil(Math.sqrt((width * height) / mostVertices)), Math.round(1 / scale));
    const ratio = Math.min(devicePixelRatio, 2) * scale;
    const size = (px: number) => Math.max(Math.round(px * ratio), 1);
    const [turn, tip] = [state.get('turn'), state.get('tip')];
    const margin = 0.85; // so that a turned relief fits
    const values = {
      ...picture,
      ...this.map.uniforms(state, state.get('overlay')),
      turned: [Math.sin(turn), Math.cos(turn), Math.sin(tip), Math.cos(tip)],
      deep: state.get('depth'),
      shown: [2 * state.get('panx') - 1, 1 - 2 * state.get('pany'), margin * state.get('zoom')],
    };
    this.painter.paint(target, size(target.clientWidth), size(target.clientHeight), reliefShader, values,
      { vertex: reliefVertices, ground: groundColour(), ...this.meshFor(step) });
  }

  private meshFor(step: number): { buffer: WebGLBuffer; count: number } {
    const { version } = this.map;
    if (this.mesh?.step === step && this.mesh.version === version) return this.mesh;
    const cells = cellsOf(this.map, step);
    const buffer = this.painter.indices(this.mesh?.buffer ?? null, cells);
    this.mesh = { buffer, count: cells.length, step, version };
    return this.mesh;
  }

  close(): void {
    if (this.mesh) this.painter.gl.deleteBuffer(this.mesh.buffer);
  }
}

const reliefVertices = `#version 300 es
precision highp float;
uniform highp sampler2D disparities;
uniform vec2 size, overlayRange;
uniform vec3 shown;     // the middle of what is shown, and the magnification
uniform vec4 turned;    // sine and cosine of both angles
uniform float deep;
out vec2 at;            // px of the map
out float disparity;
out vec3 position;
void main() {
  ivec2 pixel = ivec2(gl_VertexID % int(size.x), gl_VertexID / int(size.x));
  disparity = texelFetch(disparities, pixel, 0).r;
  at = vec2(pixel) + 0.5;
  float range = max(overlayRange.y - overlayRange.x, 1e-6);
  float height = clamp(((overlayRange.x + overlayRange.y) * 0.5 - disparity) / range, -0.8, 0.8);
  vec3 p = vec3((at / size * 2.0 - 1.0) * vec2(1.0, -size.y / size.x), 2.0 * deep * height);
  p = vec3(turned.y * p.x + turned.x * p.z, p.y, turned.y * p.z - turned.x * p.x);
  p = vec3(p.x, turned.w * p.y + turned.z * p.z, turned.w * p.z - turned.z * p.y);
  position = p;
  const float eye = 4.0;    // its distance, in half widths
  float w = (eye - p.z) / eye;
  gl_Position = vec4(shown.z * (vec2(p.x, p.y * size.x / size.y) - shown.xy * w), -0.3 * p.z, w);
}`;

const reliefShader = `${disparityColours}uniform highp sampler2D disparities;
in vec2 at;
in float disparity;
in vec3 position;
void main() {
  vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
  vec3 picture = shown(sampled(false, vec3(at / size, layer))).rgb;
  colour = vec4(mix(picture, (0.45 + 0.55 * abs(normal.z)) * colourOf(disparity), overlay * opacityOf(texelFetch(disparities, ivec2(at), 0).g, at)), 1.0);
}`;
