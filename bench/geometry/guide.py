"""Makes a network for light fields follow a network for disparity where the picture has no more than weak texture: there, its parallax
collapses towards zero.

usage: guide.py VIEWS DEPTH NAME OUT.safetensors
VIEWS is a model file whose outputs are 8x8 views, DEPTH one whose outputs are disparities, for the same patterns and conditioned on a
camera. Where the mean absolute detail of the central picture is below 1 % of white, the views become those of this picture on a
surface at the disparity of DEPTH, and where it is above twice this limit, they stay as they are. If VIEWS is not conditioned on a
camera, neither is the result: the conditioning vector of the paper's event model becomes a part of DEPTH's weights. `e2lf model store`
then checks the precisions. Requires torch.
"""
import pathlib
import sys

import numpy as np
import torch

import model_files
import sensor

GUIDE = "guide_"
PLANES = [round(-3.45 + 0.3 * i, 3) for i in range(24)]  # disparities, near to far, px per view step
VIEWPOINTS = [view - 3.5 for view in range(8)]
WINDOW = 9  # of the local mean of the picture and of its detail, px
WEAK_DETAIL = 0.01  # mean absolute detail, of intensities in [0, 1]
STEEPNESS = 5.0  # logit of the opacity per plane before the surface: the plane before it covers the share that its distance leaves
LARGEST_LOGIT = 6.0
MUTED = 0.5  # by how much a difference moves towards zero where the surface has no say
CENTRAL_VIEWS = [27, 28, 35, 36]


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
    header["input"].insert(2, model_files.INPUTS[2])


class Graph:
    """Layers of a network and their weights and biases."""

    def __init__(self):
        self.layers, self.tensors = [], {}

    def add(self, name, op, *inputs, **attributes):
        self.layers.append({"name": name, "op": op, "inputs": list(inputs), **attributes})

    def conv(self, name, source, weight, bias=0.0, **attributes):
        """Adds a convolution with a weight [out, in] of one pixel or [out, in, kernel, kernel]."""
        weight = np.reshape(weight, (*np.shape(weight)[:2], *(np.shape(weight)[2:] or (1, 1))))
        self.add(name, "conv", source, out_channels=len(weight), kernel=weight.shape[-1], **attributes)
        self.tensors[name + ".weight"], self.tensors[name + ".bias"] = weight, np.broadcast_to(bias, len(weight))


def box(factors):
    """Returns the weight of factors [out, in] times the mean over the window."""
    return np.multiply.outer(factors, np.full((WINDOW, WINDOW), 1 / WINDOW**2))


def add_muting(graph, picture):
    """Adds `muted`, which is 0 where the picture has weak detail, and MUTED where it has at least twice as much."""
    graph.conv("local_mean", picture, box([[1]]))
    graph.add("picture_and_mean", "concat", picture, "local_mean")
    graph.conv("picture_detail", "picture_and_mean", [[1, -1], [-1, 1]], relu=True)
    slope = MUTED / WEAK_DETAIL
    graph.conv("unmuted", "picture_detail", box([[-slope, -slope]]), 2 * MUTED, relu=True)
    graph.conv("muted", "unmuted", [[-1]], MUTED, relu=True)


def add_surface(graph, disparity, picture):
    """Adds `surface`, the views of the picture on a surface at a disparity. Planes behind it are opaque, too, and not seen."""
    planes, one = np.array(PLANES), np.eye(len(PLANES))
    per_px, none = STEEPNESS / (planes[1] - planes[0]), np.zeros(len(planes))
    graph.conv("below", disparity, np.stack([none + per_px, none], 1), LARGEST_LOGIT - STEEPNESS / 2 - per_px * planes, relu=True)
    graph.conv("opacities", "below", -one, 2 * LARGEST_LOGIT, relu=True)
    graph.add("opacities_and_picture", "concat", "opacities", picture)
    layers = np.zeros((2 * len(planes), len(planes) + 1))
    layers[:len(planes), :-1], layers[len(planes):, -1] = one, 1
    graph.conv("surface_layers", "opacities_and_picture", layers, np.concatenate([none - LARGEST_LOGIT, none]))
    graph.add("surface", "render-layers", "surface_layers", disparities=PLANES, rows=VIEWPOINTS, columns=VIEWPOINTS)


def follow(views, number, disparity):
    """Returns the graph that turns views and a disparity into views that follow it."""
    graph, one = Graph(), np.eye(number)
    graph.conv("picture", views, [[0.25 * (view in CENTRAL_VIEWS) for view in range(number)]])
    add_muting(graph, "picture")
    add_surface(graph, disparity, "picture")
    graph.add("both", "concat", views, "surface", "muted")
    graph.conv("differences", "both", np.block([[-one, one, -np.ones((number, 1))], [one, -one, -np.ones((number, 1))]]), relu=True)
    graph.conv("guided", "differences", np.block([one, -one]), residual=views)
    return graph


def main():
    (header, tensors), (depth, depth_tensors) = model_files.read_model(sys.argv[1]), model_files.read_model(sys.argv[2])
    name, out = sys.argv[3], sys.argv[4]
    if not np.array_equal(tensors.get("aperture.codes"), depth_tensors.pop("aperture.codes", None)):
        sys.exit(f"{sys.argv[2]} was trained for other patterns than {sys.argv[1]}")
    if header["input"][-1]["kind"] != "camera":
        paper = sensor.Conditions(1, np.random.default_rng(0), torch.device("cpu"), stated=True)
        of_cycles_and_transmissions = np.zeros(header["num_patterns"] - 1)
        fold_conditioning(depth, depth_tensors, np.concatenate([paper.conditioning()[0].numpy(), of_cycles_and_transmissions]))
    if model_files.INPUTS[2] not in header["input"]:
        insert_level(header, tensors)
    if depth["input"] != header["input"]:
        sys.exit(f"{sys.argv[2]} has other inputs than {sys.argv[1]}")
    layers, guide = header["network"]["layers"], model_files.prefixed(depth["network"]["layers"], GUIDE)
    graph = follow(layers[-1]["name"], len(VIEWPOINTS)**2, guide[-1]["name"])
    header["network"]["layers"] = [*guide, *layers, *graph.layers]
    tensors.update({GUIDE + key: values for key, values in depth_tensors.items()} | graph.tensors)
    header["provenance"]["guided_by"] = depth["name"]
    header.pop("precision_loss", None)
    header["name"] = name
    model_files.write(pathlib.Path(out), header, tensors)


if __name__ == "__main__":
    main()
