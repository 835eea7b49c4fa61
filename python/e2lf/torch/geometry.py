"""The operations of networks with an explicit geometry; documented at e2lf::geometry::Op."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Sequence, Tuple

import torch
from torch import Tensor, nn
from torch.autograd.function import once_differentiable
from torch.nn import functional as F

Layer = Dict[str, Any]


def is_traced() -> bool:
    """Returns whether torch.jit.trace or torch.onnx.export records what is computed."""
    return bool(torch.jit.is_tracing())  # type: ignore[attr-defined]


def _linear_taps(offset: float) -> Tuple[int, List[float]]:
    whole = math.floor(offset)
    t = offset - whole
    return whole, [1 - t, t]


def _cubic_taps(offset: float) -> Tuple[int, List[float]]:
    whole = math.floor(offset)
    t = offset - whole

    def near(u: float) -> float:
        return (1.5 * u - 2.5) * u * u + 1

    def far(u: float) -> float:
        return ((-0.5 * u + 2.5) * u - 4) * u + 2

    return whole - 1, [far(t + 1), near(t), near(1 - t), far(2 - t)]


def _extend(x: Tensor, axis: int, before: int, after: int, repeats_edges: bool) -> Tensor:
    """Extends an axis by its edges or by zeros."""
    size = x.shape[axis]
    edges = [x.narrow(axis, 0, 1), x.narrow(axis, size - 1, 1)]
    if not repeats_edges:
        edges = [torch.zeros_like(edge) for edge in edges]
    shape = list(x.shape)
    parts = [x]
    for count, edge, is_first in ((before, edges[0], True), (after, edges[1], False)):
        if count:
            shape[axis] = count
            parts.insert(0 if is_first else len(parts), edge.expand(shape))
    return torch.cat(parts, axis)


class _Reads:
    """From where each plane is read along an axis of `size` px, and the weights of the taps."""

    def __init__(self, size: int, offsets: Sequence[float], is_cubic: bool) -> None:
        taps = [_cubic_taps(offset) if is_cubic else _linear_taps(offset) for offset in offsets]
        self.size, self.is_cubic, self.weights = size, is_cubic, [weights for _, weights in taps]
        self.count = len(self.weights[0])
        # Beyond a width outside of the image, there are only zeros or only the edge.
        firsts = [min(max(first, -size - self.count), size) for first, _ in taps]
        self.before, self.after = max(0, -min(firsts)), max(0, max(firsts) + self.count - 1)
        self.starts = [self.before + first for first in firsts]

    def weight(self, like: Tensor) -> Tensor:
        """Returns the weights, [plane, tap, 1, ...]."""
        return like.new_tensor(self.weights).reshape(len(self.weights), self.count, *[1] * (like.dim() - 1))


def _shifted(x: Tensor, axis: int, reads: _Reads) -> Tensor:
    planes = _extend(x, axis, reads.before, reads.after, reads.is_cubic).unbind(0)
    length = reads.size + reads.count - 1
    window = torch.stack([plane.narrow(axis - 1, start, length) for plane, start in zip(planes, reads.starts)])
    weight = reads.weight(x)
    moved = window.narrow(axis, 0, reads.size) * weight[:, 0]
    for tap in range(1, reads.count):
        moved.addcmul_(window.narrow(axis, tap, reads.size), weight[:, tap])
    return moved


class _Shift(torch.autograd.Function):
    """_shifted() with a gradient that adds in place, which takes half of the time of the gradients of its slices."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, axis: int, reads: _Reads) -> Tensor:  # type: ignore[override]
        ctx.axis, ctx.reads = axis, reads
        return _shifted(x, axis, reads)

    @staticmethod
    @once_differentiable  # type: ignore[misc]
    def backward(ctx: Any, gradient: Tensor) -> Tuple[Tensor, None, None]:
        axis, reads = ctx.axis, ctx.reads
        shape = list(gradient.shape)
        shape[axis] = reads.size + reads.count - 1
        window, weight = gradient.new_empty(shape), reads.weight(gradient)
        torch.mul(gradient, weight[:, 0], out=window.narrow(axis, 0, reads.size))
        window.narrow(axis, reads.size, reads.count - 1).zero_()
        for tap in range(1, reads.count):
            window.narrow(axis, tap, reads.size).addcmul_(gradient, weight[:, tap])
        shape[axis] = reads.before + reads.size + reads.after
        extended = gradient.new_zeros(shape)
        for plane, part, start in zip(extended, window, reads.starts):
            plane.narrow(axis - 1, start, part.shape[axis - 1]).copy_(part)
        inner = extended.narrow(axis, reads.before, reads.size)
        if reads.is_cubic and reads.before:
            inner.narrow(axis, 0, 1).add_(extended.narrow(axis, 0, reads.before).sum(axis, keepdim=True))
        if reads.is_cubic and reads.after:
            outside = extended.narrow(axis, reads.before + reads.size, reads.after)
            inner.narrow(axis, reads.size - 1, 1).add_(outside.sum(axis, keepdim=True))
        return inner, None, None


def shift(x: Tensor, axis: int, offsets: Sequence[float], is_cubic: bool) -> Tensor:
    """Reads x [plane, ...] at i + offsets[plane] along an axis: linearly with zeros outside, or cubically with edges repeated."""
    reads = _Reads(x.shape[axis], offsets, is_cubic)
    if is_traced():  # exported networks consist of the operations of torch
        return _shifted(x, axis, reads)
    moved: Tensor = _Shift.apply(x, axis, reads)
    return moved


