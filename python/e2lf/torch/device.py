"""The networks of e2lf.Reconstructor on devices of PyTorch; the extension module makes and calls them."""
from __future__ import annotations

from typing import Any, Mapping

import torch

import e2lf

from .network import ConvGraph

TYPES = {"float32": torch.float32, "float16": torch.float16, "bfloat16": torch.bfloat16}


def device_of(name: str) -> torch.device:
    """Returns the device "cuda", "cuda:N" or "torch-cpu". Raises a LookupError if PyTorch has none of this name."""
    if name == "torch-cpu":
        return torch.device("cpu")
    kind, _, number = name.partition(":")
    count = torch.cuda.device_count()
    if kind != "cuda" or (number or "0") not in map(str, range(count)):
        raise LookupError(f"PyTorch finds {count} CUDA devices, and not the device {name}; use the device cpu")
    return torch.device(name)


class Network:
    """The network of a model file on a device, in half precision there if what bfloat16 loses was checked."""

    def __init__(self, description: Mapping[str, Any], weights: Mapping[str, e2lf.Array], device: str, precision: str,
                 is_checked: bool) -> None:
        self._device = device_of(device)
        is_gpu = self._device.type != "cpu"
        if precision == "auto":
            precision = "float16" if is_checked and is_gpu else "float32"
        # On CPUs, torch 1.13 fails in transposed convolutions in bfloat16.
        if precision not in TYPES or (precision != "float32" and not is_gpu):
            raise ValueError(f"the device {device} does not compute in {precision}; use precision auto")
        self.precision = precision
        self.description = f"torch {torch.__version__} on {self._device}, {precision}"
        self._network = ConvGraph(description)
        state = self._network.state_dict()
        self._network.load_state_dict({name: torch.tensor(weights[name]).reshape(value.shape) for name, value in state.items()})
        self._network.to(self._device, TYPES[precision])

    def run(self, planes: e2lf.Array) -> e2lf.Array:
        """Returns the output of the network, float32 [channel, y, x], for its input of the same axes."""
        x = torch.from_numpy(planes)[None].to(self._device, TYPES[self.precision]).contiguous(memory_format=torch.channels_last)
        # What is called float32 is computed in it.
        with torch.no_grad(), torch.backends.cudnn.flags(enabled=True, allow_tf32=False):
            result: e2lf.Array = self._network(x)[0].float().cpu().contiguous().numpy()
        return result
