"""Sequences of lit patterns, drawn anew for each sample, and what a network needs to know of them."""
import math

import numpy as np
import torch

VIEWS = 8
REFERENCE = 4  # row and column of the view whose disparity is estimated
AREAS = [5 / 64, 8 / 64, 7 / 64]  # of the first, the second and later patterns of e2lf-n4, as shares of the open aperture
RIDGE = 0.02  # of the gradients with respect to the viewpoint, per picture
CONSTANTS = 17  # of an Aperture
SLOTS = MOMENTS = 3  # of an Aperture

_ROWS, _COLUMNS = (axis.astype(np.float64) for axis in np.meshgrid(range(VIEWS), range(VIEWS), indexing="ij"))


def _compact(rng):
    """Returns a compact aperture of 2 to 16 cells of any outline."""
    centre = rng.uniform(0.3, 6.7, 2)
    number = int(round(math.exp(rng.uniform(math.log(2), math.log(16)))))
    angle, stretch = rng.uniform(0, math.pi), math.exp(rng.uniform(0, 0.8))
    y, x = _ROWS - centre[0], _COLUMNS - centre[1]
    along, across = y * math.sin(angle) + x * math.cos(angle), y * math.cos(angle) - x * math.sin(angle)
    distance = np.hypot(along / stretch, across * stretch) + rng.uniform(0, 0.8) * rng.random((VIEWS, VIEWS))
    return (distance <= np.sort(distance.ravel())[number - 1]).astype(np.float64)


def _half(rng):
    """Returns a half, a quarter or another part of the aperture beside one or two lines."""
    inside = np.full((VIEWS, VIEWS), 10.0)
    for _ in range(rng.integers(1, 3)):
        angle = rng.choice(8) * math.pi / 4 if rng.random() < 0.6 else rng.uniform(0, 2 * math.pi)
        inside = np.minimum(inside, (_ROWS - 3.5) * math.sin(angle) + (_COLUMNS - 3.5) * math.cos(angle) - rng.choice([0, rng.uniform(-1, 2)]))
    return np.clip(inside + 0.5, 0, 1)


def _shifted(code, dy, dx):
    """Returns a pattern that is shifted by a part of a cell, linear with zeros outside."""
    for axis, shift in ((0, dy), (1, dx)):
        moved = np.zeros_like(code)
        step, at = int(math.copysign(1, shift)), [slice(None)] * 2
        source = [slice(None)] * 2
        at[axis], source[axis] = (slice(1, None), slice(None, -1)) if step > 0 else (slice(None, -1), slice(1, None))
        moved[tuple(at)] = code[tuple(source)]
        code = (1 - abs(shift)) * code + abs(shift) * moved
    return code


def _blurred(code, share):
    padded = np.pad(code, 1)
    mean = sum(padded[1 + dy:9 + dy, 1 + dx:9 + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)) / 9
    return (1 - share) * code + share * mean


def _imperfect(rng, codes):
    """Returns patterns with edges, leakage and transmissions as of real displays."""
    if rng.random() < 0.3:
        shift = rng.uniform(-0.5, 0.5, 2)
        codes = [_shifted(code, *shift) for code in codes]
    if rng.random() < 0.3:
        share = rng.uniform(0.1, 0.8)
        codes = [_blurred(code, share) for code in codes]
    if rng.random() < 0.3:
        leakage, transmission = rng.uniform(0.02, 0.1) * rng.integers(2), rng.uniform(0.7, 1.0)
        codes = [leakage + (transmission - leakage) * code for code in codes]
    return codes


def _is_usable(codes):
    """Tells whether the pictures have parallax between them."""
    centroids = np.array([[(c * _ROWS).sum(), (c * _COLUMNS).sum()] / c.sum() if c.sum() > 1 else [np.nan] * 2 for c in codes])
    return np.isfinite(centroids).all() and (len(codes) < 2 or centroids.std(0).sum() > 0.7)


