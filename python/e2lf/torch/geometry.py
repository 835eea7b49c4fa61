"""The operations of networks with an explicit geometry; documented at e2lf::geometry::Op."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Sequence, Tuple

import torch
from torch import Tensor
from torch.nn import functional as F


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


def shift_matrices(size: int, offsets: Sequence[float], is_cubic: bool, like: Tensor) -> Tensor:
    """Returns matrices M [offset, size, size] with (M x)[i] = x(i + offset): linear with zeros outside, or cubic with edges repeated."""
    matrices = torch.zeros(len(offsets), size, size)
    rows = torch.arange(size)
    for matrix, offset in zip(matrices, offsets):
        first, weights = _cubic_taps(offset) if is_cubic else _linear_taps(offset)
        for tap, weight in enumerate(weights):
            columns = rows + (first + tap)
            inside = torch.ones_like(columns, dtype=torch.bool) if is_cubic else (columns >= 0) & (columns < size)
            values = torch.full((int(inside.sum()),), float(weight))
            matrix.index_put_((rows[inside], columns[inside].clamp(0, size - 1)), values, accumulate=True)
    return matrices.to(like)


def _move(x: Tensor, down: Tensor, across: Tensor) -> Tensor:
    """Moves x [batch, channel, y, x] by matrices [y, y] and [x, x]."""
    moved: Tensor = down @ (x @ across.t())
    return moved


def plane_sweep(x: Tensor, layer: Dict[str, Any]) -> Tensor:
    offsets, disparities, kernel = layer["offsets"], layer["disparities"], layer.get("kernel", 1)
    pictures = x.chunk(len(offsets) // 2, 1)
    evidence = []
    for disparity in disparities:
        moved = [_move(picture, shift_matrices(x.shape[2], [offsets[2 * p] * disparity], False, x)[0],
                       shift_matrices(x.shape[3], [offsets[2 * p + 1] * disparity], False, x)[0])
                 for p, picture in enumerate(pictures)]
        total, energy = torch.stack(moved).sum(0), torch.stack(moved).square().sum(0)
        means = torch.stack([(total.square() - energy) / 2, energy]).mean(2)
        products, squares = F.avg_pool2d(means, kernel, 1, kernel // 2)
        evidence.append(products / (1 + squares))
    return torch.stack(evidence, 1)


def render_layers(x: Tensor, layer: Dict[str, Any]) -> Tensor:
    disparities, rows, columns = layer["disparities"], layer["rows"], layer["columns"]
    planes = len(disparities)
    opacity = torch.sigmoid(x[:, :planes])
    opacity = torch.cat([opacity[:, :-1], torch.ones_like(opacity[:, -1:])], 1)
    maps = torch.stack([opacity, x[:, planes:]], 2)  # [batch, plane, map, y, x]
    down = [shift_matrices(x.shape[2], [-row * d for d in disparities], True, x) for row in rows]
    across = [shift_matrices(x.shape[3], [-column * d for d in disparities], True, x) for column in columns]
    views = []
    for vertical in down:
        lower = torch.einsum("pij,bpmjx->bpmix", vertical, maps)
        for horizontal in across:
            picture, passed = torch.zeros_like(x[:, 0]), torch.ones_like(x[:, 0])
            for plane in torch.einsum("pij,bpmyj->pbmyi", horizontal, lower):
                share = passed * plane[:, 0].clamp(0, 1)
                picture, passed = picture + share * plane[:, 1], passed - share
            views.append(picture)
    return torch.stack(views, 1)
