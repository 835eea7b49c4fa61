"""Layouts of light fields in one image, PSNR and SSIM."""
from __future__ import annotations

from typing import Tuple

import torch
from torch import Tensor
from torch.nn import functional as F

UNIFORM_SIDE, GAUSSIAN_SIDE, GAUSSIAN_SIGMA = 7, 11, 1.5
C1, C2 = 0.01**2, 0.03**2


def check_shape(name: str, x: Tensor, axes: str, sizes: Tuple[int, ...] = ()) -> None:
    """Raises a ValueError of one sentence unless x has the axes "[batch, ...]", whose second and further sizes may be given."""
    if x.dim() == axes.count(",") + 1 and tuple(x.shape[1 : 1 + len(sizes)]) == sizes:
        return
    wanted = ", ".join(str(size) for size in sizes)
    remedy = "; add the batch axis by [None]" if x.dim() == axes.count(",") else ""
    raise ValueError(f"{name} must be {axes}{f' with sizes {wanted} after the batch' if wanted else ''}, "
                     f"but the shape is {list(x.shape)}{remedy}")


def to_sai(light_fields: Tensor) -> Tensor:
    """Returns the views side by side: [batch, 1, view_y * y, view_x * x] of light fields [batch, view_y, view_x, y, x], and
    [batch, 3, ...] of [batch, view_y, view_x, y, x, 3]."""
    fields = _with_channels(light_fields)
    batch, rows, columns, height, width, channels = fields.shape
    return fields.permute(0, 5, 1, 3, 2, 4).reshape(batch, channels, rows * height, columns * width)


def from_sai(image: Tensor, views: Tuple[int, int] = (8, 8)) -> Tensor:
    """Returns the light fields of which to_sai() made an image."""
    batch, channels, height, width = _divisible(image, views)
    fields = image.reshape(batch, channels, views[0], height // views[0], views[1], width // views[1])
    return _without_channel(fields.permute(0, 2, 4, 3, 5, 1))


def to_macpi(light_fields: Tensor) -> Tensor:
    """Returns the macro-pixel image [batch, 1 or 3, y * view_y, x * view_x], in which the views of a pixel are side by side."""
    fields = _with_channels(light_fields)
    batch, rows, columns, height, width, channels = fields.shape
    return fields.permute(0, 5, 3, 1, 4, 2).reshape(batch, channels, height * rows, width * columns)


def from_macpi(image: Tensor, views: Tuple[int, int] = (8, 8)) -> Tensor:
    """Returns the light fields of which to_macpi() made an image."""
    batch, channels, height, width = _divisible(image, views)
    fields = image.reshape(batch, channels, height // views[0], views[0], width // views[1], views[1])
    return _without_channel(fields.permute(0, 3, 5, 2, 4, 1))


def _with_channels(light_fields: Tensor) -> Tensor:
    if light_fields.dim() == 6:
        return light_fields
    check_shape("light fields", light_fields, "[batch, view_y, view_x, y, x]")
    return light_fields[..., None]


def _without_channel(fields: Tensor) -> Tensor:
    return fields[..., 0] if fields.shape[5] == 1 else fields


def _divisible(image: Tensor, views: Tuple[int, int]) -> Tuple[int, int, int, int]:
    check_shape("the image", image, "[batch, channel, y, x]")
    batch, channels, height, width = image.shape
    if height % views[0] or width % views[1]:
        raise ValueError(f"an image of {height}x{width} px has no {views[0]}x{views[1]} views of equal size")
    return batch, channels, height, width


def psnr(a: Tensor, b: Tensor) -> Tensor:
    """Returns the PSNR in dB of each light field [batch, view_y, view_x, y, x] (or with [channel]) with values in [0, 1], as the
    mean over the views, as e2lf.psnr() of one light field. Differentiable."""
    _check_pair(a, b)
    errors = (a - b).square().flatten(3).mean(3)
    return (-10 * torch.log10(errors)).flatten(1).mean(1)


def ssim(a: Tensor, b: Tensor, window: str = "uniform7") -> Tensor:
    """Returns the mean SSIM of each light field over its views and channels, as e2lf.ssim() of one light field. Differentiable.

    window: "uniform7" or "gaussian" (11x11).
    """
    _check_pair(a, b)
    if window not in ("uniform7", "gaussian"):
        raise ValueError(f'there is no window "{window}"; give "uniform7" or "gaussian"')
    side = UNIFORM_SIDE if window == "uniform7" else GAUSSIAN_SIDE
    places = torch.arange(side, dtype=a.dtype, device=a.device) - side // 2
    weights = torch.ones_like(places) if window == "uniform7" else torch.exp(-0.5 * (places / GAUSSIAN_SIGMA).square())
    weights = weights / weights.sum()
    pictures = [_with_channels(x).movedim(5, 3).flatten(0, 3)[:, None] for x in (a, b)]
    if min(pictures[0].shape[2:]) < side:
        raise ValueError(f"SSIM needs views of at least {side}x{side} px")

    def mean(x: Tensor) -> Tensor:
        return F.conv2d(F.conv2d(x, weights.reshape(1, 1, 1, side)), weights.reshape(1, 1, side, 1))

    x, y = pictures
    mean_x, mean_y = mean(x), mean(y)
    scale = side**2 / (side**2 - 1)  # the covariance of a sample
    variances = scale * (mean(x * x + y * y) - mean_x.square() - mean_y.square())
    covariance = scale * (mean(x * y) - mean_x * mean_y)
    similarity = ((2 * mean_x * mean_y + C1) * (2 * covariance + C2)
                  / ((mean_x.square() + mean_y.square() + C1) * (variances + C2)))
    return similarity.flatten(1).mean(1).reshape(a.shape[0], -1).mean(1)


def _check_pair(a: Tensor, b: Tensor) -> None:
    if a.shape != b.shape or a.dim() not in (5, 6):
        raise ValueError("light fields to compare are two [batch, view_y, view_x, y, x], or two with [channel], but the shapes are "
                         f"{list(a.shape)} and {list(b.shape)}")
