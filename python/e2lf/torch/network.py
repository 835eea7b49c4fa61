"""The network of a model file, which is a list of layers, as a module of PyTorch."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from .geometry import plane_sweep, render_layers

Layer = Dict[str, Any]
State = Dict[str, Tensor]

CELLS = {"conv-gru": {"gates": 2, "candidate": 1}, "conv-lstm": {"gates": 4}}


def output_channels(layer: Layer, inputs: List[int]) -> int:
    """Returns the number of channels of a layer whose inputs have `inputs` channels."""
    op, area = layer["op"], int(layer.get("stride", 1)) ** 2
    if "out_channels" in layer:
        return int(layer["out_channels"])
    if op == "pixel-unshuffle":
        return inputs[0] * area
    if op == "pixel-shuffle":
        return inputs[0] // area
    if op == "concat":
        return sum(inputs)
    if op == "plane-sweep":
        return len(layer["disparities"])
    if op == "render-layers":
        return len(layer["rows"]) * len(layer["columns"])
    if op == "dynamic-filter":
        return inputs[0] * (inputs[1] // int(layer["kernel"]) ** 2)
    return inputs[0]


def weight_shapes(layer: Layer, channels: int) -> Dict[str, Tuple[int, ...]]:
    """Returns the shapes of the weights of a layer with `channels` input channels; biases have their first or second size."""
    op, name, kernel = layer["op"], layer["name"], layer.get("kernel", 1)
    if op == "conv":
        return {name: (layer["out_channels"], channels, kernel, kernel)}
    if op == "conv-transposed":
        return {name: (channels, layer["out_channels"], kernel, kernel)}
    if op == "layer-norm":
        return {name: (channels,)}
    out = layer.get("out_channels", 0)
    return {f"{name}.{part}": (n * out, channels + out, kernel, kernel) for part, n in CELLS.get(op, {}).items()}


def initial_weight(layer: Layer, shape: Tuple[int, ...]) -> Tensor:
    """Draws weights from He's normal distribution, and zeros for convolutions that add a residual."""
    if layer["op"] == "layer-norm":
        return torch.ones(shape)
    if layer.get("residual"):
        return torch.zeros(shape)
    fan_in = shape[0] if layer["op"] == "conv-transposed" else math.prod(shape[1:])
    return torch.randn(shape) * math.sqrt((2.0 if layer.get("relu") else 1.0) / fan_in)


