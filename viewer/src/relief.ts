// A disparity map as a relief in three dimensions: the surface of surface.ts with the picture of the view on it.
import { canvas, clamp } from './dom';
import type { DisparityMap } from './disparity_map';
import { glbOf } from './glb';
import type { Painter, Uniform } from './painter';
import { pngOf } from './screenshot';
import { disparityColours, pictureOfMap } from './shaders';
import type { State } from './state';
import { surfaceOf, type Surface } from './surface';
import { groundColour } from './theme';

const mostVertices = 1e5; // of the surface; the picture on it has all pixels
const mostTip = 1.4;
const eye = 4; // distance of the eye, in half widths
const margin = 0.85; // of the picture, within which a relief is
const mostPlacesToFit = 5000;

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

export class Relief {
  private mesh: { surface: Surface; version: string; buffer: WebGLBuffer; vertices: WebGLTexture } | null = null;

  constructor(private readonly painter: Painter, private readonly map: DisparityMap) {}

  /** Paints at a scale of the resolution. `picture` has the uniforms of light fields, of which the first is shown. */
  paint(target: HTMLCanvasElement, state: State, scale: number, picture: Record<string, Uniform>): void {
    const ratio = Math.min(devicePixelRatio, 2) * scale;
    const size = (px: number) => Math.max(Math.round(px * ratio), 1);
    const [turn, tip] = [state.get('turn'), state.get('tip')];
    const { surface, buffer, vertices } = this.meshFor(Math.max(this.finestStep(), Math.round(1 / scale)), this.map.leastConfidence(state));
    const [x, y, magnification] = fitted(surface, this.map, [turn, tip], state.get('depth'));
    const values = {
      ...picture,
      ...this.map.uniforms(state, state.get('overlay')),
      vertices,
      columns: surface.columns,
      spacing: surface.step,
      turned: [Math.sin(turn), Math.cos(turn), Math.sin(tip), Math.cos(tip)],
      deep: state.get('depth'),
      shown: [x + 2 * state.get('panx') - 1, y + 1 - 2 * state.get('pany'), margin * magnification * state.get('zoom')],
    };
    this.painter.paint(target, size(target.clientWidth), size(target.clientHeight), reliefShader, values,
      { vertex: reliefVertices, ground: groundColour(), buffer, count: surface.triangles.length });
  }

  /** Returns the relief as a binary glTF file; units are half the width of the picture. */
  async glb(state: State, picture: Record<string, Uniform>): Promise<Blob> {
    const { map, painter } = this;
    const [width, height] = map.size;
    const surface = surfaceOf(map, this.finestStep(), map.leastConfidence(state));
    const { columns, step, disparities } = surface;
    const numbers = [...new Set(surface.triangles)].sort((a, b) => a - b);
    const places = new Float32Array(2 * numbers.length), positions = new Float32Array(3 * numbers.length);
    const newNumber = new Uint32Array(disparities.length);
    numbers.forEach((number, i) => {
      newNumber[number] = i;
      const [x, y] = [((number % columns) + 0.5) * (step / width), (Math.floor(number / columns) + 0.5) * (step / height)];
      places.set([x, y], 2 * i);
      positions.set([2 * x - 1, (1 - 2 * y) * (height / width), 2 * state.get('depth') * heightOf(disparities[number]!, map.range)], 3 * i);
    });
    const texture = canvas('The picture on the relief');
    painter.paint(texture, width, height, pictureOfMap, { ...picture, ...map.uniforms(state, state.get('overlay')) });
    const png = new Uint8Array(await (await pngOf(texture)).arrayBuffer());
    const triangles = surface.triangles.map((number) => newNumber[number]!);
    return new Blob([glbOf({ positions, places, triangles, png })], { type: 'model/gltf-binary' });
  }

  private finestStep(): number {
    const [width, height] = this.map.size;
    return Math.ceil(Math.sqrt((width * height) / mostVertices));
  }

  private meshFor(step: number, leastConfidence: number): NonNullable<Relief['mesh']> {
    const version = `${this.map.version} ${this.map.range.join()} ${step} ${leastConfidence}`;
    if (this.mesh?.version === version) return this.mesh;
    const { painter } = this;
    const surface = surfaceOf(this.map, step, leastConfidence);
    const pairs = new Float32Array(2 * surface.disparities.length);
    surface.disparities.forEach((value, i) => (pairs[2 * i] = value));
    this.mesh = {
      surface,
      version,
      buffer: painter.indices(this.mesh?.buffer ?? null, surface.triangles),
      vertices: painter.pairs(this.mesh?.vertices ?? null, surface.columns, surface.rows, pairs),
    };
    return this.mesh;
  }

