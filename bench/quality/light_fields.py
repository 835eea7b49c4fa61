"""Reads light fields for the scripts of this folder."""

from pathlib import Path

import numpy as np
from PIL import Image


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
