#!/usr/bin/env python3
"""Measures where light fields are good, in PSNR.

    python3 bench/quality/light_fields.py parts SCENE RESULT [RESULT...]
        of flat areas, edges, inner and outer views, dark and bright pixels; RESULT is the folder of
        `e2lf reconstruct events.npz -m MODEL -o RESULT --format npy --gain 1`
    python3 bench/quality/light_fields.py crops SCENE events.npz MODEL
        of the middle of crops of different sizes, which shows how far a network looks; events.npz is that of
        `e2lf simulate SCENE -m MODEL -o events.npz`
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

SIZES, CROPS, MIDDLE = (32, 48, 64, 96, 128, 192), 12, 24


def read_views(folder: Path) -> np.ndarray:
    """Returns the 8x8 views VV_UU.png of a folder as float32 [8, 8, y, x] in 0..1."""
    view = lambda v, u: np.asarray(Image.open(folder / f"{v:02}_{u:02}.png").convert("L"), np.float32) / 255
    return np.stack([np.stack([view(v, u) for u in range(8)]) for v in range(8)])


def read_result(folder: Path) -> np.ndarray:
    """Returns the light field that `e2lf reconstruct --format npy` wrote, clamped, as float32 [8, 8, y, x]."""
    field = np.load(folder / "lightfield.npy")
    return np.clip(field.reshape(8, 8, *field.shape[2:4]), 0, 1)


def psnr_db(squares: np.ndarray) -> float:
    return float(-10 * np.log10(squares.mean()))


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


def print_parts(scene: str, *results: str) -> None:
    truth = read_views(Path(scene))
    squares = [(read_result(Path(name)) - truth) ** 2 for name in results]
    for name, mask in parts_of(truth).items():
        print(f"{name:18}", *(f"{psnr_db(errors[mask]):7.2f}" for errors in squares))


def middle(array: np.ndarray, y: int, x: int, size: int) -> np.ndarray:
    return array[..., y - size // 2:y + size // 2, x - size // 2:x + size // 2]


def print_crops(scene: str, events: str, model: str) -> None:
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
    {"parts": print_parts, "crops": print_crops}[sys.argv[1]](*sys.argv[2:])
