// node run.mjs MODEL.onnx INPUTS.json VIEWS.f32: runs an exported model in ONNX Runtime. INPUTS.json says for each input
// its shape and the file of its float32 values; the output is written as float32, its shape is printed.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

// The package lies in the build folder, which ONNX_PACKAGES names.
const { InferenceSession, Tensor } = createRequire(resolve(process.env.ONNX_PACKAGES, 'package.json'))('onnxruntime-node');

const [model, inputs, output] = process.argv.slice(2);
const feeds = {};
for (const [name, { shape, file }] of Object.entries(JSON.parse(readFileSync(inputs, 'utf8')))) {
  const bytes = readFileSync(file);
  feeds[name] = new Tensor('float32', new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4), shape);
}
const session = await InferenceSession.create(model, { intraOpNumThreads: 1, logSeverityLevel: 2 });
const [{ data, dims }] = Object.values(await session.run(feeds));
writeFileSync(output, Buffer.from(data.buffer, data.byteOffset, data.byteLength));
console.log(JSON.stringify({ inputs: session.inputNames, outputs: session.outputNames, shape: dims }));
