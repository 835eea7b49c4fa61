"""The network of a model file, which is a list of layers, as a module of PyTorch."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Optional, Tuple

import torch
from torch import Tensor, nn

from .layers import OPERATIONS, Layer, Recurrent, State, initialise, needed_extents, output_channels


class ConvGraph(nn.Module):
    """The network that a model file describes. Its layers are modules with the names of the file, such as nn.Conv2d, and so its
    parameters are "<layer>.weight" and "<layer>.bias".

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
            module = OPERATIONS[layer["op"]](layer, inputs[0] if inputs else 0)
            if weights is None:
                initialise(module, layer)
            self._add(layer["name"], module)
        self.output_channels = channels[self.layers[-1]["name"]]
        self._last_use = {name: i for i, layer in enumerate(self.layers) for name in _reads(layer)}
        if weights is not None:
            self.load_state_dict({name: torch.tensor(value) for name, value in weights.items()})

    def _add(self, name: str, module: nn.Module) -> None:
        """Registers a layer below modules that are named after the parts of its name, which add_module() refuses where a module
        has such an attribute."""
        parent: Any = self
        *parts, last = name.split(".")
        for part in parts:
            parent = parent._modules.setdefault(part, nn.Module())
        if last in parent._modules:
            module._modules.update(parent._modules[last]._modules)
        parent._modules[last] = module

    def layer(self, name: str) -> nn.Module:
        """Returns a layer by its name in the model file."""
        module: Any = self
        for part in name.split("."):
            module = module._modules[part]
        return module  # type: ignore[no-any-return]

    def forward(self, x: Tensor, state: Optional[State] = None, size: Optional[Tuple[int, int]] = None) -> Tensor:
        """Applies the network to [batch, channel, y, x].

        state: the memory of a recurrent network, which is updated; an empty dict is the initial memory. Without it, every
        call starts from the initial memory.
        size: (y, x) of the part at the top left that is needed. Layers then compute only what it depends on.
        """
        memory: State = {} if state is None else state
        whole = [int(extent) for extent in x.shape[2:]]  # torch.jit.trace would record tensors
        needs = [needed_extents(self.layers, int(wanted), extent) for wanted, extent in zip(size or whole, whole)]
        values = {"input": x}
        result = x
        for number, layer in enumerate(self.layers):
            name, module = layer["name"], self.layer(layer["name"])
            inputs = [_cut(values[read], [of_inputs[name] for _, of_inputs in needs]) for read in layer["inputs"]]
            if isinstance(module, Recurrent):
                result = module(*(inputs or [x]), memory)
            else:
                result = module(*inputs)
            needed = [extents[name] for extents, _ in needs]
            result = _cut(result, needed)
            if layer.get("residual"):
                result = result + _cut(values[layer["residual"]], needed)
            if layer.get("relu"):
                result = torch.relu(result)
            values[name] = result
            for read in _reads(layer):
                if self._last_use[read] == number:
                    values.pop(read, None)
        for layer in self.layers:
            if layer["op"] == "previous":
                memory[layer["name"]] = result
        return result


def _reads(layer: Layer) -> List[str]:
    return [*layer["inputs"], *([layer["residual"]] if layer.get("residual") else [])]


def _cut(x: Tensor, size: List[int]) -> Tensor:
    """Returns the part [..., :y, :x]; a slice of an axis that stays whole would cost a copy in the gradient."""
    for axis, extent in zip((2, 3), size):
        if int(x.shape[axis]) != extent:
            x = x.narrow(axis, 0, extent)
    return x
