"""The layers of model files as modules of PyTorch. Each is documented at e2lf::model::Op, e2lf::video::Op or e2lf::geometry::Op."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, List, Optional, Tuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from .geometry import PlaneSweep, RenderLayers, Warp

Layer = Dict[str, Any]
State = Dict[str, Tensor]


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


class Add(nn.Module):
    def forward(self, *inputs: Tensor) -> Tensor:
        return torch.stack(inputs).sum(0)


class Mean(nn.Module):
    def forward(self, *inputs: Tensor) -> Tensor:
        return torch.stack(inputs).mean(0)


class Concat(nn.Module):
    def forward(self, *inputs: Tensor) -> Tensor:
        return torch.cat(inputs, 1)


class ChannelNorm(nn.LayerNorm):
    """Normalises each pixel over its channels."""

    def forward(self, x: Tensor) -> Tensor:
        return super().forward(x.permute(0, 2, 3, 1)).permute(0, 3, 1, 2)


class DynamicFilter(nn.Module):
    """Filters each pixel by filters of its own."""

    def __init__(self, kernel: int) -> None:
        super().__init__()
        self.kernel = kernel

    def forward(self, x: Tensor, filters: Tensor) -> Tensor:
        kernel, (batch, channels, height, width) = self.kernel, x.shape
        around = F.unfold(x, kernel, padding=kernel // 2).reshape(batch, channels, kernel**2, height, width)
        filters = filters.reshape(batch, -1, kernel**2, height, width)
        return torch.einsum("bmtyx,bctyx->bmcyx", filters, around).reshape(batch, -1, height, width)


class PositionCode(nn.Module):
    """Adds a code of the position of each pixel."""

    def forward(self, x: Tensor) -> Tensor:
        channels, height, width = x.shape[1:]
        pairs = torch.arange((channels + 1) // 2, dtype=torch.float64, device=x.device)
        pixels = torch.arange(height * width, dtype=torch.float64, device=x.device)
        angles = torch.outer(10000.0 ** (pairs * (-2.0 / channels)), pixels)
        code = torch.stack([angles.sin(), angles.cos()], 1).reshape(-1, height, width)
        return x + code[:channels].to(x.dtype)


class Attention(nn.Module):
    """Attention between all pixels."""

    def __init__(self, heads: int) -> None:
        super().__init__()
        self.heads = heads

    def forward(self, q: Tensor, k: Tensor, v: Tensor) -> Tensor:
        queries, keys, values = (x.reshape(x.shape[0], self.heads, x.shape[1] // self.heads, -1).transpose(2, 3)
                                 for x in (q, k, v))
        scores = torch.softmax((queries / math.sqrt(queries.shape[3])) @ keys.transpose(2, 3), 3)
        return (scores @ values).transpose(2, 3).reshape(v.shape)


class Recurrent(nn.Module):
    """A layer with a memory of the previous frame, which forward() takes from the state and updates there."""

    def __init__(self, layer: Layer) -> None:
        super().__init__()
        self.key: str = layer["name"]
        self.out_channels: int = layer["out_channels"]

    def zeros(self, like: Tensor) -> Tensor:
        return like.new_zeros(like.shape[0], self.out_channels, *like.shape[2:])


class Previous(Recurrent):
    """The output of the network for the previous frame, which ConvGraph stores."""

    def forward(self, image: Tensor, state: State) -> Tensor:
        return state.get(self.key, self.zeros(image))


class ConvGru(Recurrent):
    def __init__(self, layer: Layer, channels: int) -> None:
        super().__init__(layer)
        out, kernel = self.out_channels, layer["kernel"]
        self.gates = nn.Conv2d(channels + out, 2 * out, kernel, padding=kernel // 2)
        self.candidate = nn.Conv2d(channels + out, out, kernel, padding=kernel // 2)

    def forward(self, x: Tensor, state: State) -> Tensor:
        hidden = state.get(self.key, self.zeros(x))
        update, reset = torch.sigmoid(self.gates(torch.cat([x, hidden], 1))).chunk(2, 1)
        candidate = torch.tanh(self.candidate(torch.cat([x, reset * hidden], 1)))
        state[self.key] = hidden * (1 - update) + candidate * update
        return state[self.key]


class ConvLstm(Recurrent):
    def __init__(self, layer: Layer, channels: int) -> None:
        super().__init__(layer)
        out, kernel = self.out_channels, layer["kernel"]
        self.gates = nn.Conv2d(channels + out, 4 * out, kernel, padding=kernel // 2)

    def forward(self, x: Tensor, state: State) -> Tensor:
        hidden = state.get(self.key, self.zeros(x))
        i, f, o, g = self.gates(torch.cat([x, hidden], 1)).chunk(4, 1)
        memory_key = f"{self.key}.memory"
        memory = torch.sigmoid(f) * state.get(memory_key, self.zeros(x)) + torch.sigmoid(i) * torch.tanh(g)
        state[memory_key] = memory
        state[self.key] = torch.sigmoid(o) * torch.tanh(memory)
        return state[self.key]


def _convolution(layer: Layer, channels: int) -> nn.Module:
    kernel, stride = layer.get("kernel", 1), layer.get("stride", 1)
    return nn.Conv2d(channels, layer["out_channels"], kernel, stride, 0 if kernel == stride else kernel // 2)


def _transposed(layer: Layer, channels: int) -> nn.Module:
    return nn.ConvTranspose2d(channels, layer["out_channels"], layer.get("kernel", 1), layer.get("stride", 1))


# How a module is made of a layer and the number of channels of its first input.
OPERATIONS: Dict[str, Callable[[Layer, int], nn.Module]] = {
    "conv": _convolution,
    "conv-transposed": _transposed,
    "pixel-unshuffle": lambda layer, _: nn.PixelUnshuffle(layer["stride"]),
    "pixel-shuffle": lambda layer, _: nn.PixelShuffle(layer["stride"]),
    "upsample": lambda layer, _: nn.Upsample(scale_factor=layer["stride"], mode="nearest"),
    "upsample-bilinear": lambda layer, _: nn.Upsample(scale_factor=layer["stride"], mode="bilinear", align_corners=False),
    "add": lambda *_: Add(),
    "mean": lambda *_: Mean(),
    "concat": lambda *_: Concat(),
    "sigmoid": lambda *_: nn.Sigmoid(),
    "tanh": lambda *_: nn.Tanh(),
    "dynamic-filter": lambda layer, _: DynamicFilter(layer["kernel"]),
    "layer-norm": lambda _, channels: ChannelNorm(channels, eps=1e-5),
    "position-code": lambda *_: PositionCode(),
    "attention": lambda layer, _: Attention(layer.get("heads", 1)),
    "plane-sweep": lambda layer, _: PlaneSweep(layer),
    "render-layers": lambda layer, _: RenderLayers(layer),
    "warp": lambda layer, _: Warp(layer),
    "previous": lambda layer, _: Previous(layer),
    "conv-gru": ConvGru,
    "conv-lstm": ConvLstm,
}


def initialise(module: nn.Module, layer: Layer) -> None:
    """Draws the weights of convolutions from He's normal distribution; zeros for those that add a residual, and for biases."""
    for part in module.modules():
        if not isinstance(part, (nn.Conv2d, nn.ConvTranspose2d)):
            continue
        shape = part.weight.shape
        fan_in = shape[0] if isinstance(part, nn.ConvTranspose2d) else math.prod(shape[1:])
        gain = 0.0 if layer.get("residual") else 2.0 if layer.get("relu") else 1.0
        nn.init.normal_(part.weight, std=math.sqrt(gain / fan_in))
        if part.bias is not None:
            nn.init.zeros_(part.bias)


