#!/usr/bin/env python3
"""Prints the PSNR in dB of the last of 8 cycles in which a square moves before a scene: of one cycle, of the fused cycles
and of the mean of all, for the whole image, what stands still and what moves.

    python3 bench/quality/fusion.py SCENE THING [--step 4] [--camera evk4-lcos] [--model e2lf-n4-camera]

SCENE and THING are folders of 8x8 views. The square is the middle of the central view of THING, at the disparity 0. It
moves by --step px per cycle while the cycles are recorded; of the light fields that the last cycle shows, the one counts
that is nearest to what moves. `e2lf` must be on the PATH.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from light_fields import psnr_db, read_views
from PIL import Image

CYCLES, CYCLE_US = 8, 94738
SIZE, SIDE, MARGIN = 256, 72, 12  # of the image, of the square, and of the border that is left out, px
TIMES = np.linspace(0, 1, 9)  # of the last cycle


def middle(image: np.ndarray, size: int) -> np.ndarray:
    top, left = ((length - size) // 2 for length in image.shape[-2:])
    return image[..., top:top + size, left:left + size]


def place(options: argparse.Namespace, cycle: int) -> tuple[slice, slice]:
    left = (SIZE - SIDE - options.step * CYCLES) // 2 + options.step * cycle
    return slice((SIZE - SIDE) // 2, (SIZE + SIDE) // 2), slice(left, left + SIDE)


def write_views(views: np.ndarray, folder: Path) -> None:
    folder.mkdir(parents=True)
    for v, row in enumerate(views):
        for u, view in enumerate(row):
            Image.fromarray(np.rint(255 * view).astype(np.uint8)).save(folder / f"{v:02}_{u:02}.png")


def reconstruct(recording: Path, out: Path, options: argparse.Namespace, *flags: str) -> np.ndarray:
    """Returns the light field of the last cycle."""
    subprocess.run(["e2lf", "reconstruct", recording, "-m", options.model, "--camera", options.camera, "--gain", "1", "--format", "npy",
                    "--quiet", "-o", out, *flags], check=True)
    return np.load(sorted(out.rglob("lightfield.npy"))[-1])


def figures(field: np.ndarray, before: np.ndarray, after: np.ndarray, moving: np.ndarray) -> list[float]:
    """Returns the PSNR of all, what stands still and what moves, after a fit of the brightness."""
    inner = np.s_[..., MARGIN:-MARGIN, MARGIN:-MARGIN]
    results = []
    for time in TIMES:
        truth = (1 - time) * before + time * after
        fitted = np.clip(field * (field * truth).sum() / (field * field).sum(), 0, 1)
        squares = ((fitted - truth) ** 2)[inner]
        results.append([psnr_db(squares), psnr_db(squares[..., ~moving[inner]]), psnr_db(squares[..., moving[inner]])])
    return max(results, key=lambda row: row[2])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("thing", type=Path)
    parser.add_argument("--step", type=int, default=4, help="motion, px per cycle")
    parser.add_argument("--camera", default="evk4-lcos")
    parser.add_argument("--model", default="e2lf-n4-camera")
    options = parser.parse_args()
    scene, square = middle(read_views(options.scene), SIZE), middle(read_views(options.thing)[4, 4], SIDE)
    fields = []
    for cycle in range(CYCLES + 1):
        fields.append(scene.copy())
        fields[-1][(..., *place(options, cycle))] = square
    moving = np.zeros((SIZE, SIZE), bool)  # during the last cycle, or near it
    for cycle in (CYCLES - 1, CYCLES):
        rows, columns = place(options, cycle)
        moving[rows.start - 4:rows.stop + 4, columns.start - 4:columns.stop + 4] = True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number, field in enumerate(fields):
            write_views(field, folder / "fields" / f"{number:02}")
        recording = folder / "moving.raw"
        subprocess.run(["e2lf", "simulate", folder / "fields", "-m", options.model, "--stream", "--field-us", str(CYCLE_US), "--camera",
                        options.camera, "--cycles", str(CYCLES), "--quiet", "-o", recording], check=True)
        print("                    all  still  moving")
        for label, flags in (("one cycle", []), ("fused", ["--fuse", str(CYCLES)]), ("mean of 8", ["--cycles-per-field", str(CYCLES)])):
            field = reconstruct(recording, folder / label, options, *flags)
            print(f"{label:14}", *(f"{value:7.2f}" for value in figures(field, fields[CYCLES - 1], fields[CYCLES], moving)))


if __name__ == "__main__":
    main()
