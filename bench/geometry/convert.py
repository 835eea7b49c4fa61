"""Makes a model file of e2lf from a network that train.py of revision c8f7355f trained for fixed patterns.

usage: convert.py NETWORK.pt MODEL NAME OUT.safetensors [KEY=VALUE...]
MODEL is a bundled model for the same patterns and, if the network is conditioned on the camera, for cameras: the result has its
patterns, camera and constants. KEY=VALUE is added to the provenance. Requires torch.
"""
import json
import pathlib
import struct
import sys

import numpy as np
import torch

INPUTS = [{"kind": "counts", "scale": 0.125}, {"kind": "cumulative", "scale": 0.125}, {"kind": "level", "scale": 0.125},
          {"kind": "intensity", "scale": 4.0}]


def read_model(path):
    """Returns the header of a model file and its tensors as float32."""
    content = pathlib.Path(path).read_bytes()
    length = struct.unpack("<Q", content[:8])[0]
    entries = json.loads(content[8:8 + length])
    header = json.loads(entries.pop("__metadata__")["e2lf"])
    tensors = {}
    for name, entry in entries.items():
        begin, end = (8 + length + offset for offset in entry["data_offsets"])
        bits = np.frombuffer(content[begin:end], np.uint16 if entry["dtype"] == "BF16" else np.float32)
        values = (bits.astype(np.uint32) << 16).view(np.float32) if entry["dtype"] == "BF16" else bits.copy()
        tensors[name] = values.reshape(entry["shape"])
    tensors.update((name, tensors[source]) for name, source in header.pop("shared_weights", {}).items())
    return header, tensors


def file_layers(layers):
    """Returns layers as model files have them, with lists of numbers as attributes."""
    result = []
    for layer in layers:
        layer = {key: value for key, value in layer.items() if value not in (False, "")}
        if layer["op"] == "plane-sweep":
            layer["offsets"] = [position for offset in layer["offsets"] for position in offset]
        result.append(layer)
    return result


def prefixed(layers, prefix, source="input"):
    """Returns a copy of layers whose names have a prefix, and whose input is `source`."""
    renamed = lambda name: source if name == "input" else prefix + name
    result = [layer | {"name": renamed(layer["name"]), "inputs": [renamed(name) for name in layer["inputs"]]} for layer in layers]
    for layer in result:
        if layer.get("residual"):
            layer["residual"] = renamed(layer["residual"])
    return result


def write(path, header, tensors):
    """Writes a .safetensors file; tensors are arrays by name, which it stores as float32."""
    entries, offset = {"__metadata__": {"e2lf": json.dumps(header)}}, 0
    stored = {name: np.ascontiguousarray(values, np.float32) for name, values in sorted(tensors.items())}
    for name, values in stored.items():
        entries[name] = {"dtype": "F32", "shape": list(values.shape), "data_offsets": [offset, offset + values.nbytes]}
        offset += values.nbytes
    text = json.dumps(entries).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + b"".join(values.tobytes() for values in stored.values()))


def main():
    network, model, name, out = sys.argv[1:5]
    trained = torch.load(network, map_location="cpu")
    header, of_model = read_model(model)
    if header["num_patterns"] != trained["num_patterns"]:
        sys.exit(f"{network} is for {trained['num_patterns']} patterns, and {model} for {header['num_patterns']}")
    channels = trained["weights"]["pictures/weight"].shape[1]
    is_conditioned = channels > 4 * (trained["num_patterns"] - 1)
    header.pop("precision_loss", None)
    if not is_conditioned:
        header.pop("camera", None)
    header.update(name=name, input=INPUTS + ([{"kind": "camera", "scale": 1.0}] if is_conditioned else []),
                  network={"type": "conv-graph", "input_channels": channels, "layers": file_layers(trained["layers"])},
                  provenance={"trained_by": "bench/geometry/train.py", **dict(pair.split("=", 1) for pair in sys.argv[5:])})
    tensors = {key.replace("/", "."): weight.float().numpy() for key, weight in trained["weights"].items()}
    tensors.update((key, values) for key, values in of_model.items() if key == "aperture.codes")  # some models leave them to the user
    write(pathlib.Path(out), header, tensors)


if __name__ == "__main__":
    main()
