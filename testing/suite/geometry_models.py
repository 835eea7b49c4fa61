"""geometry_models.py MODEL: writes depth.safetensors and layers.safetensors, small networks with the operations plane-sweep and
render-layers and random weights, with the patterns and constants of the model file MODEL of four patterns."""
import json
import struct
import sys

import numpy as np

content = open(sys.argv[1], "rb").read()
length = struct.unpack("<Q", content[:8])[0]
entries = json.loads(content[8:8 + length])
header = json.loads(entries["__metadata__"]["e2lf"])
begin, end = (8 + length + offset for offset in entries["aperture.codes"]["data_offsets"])
codes = np.frombuffer(content[begin:end], np.float32).reshape(entries["aperture.codes"]["shape"])


def conv(name, source, out, kernel=3, stride=1):
    return {"name": name, "op": "conv", "inputs": [source], "out_channels": out, "kernel": kernel, "stride": stride}


def write(name, layers, channels):
    rng, tensors = np.random.default_rng(5), {"aperture.codes": codes}
    for layer, inputs in zip(layers, channels):
        if layer["op"] == "conv":
            shape = (layer["out_channels"], inputs, layer["kernel"], layer["kernel"])
            tensors[layer["name"] + ".weight"] = (rng.standard_normal(shape) / np.sqrt(np.prod(shape[1:]))).astype(np.float32)
            tensors[layer["name"] + ".bias"] = rng.standard_normal(shape[0]).astype(np.float32) * 0.1
    description = {**header, "name": name, "network": {"type": "conv-graph", "input_channels": 12, "layers": layers}, "provenance": {}}
    for key in ("camera", "precision_loss"):
        description.pop(key, None)
    description["input"] = [{"kind": "counts", "scale": 0.125}, {"kind": "cumulative", "scale": 0.125}, {"kind": "level", "scale": 0.5},
                            {"kind": "intensity", "scale": 4.0}]
    text, offset = {"__metadata__": {"e2lf": json.dumps(description)}}, 0
    for key, value in sorted(tensors.items()):
        text[key] = {"dtype": "F32", "shape": value.shape, "data_offsets": [offset, offset + value.nbytes]}
        offset += value.nbytes
    text = json.dumps(text).encode()
    data = b"".join(np.ascontiguousarray(value).tobytes() for _, value in sorted(tensors.items()))
    open(name + ".safetensors", "wb").write(struct.pack("<Q", len(text)) + text + data)


sweep = [conv("features", "input", 6, 2, 2),
         {"name": "sweep", "op": "plane-sweep", "inputs": ["features"], "kernel": 5, "offsets": [-0.6, -1.3, 0.94, 0.94, -1.1, 1.0],
          "disparities": [-1.5, -0.5, 0.0, 0.8]}]
write("depth", [*sweep, conv("weighed", "sweep", 8), {"name": "output", "op": "pixel-shuffle", "inputs": ["weighed"], "stride": 2}],
      [12, 6, 4, 8])
viewpoints = [view - 3.5 for view in range(8)]
write("layers", [*sweep, conv("weighed", "sweep", 24), {"name": "planes", "op": "pixel-shuffle", "inputs": ["weighed"], "stride": 2},
                 {"name": "views", "op": "render-layers", "inputs": ["planes"], "disparities": [-1.5, 0.1, 0.9], "rows": viewpoints,
                  "columns": viewpoints}], [12, 6, 4, 24, 6])