class ConvGraph(nn.Module):
    """The network that a model file describes. Its parameters have the names of the file: "<layer>.weight", "<layer>.bias".

    description: the entry "network" of the header of a model file.
    weights: arrays or tensors by name; without them, the weights are drawn from torch's generator.
    """

    def __init__(self, description: Mapping[str, Any], weights: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__()
        self.description = dict(description)
        self.layers: List[Layer] = list(description["layers"])
        channels = {"input": int(description["input_channels"])}
        for layer in self.layers:
            inputs = [channels[name] for name in layer["inputs"]]
            channels[layer["name"]] = output_channels(layer, inputs)
            for name, shape in weight_shapes(layer, inputs[0] if inputs else 0).items():
                bias = torch.zeros(shape[1 if layer["op"] == "conv-transposed" else 0])
                self._add(name, initial_weight(layer, shape), bias)
        self.output_channels = channels[self.layers[-1]["name"]]
        self._last_use = {name: i for i, layer in enumerate(self.layers) for name in _reads(layer)}
        if weights is not None:
            self.load_state_dict({name: torch.tensor(value) for name, value in weights.items()})

    def _add(self, name: str, weight: Tensor, bias: Tensor) -> None:
        """Registers a pair of parameters below modules that are named after the parts of `name`, which add_module() refuses
        where a module has such an attribute."""
        module: Any = self
        for part in name.split("."):
            module = module._modules.setdefault(part, nn.Module())
        module.register_parameter("weight", nn.Parameter(weight))
        module.register_parameter("bias", nn.Parameter(bias))

    def weights_of(self, name: str) -> Tuple[Tensor, Tensor]:
        """Returns the weight and the bias of a layer, or of a part "<layer>.gates" of a cell."""
        module: Any = self
        for part in name.split("."):
            module = module._modules[part]
        return module.weight, module.bias

    def forward(self, x: Tensor, state: Optional[State] = None) -> Tensor:
        """Applies the network to [batch, channel, y, x].

        state: the memory of a recurrent network, which is updated; an empty dict is the initial memory. Without it, every
        call starts from the initial memory.
        """
        memory: State = {} if state is None else state
        values = {"input": x}
        for number, layer in enumerate(self.layers):
            result = OPERATIONS[layer["op"]](self, layer, [values[name] for name in layer["inputs"]], memory, x)
            if layer.get("residual"):
                result = result + values[layer["residual"]]
            if layer.get("relu"):
                result = torch.relu(result)
            values[layer["name"]] = result
            for name in _reads(layer):
                if self._last_use[name] == number:
                    values.pop(name, None)
        for layer in self.layers:
            if layer["op"] == "previous":
                memory[layer["name"]] = result
        return result


def _reads(layer: Layer) -> List[str]:
    return [*layer["inputs"], *([layer["residual"]] if layer.get("residual") else [])]


# Each operation is documented at e2lf::model::Op, e2lf::video::Op or e2lf::geometry::Op.
Operation = Callable[[ConvGraph, Layer, List[Tensor], State, Tensor], Tensor]


def _conv(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    kernel, stride = layer.get("kernel", 1), layer.get("stride", 1)
    weight, bias = net.weights_of(layer["name"])
    return F.conv2d(inputs[0], weight, bias, stride, 0 if kernel == stride else kernel // 2)


def _conv_transposed(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    weight, bias = net.weights_of(layer["name"])
    return F.conv_transpose2d(inputs[0], weight, bias, layer.get("stride", 1))


def _bilinear(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    larger: Tensor = F.interpolate(inputs[0], scale_factor=layer["stride"], mode="bilinear", align_corners=False)
    return larger


def _dynamic_filter(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    x, filters = inputs
    kernel, (batch, channels, height, width) = layer["kernel"], x.shape
    around = F.unfold(x, kernel, padding=kernel // 2).reshape(batch, channels, kernel**2, height, width)
    filters = filters.reshape(batch, -1, kernel**2, height, width)
    return torch.einsum("bmtyx,bctyx->bmcyx", filters, around).reshape(batch, -1, height, width)


def _layer_norm(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    x = inputs[0].permute(0, 2, 3, 1)
    return F.layer_norm(x, x.shape[3:], *net.weights_of(layer["name"]), 1e-5).permute(0, 3, 1, 2)


def _position_code(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    x = inputs[0]
    channels, height, width = x.shape[1:]
    pairs = torch.arange((channels + 1) // 2, dtype=torch.float64, device=x.device)
    pixels = torch.arange(height * width, dtype=torch.float64, device=x.device)
    angles = torch.outer(10000.0 ** (pairs * (-2.0 / channels)), pixels)
    code = torch.stack([angles.sin(), angles.cos()], 1).reshape(-1, height, width)
    return x + code[:channels].to(x.dtype)


def _attention(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    heads = layer.get("heads", 1)
    q, k, v = (x.reshape(x.shape[0], heads, x.shape[1] // heads, -1).transpose(2, 3) for x in inputs)
    scores = torch.softmax((q / math.sqrt(q.shape[3])) @ k.transpose(2, 3), 3)
    return (scores @ v).transpose(2, 3).reshape(inputs[2].shape)


def _previous(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    zeros = image.new_zeros(image.shape[0], layer["out_channels"], *image.shape[2:])
    return state.get(layer["name"], zeros)


def _cell(net: ConvGraph, layer: Layer, inputs: List[Tensor], state: State, image: Tensor) -> Tensor:
    x, name = inputs[0], layer["name"]
    zeros = x.new_zeros(x.shape[0], layer["out_channels"], *x.shape[2:])
    hidden = state.get(name, zeros)

    def convolve(part: str, y: Tensor) -> Tensor:
        return F.conv2d(torch.cat([x, y], 1), *net.weights_of(f"{name}.{part}"), 1, layer["kernel"] // 2)

    if layer["op"] == "conv-lstm":
        i, f, o, g = convolve("gates", hidden).chunk(4, 1)
        memory = torch.sigmoid(f) * state.get(f"{name}.memory", zeros) + torch.sigmoid(i) * torch.tanh(g)
        state[f"{name}.memory"] = memory
        state[name] = torch.sigmoid(o) * torch.tanh(memory)
    else:
        update, reset = torch.sigmoid(convolve("gates", hidden)).chunk(2, 1)
        state[name] = hidden * (1 - update) + torch.tanh(convolve("candidate", reset * hidden)) * update
    return state[name]


OPERATIONS: Dict[str, Operation] = {
    "plane-sweep": lambda net, layer, inputs, *_: plane_sweep(inputs[0], layer),
    "render-layers": lambda net, layer, inputs, *_: render_layers(inputs[0], layer),
    "conv": _conv,
    "conv-transposed": _conv_transposed,
    "pixel-unshuffle": lambda net, layer, inputs, *_: F.pixel_unshuffle(inputs[0], layer["stride"]),
    "pixel-shuffle": lambda net, layer, inputs, *_: F.pixel_shuffle(inputs[0], layer["stride"]),
    "upsample": lambda net, layer, inputs, *_: F.interpolate(inputs[0], scale_factor=layer["stride"], mode="nearest"),
    "upsample-bilinear": _bilinear,
    "add": lambda net, layer, inputs, *_: torch.stack(inputs).sum(0),
    "mean": lambda net, layer, inputs, *_: torch.stack(inputs).mean(0),
    "concat": lambda net, layer, inputs, *_: torch.cat(inputs, 1),
    "sigmoid": lambda net, layer, inputs, *_: torch.sigmoid(inputs[0]),
    "tanh": lambda net, layer, inputs, *_: torch.tanh(inputs[0]),
    "dynamic-filter": _dynamic_filter,
    "layer-norm": _layer_norm,
    "position-code": _position_code,
    "attention": _attention,
    "previous": _previous,
    "conv-gru": _cell,
    "conv-lstm": _cell,
}
