#!/usr/bin/env python3
"""Small inputs for the command-line cases: make_inputs.py KIND PATH [key=value ...]

  events PATH.npz [transitions=3 height=24 width=32 cycles=1 nan=0]   event images drawn at random
  triple DIR      [transitions=3 height=24 width=32]                  event_image_0000K.npy as the paper's software writes them
  release DIR     [width=64 transpose=0]                              random weights named and shaped like the paper's release
  firenet PATH.safetensors                                            random weights named and shaped like FireNet+
"""
import json
import pathlib
import sys

import numpy as np


def make_events(path, transitions=3, height=24, width=32, cycles=1, nan=0):
    events = np.random.default_rng(1).integers(-2, 7, (cycles, transitions, height, width))
    if nan:
        events = events.astype(np.float32)
        events[0, 0, 3, 4] = np.nan
        np.savez(path, events=events)
    else:
        np.savez(path, events=events.astype(np.int16))


def make_triple(folder, transitions=3, height=24, width=32):
    pathlib.Path(folder).mkdir()
    rng = np.random.default_rng(1)
    for k in range(transitions):
        image = rng.integers(-2, 7, (height, width, 1)).astype(np.int32)
        np.save(f"{folder}/event_image_{k:05d}.npy", image)


def write_safetensors(path, tensors):
    header, data = {}, b""
    for name, array in tensors.items():
        kind = {"float32": "F32", "uint8": "U8"}[str(array.dtype)]
        header[name] = {"dtype": kind, "shape": list(array.shape), "data_offsets": [len(data), len(data) + array.nbytes]}
        data += array.tobytes()
    text = json.dumps(header).encode()
    pathlib.Path(path).write_bytes(len(text).to_bytes(8, "little") + text + data)


def make_release(folder, width=64, transpose=0):
    pathlib.Path(folder).mkdir()
    rng = np.random.default_rng(2)
    shapes = {"conv1": (width, 3, 5, 5), "conv2": (width, width, 5, 5), "conv3": (64, width, 5, 5)}
    shapes |= {f"l{i}": (64, 64, 3, 3) for i in range(1, 21)}
    tensors = {}
    for name, shape in shapes.items():
        if transpose:
            shape = shape[::-1]
        tensors[f"{name}.weight"] = rng.normal(0, 0.4 / np.sqrt(np.prod(shape[1:])), shape).astype(np.float32)
        tensors[f"{name}.bias"] = np.zeros(shape[0], np.float32)
    write_safetensors(f"{folder}/RecNet.safetensors", tensors)
    codes = (rng.random((4, 64)) < 0.15).astype(np.float32)
    codes[0] = 0
    write_safetensors(f"{folder}/AcqNet.safetensors", {"param": np.zeros((64, 3), np.float32), "mask_4x64": codes})


def make_firenet(path):
    rng = np.random.default_rng(3)
    tensors = {}

    def conv(name, inputs, outputs, kernel):
        tensors[f"{name}.weight"] = rng.normal(0, 1 / np.sqrt(inputs * kernel**2),
                                               (outputs, inputs, kernel, kernel)).astype(np.float32)
        tensors[f"{name}.bias"] = rng.normal(0, 0.1, outputs).astype(np.float32)

    conv("head.conv2d", 5, 16, 3)
    for number in "12":
        for gate in ("reset_gate", "update_gate", "out_gate"):
            conv(f"G{number}.{gate}", 32, 16, 3)
        for part in "12":
            conv(f"R{number}.conv{part}", 16, 16, 3)
    conv("pred.conv2d", 16, 1, 1)
    write_safetensors(path, tensors)


def main():
    kind, path, *rest = sys.argv[1:]
    options = {key: int(value) for key, value in (pair.split("=") for pair in rest)}
    {"events": make_events, "triple": make_triple, "release": make_release,
     "firenet": make_firenet}[kind](path, **options)


if __name__ == "__main__":
    main()
