#!/usr/bin/env python3
"""Prints the PSNR in dB of parts of light fields: flat areas, edges, inner and outer views, dark and bright pixels.

    e2lf reconstruct events.npz -m MODEL -o RESULT --format npy --gain 1
    python3 bench/quality/parts.py SCENE RESULT [RESULT...]
"""

import sys
from pathlib import Path

import numpy as np
from light_fields import psnr_db, read_result, read_views


def parts_of(truth: np.ndarray) -> dict:
    """Returns a mask [8, 8, y, x] for each part."""
    difference = np.abs(np.diff(truth, axis=2, append=truth[:, :, -1:])) + np.abs(
        np.diff(truth, axis=3, append=truth[..., -1:]))
    offset = np.abs(np.arange(8) - 3.5)
    ring = np.maximum(offset[:, None], offset)[:, :, None, None] + np.zeros_like(truth)
    return {"all": ring >= 0, "flat half": difference <= np.quantile(difference, 0.5),
            "edges (a fifth)": difference > np.quantile(difference, 0.8), "inner 4x4 views": ring < 2,
            "outermost views": ring > 3, "darkest quarter": truth <= np.quantile(truth, 0.25),
            "brightest quarter": truth >= np.quantile(truth, 0.75)}


def main() -> None:
    truth = read_views(Path(sys.argv[1]))
    squares = [(read_result(Path(name)) - truth) ** 2 for name in sys.argv[2:]]
    for name, mask in parts_of(truth).items():
        print(f"{name:18}", *(f"{psnr_db(errors[mask]):7.2f}" for errors in squares))


if __name__ == "__main__":
    main()