  close(): void {
    if (!this.mesh) return;
    this.painter.gl.deleteBuffer(this.mesh.buffer);
    this.painter.gl.deleteTexture(this.mesh.vertices);
  }
}

/** Returns the height over the middle of the range, in shares of the range, as the shader computes it. */
function heightOf(disparity: number, [near, far]: [number, number]): number {
  return clamp(((near + far) / 2 - disparity) / Math.max(far - near, 1e-6), -0.8, 0.8);
}

/** Returns the middle of what is shown of a turned relief and its magnification, so that nearly all of it is within the
 *  picture: 0, 0 and 1 where it fits anyway. Units are half the width and height of the flat relief. */
function fitted(surface: Surface, map: DisparityMap, [turn, tip]: [number, number], deep: number): [number, number, number] {
  const { columns, step, disparities, triangles } = surface;
  const [width, height] = map.size;
  const seen: [number[], number[]] = [[], []];
  const stride = 6 * Math.max(Math.ceil(triangles.length / (6 * mostPlacesToFit)), 1);
  for (let i = 0; i < triangles.length; i += stride) {
    const vertex = triangles[i]!;
    const x = ((2 * ((vertex % columns) + 0.5) * step) / width) - 1;
    const y = (1 - (2 * (Math.floor(vertex / columns) + 0.5) * step) / height) * (height / width);
    const z = 2 * deep * heightOf(disparities[vertex]!, map.range);
    // As in the shader.
    const [right, away] = [Math.cos(turn) * x + Math.sin(turn) * z, Math.cos(turn) * z - Math.sin(turn) * x];
    const [up, near] = [Math.cos(tip) * y + Math.sin(tip) * away, Math.cos(tip) * away - Math.sin(tip) * y];
    const w = (eye - near) / eye;
    seen[0].push(right / w);
    seen[1].push((up * width) / height / w);
  }
  // Single places at wrong disparities do not count.
  const ends = seen.map((values) => {
    values.sort((a, b) => a - b);
    const one = Math.floor(values.length / 400);
    return [values[one] ?? -1, values[values.length - 1 - one] ?? 1] as const;
  });
  const magnification = Math.min(1, ...ends.map(([least, most]) => 2 / Math.max(most - least, 1e-6)));
  const [x, y] = ends.map(([least, most]) => clamp(0, most - 1 / magnification, least + 1 / magnification));
  return [x!, y!, magnification];
}

const reliefVertices = `#version 300 es
precision highp float;
uniform highp sampler2D vertices;
uniform int columns;    // of vertices
uniform float spacing;  // px of the map from vertex to vertex
uniform vec2 size, overlayRange;
uniform vec3 shown;     // the middle of what is shown, and the magnification
uniform vec4 turned;    // sine and cosine of both angles
uniform float deep;
out vec2 at;            // px of the map
out float disparity;
out vec3 position;
void main() {
  ivec2 vertex = ivec2(gl_VertexID % columns, gl_VertexID / columns);
  disparity = texelFetch(vertices, vertex, 0).r;
  at = (vec2(vertex) + 0.5) * spacing;
  float range = max(overlayRange.y - overlayRange.x, 1e-6);
  float height = clamp(((overlayRange.x + overlayRange.y) * 0.5 - disparity) / range, -0.8, 0.8);
  vec3 p = vec3((at / size * 2.0 - 1.0) * vec2(1.0, -size.y / size.x), 2.0 * deep * height);
  p = vec3(turned.y * p.x + turned.x * p.z, p.y, turned.y * p.z - turned.x * p.x);
  p = vec3(p.x, turned.w * p.y + turned.z * p.z, turned.w * p.z - turned.z * p.y);
  position = p;
  const float eye = ${eye.toFixed(1)};
  float w = (eye - p.z) / eye;
  gl_Position = vec4(shown.z * (vec2(p.x, p.y * size.x / size.y) - shown.xy * w), -0.3 * p.z, w);
}`;

const reliefShader = `${disparityColours}in vec2 at;
in float disparity;
in vec3 position;
void main() {
  vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
  vec3 picture = shown(sampled(false, vec3(at / size, layer))).rgb;
  colour = vec4(mix(picture, (0.45 + 0.55 * abs(normal.z)) * colourOf(disparity), overlay), 1.0);
}`;
