"""Event counts of the paper's model (Eq. 9 and 10) and of physical pixels, with constants drawn for each sample."""
import math

import numpy as np
import torch

from scenes import to_device

THRESHOLD_FLOOR, RELATIVE_FLOOR = 0.01, 0.3
FIXED_CONDITIONS = 16  # as in capture::conditioning_vector()
CYCLES_CONDITION, CYCLES_STEP = 15, 0.25  # the place of the number of cycles, and what a doubling adds
MOST_PATTERNS = 7  # lit ones


def nominal(camera):
    """Returns the constants and uncertainties of a camera file as two dicts."""
    constants = camera["constants"]
    return {k: v["value"] for k, v in constants.items()}, {k: v.get("uncertainty", 0.0) for k, v in constants.items()}


class Conditions:
    """Sensor constants of a batch.

    options: camera (a parsed camera file, or None), camera_share, residue_share, nominal_share, noise_free_share; or
    nominal=True for the stated constants alone.
    """

    def __init__(self, batch, rng, device, camera=None, camera_share=0.0, residue_share=0.0, nominal_share=0.4,
                 noise_free_share=0.2, stated=False):
        is_nominal = (rng.random(batch) < nominal_share) | stated
        is_free = (rng.random(batch) < noise_free_share) & ~is_nominal
        pick = lambda usual, low, high: np.where(is_nominal, usual, rng.uniform(low, high, batch))
        self.tau = pick(0.3, 0.27, 0.33)
        self.sigma_w, self.sigma_z = pick(0.175, 0, 0.25) * ~is_free, pick(0.04, 0, 0.06) * ~is_free
        self.residue = np.minimum(1, rng.uniform(0, 2, batch)) * ((rng.random(batch) < residue_share) & ~is_nominal)
        self.gain = np.where((rng.random(batch) < 0.5) | stated, 1.0, np.exp(rng.uniform(math.log(0.15), 0, batch)))
        self.eps = np.full(batch, 0.01)
        self.is_pixel = rng.random(batch) < (camera_share if camera else 0)
        self.device = device
        if camera:
            self._draw_camera(batch, rng, camera, 0.0 if stated else 1.0)

    def _draw_camera(self, batch, rng, camera, spread):
        values, uncertainties = nominal(camera)
        self.pixel = {key: value * np.exp(rng.uniform(-1, 1, batch) * uncertainties[key] * spread) for key, value in values.items()}
        is_better = (rng.random(batch) < 0.35) & (spread > 0)
        for keys, least, most in ((("receptor_rate_hz", "amplifier_rate_hz"), 1.0, 1000.0), (("mismatch", "mismatch_each"), 0.01, 1.0),
                                  (("noise", "shot_noise", "dark_off", "dark_on"), 0.01, 1.0), (("leak",), 0.01, 1.0)):
            factor = np.where(is_better & (rng.random(batch) < 0.5), np.exp(rng.uniform(math.log(least), math.log(most), batch)), 1.0)
            for key in keys:
                self.pixel[key] = self.pixel[key] * factor
        stated = np.ones(MOST_PATTERNS)
        stated[:len(camera["transmission"]["value"])] = camera["transmission"]["value"]
        self.known_transmission = stated * np.exp(rng.uniform(-1, 1, (batch, len(stated))) * 0.06 * spread)
        self.transmission = self.known_transmission * np.exp(rng.uniform(-1, 1, (batch, len(stated))) * 0.12 * spread)
        self.gain = np.where(self.is_pixel & (spread > 0), np.exp(rng.uniform(math.log(0.12), math.log(1.4), batch)), self.gain)
        self.eps = np.where(self.is_pixel, self.pixel["eps"], self.eps)

    def planes(self, values):
        """Returns a value per sample, shaped to be multiplied with [batch, y, x]."""
        return to_device(np.asarray(values, np.float32), self.device).view(-1, 1, 1)

    def conditioning(self):
        """Returns what describes the sensor to a network, as the first elements of capture::conditioning_vector() before the number of
        cycles: [batch, 15]."""
        batch = len(self.tau)
        threshold = lambda tau: 4 * (tau / 0.3 - 1)
        lag = lambda rate_hz: 30 / (30 + rate_hz)
        zero = np.zeros(batch)
        rows = [zero, threshold(self.tau), threshold(self.tau), self.sigma_w / 0.1, self.sigma_z / 0.04, zero, zero, self.residue, *[zero] * 7]
        if self.is_pixel.any():
            p = self.pixel
            pixel = [zero + 1, threshold(p["threshold_on"]), threshold(p["threshold_off"]), p["noise"] / 0.1, zero, p["mismatch"] / 0.1,
                     p["mismatch_each"] / 0.1, p["reset_span"], p["reset_offset"] / 0.1, lag(p["receptor_rate_hz"]),
                     lag(p["amplifier_rate_hz"]), p["leak"] * 500, p["shot_noise"] / 0.1, p["dark_off"] * 20, p["dark_on"] * 20]
            rows = [np.where(self.is_pixel, a, b) for a, b in zip(pixel, rows)]
        return to_device(np.stack(rows, 1).astype(np.float32), self.device)

    def transmissions(self, lit, number):
        """Returns the elements of the conditioning vector for the transmissions of `lit` patterns, relative to the first, and 0 for the other
        pictures of a whole cycle: [batch, number]."""
        relative = np.zeros((len(self.tau), number))
        if self.is_pixel.any():
            relative[:, :lit] = 5 * (self.known_transmission[:, :lit] / self.known_transmission[:, :1] - 1) * self.is_pixel[:, None]
        return to_device(relative.astype(np.float32), self.device)


