#!/usr/bin/env python3
"""Grain and contrast of two light fields of the released capture `Animals`, at the same brightness.

    e2lf reconstruct Animals -m models/e2lf-n4-capture.safetensors --format npy -o ours
    e2lf reconstruct Animals -m release.safetensors --format npy -o release
    python3 bench/capture/compare_on_capture.py ours release

There is no true light field. So the second picture first gets the tones of the first: one curve for the whole picture,
the median of the first over each brightness of the second, taken where both are smooth. Then the same numbers are
taken of both central views. Needs python3-numpy.
"""

import sys
from pathlib import Path

import numpy as np

CENTRE = 3  # view_y and view_x

# Places of structure, half-open in pixels: y0, y1, x0, x1.
PLACES = {
    "zebra, stripes of the back": (20, 200, 960, 1090),
    "zebra, stripes of the neck": (20, 150, 880, 930),
    "rabbit, fur of the flank": (330, 560, 640, 880),
    "rabbit, fur of the face": (250, 360, 400, 500),
    "butterfly, upper wing": (110, 280, 200, 440),
    "butterfly, lower wing": (330, 500, 180, 390),
    "butterfly, spots of the wing's edge": (100, 250, 400, 450),
    "printed butterfly": (20, 180, 330, 510),
    "base of the rabbit": (580, 700, 420, 970),
}
FLAT_PLACES = {
    "checkerboard, white, left": (565, 635, 40, 240),
    "checkerboard, white, right": (590, 650, 1050, 1150),
    "checkerboard, white, far right": (150, 190, 1115, 1175),
    "white wall": (15, 100, 248, 300),
    "zebra's face": (150, 230, 790, 822),
    "zebra's chest": (200, 240, 885, 935),
    "checkerboard, black, right": (470, 525, 1120, 1230),
    "checkerboard, black, left": (15, 75, 90, 185),
}


def blur(picture: np.ndarray, sigma_px: float) -> np.ndarray:
    """Gaussian blur, edges repeated."""
    radius = int(4 * sigma_px + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma_px) ** 2)
    kernel /= kernel.sum()
    for _ in range(2):
        padded = np.pad(picture, ((radius, radius), (0, 0)), mode="edge")
        picture = sum(weight * padded[k : k + len(picture)] for k, weight in enumerate(kernel)).T
    return picture


def steepness(picture: np.ndarray, sigma_px: float) -> np.ndarray:
    return np.hypot(*np.gradient(blur(picture, sigma_px)))


def tone_curve(source: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Brightness of `source` and what stands for it in `target`, rising, of the 40 % smoothest pixels."""
    rough = steepness(source, 2) + steepness(target, 2)
    smooth = rough < np.quantile(rough, 0.4)
    x, y = blur(source, 3)[smooth], blur(target, 3)[smooth]
    bins = np.digitize(x, np.linspace(x.min(), x.max(), 60))
    points = [(x[bins == b].mean(), np.median(y[bins == b])) for b in np.unique(bins) if (bins == b).sum() > 300]
    levels, tones = np.array(points).T
    return levels, np.maximum.accumulate(tones)


def apply_curve(picture: np.ndarray, levels: np.ndarray, tones: np.ndarray) -> np.ndarray:
    """The curve goes on straight at both ends."""
    low = (tones[3] - tones[0]) / (levels[3] - levels[0])
    high = (tones[-1] - tones[-4]) / (levels[-1] - levels[-4])
    inside = np.interp(picture, levels, tones)
    return inside + low * np.minimum(picture - levels[0], 0) + high * np.maximum(picture - levels[-1], 0)


def grain(picture: np.ndarray, place: tuple[int, int, int, int]) -> float:
    """Deviation from the mean over 11x11 px, in percent of white."""
    y0, y1, x0, x1 = place
    near = picture[y0 - 5 : y1 + 5, x0 - 5 : x1 + 5]
    mean = np.lib.stride_tricks.sliding_window_view(near, (11, 11)).mean((2, 3))
    return float(100 * (picture[y0:y1, x0:x1] - mean).std())


def structure(picture: np.ndarray, place: tuple[int, int, int, int]) -> float:
    """Deviation between blurs of 0.8 and 6 px over the mean of the place."""
    y0, y1, x0, x1 = place
    detail = blur(picture, 0.8) - blur(picture, 6)
    return float(detail[y0:y1, x0:x1].std() / picture[y0:y1, x0:x1].mean())


def print_table(title: str, places: dict, figure, first: np.ndarray, second: np.ndarray) -> None:
    print(f"{title:>36} {'first':>7} {'second':>7} {'ratio':>6}")
    ratios = []
    for name, place in places.items():
        a, b = figure(first, place), figure(second, place)
        ratios.append(a / b)
        print(f"{name:>36} {a:7.3f} {b:7.3f} {a / b:6.2f}")
    print(f"{'mean':>36} {'':7} {'':7} {np.mean(ratios):6.2f}\n")


def main() -> None:
    first, second = (np.load(Path(folder) / "lightfield.npy")[CENTRE, CENTRE].astype(float) for folder in sys.argv[1:])
    second = apply_curve(second, *tone_curve(second, first))
    print_table("grain, % of white", FLAT_PLACES, grain, first, second)
    print_table("structure", PLACES, structure, first, second)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main()
