"""Modules of PyTorch from model files, and model files from modules."""
from __future__ import annotations

from os import PathLike
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union, overload

import torch
from torch import Tensor, nn

import e2lf

from .inputs import form_inputs
from .layers import State, scales_of
from .light_fields import check_shape
from .network import ConvGraph

CONSTANTS = ("eps", "tau", "sigma_w", "sigma_z")
Path = Union[str, "PathLike[str]"]


def as_dict(constants: e2lf.SensorConstants) -> Dict[str, float]:
    return {key: getattr(constants, key) for key in CONSTANTS}


class LightFieldNetwork(nn.Module):
    """A network that makes light fields from event images.

    header: the content of a model file except its tensors; see e2lf.Model.header.
    weights: the weights by name; without them, they are drawn from torch's generator.
    """

    constants: e2lf.SensorConstants  #: eps and tau of the input
    conditioning: Optional[Tensor]  #: the description of the camera, [1, number], for networks that are conditioned on it

    def __init__(self, header: Mapping[str, Any], weights: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__()
        self.header: Dict[str, Any] = dict(header)
        self.views = (int(header["views_y"]), int(header["views_x"]))
        self.num_patterns = int(header["num_patterns"])
        self.network = ConvGraph(header["network"], weights)
        #: The number of which the height and width of the input of the network must be multiples.
        self.multiple = max(scales_of(header["network"]["layers"]).values())
        self.gives_disparity = self.network.output_channels == 2 != self.views[0] * self.views[1]
        self.is_conditioned_on_camera = any(group["kind"] == "camera" for group in header["input"])
        self.constants = e2lf.SensorConstants(**{key: header["constants"][key] for key in CONSTANTS})
        self.register_buffer("conditioning", None, persistent=False)

    def set_camera(self, camera: e2lf.Camera, cycles: int = 1) -> None:
        """Sets the camera that records the events, and the number of cycles over which they are averaged, for networks that are
        conditioned on the camera."""
        if not self.is_conditioned_on_camera:
            raise ValueError(f"{self.header['name']} was trained for a single camera and single cycles; omit the camera")
        self.constants = camera.constants
        vector = torch.from_numpy(camera.conditioning(self.num_patterns, cycles))
        self.conditioning = vector[None].to(next(self.parameters()).device)

    def planes(self, events: Optional[Tensor], images: Optional[Tensor] = None) -> Tensor:
        """Returns the input of the network, [batch, channel, y, x], extended at the bottom and right by its mirror image."""
        x = form_inputs(events, self.header["input"], eps=self.constants.eps, tau=self.constants.tau,
                        conditioning=self.conditioning, images=images)
        for axis in (2, 3):
            size = x.shape[axis]
            if missing := -size % self.multiple:
                places = torch.arange(size + missing, device=x.device) % (2 * size)
                x = x.index_select(axis, torch.minimum(places, 2 * size - 1 - places))
        return x

    def forward(self, events: Optional[Tensor], images: Optional[Tensor] = None) -> Tensor:
        """Returns light fields [batch, view_y, view_x, y, x], not clamped; of depth networks the disparity of view (4, 4) and the
        logarithm of its scale, [batch, 2, y, x].

        events: event images [batch, N - 1, y, x], averaged over cycles; None for networks that take images only.
        images: intensity images [batch, image, y, x], for networks that take them.
        """
        given = events if events is not None else images
        if given is None:
            raise ValueError("there is nothing to reconstruct from; give event images or images")
        if events is not None:
            check_shape("event images", events, "[batch, transition, y, x]", (self.num_patterns - 1,))
        if images is not None:
            check_shape("intensity images", images, "[batch, image, y, x]")
        fields: Tensor = self.network(self.planes(events, images), size=(given.shape[2], given.shape[3]))
        if self.gives_disparity:
            return fields
        return fields.reshape(fields.shape[0], *self.views, *fields.shape[2:])


class FrameNetwork(nn.Module):
    """A recurrent network that makes grey frames from the voxel grids of consecutive windows."""

    def __init__(self, header: Mapping[str, Any], weights: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__()
        self.header: Dict[str, Any] = dict(header)
        self.network = ConvGraph(header["network"], weights)

    def forward(self, grid: Tensor, state: Optional[State] = None) -> Tensor:
        """Returns frames [batch, 1, y, x] before the tone curve; `state` is that of ConvGraph.

        grid: voxel grids [batch, bin, y, x], normalised and padded as the header states.
        """
        check_shape("voxel grids", grid, "[batch, bin, y, x]", (int(self.header["bins"]),))
        frame: Tensor = self.network(grid, state)
        return frame


@overload
def load_module(name: e2lf.VideoModel) -> FrameNetwork: ...
@overload
def load_module(name: Union[Path, e2lf.Model], camera: Optional[e2lf.Camera] = None) -> LightFieldNetwork: ...
def load_module(name: Union[Path, e2lf.Model, e2lf.VideoModel],
                camera: Optional[e2lf.Camera] = None) -> Union[LightFieldNetwork, FrameNetwork]:
    """Returns the network of a model file with its weights.

    name: the path of a model file, the name of a bundled model, an e2lf.Model or an e2lf.VideoModel.
    camera: the camera that records the events; None = that of the model.
    """
    if isinstance(name, e2lf.VideoModel):
        return FrameNetwork(name.header, name.weights)
    model = name if isinstance(name, e2lf.Model) else e2lf.Model(name)
    module = LightFieldNetwork(model.header, model.weights)
    if camera or module.is_conditioned_on_camera:
        module.set_camera(camera or model.camera or e2lf.Camera.from_constants(model.constants))
    return module


def new_module(
    num_patterns: int = 4,
    *,
    width: int = 48,
    blocks: int = 3,
    name: str = "mine",
    views: Tuple[int, int] = (8, 8),
    input: Sequence[Tuple[str, float]] = (("counts", 0.125), ("cumulative", 0.125), ("intensity", 4.0)),
    layers: Optional[Sequence[Mapping[str, Any]]] = None,
) -> LightFieldNetwork:
    """Returns a network with random weights: by default, residual blocks of 3x3 convolutions at half the resolution.

    num_patterns: the number N of patterns.
    width: channels of the blocks.
    blocks: number of blocks.
    name: name of the model.
    views: number of views, (view_y, view_x).
    input: kinds and scales of the input channels that are made from the N - 1 event images.
    layers: the layers of another network, as in a model file; the last one has view_y * view_x channels.
    """
    network = {"type": "conv-graph", "input_channels": len(input) * (num_patterns - 1),
               "layers": list(layers) if layers is not None else _residual_layers(width, blocks, views[0] * views[1])}
    return LightFieldNetwork({
        "format_version": 1, "name": name, "num_patterns": num_patterns, "views_y": views[0], "views_x": views[1],
        "event_model": "reference-aware", "black_first": True,
        "constants": as_dict(e2lf.SensorConstants()),
        "input": [{"kind": kind, "scale": scale} for kind, scale in input], "network": network, "provenance": {}})


def _residual_layers(width: int, blocks: int, outputs: int) -> List[Dict[str, Any]]:
    conv = {"op": "conv", "kernel": 3}
    layers: List[Dict[str, Any]] = [
        {"name": "half", "op": "pixel-unshuffle", "inputs": ["input"], "stride": 2},
        {**conv, "name": "stem", "inputs": ["half"], "out_channels": width}]
    for block in range(blocks):
        before = layers[-1]["name"]
        layers += [{**conv, "name": f"block{block}a", "inputs": [before], "out_channels": width, "relu": True},
                   {**conv, "name": f"block{block}b", "inputs": [f"block{block}a"], "out_channels": width,
                    "residual": before}]
    layers += [{**conv, "name": "last", "inputs": [layers[-1]["name"]], "out_channels": 4 * outputs},
               {"name": "views", "op": "pixel-shuffle", "inputs": ["last"], "stride": 2}]
    return layers


def save_module(
    path: Path,
    module: LightFieldNetwork,
    *,
    codes: Optional[Any] = None,
    constants: Optional[e2lf.SensorConstants] = None,
    name: str = "",
    provenance: Mapping[str, Any] = {},
    overwrite: bool = False,
) -> None:
    """Writes a module as a model file, which `e2lf reconstruct` runs.

    codes: the patterns [N, view_y, view_x] for which it was trained; None = the file contains no patterns.
    constants: the sensor constants of its training; None = those of the model that was loaded.
    name: name of the model; "" = that of the module.
    provenance: what the file states about its origin, such as {"samples": 100000}.
    """
    if not isinstance(module, LightFieldNetwork):
        raise TypeError(f"a model file holds networks of new_module() and load_module(), not a {type(module).__name__}; export "
                        "yours by torch.onnx.export, or score its light fields by e2lf.compare (docs/pytorch.md)")
    header = dict(module.header)
    header.pop("precision_loss", None)  # it was checked for the weights that were loaded
    if constants:
        header["constants"] = {**header["constants"], **as_dict(constants)}
    header["name"] = name or header["name"]
    header["provenance"] = {**header.get("provenance", {}), **provenance}
    if codes is not None:
        codes = torch.as_tensor(codes).detach().float().cpu().numpy()
        header["black_first"] = not codes[0].any()
    weights = {key: value.detach().float().cpu().numpy() for key, value in module.network.state_dict().items()}
    e2lf.write_model(path, e2lf.Model.of(header, weights, codes), overwrite=overwrite)
