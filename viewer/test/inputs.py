"""Makes what the browser tests look at, and what they must see: light.npy, other.npy, events.npz, expected.json."""
import json
import os
import sys

import numpy as np

VIEWS, HEIGHT, WIDTH, DISPARITY = 8, 48, 64, 2
folder = sys.argv[1]
rng = np.random.default_rng(3)


def weights(radius, x=0.0, y=0.0):
    """lightfield::round_aperture."""
    steps = np.arange(VIEWS) - (VIEWS - 1) / 2
    distance = np.hypot(steps[:, None] - y, steps[None, :] - x)
    return np.clip(radius + 0.5 - distance, 0, 1)


def refocused(field, disparity, weight):
    """lightfield::refocus for shifts by whole pixels; the nearest pixel stands in for what lies outside."""
    total = np.zeros((HEIGHT, WIDTH))
    for row in range(VIEWS):
        for column in range(VIEWS):
            y = np.clip(np.arange(HEIGHT) + int(disparity * (row - 3.5)), 0, HEIGHT - 1)
            x = np.clip(np.arange(WIDTH) + int(disparity * (column - 3.5)), 0, WIDTH - 1)
            total += weight[row, column] * field[row, column][np.ix_(y, x)]
    return total / weight.sum()


# A plane of noise, smooth enough for a disparity to be found, at a known disparity.
texture = rng.random((HEIGHT + 32, WIDTH + 32))
texture = (texture + np.roll(texture, 1, 0) + np.roll(texture, 1, 1) + np.roll(texture, (1, 1), (0, 1))) / 4
texture = np.round(255 * texture) / 255
light = np.empty((VIEWS, VIEWS, HEIGHT, WIDTH), np.float32)
for row in range(VIEWS):
    for column in range(VIEWS):
        top, left = 16 - DISPARITY * row, 16 - DISPARITY * column
        light[row, column] = texture[top : top + HEIGHT, left : left + WIDTH]
other = np.clip(light + (rng.integers(-8, 9, light.shape) / 255), 0, 1).astype(np.float32)
other[0, 0] = light[0, 0]
np.save(f"{folder}/light.npy", light)
np.save(f"{folder}/other.npy", other)

# A map that rises to the right, as of view 4, 4; the last columns are not known.
disparity = np.tile((1 + np.arange(WIDTH) / WIDTH).astype(np.float32), (HEIGHT, 1))
disparity[:, 60:] = np.nan
np.save(f"{folder}/disparity.npy", disparity)
np.save(f"{folder}/true_disparity.npy", np.full((HEIGHT, WIDTH), DISPARITY, np.float32))


def disparity_colours(values):
    """Those of e2lf depth, from near to far."""
    stops = np.array([[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [68, 1, 84]], float)
    known = np.sort(np.round(1000 * disparity[np.isfinite(disparity)])) / 1000
    few = (len(known) - 1) // 100
    near, far = known[few], known[len(known) - 1 - few]
    share = 4 * np.clip((values - near) / (far - near), 0, 1)
    return np.stack([np.interp(share, range(5), stops[:, channel]) for channel in range(3)])


# Two planes with holes in their confidence, of wrong disparities: one within a plane, which a relief closes, and one
# between both, which it leaves open. A few wrong disparities with a high confidence are closed as well.
disparity_of_planes = np.where(np.arange(WIDTH) < 32, -1, 1).astype(np.float32) * np.ones((HEIGHT, 1), np.float32)
certain = np.ones((HEIGHT, WIDTH), np.float32)
is_open = np.zeros((HEIGHT, WIDTH), bool)
wrong = disparity_of_planes.copy()
certain[10:14, 8:12] = 0.01
certain[:, 30:34] = 0.01
is_open[:, 30:34] = True
wrong[certain < 0.05] = 3
wrong[20:22, 50:53] = -3
os.makedirs(f"{folder}/planes")
np.save(f"{folder}/planes/disparity.npy", wrong)
np.save(f"{folder}/planes/confidence.npy", certain)
with open(f"{folder}/surface.json", "w") as file:
    json.dump({"disparity": disparity_of_planes.tolist(), "isOpen": is_open.tolist()}, file)

# Stripes of one pixel: what thins them out shows black or white.
fine = np.zeros((2, 2, 600, 500), np.float32)
fine[..., ::2] = 1
np.save(f"{folder}/fine.npy", fine)

colour = np.zeros((8, 8, 16, 24, 3), np.float32)
colour[..., 0], colour[..., 1], colour[..., 2] = 1.0, 128 / 255, 64 / 255
np.save(f"{folder}/colour.npy", colour)

events = rng.integers(-2, 3, (2, 3, HEIGHT, WIDTH)).astype(np.int16)
events[:, :, :8, :8] = 5
events[:, :, :8, 8:16] = -5
codes = np.zeros((4, 8, 8), np.float32)
codes[1, :4], codes[2, 4:], codes[3, :, :4] = 1, 1, 1
np.savez(f"{folder}/events.npz", events=events, codes=codes)

with np.errstate(divide="ignore"):
    mse = ((light.astype(np.float64) - other) ** 2).mean(axis=(2, 3)).ravel()
    psnr = -10 * np.log10(mse)
expected = {
    "views": np.round(255 * light[:, :, 20]).tolist(),  # row 20 of every view
    "view_columns": np.round(255 * light[:, :, :, 30]).tolist(),  # column 30
    "focused": (255 * refocused(light, 2, weights(3))[20]).tolist(),
    "defocused": (255 * refocused(light, 0, weights(3))[20]).tolist(),
    "moved": (255 * refocused(light, 0, weights(1, 1.5, -0.5))[20]).tolist(),
    "other": np.round(255 * other[4, 4, 20]).tolist(),
    "psnr_db": [None if np.isinf(value) else value for value in psnr],
    "disparity_colours": disparity_colours(disparity[20, :60]).tolist(),
    # Two views to the right a point of the map is further to the right by twice its disparity.
    "disparity_colours_moved": disparity_colours(1 + (np.arange(WIDTH) - 2) / (WIDTH + 2)).tolist(),
    "events_here": int(events[0, 1, 30, 40]),
    "events_around": float(np.abs(events[0, 1, 14:47, 24:57].astype(int)).mean()),
}
with open(f"{folder}/expected.json", "w") as file:
    json.dump(expected, file)