class PlaneSweep(nn.Module):
    """Compares pictures at several disparities."""

    def __init__(self, layer: Layer) -> None:
        super().__init__()
        self.disparities: List[float] = list(layer["disparities"])
        self.offsets: List[float] = list(layer["offsets"])
        self.kernel = int(layer.get("kernel", 1))

    def extra_repr(self) -> str:
        return f"pictures={len(self.offsets) // 2}, disparities={len(self.disparities)}, kernel={self.kernel}"

    def forward(self, x: Tensor) -> Tensor:
        total, energy = torch.zeros(()), torch.zeros(())
        for picture, y, x_ in zip(x.chunk(len(self.offsets) // 2, 1), self.offsets[::2], self.offsets[1::2]):
            planes = picture.expand(len(self.disparities), *picture.shape)  # [disparity, batch, feature, y, x]
            across = shift(planes, 4, [x_ * d for d in self.disparities], is_cubic=False)
            moved = shift(across, 3, [y * d for d in self.disparities], is_cubic=False)
            total, energy = total + moved, energy + moved.square()
        means = torch.cat([(total.square() - energy).mean(2) / 2, energy.mean(2)], 1)  # [disparity, 2 batch, y, x]
        products, squares = F.avg_pool2d(means, self.kernel, 1, self.kernel // 2).chunk(2, 1)
        evidence: Tensor = (products / (1 + squares)).transpose(0, 1)
        return evidence


class RenderLayers(nn.Module):
    """Renders planes at different disparities to views."""

    def __init__(self, layer: Layer) -> None:
        super().__init__()
        self.disparities: List[float] = list(layer["disparities"])
        self.rows: List[float] = list(layer["rows"])
        self.columns: List[float] = list(layer["columns"])

    def extra_repr(self) -> str:
        return f"planes={len(self.disparities)}, rows={len(self.rows)}, columns={len(self.columns)}"

    def forward(self, x: Tensor) -> Tensor:
        planes = len(self.disparities)
        opacity = torch.sigmoid(x[:, :planes])
        opacity = torch.cat([opacity[:, :-1], torch.ones_like(opacity[:, -1:])], 1)
        maps = torch.stack([opacity, x[:, planes:]]).permute(2, 0, 1, 3, 4)  # [plane, map, batch, y, x]
        views = []
        for row in self.rows:
            lower = shift(maps, 3, [-row * d for d in self.disparities], is_cubic=True)
            for column in self.columns:
                opacities, intensities = shift(lower, 4, [-column * d for d in self.disparities], is_cubic=True).unbind(1)
                views.append(_compose(opacities.clamp(0, 1), intensities))
        return torch.stack(views, 1)


class Warp(nn.Module):
    """Moves pictures to the reference view by a disparity of each pixel."""

    def __init__(self, layer: Layer) -> None:
        super().__init__()
        self.offsets: List[float] = list(layer["offsets"])
        self.least, self.most = layer["disparities"]

    def extra_repr(self) -> str:
        return f"pictures={len(self.offsets) // 2}, disparities=({self.least}, {self.most})"

    def forward(self, pictures: Tensor, disparity: Tensor) -> Tensor:
        number, (height, width) = len(self.offsets) // 2, pictures.shape[2:]
        d = disparity[:, 0].clamp(self.least, self.most)
        rows = torch.arange(height, dtype=d.dtype, device=d.device)[:, None]
        columns = torch.arange(width, dtype=d.dtype, device=d.device)
        moved = []
        for p in range(number):
            places = [(columns + self.offsets[2 * p + 1] * d) * (2 / max(1, width - 1)) - 1,
                      (rows + self.offsets[2 * p] * d) * (2 / max(1, height - 1)) - 1]
            moved.append(F.grid_sample(pictures[:, p::number], torch.stack(places, -1), padding_mode="border", align_corners=True))
        return torch.stack(moved, 2).flatten(1, 2)


def _compose(opacities: Tensor, intensities: Tensor) -> Tensor:
    """Returns what is seen of planes [plane, ...] from front to back; the last one is opaque."""
    picture: Tensor
    if is_traced():
        picture = intensities[-1]
        for opacity, intensity in zip(opacities[:-1].flip(0), intensities[:-1].flip(0)):
            picture = torch.lerp(picture, intensity, opacity)
    else:
        picture = _Compose.apply(opacities, intensities)
    return picture


class _Compose(torch.autograd.Function):
    """The composition with its gradient in closed form: a plane changes the picture by what it hides behind it."""

    @staticmethod
    def forward(ctx: Any, opacities: Tensor, intensities: Tensor) -> Tensor:  # type: ignore[override]
        passed = torch.cat([torch.ones_like(opacities[:1]), (1 - opacities[:-1]).cumprod(0)])
        shares = passed * opacities
        ctx.save_for_backward(opacities, intensities, passed, shares)
        return (shares * intensities).sum(0)

    @staticmethod
    @once_differentiable  # type: ignore[misc]
    def backward(ctx: Any, gradient: Tensor) -> Tuple[Tensor, Tensor]:
        opacities, intensities, passed, shares = ctx.saved_tensors
        behind = torch.zeros_like(intensities)
        for k in range(len(intensities) - 2, -1, -1):
            torch.lerp(behind[k + 1], intensities[k + 1], opacities[k + 1], out=behind[k])
        return passed * (intensities - behind) * gradient, shares * gradient
