"""Makes of a network for disparity one that works at two scales: the result is the weighted mean of its disparities for the events and
for their means over 2x2 pixels, which have half of the noise and of the disparity.

usage: scales.py DEPTH SHARE NAME OUT.safetensors
DEPTH is a model file of one scale that is conditioned on a camera, and SHARE the weight of the full scale, from 0 to 1. `e2lf model store`
then checks the precisions. Requires torch.
"""
import math
import pathlib
import sys

import numpy as np

import model_files
from sensor import CYCLES_CONDITION, CYCLES_STEP

HALF = "half_"


def halving(header):
    """Returns the weight and bias of the mean over 2x2 pixels, which is like one over four cycles."""
    channels, transitions = header["network"]["input_channels"], header["num_patterns"] - 1
    of_events = transitions * sum(group["kind"] != "camera" for group in header["input"])
    weight, bias = np.zeros((channels, channels, 2, 2)), np.zeros(channels)
    weight[range(channels), range(channels)] = 1 / 4
    bias[of_events + CYCLES_CONDITION] = CYCLES_STEP * 2
    return weight, bias


def mean(share):
    """Returns the weight and bias of the mean of four subpixels of the disparity and of the logarithm of its scale, and of both at half the
    size."""
    weight, bias = np.zeros((8, 10, 1, 1)), np.zeros(8)
    weight[range(8), range(8)] = share
    weight[:4, 8] = (1 - share) * 2
    weight[4:, 9], bias[4:] = 1 - share, (1 - share) * math.log(2)
    return weight, bias


def main():
    header, tensors = model_files.read_model(sys.argv[1])
    share, name, out = float(sys.argv[2]), sys.argv[3], sys.argv[4]
    if header["input"][-1]["kind"] != "camera" or HALF + "input.weight" in tensors:
        sys.exit(f"{sys.argv[1]} has two scales already or is not conditioned on a camera; give one of a single scale that is conditioned")
    channels = header["network"]["input_channels"]
    *layers, shuffle = header["network"]["layers"]
    head = layers[-1]["name"]
    half = model_files.prefixed([*layers, shuffle], HALF, HALF + "input")
    header["network"]["layers"] = [
        *layers, {"name": HALF + "input", "op": "conv", "inputs": ["input"], "out_channels": channels, "kernel": 2, "stride": 2}, *half,
        {"name": "both", "op": "concat", "inputs": [head, half[-1]["name"]]},
        {"name": "mean", "op": "conv", "inputs": ["both"], "out_channels": 8, "kernel": 1}, shuffle | {"inputs": ["mean"]}]
    tensors.update({HALF + key: values for key, values in tensors.items() if not key.startswith("aperture.")})
    tensors[HALF + "input.weight"], tensors[HALF + "input.bias"] = halving(header)
    tensors["mean.weight"], tensors["mean.bias"] = mean(share)
    header["provenance"]["share_of_full_scale"] = str(share)
    header.pop("precision_loss", None)
    header["name"] = name
    model_files.write(pathlib.Path(out), header, tensors)


if __name__ == "__main__":
    main()
