// Draws with WebGL 2 off screen and copies the results to canvases of the page.
import { vertexShader } from './shaders';

export type Uniform = number | boolean | number[] | WebGLTexture;

/** An array of pictures of one size on the graphics card, with 8 bits per channel, grey or colour. */
export interface Pictures {
  texture: WebGLTexture;
  isGrey: boolean;
}

/** Triangles in place of one that covers everything. */
export interface Mesh {
  vertex: string; // the shader of their vertices
  buffer: WebGLBuffer; // the numbers of their vertices: indices()
  count: number; // of these numbers
  ground: number[]; // the colour beside them, in 0..1
}

const wholePicture = [0, 0, 1, 1];

interface Program {
  program: WebGLProgram;
  types: Map<string, { at: WebGLUniformLocation; type: number; unit: number }>;
}

export class Painter {
  readonly gl: WebGL2RenderingContext;
  private readonly canvas = document.createElement('canvas');
  private readonly programs = new Map<string, Program>();

  constructor() {
    const gl = this.canvas.getContext('webgl2', { alpha: false, antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error('This browser has no WebGL 2; use another one, or enable its graphics acceleration.');
    this.gl = gl;
    gl.bindVertexArray(gl.createVertexArray());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  }

  /** Allocates `count` pictures, which are black until put() sets them. */
  pictures(width: number, height: number, count: number, isGrey: boolean): Pictures {
    const gl = this.gl;
    const side = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
    const layers = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS) as number;
    if (Math.max(width, height) > side || count > layers) {
      throw new Error(`This browser supports at most ${layers} views of ${side} px; show fewer with --views or --step.`);
    }
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, isGrey ? gl.R8 : gl.RGBA8, width, height, count);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) {
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, name, gl.CLAMP_TO_EDGE);
    }
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, name, gl.LINEAR);
    }
    return { texture, isGrey };
  }

  /** Sets the only picture of an array to grey bytes [y, x]. */
  putGrey(pictures: Pictures, width: number, height: number, grey: Uint8Array): void {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, pictures.texture);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, 0, width, height, 1, gl.RED, gl.UNSIGNED_BYTE, grey);
  }

  put(pictures: Pictures, number: number, bitmap: ImageBitmap): void {
    const gl = this.gl;
    const format = pictures.isGrey ? gl.RED : gl.RGBA;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, pictures.texture);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, number, bitmap.width, bitmap.height, 1, format, gl.UNSIGNED_BYTE, bitmap);
  }

  /** Uploads a table of float32 in rows of 4 for texelFetch; replaces the content of `table`. */
  table(table: WebGLTexture | null, rows: Float32Array): WebGLTexture {
    const gl = this.gl;
    const made = table ?? gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, rows.length / 4, 1, 0, gl.RGBA, gl.FLOAT, rows);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  }

  /** Uploads two float32 per pixel for texelFetch; replaces the content of `table`. */
  pairs(table: WebGLTexture | null, width: number, height: number, values: Float32Array): WebGLTexture {
    const gl = this.gl;
    const made = table ?? gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, width, height, 0, gl.RG, gl.FLOAT, values);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  }

  /** Uploads the numbers of the vertices of a mesh; replaces the content of `buffer`. */
  indices(buffer: WebGLBuffer | null, numbers: Uint32Array): WebGLBuffer {
    const gl = this.gl;
    const made = buffer ?? gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    return made;
  }

  /** Runs a program on width x height pixels and copies the picture to `target`, which is resized. */
  paint(target: HTMLCanvasElement, width: number, height: number, shader: string, values: Record<string, Uniform>, mesh?: Mesh): void {
    this.run(width, height, shader, values, mesh);
    if (target.width !== width || target.height !== height) {
      target.width = width;
      target.height = height;
    }
    const top = this.canvas.height - height;
    target.getContext('2d')!.drawImage(this.canvas, 0, top, width, height, 0, 0, width, height);
  }

  /** Runs a program and returns the RGBA bytes, bottom row first. */
  read(width: number, height: number, shader: string, values: Record<string, Uniform>): Uint8Array {
    this.run(width, height, shader, values);
    const bytes = new Uint8Array(4 * width * height);
    this.gl.readPixels(0, 0, width, height, this.gl.RGBA, this.gl.UNSIGNED_BYTE, bytes);
    return bytes;
  }

  /** Waits until all drawing is complete, for measurements. */
  finish(): void {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  private run(width: number, height: number, shader: string, values: Record<string, Uniform>, mesh?: Mesh): void {
    const gl = this.gl;
    if (gl.isContextLost()) throw new Error('The graphics card was reset; reload the page.');
    // The canvas never shrinks, because a new size costs more than a picture.
    if (this.canvas.width < width) this.canvas.width = width;
    if (this.canvas.height < height) this.canvas.height = height;
    const { program, types } = this.program(shader, mesh?.vertex ?? vertexShader);
    gl.useProgram(program);
    gl.viewport(0, 0, width, height);
    for (const [name, value] of Object.entries({ part: wholePicture, ...values })) {
      const uniform = types.get(name);
      if (uniform) this.setUniform(uniform, value);
    }
    if (mesh) {
      gl.enable(gl.DEPTH_TEST);
      gl.clearColor(mesh.ground[0]!, mesh.ground[1]!, mesh.ground[2]!, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    }
    if (mesh) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.buffer);
      gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    } else {
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    gl.disable(gl.DEPTH_TEST);
  }

  private setUniform(uniform: { at: WebGLUniformLocation; type: number; unit: number }, value: Uniform): void {
    const gl = this.gl;
    switch (uniform.type) {
      case gl.FLOAT: gl.uniform1f(uniform.at, value as number); break;
      case gl.FLOAT_VEC2: gl.uniform2fv(uniform.at, value as number[]); break;
      case gl.FLOAT_VEC3: gl.uniform3fv(uniform.at, value as number[]); break;
      case gl.FLOAT_VEC4: gl.uniform4fv(uniform.at, value as number[]); break;
      case gl.INT: case gl.BOOL: gl.uniform1i(uniform.at, Number(value)); break;
      case gl.SAMPLER_2D: case gl.SAMPLER_2D_ARRAY:
        gl.activeTexture(gl.TEXTURE0 + uniform.unit);
        gl.bindTexture(uniform.type === gl.SAMPLER_2D ? gl.TEXTURE_2D : gl.TEXTURE_2D_ARRAY, value as WebGLTexture);
        gl.uniform1i(uniform.at, uniform.unit);
        break;
      default: throw new Error(`uniform of an unexpected type ${uniform.type}`);
    }
  }

  private program(shader: string, vertex: string): Program {
    const known = this.programs.get(shader);
    if (known) return known;
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, shader]] as const) {
      const part = gl.createShader(type)!;
      gl.shaderSource(part, text);
      gl.compileShader(part);
      gl.attachShader(program, part);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      const logs = gl.getAttachedShaders(program)!.map((part) => gl.getShaderInfoLog(part));
      throw new Error(`The graphics card rejected a program: ${logs.join(' ')} ${gl.getProgramInfoLog(program)}`);
    }
    const types: Program['types'] = new Map();
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) as number;
    let units = 0;
    for (let i = 0; i < count; ++i) {
      const info = gl.getActiveUniform(program, i)!;
      const isSampler = info.type === gl.SAMPLER_2D || info.type === gl.SAMPLER_2D_ARRAY;
      types.set(info.name, { at: gl.getUniformLocation(program, info.name)!, type: info.type, unit: isSampler ? units++ : 0 });
    }
    const made = { program, types };
    this.programs.set(shader, made);
    return made;
  }
}
