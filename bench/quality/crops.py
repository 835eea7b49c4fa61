#!/usr/bin/env python3
"""Prints how the PSNR in the middle of crops grows with their size, which shows how far a network looks.

    e2lf simulate SCENE -m MODEL -o events.npz
    python3 bench/quality/crops.py SCENE events.npz MODEL
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from light_fields import psnr_db, read_result, read_views

SIZES, CROPS, MIDDLE = (32, 48, 64, 96, 128, 192), 12, 24


def middle(array: np.ndarray, y: int, x: int, size: int) -> np.ndarray:
    return array[..., y - size // 2:y + size // 2, x - size // 2:x + size // 2]


def main() -> None:
    scene, events, model = sys.argv[1:4]
    truth, arrays = read_views(Path(scene)), dict(np.load(events))
    height, width = truth.shape[2:]
    images = arrays["events"].reshape(-1, height, width)
    random = np.random.default_rng(3)
    places = [tuple(random.integers(max(SIZES) // 2, extent - max(SIZES) // 2) for extent in (height, width))
              for _ in range(CROPS)]
    for size in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            arrays["events"] = np.stack([middle(images, *place, size) for place in places])
            np.savez(f"{folder}/crops.npz", **arrays)
            subprocess.run(["e2lf", "reconstruct", f"{folder}/crops.npz", "-m", model, "-o", f"{folder}/out",
                            "--format", "npy", "--gain", "1", "--precision", "float32", "--quiet"], check=True)
            squares = [(middle(read_result(Path(f"{folder}/out/cycle_{i:05}")), size // 2, size // 2, MIDDLE) -
                        middle(truth, *place, MIDDLE)) ** 2 for i, place in enumerate(places)]
        print(f"{size:4} px {psnr_db(np.stack(squares)):6.2f} dB", flush=True)


if __name__ == "__main__":
    main()
