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
        bits = np.frombuffer(content[begin:end], {"BF16": np.uint16, "F16": np.float16, "F32": np.float32}[entry["dtype"]])
        values = (bits.astype(np.uint32) << 16).view(np.float32) if entry["dtype"] == "BF16" else bits.astype(np.float32)
        tensors[name] = values.reshape(entry["shape"])
    tensors.update((name, tensors[source]) for name, source in header.pop("shared_weights", {}).items())
    return header, tensors


def write(path, header, tensors, is_half=False):
    """Writes a .safetensors file; tensors are arrays by name, which it stores as float32, or as bfloat16 if `is_half`."""
    entries, blobs, offset = {"__metadata__": {"e2lf": json.dumps(header)}}, [], 0
    for name, values in sorted(tensors.items()):
        values = np.ascontiguousarray(values, np.float32)
        if is_half:
            bits = values.view(np.uint32)
            values = ((bits + 0x7FFF + ((bits >> 16) & 1)) >> 16).astype(np.uint16)  # to the nearest, ties to even
        blobs.append(values.tobytes())
        entries[name] = {"dtype": "BF16" if is_half else "F32", "shape": list(values.shape), "data_offsets": [offset, offset + len(blobs[-1])]}
        offset += len(blobs[-1])
    text = json.dumps(entries).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + b"".join(blobs))
