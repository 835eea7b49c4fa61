"""Patches of light fields for training."""
from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any, Optional, Sequence, Tuple, Union

import torch
from torch import Tensor
from torch.nn import functional as F
from torch.utils.data import Dataset

import e2lf

FARTHEST_LAYER_PX = 3.0
FINENESS = 2  # samples of a texture per pixel, between which it is linear


class LightFieldPatches(Dataset[Tensor]):
    """Random patches of light fields, float32 [view_y, view_x, size, size] in [0, 1], in colour with a last axis [channel].

    A patch depends only on its number and the seed. It is flipped and transposed at random, views and pixels together.

    light_fields: paths of any light fields that e2lf reads, or arrays [view_y, view_x, y, x] in [0, 1], or all with a last
        axis [channel]; the option colour=True reads files in colour.
    size: height and width of a patch.
    length: number of patches.
    synthesised: share of patches that are synthesised; 1 if there are no light fields.
    seed: seed of all draws.
    max_disparity: largest disparity of synthesised patches, px per view step.
    reading: options of e2lf.read_light_field, such as views=7.
    """

    def __init__(self, light_fields: Sequence[Union[str, "PathLike[str]", Any]] = (), *, size: int = 64,
                 length: int = 1_000_000, synthesised: float = 0.5, seed: int = 1,
                 max_disparity: float = FARTHEST_LAYER_PX, **reading: Any) -> None:
        self.size, self.length, self.seed, self.max_disparity = size, length, seed, max_disparity
        # Half precision resolves 2^-11, finer than 8-bit images.
        self.light_fields = [
            torch.as_tensor(e2lf.read_light_field(given, **reading) if isinstance(given, (str, PathLike)) else given).half()
            for given in light_fields]
        for field in self.light_fields:
            if field.ndim not in (4, 5) or min(field.shape[2:4]) < size:
                raise ValueError(f"a light field {list(field.shape)} has no patches [view_y, view_x, {size}, {size}]")
        self.is_colour = any(field.ndim == 5 for field in self.light_fields)
        if self.is_colour and any(field.ndim == 4 for field in self.light_fields):
            raise ValueError("some light fields are grey and some are in colour; give light fields of one kind")
        self.synthesised = synthesised if self.light_fields else 1.0
        self.views = tuple(self.light_fields[0].shape[:2]) if self.light_fields else (8, 8)

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, number: int) -> Tensor:
        if not 0 <= number < self.length:
            raise IndexError(number)
        draws = torch.Generator().manual_seed((self.seed << 32) + number)
        if torch.rand((), generator=draws) < self.synthesised:
            grey = synthesise(self.size, draws, views=self.views, max_disparity=self.max_disparity)
            return grey[..., None] * (0.5 + 0.5 * torch.rand(3, generator=draws)) if self.is_colour else grey
        field = self.light_fields[int(torch.randint(len(self.light_fields), (), generator=draws))]
        y, x = (int(torch.randint(length - self.size + 1, (), generator=draws)) for length in field.shape[2:4])
        return augment(field[:, :, y : y + self.size, x : x + self.size].float(), draws)


class BasicLFSRPatches(Dataset[Tensor]):
    """The patches of the data of BasicLFSR, float32 [view_y, view_x, y, x] in [0, 1]: the high-resolution light fields
    (Hr_SAI_y) of the HDF5 files (.h5) of one split.

    root: the folder with "data_for_training" and "data_for_test".
    split: "training" or "test".
    views: number of views per axis, which the files do not state.
    datasets: names of data sets, such as ["EPFL", "HCI_new"]; None = all.
    augmented: whether a patch is flipped and transposed at random, each time it is read.
    """

    FOLDERS = {"training": "data_for_training", "test": "data_for_test"}

    def __init__(self, root: Union[str, "PathLike[str]"], split: str = "training", *, views: int = 5,
                 datasets: Optional[Sequence[str]] = None, augmented: bool = False) -> None:
        if split not in self.FOLDERS:
            raise ValueError(f'there is no split "{split}"; give "training" or "test"')
        folder = Path(root) / self.FOLDERS[split]
        self.views, self.augmented = views, augmented
        self.files = [file for file in sorted(folder.rglob("*.h5"))
                      if datasets is None or set(datasets) & set(file.relative_to(folder).parts)]
        if not self.files:
            raise ValueError(f"{folder} has no patches (.h5) of these data sets")

    def __len__(self) -> int:
        return len(self.files)

    def __getitem__(self, number: int) -> Tensor:
        patch = torch.as_tensor(e2lf.read_light_field(self.files[number], views=0, lenslet_views=self.views, range="clamp"))
        if not self.augmented:
            return patch
        return augment(patch, torch.Generator().manual_seed(int(torch.randint(1 << 62, ()))))


