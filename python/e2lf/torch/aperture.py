"""Coded apertures with trainable patterns."""
from __future__ import annotations

from typing import Any, List, Optional, Tuple

import torch
from torch import Tensor, nn

from .light_fields import check_shape

AMPLITUDE, RADIUS = 0.4, 2.0  # of the parameters of a soft disc, and in cells
TIES = ("none", "black-first", "complementary", "whole-cycle")


class CodedAperture(nn.Module):
    """The patterns of an aperture, which sum the views of light fields to coded intensities (Eq. 1).

    num_patterns: the number N of patterns; for "whole-cycle" 2 N + 1.
    views: number of views, (view_y, view_x).
    tie: "black-first" (the first pattern is black), "complementary" (every second pattern is the inverse of the one
        before), "whole-cycle" (black, codes, the inverses of both, black) or "none".
    codes: patterns [N, view_y, view_x] with which the training starts; None = soft discs at random positions.
    trained: whether the patterns are parameters. If not, `codes` are used as they are.
    binary: whether cells are open or closed, with the gradient of the sigmoid (straight-through); if not, they are the
        sigmoid itself.
    scale: factor of the parameters in the sigmoid, which may be increased during training.
    """

    weight: Optional[Tensor]

    def __init__(self, num_patterns: int = 4, *, views: Tuple[int, int] = (8, 8), tie: str = "black-first",
                 codes: Optional[Any] = None, trained: bool = True, binary: bool = True, scale: float = 1.0) -> None:
        super().__init__()
        if tie not in TIES:
            raise ValueError(f'a tie is one of {", ".join(TIES)}')
        self.tie, self.binary, self.scale = tie, binary, scale
        given = None if codes is None else torch.as_tensor(codes, dtype=torch.float32)
        self.register_buffer("fixed", None if trained else given)
        if not trained:
            if given is None:
                raise ValueError("patterns that are not trained must be given")
            self.weight = None
            return
        if given is not None:
            num_patterns = len(given)
        first, step, count = {"none": (0, 1, num_patterns), "black-first": (1, 1, num_patterns - 1),
                              "complementary": (0, 2, num_patterns // 2),
                              "whole-cycle": (1, 1, (num_patterns - 1) // 2 - 1)}[tie]
        if count < 1:
            raise ValueError(f"there is nothing to learn in {num_patterns} patterns")
        start = soft_discs(count, views) if given is None else (given[first::step][:count] - 0.5) * (2 * AMPLITUDE)
        self.weight = nn.Parameter(start)

    def codes(self) -> Tensor:
        """Returns the patterns, float32 [N, view_y, view_x], differentiable."""
        if self.weight is None:
            return self.fixed  # type: ignore[return-value]
        soft = torch.sigmoid(self.scale * self.weight)
        hard = (self.weight > 0).to(soft.dtype)
        free = hard + (soft - soft.detach()) if self.binary else soft
        black = torch.zeros_like(free[:1])
        if self.tie == "black-first":
            return torch.cat([black, free])
        if self.tie == "complementary":
            return torch.stack([free, 1 - free], 1).flatten(0, 1)
        if self.tie == "whole-cycle":
            return torch.cat([black, free, 1 - black, 1 - free, black])
        return free

    def forward(self, light_fields: Tensor) -> Tensor:
        """Returns coded intensities [batch, N, y, x] of light fields [batch, view_y, view_x, y, x]."""
        codes = self.codes().to(light_fields)
        check_shape("light fields", light_fields, "[batch, view_y, view_x, y, x]", tuple(codes.shape[1:]))
        return torch.einsum("nvu,bvuyx->bnyx", codes / codes[0].numel(), light_fields)


def soft_discs(count: int, views: Tuple[int, int]) -> Tensor:
    """Returns functions [count, view_y, view_x] that are positive near a random cell, far from the others, and negative elsewhere.

    White noise of small amplitude is not used, because all patterns would initially measure the same.
    """
    limits = torch.tensor(views) - 1.0
    centres: List[Tensor] = []
    for _ in range(count):
        candidates = [1 + (limits - 2).clamp_min(0) * torch.rand(2) for _ in range(8)]
        centres.append(max(candidates, key=lambda point: min((float(((point - other) ** 2).sum()) for other in centres), default=0)))
    rows, columns = torch.arange(views[0])[:, None], torch.arange(views[1])
    return torch.stack([
        AMPLITUDE * (1 - ((rows - y) ** 2 + (columns - x) ** 2) / RADIUS**2).clamp_min(-1) for y, x in centres])
