// A textured surface as a binary glTF 2.0 file, which Blender and most viewers of 3-D models read.

export interface TexturedMesh {
  positions: Float32Array; // x (right), y (up), z (towards the viewer)
  places: Float32Array; // in the picture: x, y in 0..1 from the left top corner
  triangles: Uint32Array; // numbers of vertices, counterclockwise from the front
  png: Uint8Array;
}

const padded = (length: number): number => 4 * Math.ceil(length / 4);

export function glbOf({ positions, places, triangles, png }: TexturedMesh): Uint8Array {
  const parts = [positions, places, triangles, png].map((part) => new Uint8Array(part.buffer, part.byteOffset, part.byteLength));
  const starts = parts.map((_, i) => parts.slice(0, i).reduce((sum, part) => sum + padded(part.length), 0));
  const numBytes = starts.at(-1)! + padded(png.length);
  const least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    least[i % 3] = Math.min(least[i % 3]!, value);
    most[i % 3] = Math.max(most[i % 3]!, value);
  });
  const [float, uint32, arrayBuffer, indexBuffer] = [5126, 5125, 34962, 34963];
  const description = {
    asset: { version: '2.0', generator: 'e2lf' },
    extensionsUsed: ['KHR_materials_unlit'],
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'relief' }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{
      pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicFactor: 0, roughnessFactor: 1 },
      doubleSided: true,
      extensions: { KHR_materials_unlit: {} },
    }],
    textures: [{ source: 0 }],
    images: [{ bufferView: 3, mimeType: 'image/png' }],
    accessors: [
      { bufferView: 0, componentType: float, count: positions.length / 3, type: 'VEC3', min: least, max: most },
      { bufferView: 1, componentType: float, count: places.length / 2, type: 'VEC2' },
      { bufferView: 2, componentType: uint32, count: triangles.length, type: 'SCALAR' },
    ],
    bufferViews: parts.map((part, i) => ({
      buffer: 0, byteOffset: starts[i], byteLength: part.length, ...(i < 3 && { target: i === 2 ? indexBuffer : arrayBuffer }),
    })),
    buffers: [{ byteLength: numBytes }],
  };
  const text = new TextEncoder().encode(JSON.stringify(description));
  const numText = padded(text.length);
  const file = new Uint8Array(12 + 8 + numText + 8 + numBytes);
  const view = new DataView(file.buffer);
  const words = (at: number, ...values: number[]) => values.forEach((value, i) => view.setUint32(at + 4 * i, value, true));
  const [glTF, json, bin] = [0x46546c67, 0x4e4f534a, 0x004e4942];
  words(0, glTF, 2, file.length, numText, json);
  file.fill(0x20, 20, 20 + numText);
  file.set(text, 20);
  words(20 + numText, numBytes, bin);
  parts.forEach((part, i) => file.set(part, 28 + numText + starts[i]!));
  return file;
}
