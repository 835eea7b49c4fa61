#!/usr/bin/env python3
"""Small inputs for the command-line cases: make_inputs.py KIND PATH [key=value ...]

  events PATH.npz [transitions=3 height=24 width=32 cycles=1 nan=0]   event images drawn at random
  triple DIR      [transitions=3 height=24 width=32]                  event_image_0000K.npy as the paper's software writes them
  release DIR     [width=64 transpose=0]                              random weights named and shaped like the paper's release
  firenet PATH.safetensors                                            random weights named and shaped like FireNet+
  etnet PATH.safetensors [channels=32]                                random weights named and shaped like ET-Net, channels of its head
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


class Checkpoint:
    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)
        self.tensors = {}

    def layer(self, name, inputs, outputs, *kernel, end="."):
        scale = 1 / np.sqrt(inputs * np.prod(kernel, dtype=int))
        self.tensors[f"{name}{end}weight"] = self.rng.normal(0, scale, (outputs, inputs, *kernel)).astype(np.float32)
        self.tensors[f"{name}{end}bias"] = self.rng.normal(0, 0.1, outputs).astype(np.float32)

    def conv(self, name, inputs, outputs, kernel):
        self.layer(name, inputs, outputs, kernel, kernel)

    def norm(self, name, channels):
        self.tensors[f"{name}.weight"] = np.ones(channels, np.float32)
        self.tensors[f"{name}.bias"] = np.zeros(channels, np.float32)


def make_firenet(path):
    made = Checkpoint(3)
    conv = made.conv
    conv("head.conv2d", 5, 16, 3)
    for number in "12":
        for gate in ("reset_gate", "update_gate", "out_gate"):
            conv(f"G{number}.{gate}", 32, 16, 3)
        for part in "12":
            conv(f"R{number}.conv{part}", 16, 16, 3)
    conv("pred.conv2d", 16, 1, 1)
    write_safetensors(path, made.tensors)


def make_etnet(path, channels=32):
    made = Checkpoint(4)
    size = 8 * channels
    made.conv("head.conv2d", 5, channels, 5)
    for i in range(3):
        key = f"DownsampleConv.{i}"
        made.conv(f"{key}.conv.conv2d", channels << i, channels << i + 1, 5)
        made.conv(f"{key}.recurrent_block.Gates", channels << i + 2, channels << i + 3, 3)
        made.conv(f"UpsampleConv.{i}.conv2d", size >> i, size >> i + 1, 5)
    made.conv("split1", 4 * channels, size, 2)
    made.conv("split2", 2 * channels, size, 4)
    kinds = (("encoder", 3, ["self_attn"], ["norm1", "norm2"]),
             ("decoder", 2, ["self_attn", "cross_attn"], ["norm1", "norm21", "norm22", "norm3"]))
    for kind, layers, attentions, norms in kinds:
        for key in (f"trans_{kind}{scale}.{kind}.layers.{i}" for scale in range(3) for i in range(layers)):
            for name in attentions:
                made.layer(f"{key}.{name}.in_proj", size, 3 * size, end="_")
                made.layer(f"{key}.{name}.out_proj", size, size)
            made.layer(f"{key}.linear1", size, 4 * size)
            made.layer(f"{key}.linear2", 4 * size, size)
            for name in norms:
                made.norm(f"{key}.{name}", size)
    made.conv("pred.conv2d", channels, 1, 1)
    write_safetensors(path, made.tensors)


def main():
    kind, path, *rest = sys.argv[1:]
    options = {key: int(value) for key, value in (pair.split("=") for pair in rest)}
    {"events": make_events, "triple": make_triple, "release": make_release,
     "firenet": make_firenet, "etnet": make_etnet}[kind](path, **options)


if __name__ == "__main__":
    main()