def _largest_shift(viewpoints: List[float], disparities: List[float]) -> int:
    """Returns the largest distance in px at which a picture is read, with the taps of the interpolation."""
    return math.ceil(max(abs(place) for place in viewpoints) * max(abs(each) for each in disparities)) + 2


def needed_input(layer: Layer, needed: int) -> Optional[int]:
    """Returns how many first rows (or columns) of its inputs the first `needed` ones of a layer depend on; None: on all."""
    op, kernel, stride = layer["op"], int(layer.get("kernel", 1)), int(layer.get("stride", 1))
    if op == "conv":
        return needed * stride + (kernel // 2 if kernel != stride else 0)
    if op == "pixel-unshuffle":
        return needed * stride
    if op in ("conv-transposed", "pixel-shuffle", "upsample", "upsample-bilinear"):
        return -(-needed // stride) + (1 if op == "upsample-bilinear" else 0)
    if op == "plane-sweep":
        return needed + kernel // 2 + _largest_shift(layer["offsets"], layer["disparities"])
    if op == "render-layers":
        return needed + _largest_shift([*layer["rows"], *layer["columns"]], layer["disparities"])
    if op == "warp":
        return needed + _largest_shift(layer["offsets"], layer["disparities"])
    if op == "dynamic-filter":
        return needed + kernel // 2
    if op in ("add", "mean", "concat", "sigmoid", "tanh", "layer-norm"):
        return needed
    return None


def scales_of(layers: List[Layer]) -> Dict[str, int]:
    """Returns by how much each tensor is smaller than the input."""
    scales = {"input": 1}
    for layer in layers:
        scale = max((scales[name] for name in layer["inputs"]), default=1)
        stride = int(layer.get("stride", 1))
        if layer["op"] in ("conv", "pixel-unshuffle"):
            scale *= stride
        elif layer["op"] in ("conv-transposed", "pixel-shuffle", "upsample", "upsample-bilinear"):
            scale //= stride
        scales[layer["name"]] = scale
    return scales


def needed_extents(layers: List[Layer], size: int, whole: int) -> Tuple[Dict[str, int], Dict[str, int]]:
    """Returns how many rows (or columns) of each tensor, and of the inputs of each layer, the first `size` ones of the output
    depend on; `whole` is the size of the input of the network."""
    full = {name: whole // scale for name, scale in scales_of(layers).items()}
    last = layers[-1]["name"]
    needs = {last: min(size, full[last])}
    of_inputs: Dict[str, int] = {}
    for layer in reversed(layers):
        need = needs.setdefault(layer["name"], full[layer["name"]])
        of_input = needed_input(layer, need)
        for name in layer["inputs"]:
            rows = full[name] if of_input is None else min(of_input, full[name])
            needs[name] = max(needs.get(name, 0), rows)
            of_inputs[layer["name"]] = rows
        if residual := layer.get("residual"):
            needs[residual] = max(needs.get(residual, 0), need)
    return needs, of_inputs
