"""Reads and writes model files for the scripts of this folder."""
import json
import pathlib
import struct

import numpy as np


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
