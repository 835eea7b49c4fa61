"""Compares the scale that a map of `e2lf depth EVENTS` states with its errors.

usage: stated_scale.py MAP TRUTH.npy
MAP is the folder of a map, and TRUTH its true disparity [y, x] in px. Prints, for fifths of the pixels by the stated scale of their Laplace
distributions, the mean scale, the mean absolute error, which would be equal to it, and the share of errors below the median of the
distribution, which would be 50 %; and the area between the sparsification curve and that of an oracle, over the mean error (AUSE).
"""
import math
import pathlib
import sys

import numpy as np

HALF_ERROR_PX = 0.07  # the scale whose confidence is 0.5
BORDER_PX = 15


def scale_of(confidence):
    """Returns the scale that has this confidence, px."""
    return HALF_ERROR_PX * np.sqrt(1 / np.clip(confidence, 1e-9, 1) - 1)


def remaining_error(error, order):
    """Returns the mean error of what is left when the first 0, 1, ... pixels in this order are left out."""
    return (np.cumsum(error[order][::-1]) / np.arange(1, len(error) + 1))[::-1]


def main():
    folder, truth = pathlib.Path(sys.argv[1]), np.load(sys.argv[2]).astype(np.float32)
    inside = (slice(BORDER_PX, -BORDER_PX), slice(BORDER_PX, -BORDER_PX))
    error = np.abs(np.load(folder / "disparity.npy") - truth)[inside].ravel()
    scale = scale_of(np.load(folder / "confidence.npy"))[inside].ravel()
    print("stated scale   mean error   below the median")
    for part in np.array_split(np.argsort(scale), 5):
        print(f"{scale[part].mean():9.3f} px {error[part].mean():9.3f} px {np.mean(error[part] < math.log(2) * scale[part]):12.0%}")
    area = np.mean(remaining_error(error, np.argsort(-scale)) - remaining_error(error, np.argsort(-error))) / error.mean()
    print(f"AUSE {area:.2f}; of an order by chance {np.mean(error.mean() - remaining_error(error, np.argsort(-error))) / error.mean():.2f}")


if __name__ == "__main__":
    main()