def draw_patterns(rng, number, known, known_share=0.5):
    """Returns `number` lit patterns, [number, 64] in [0, 1]; known: sets of lit patterns [n, 64] of which some are taken."""
    while True:
        candidates = [codes for codes in known if len(codes) >= number]
        if candidates and rng.random() < known_share:
            chosen = candidates[rng.integers(len(candidates))]
            at = np.arange(number) if rng.random() < 0.6 else rng.permutation(len(chosen))[:number]
            codes = [chosen[i].reshape(VIEWS, VIEWS).astype(np.float64) for i in at]
        else:
            draw = _half if rng.random() < 0.15 else _compact
            codes = [draw(rng) for _ in range(number)]
        turn, is_mirrored = rng.integers(4), rng.random() < 0.5
        if rng.random() < 0.5:
            codes = [np.rot90(code[::-1] if is_mirrored else code, turn) for code in codes]
        codes = _imperfect(rng, codes)
        if _is_usable(codes):
            return np.stack(codes).reshape(number, -1).astype(np.float32)


def with_inverses(codes):
    """Returns the patterns of a whole cycle between its black ones: the lit ones, the open aperture, and the inverses."""
    return np.concatenate([codes, np.ones((1, codes.shape[1]), np.float32), 1 - codes])


class Aperture:
    """What a network for any patterns knows of those of a batch, [batch, P, 64].

    slots: the linear map [batch, 3, P] from pictures to the first, the second, and the mean of the later ones; moments: the linear map
    [batch, 3, P] from pictures to the central one and its derivatives with respect to the row and column of the viewpoint; gains: what makes
    intensities behind all patterns alike, [batch, P];
    offsets: of the pictures from the reference view, [batch, P, 2] in view steps; weights: of the pictures in the comparison, with a mean
    of 1, [batch, P]; constants: [batch, CONSTANTS].
    """

    def __init__(self, codes, device):
        codes = np.asarray(codes, np.float64)
        total = codes.sum(2)
        row, column = ((codes * axis.ravel()).sum(2) / total for axis in (_ROWS, _COLUMNS))
        spread = [((codes * (axis.ravel() - mean[:, :, None]) * (other.ravel() - other_mean[:, :, None])).sum(2) / total) for axis, mean, other, other_mean in
                  ((_ROWS, row, _ROWS, row), (_COLUMNS, column, _COLUMNS, column), (_ROWS, row, _COLUMNS, column))]
        row, column = row - REFERENCE, column - REFERENCE
        weights = 1 / (0.5 + spread[0] + spread[1])
        weights /= weights.mean(1, keepdims=True)
        design = np.stack([np.ones_like(row), row, column], 2)
        weighted = design * weights[:, :, None]
        normal = weighted.transpose(0, 2, 1) @ design + RIDGE * codes.shape[1] * np.diag([0, 1, 1])
        moments = np.linalg.solve(normal + 1e-9 * np.eye(3), weighted.transpose(0, 2, 1))
        areas = total / VIEWS**2
        number = codes.shape[1]
        slots = np.zeros((len(codes), 3, number))
        slots[:, 0, 0] = slots[:, 1, 1] = 1
        slots[:, 2, min(2, number - 1):] = 1 / max(1, number - 2)
        offsets = np.stack([row, column], 2)
        noise = np.log((moments**2).sum(2) + 1e-4)  # without parallax along an axis, a row is zero
        mean_spread = [(weights * s).mean(1) for s in spread]
        of_slots = lambda values: np.einsum("bsp,bp->sb", slots, values)
        relative_area = np.log(areas / np.array([AREAS[min(p, 2)] for p in range(number)]))
        constants = np.stack([*(0.5 * of_slots(relative_area)), *(0.3 * of_slots(row)), *(0.3 * of_slots(column)), *(0.3 * noise.T),
                              *(0.3 * s for s in mean_spread), 0.3 * np.log(weights).std(1), np.log(number / 3) * np.ones(len(codes))], 1)
        put = lambda values: torch.from_numpy(np.ascontiguousarray(values, np.float32)).to(device)
        self.slots, self.moments, self.gains = put(slots), put(moments), put(AREAS[1] / areas)
        self.offsets, self.weights, self.constants = put(offsets), put(weights), put(constants)
        self.number = number