def count_events(intensities, conditions, whole_cycle, cycles):
    """Returns event images [batch, transitions, y, x] of one kind of sensor for each sample, averaged over cycles [batch, y, x]."""
    light = intensities * conditions.planes(conditions.gain).unsqueeze(1)
    codes, full = light[:, :-1], light[:, -1]
    counts, numbers = None, torch.unique(cycles).tolist()
    for is_pixel, count in ((False, count_paper), (True, count_pixel)):
        chosen = np.nonzero(conditions.is_pixel == is_pixel)[0]
        if not len(chosen):
            continue
        at = to_device(chosen, light.device)
        mismatch, total, found = torch.randn(3, *full[at].shape, device=light.device), 0, 0  # of the pixels: the same in each cycle
        for done in range(1, int(max(numbers)) + 1):
            total = total + count(codes[at], full[at], conditions, at, whole_cycle, mismatch)
            if done in numbers:
                found = torch.where(cycles[at].unsqueeze(1) == done, total / done, found)
        if counts is None:
            counts = found.new_empty(len(light), *found.shape[1:])
        counts[at] = found
    return counts


def count_paper(codes, full, conditions, at, whole_cycle, _):
    of = lambda values: conditions.planes(values)[at]
    shown = torch.cat([codes, full[:, None] - codes, codes[:, :1]], 1).clamp_min(0) if whole_cycle else codes
    levels = torch.log(shown + of(conditions.eps).unsqueeze(1))
    tau = of(conditions.tau)
    reference = levels[:, 0] + tau * of(conditions.residue) * torch.rand_like(full)
    counts = []
    for level in levels.unbind(1)[1:]:
        threshold = (tau + of(conditions.sigma_z) * torch.randn_like(level)).clamp_min(THRESHOLD_FLOOR)
        counts.append(((level - reference + of(conditions.sigma_w) * torch.randn_like(level)) / threshold).trunc())
        reference = reference + tau * counts[-1]
    return torch.stack(counts, 1)


def count_pixel(codes, full, conditions, at, whole_cycle, mismatch):
    """As learn::simulate_pixel_events() with one sub-window."""
    of = {key: conditions.planes(values)[at] for key, values in conditions.pixel.items()}
    transmission = to_device(conditions.transmission.astype(np.float32), full.device)[at]
    num_codes, eps = codes.shape[1], of["eps"]
    shown, inverses = [], []
    for n in range(num_codes):
        passed = codes[:, n] * (transmission[:, n - 1].view(-1, 1, 1) if n else 1)
        shown.append((passed + of["leak"] * (full - codes[:, n])) / eps + 1)
        inverses.append((full - passed).clamp_min(0) / eps + 1)
    if whole_cycle:
        shown += [*inverses, shown[0]]
    start = inverses[-1]

    def follow(light, seconds, inverse_level, level):
        target = 1 / light
        inverse_level = target + (inverse_level - target) * torch.exp(-of["receptor_rate_hz"] * seconds * light)
        settled = -torch.log(inverse_level)
        return inverse_level, settled + (level - settled) * torch.exp(-of["amplifier_rate_hz"] * seconds)

    common = 1 + of["mismatch"] * mismatch[0]
    on, off = (of[key] * (common + of["mismatch_each"] * each).clamp_min(RELATIVE_FLOOR)
               for key, each in zip(("threshold_on", "threshold_off"), mismatch[1:]))
    inverse_level, level = follow(shown[0], of["black_time_s"], 1 / start, torch.log(start))
    reference = level + off * of["reset_span"] * torch.rand_like(full) - of["reset_offset"]
    counts = []
    for n, light in enumerate(shown[1:], 1):
        is_black = n == 2 * num_codes
        deviation = torch.sqrt(of["noise"] ** 2 + of["shot_noise"] ** 2 / light)
        noise = -of["reset_offset"] if is_black else deviation * torch.randn_like(light)
        inverse_level, level = follow(light, of["black_time_s" if n % num_codes == 0 else "lit_time_s"], inverse_level, level)
        difference = level + noise - reference
        threshold = torch.where(difference > 0, on, off)
        count = (difference / threshold).trunc()
        reference = reference + threshold * count
        if not is_black:
            draw = torch.rand_like(light)
            dark_off, dark_on = (draw * light < of["dark_off"]).float(), ((1 - draw) * light < of["dark_on"]).float()
            reference, count = reference - dark_off * off + dark_on * on, count + dark_on - dark_off
        counts.append(count)
    return torch.stack(counts, 1)


def event_planes(events, conditions):
    """Returns the cumulative counts, levels and intensities of each picture, [batch, 3, P, y, x], as recon::network_input()."""
    cumulative, signs = events.cumsum(1), []
    for count in events.unbind(1):
        sign = count.sign()
        signs.append(torch.where(sign == 0, signs[-1], sign) if signs else sign)
    eps, tau = conditions.planes(conditions.eps).unsqueeze(1), conditions.planes(conditions.tau).unsqueeze(1)
    if conditions.is_pixel.any():
        means = 0.5 * (conditions.pixel["threshold_on"] + conditions.pixel["threshold_off"])
        tau = conditions.planes(np.where(conditions.is_pixel, means, conditions.tau)).unsqueeze(1)
    level = cumulative + 0.5 * torch.stack(signs, 1)
    intensity = eps * torch.expm1(torch.minimum(tau * level, torch.log1p(1 / eps)))
    return torch.stack([0.125 * cumulative, 0.125 * level, 4 * intensity], 1)
