"""The input channels of networks, made from event images as `e2lf reconstruct` makes them."""
from __future__ import annotations

from typing import Any, List, Mapping, Optional, Sequence

import torch
from torch import Tensor
from torch.nn import functional as F

from .geometry import is_traced

LENS_PIXELS = 8


def level(events: Tensor) -> Tensor:
    """Returns the sum of the counts up to each transition and half a threshold with the sign of the last change."""
    signs: List[Tensor] = []
    for count in events.detach().unbind(1):
        sign = torch.sign(count)
        signs.append(torch.where(sign == 0, signs[-1], sign) if signs else sign)
    return events.cumsum(1) + 0.5 * torch.stack(signs, 1)


def intensity(events: Tensor, eps: float, tau: float) -> Tensor:
    """Returns the linearised intensities min(J_k, 1) of Eq. 7 for the levels."""
    # The exponent is limited instead of the result, which keeps the gradient finite.
    limit = torch.log1p(torch.tensor(1 / eps, dtype=events.dtype, device=events.device))
    exponent = torch.minimum(tau * level(events), limit)
    return eps * (torch.exp(exponent) - 1 if is_traced() else torch.expm1(exponent))  # ONNX has no expm1


def form_inputs(
    events: Optional[Tensor],
    groups: Sequence[Mapping[str, Any]],
    *,
    eps: float,
    tau: float,
    conditioning: Optional[Tensor] = None,
    images: Optional[Tensor] = None,
) -> Tensor:
    """Returns the input channels of a network, [batch, channel, y, x]. Differentiable.

    events: event images [batch, N - 1, y, x], averaged over cycles.
    groups: the entry "input" of the header of a model file.
    eps, tau: sensor constants, which the group "intensity" uses.
    conditioning: the description of the camera, [1 or batch, number], for the group "camera".
    images: intensity images [batch, image, y, x], for models that take them.
    """
    channels = []
    for group in groups:
        kind, scale = group["kind"], group.get("scale", 1.0)
        given = images if kind in ("images", "image-sum", "lens-array") else events
        if given is None:
            raise ValueError(f'the network has the input "{kind}"; give its images')
        if kind == "counts":
            planes = given
        elif kind == "cumulative":
            planes = given.cumsum(1)
        elif kind == "level":
            planes = level(given)
        elif kind == "intensity":
            planes = intensity(given, eps, tau)
        elif kind == "camera":
            if conditioning is None:
                raise ValueError("the network is conditioned on the camera; give its conditioning vector")
            traits = conditioning.to(given)[:, :, None, None]
            planes = traits.expand(given.shape[0], -1, *given.shape[2:])
        elif kind == "lens-array":
            lenses = F.pixel_unshuffle(given, LENS_PIXELS)
            planes = F.interpolate(lenses, size=given.shape[2:], mode="bilinear", align_corners=False)
        elif kind in ("images", "image-sum"):
            planes = given
        else:
            raise ValueError(f'there is no input "{kind}"')
        channels.append(planes * scale)
    return torch.cat(channels, 1)
