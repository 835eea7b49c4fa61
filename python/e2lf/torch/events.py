"""Simulation of event counts with gradients: the models of the paper, and physical pixels."""
from __future__ import annotations

from typing import Dict, List, Optional, Tuple

import torch
from torch import Tensor, nn

import e2lf

from .light_fields import check_shape

LEAST_THRESHOLD = 0.01  # of the paper's models
LEAST_RELATIVE_THRESHOLD = 0.3  # of physical pixels
RANDOM = ("noise", "shot_noise", "dark_off", "dark_on", "mismatch", "mismatch_each")


def toward_zero(steps: Tensor) -> Tensor:
    """Rounds toward zero, with the gradient of the identity."""
    return steps + (steps.trunc() - steps).detach()


class EventSimulator(nn.Module):
    """Counts the events that each change of the pattern causes, with the gradient of the counts before rounding.

    constants: sensor constants of the paper's models; None = those of the camera, or of the paper.
    event_model: "reference-aware" (Eq. 9 and 10) or "quantised" (Eq. 8); "" = that of the camera, or "reference-aware".
    camera: a camera; if it has physical pixels, their model is used.
    residue: in the paper's models, the reference of each pixel starts up to this many thresholds above the first level.
    noise: whether anything is random.
    whole_cycle: with physical pixels, whether the patterns are those of a whole cycle (2 N + 1).
    """

    def __init__(self, constants: Optional[e2lf.SensorConstants] = None, *, event_model: str = "",
                 camera: Optional[e2lf.Camera] = None, residue: float = 0.0, noise: bool = True,
                 whole_cycle: bool = False) -> None:
        super().__init__()
        self.constants = constants or (camera.constants if camera else e2lf.SensorConstants())
        self.event_model = event_model or (camera.event_model if camera else "reference-aware")
        if self.event_model not in ("reference-aware", "quantised", "pixel"):
            raise ValueError('an event model is "reference-aware" or "quantised", or that of a camera')
        if self.event_model == "pixel" and (camera is None or camera.event_model != "pixel"):
            raise ValueError("physical pixels need a camera whose file describes them")
        self.residue, self.noise, self.whole_cycle = residue, noise, whole_cycle
        self.pixel = PhysicalPixels(camera, noise) if camera and self.event_model == "pixel" else None

    def forward(self, intensities: Tensor, full: Optional[Tensor] = None) -> Tensor:
        """Returns event images [batch, N - 1, y, x] of coded intensities [batch, N, y, x].

        full: the intensity with all cells open, [batch, y, x], which physical pixels need: the mean over the views.
        """
        check_shape("coded intensities", intensities, "[batch, N, y, x]")
        if self.pixel:
            if full is None:
                raise ValueError("physical pixels need the intensity with all cells open; give full")
            return self.pixel.count(intensities, full, self.whole_cycle)
        tau = self.constants.tau
        levels = torch.log(intensities.clamp_min(0) + self.constants.eps)
        reference = levels[:, 0]
        if self.noise and self.residue:
            reference = reference + tau * self.residue * torch.rand_like(reference)
        counts: List[Tensor] = []
        for level in levels.unbind(1)[1:]:
            noisy, threshold = level, torch.full_like(level, tau)
            if self.noise:
                noisy = level + self.constants.sigma_w * torch.randn_like(level)
                threshold = (tau + self.constants.sigma_z * torch.randn_like(level)).clamp_min(LEAST_THRESHOLD)
            counts.append(toward_zero((noisy - reference) / threshold))
            reference = reference + tau * counts[-1] if self.event_model == "reference-aware" else level
        return torch.stack(counts, 1)


