"""Stores a network of train.py as a model file for any patterns, which works at two scales.

usage: store.py E2LF NETWORK.pt TEMPLATE PATTERNS SHARE NAME OUT.safetensors SCENE ...
E2LF is the program, TEMPLATE the model file of e2lf-n4-depth, whose layers the network has, PATTERNS those to which the stored weights are
adapted until others are given, SHARE the weight of the full scale, from 0 to 1, and SCENE light fields on which the loss of faster arithmetic
is measured. Requires torch.
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np
import torch

import model_files

DEPENDENT = ("stem", "pictures", "features", "weigh.weight")  # layers whose weights depend on the patterns


def without_adapted_weights(network, template, name):
    """Returns the header and the tensors of a model whose weights that depend on the patterns are 0."""
    weights = {key.replace("/", "."): value.float().numpy() for key, value in torch.load(network, map_location="cpu")["weights"].items()}
    header, tensors = model_files.read_model(template)
    header["name"], header["input"] = name, [group for group in header["input"] if group["kind"] != "counts"]
    channels = 4 * (header["num_patterns"] - 1) + 15
    header["network"]["input_channels"] = channels
    for key, old in tensors.items():
        if key in ("stem.weight", "pictures.weight"):
            tensors[key] = np.zeros((len(old), channels, *old.shape[2:]))
        elif key.startswith(DEPENDENT):
            tensors[key] = np.zeros(old.shape)
        elif key in weights:
            tensors[key] = weights[key]
    tensors.update({"any." + key: value for key, value in weights.items() if key.startswith(DEPENDENT)})
    for key in ("precision_loss", "share_of_full_scale"):
        header.pop(key, None)
    header["provenance"] = {"script": "bench/geometry/train.py"}
    return header, tensors


def header_of(content):
    length = struct.unpack("<Q", content[:8])[0]
    entries = json.loads(content[8:8 + length])
    return entries, json.loads(entries["__metadata__"]["e2lf"]), content[8 + length:]


def state(path, **fields):
    """Adds fields to the header of a model file."""
    entries, header, tensors = header_of(path.read_bytes())
    entries["__metadata__"]["e2lf"] = json.dumps(header | fields)
    text = json.dumps(entries).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + tensors)


def main():
    e2lf, network, template, patterns, share, name, out, *scenes = sys.argv[1:]
    store, out = [e2lf, "model", "store", "--quiet"], pathlib.Path(out)
    with tempfile.TemporaryDirectory() as folder:
        raw, adapted, checked = (pathlib.Path(folder) / (name + ".safetensors") for name in ("raw", "adapted", "checked"))
        model_files.write(raw, *without_adapted_weights(network, template, name))
        subprocess.run([*store, raw, "--codes", patterns, "-o", adapted], check=True)
        state(adapted, share_of_full_scale=float(share))
        if scenes:
            subprocess.run([*store, adapted, "--check", *scenes, "-o", checked], check=True)
            state(adapted, precision_loss=header_of(checked.read_bytes())[1]["precision_loss"])
        out.write_bytes(adapted.read_bytes())


if __name__ == "__main__":
    main()
