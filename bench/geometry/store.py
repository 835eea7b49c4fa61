"""Stores a network of train.py as a model file for any patterns, at two scales as e2lf-n4-depth, whose layers it takes.

usage: store.py NETWORK.pt TEMPLATE SHARE NAME OUT.safetensors
TEMPLATE is the model file of e2lf-n4-depth, and SHARE the weight of the full scale, from 0 to 1. The weights that depend on the patterns are
0 until `e2lf model store --codes PATTERNS` makes them. Requires torch.
"""
import math
import pathlib
import sys

import numpy as np
import torch

import model_files

HALF = "half_"
DEPENDENT = ("stem", "pictures", "features", "weigh.weight")  # layers whose weights depend on the patterns


def mean(share):
    """Returns the weight and bias of the mean of four subpixels of the disparity and of the logarithm of its scale, and of both at half the
    size."""
    weight, bias = np.zeros((8, 10, 1, 1)), np.zeros(8)
    weight[range(8), range(8)] = share
    weight[:4, 8] = (1 - share) * 2
    weight[4:, 9], bias[4:] = 1 - share, (1 - share) * math.log(2)
    return weight, bias


def main():
    network, template, share, name, out = sys.argv[1:]
    weights = {key.replace("/", "."): value.float().numpy() for key, value in torch.load(network, map_location="cpu")["weights"].items()}
    header, tensors = model_files.read_model(template)
    header["name"], header["input"] = name, [group for group in header["input"] if group["kind"] != "counts"]
    channels = 4 * (header["num_patterns"] - 1) + 15
    header["network"]["input_channels"] = channels
    for layer in header["network"]["layers"]:
        if layer["name"] == HALF + "input":
            layer["out_channels"] = channels
    for key in list(tensors):
        plain = key.removeprefix(HALF)
        if plain.startswith(DEPENDENT):
            weight = tensors[key]
            tensors[key] = np.zeros((weight.shape[0], channels, *weight.shape[2:]) if plain in ("stem.weight", "pictures.weight") else weight.shape)
        elif plain in weights:
            tensors[key] = weights[plain]
    tensors[HALF + "input.weight"], tensors[HALF + "input.bias"] = np.zeros((channels, channels, 2, 2)), np.zeros(channels)
    tensors["mean.weight"], tensors["mean.bias"] = mean(float(share))
    tensors.update({"any." + key: value for key, value in weights.items() if key.startswith(DEPENDENT)})
    header.pop("precision_loss", None)
    header["provenance"] = {"script": "bench/geometry/train.py", "share_of_full_scale": share}
    model_files.write(pathlib.Path(out), header, tensors)


if __name__ == "__main__":
    main()