def augment(patch: Tensor, draws: torch.Generator) -> Tensor:
    """Flips and transposes a light field at random, its views as its pixels, so that the disparity keeps its sign."""
    choices = torch.rand(3, generator=draws) < 0.5
    for axis in (0, 1):
        if choices[axis]:
            patch = patch.flip(axis, axis + 2)
    if choices[2] and patch.shape[0] == patch.shape[1]:
        patch = patch.transpose(0, 1).transpose(2, 3)
    return patch.contiguous()


def smooth_noise(side: int, cell_px: float, draws: torch.Generator) -> Tensor:
    """Returns interpolated noise of a square of `side` px with the given size of its structures, FINENESS samples per px."""
    cells = max(2, round(side / cell_px))
    noise = torch.rand(1, 1, cells, cells, generator=draws)
    finer: Tensor = F.interpolate(noise, size=(FINENESS * side, FINENESS * side), mode="bicubic", align_corners=False)
    return finer[0, 0]


def texture(side: int, draws: torch.Generator) -> Tensor:
    """Returns a random texture in [0, 1]: noise of several sizes around a grey level, with random contrast."""
    level, contrast = torch.rand(2, generator=draws).tolist()
    octaves = [(smooth_noise(side, cell, draws) - 0.5) * weight for cell, weight in ((3, 0.5), (8, 1.0), (24, 1.0))]
    grey: Tensor = level + 2 * contrast * torch.stack(octaves).sum(0)
    return grey.clamp(0, 1)


def synthesise(size: int, draws: torch.Generator, *, views: Tuple[int, ...] = (8, 8),
               max_disparity: float = FARTHEST_LAYER_PX, max_layers: int = 5) -> Tensor:
    """Returns a random light field [view_y, view_x, size, size]: textured surfaces behind one another, some of them slanted.

    It is a small version of the synthesiser of `e2lf train`, without photographs, reflections and motion.

    draws: the generator of all random numbers.
    max_disparity: largest absolute disparity, px per view step.
    max_layers: largest number of surfaces.
    """
    margin = int(max(views) * max_disparity / 2) + 2
    side = size + 2 * margin
    count = 1 + int(torch.randint(max_layers, (), generator=draws))
    # Back to front: nearer surfaces have the smaller disparity.
    disparities = ((2 * torch.rand(count, generator=draws) - 1) * max_disparity).sort(descending=True).values
    pixels = torch.arange(size) - 0.5 * (size - 1)
    view_y, view_x = (torch.arange(n) - 0.5 * (n - 1) for n in views[:2])
    field = torch.zeros(int(views[0]) * int(views[1]), 1, size, size)
    for number, disparity in enumerate(disparities):
        slope = 0.02 * (torch.rand(2, generator=draws) - 0.5) if torch.rand((), generator=draws) < 0.5 else torch.zeros(2)
        local = (disparity + slope[0] * pixels[:, None] + slope[1] * pixels).clamp(-max_disparity, max_disparity)
        y = pixels[:, None] - view_y[:, None, None, None] * local
        x = pixels - view_x[:, None, None] * local
        places = torch.stack([x + 0 * y, y + 0 * x], -1).reshape(-1, size, size, 2) / (0.5 * side)
        maps = [texture(side, draws)]
        if number:
            cover = smooth_noise(side, float(8 + 40 * torch.rand((), generator=draws)), draws) - 0.55
            maps.append((cover * (4 + 40 * torch.rand((), generator=draws))).add(0.5).clamp(0, 1))
        layers = torch.stack(maps)[None].expand(len(places), -1, -1, -1)
        seen = F.grid_sample(layers, places, mode="bilinear", padding_mode="border", align_corners=False)
        coverage = seen[:, 1:].clamp(0, 1) if number else torch.ones(())
        field = field * (1 - coverage) + seen[:, :1] * coverage
    return field.clamp(0, 1).reshape(*views[:2], size, size)
