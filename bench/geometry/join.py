"""Joins two networks for the same patterns into one, whose views are the weighted mean of theirs.

usage: join.py GEOMETRY OTHER SHARE NAME OUT.safetensors
GEOMETRY is a model file that ends in the operation render-layers, OTHER one that ends in a convolution, and SHARE the weight of
GEOMETRY, from 0 to 1. If OTHER is not conditioned on a camera, neither is the result: the conditioning vector of the paper's event
model becomes a part of GEOMETRY's weights. `e2lf model store` then checks the precisions. Requires torch.
"""
import pathlib
import sys

import numpy as np
import torch

import convert
import sensor

OTHER = "other_"


def fold_conditioning(header, tensors, values):
    """Replaces the last input channels, which have these values at all pixels, by a channel of ones, which the network makes itself.
    Zeros beside the image stay zeros, so that the network is the same but for rounding."""
    network = header["network"]
    first = network["input_channels"] - len(values)
    strides = {"input": 1}
    for layer in network["layers"]:
        source = layer["inputs"][0]
        if source not in strides:
            continue
        layer["inputs"][0] = "known" if source == "input" else source
        if layer["op"] == "pixel-unshuffle":
            strides[layer["name"]] = layer["stride"]
        else:
            key, each = layer["name"] + ".weight", strides[source] ** 2
            weight = tensors[key]
            folded = weight[:, first * each:].reshape(len(weight), len(values), each, *weight.shape[2:])
            tensors[key] = np.concatenate([weight[:, :first * each], np.einsum("ocsyx,c->osyx", folded, values)], 1)
    network["layers"][:0] = [{"name": "one", "op": "conv", "inputs": ["input"], "out_channels": 1, "kernel": 1},
                             {"name": "known", "op": "concat", "inputs": ["input", "one"]}]
    tensors.update({"one.weight": np.zeros((1, first, 1, 1), np.float32), "one.bias": np.ones(1, np.float32)})
    network["input_channels"] = first
    header["input"].pop()
    header.pop("camera")


def insert_level(header, tensors):
    """Gives a network for counts, cumulative counts and intensities the input `level`, which it does not use."""
    network, transitions = header["network"], header["num_patterns"] - 1
    pixels = {"input": 1}  # that became channels of each input
    for layer in network["layers"]:
        source = layer["inputs"][0]
        if source in pixels and layer["op"] == "pixel-unshuffle":
            pixels[layer["name"]] = pixels[source] * layer["stride"] ** 2
        elif source in pixels:
            key, group = layer["name"] + ".weight", transitions * pixels[source]
            tensors[key] = np.insert(tensors[key], [2 * group] * group, 0, axis=1)
    network["input_channels"] += transitions
    header["input"].insert(2, convert.INPUTS[2])


def scale_views(header, tensors, share):
    """Multiplies the views by `share`: the convolutions that make the output, or the intensities of the layers (their second half)."""
    layers = {layer["name"]: layer for layer in header["network"]["layers"]}
    last = header["network"]["layers"][-1]
    is_layered = last["op"] == "render-layers"
    name = last["inputs"][0] if is_layered else last["name"]
    for part in (name, layers[name]["residual"]):
        for key in (part + ".weight", part + ".bias"):
            rows = slice(len(tensors[key]) // 2, None) if is_layered else slice(None)
            tensors[key] = tensors[key].copy()
            tensors[key][rows] *= share


def main():
    (header, tensors), (other, other_tensors) = convert.read_model(sys.argv[1]), convert.read_model(sys.argv[2])
    share, name, out = float(sys.argv[3]), sys.argv[4], sys.argv[5]
    np.testing.assert_array_equal(tensors["aperture.codes"], other_tensors.pop("aperture.codes"))
    if header["input"][-1]["kind"] == "camera" and other["input"][-1]["kind"] != "camera":
        paper = sensor.Conditions(1, np.random.default_rng(0), torch.device("cpu"), stated=True)
        fold_conditioning(header, tensors, paper.conditioning(header["num_patterns"], 1)[0].numpy())
    if convert.INPUTS[2] in header["input"] and convert.INPUTS[2] not in other["input"]:
        insert_level(other, other_tensors)
    if other["input"] != header["input"]:
        sys.exit(f"{sys.argv[2]} has other inputs than {sys.argv[1]}")
    scale_views(header, tensors, share)
    scale_views(other, other_tensors, 1 - share)
    layers = header["network"]["layers"]
    joined = layers + convert.prefixed(other["network"]["layers"], OTHER)
    joined.append({"name": "mean", "op": "add", "inputs": [layers[-1]["name"], joined[-1]["name"]]})
    header["network"]["layers"] = joined
    header["provenance"].update(joined_with=other["name"], share=str(share))
    header.pop("precision_loss", None)
    header["name"] = name
    tensors.update({OTHER + key: value for key, value in other_tensors.items()})
    convert.write(pathlib.Path(out), header, tensors)


if __name__ == "__main__":
    main()