class PhysicalPixels:
    """The pixels of a camera file, as e2lf simulates them: see docs/simulation.md."""

    def __init__(self, camera: e2lf.Camera, noise: bool) -> None:
        file = camera.to_dict()
        self.value: Dict[str, float] = {name: entry["value"] for name, entry in file["constants"].items()}
        self.noise = noise
        if not noise:
            self.value.update((name, 0.0) for name in RANDOM)
        self.transmission = file.get("transmission", {})

    def count(self, intensities: Tensor, full: Tensor, whole_cycle: bool) -> Tensor:
        """Returns the event images of the cycle: the inverse of the last code, black, the other codes and, for a whole
        cycle, their inverses and black again."""
        value, num_patterns = self.value, intensities.shape[1]
        num_codes = (num_patterns - 1) // 2 if whole_cycle else num_patterns
        light, last_inverse = self._light(intensities.clamp_min(0), full.clamp_min(0), num_codes, whole_cycle)
        on, off = self._thresholds(last_inverse)
        inverse_level, level = self._follow(light[0], value["black_time_s"], 1 / last_inverse, torch.log(last_inverse))
        draw = torch.rand_like(level) if self.noise else 0.5
        reference = level + off * value["reset_span"] * draw - value["reset_offset"]
        counts = []
        for n in range(1, num_patterns):
            seconds = value["black_time_s" if n % num_codes == 0 else "lit_time_s"]
            inverse_level, level = self._follow(light[n], seconds, inverse_level, level)
            is_last_black = n == 2 * num_codes
            offset = -value["reset_offset"] if is_last_black else self._noise_of(light[n])
            difference = level + offset - reference
            threshold = torch.where(difference > 0, on, off)
            count = toward_zero(difference / threshold)
            reference = reference + threshold * count
            if not is_last_black:
                dark_on, dark_off = self._dark_events(light[n])
                count = count + dark_on - dark_off
                reference = reference + dark_on * on - dark_off * off
            counts.append(count)
        return torch.stack(counts, 1)

    def _light(self, intensities: Tensor, full: Tensor, num_codes: int, whole_cycle: bool) -> Tuple[List[Tensor], Tensor]:
        """Returns the light (I + eps) / eps through each pattern, and through the inverse of the last code."""
        eps, leak = self.value["eps"], self.value["leak"]
        codes, inverses = [], []
        for n in range(num_codes):
            open_cells = intensities[:, n]
            passed = open_cells * self._transmission_of(n, open_cells)
            codes.append((passed + leak * (full - open_cells)) / eps + 1)
            inverses.append((full - passed).clamp_min(0) / eps + 1)
        return (codes + inverses + codes[:1] if whole_cycle else codes), inverses[-1]

    def _transmission_of(self, n: int, image: Tensor) -> Tensor:
        """Returns the transmission [y, x] of code n relative to its open cells; that of black is 1."""
        def entry(key: str, default: float) -> float:
            values = self.transmission.get(key, [])
            return float(values[n - 1]) if 0 < n <= len(values) else default

        height, width = image.shape[-2:]
        x = (torch.arange(width, device=image.device) + 0.5) / (0.5 * width) - 1
        y = (torch.arange(height, device=image.device) + 0.5 - 0.5 * height) / (0.5 * width)
        slopes = entry("slope_y", 0.0) * y[:, None] + entry("slope_x", 0.0) * x
        return entry("value", 1.0) * torch.exp(slopes).to(image.dtype)

    def _thresholds(self, like: Tensor) -> Tuple[Tensor, Tensor]:
        """Draws the ON and OFF threshold of each pixel."""
        value = self.value
        common = 1 + value["mismatch"] * torch.randn_like(like)
        factors = [(common + value["mismatch_each"] * torch.randn_like(like)).clamp_min(LEAST_RELATIVE_THRESHOLD)
                   for _ in range(2)]
        return value["threshold_on"] * factors[0], value["threshold_off"] * factors[1]

    def _follow(self, light: Tensor, seconds: float, inverse_level: Tensor, level: Tensor) -> Tuple[Tensor, Tensor]:
        """Advances the photoreceptor, of which exp(-u) relaxes to 1 / light, and the amplifier that follows it."""
        target = 1 / light
        decay = torch.exp(-self.value["receptor_rate_hz"] * seconds * light)
        inverse_level = target + (inverse_level - target) * decay
        settled = -torch.log(inverse_level)
        share = torch.exp(torch.tensor(-self.value["amplifier_rate_hz"] * seconds)).item()
        return inverse_level, settled + (level - settled) * share

    def _noise_of(self, light: Tensor) -> Tensor:
        if not self.noise:
            return torch.zeros_like(light)
        return torch.sqrt(self.value["noise"] ** 2 + self.value["shot_noise"] ** 2 / light) * torch.randn_like(light)

    def _dark_events(self, light: Tensor) -> Tuple[Tensor, Tensor]:
        """Draws spurious ON and OFF events, which are rarer in brighter pixels."""
        draw = torch.rand_like(light)
        is_off = draw * light < self.value["dark_off"]
        is_on = (1 - draw) * light < self.value["dark_on"]
        return is_on.to(light.dtype), is_off.to(light.dtype)
