#!/usr/bin/env python3
"""Renders light fields of a checkerboard in several poses through a known lens, to try calibrate_lens.py.

    python3 simulated_board.py FOLDER [POSES]      needs python3-opencv; writes FOLDER/pose_00 ... and FOLDER/true_lens.json
"""

import json
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np

WIDTH, HEIGHT, COLUMNS, ROWS, SQUARE_M = 320, 240, 9, 6, 0.025
FOCAL, CENTRE, DISTORTION = 400.0, (161.5, 118.0), np.array([-0.12, 0.03, 0, 0, 0])
BASELINE_M, FOCUS_M = 0.006, 0.6


def board_at(points: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Returns the brightness of the plane of the board, whose first inner corner is (0, 0); points [..., 2] in m."""
    x, y = points[..., 0] / SQUARE_M + 1, points[..., 1] / SQUARE_M + 1
    on_squares = (x >= 0) & (x < COLUMNS + 1) & (y >= 0) & (y < ROWS + 1)
    on_paper = (x >= -1) & (x < COLUMNS + 2) & (y >= -1) & (y < ROWS + 2)
    is_black = on_squares & ((np.floor(x) + np.floor(y)) % 2 == 0)
    return np.where(is_black, 0.05, np.where(on_paper, 0.85, 0.35))


def main() -> None:
    folder, poses = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 10
    rng = np.random.default_rng(1)
    matrix = np.array([[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]])
    offsets = (-0.25, 0.25)  # samples of a pixel
    grid = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), axis=-1).astype(np.float64)
    rays = [cv2.undistortPoints((grid + [dx, dy]).reshape(-1, 1, 2), matrix, DISTORTION).reshape(HEIGHT, WIDTH, 2)
            for dy in offsets for dx in offsets]
    middle = np.array([COLUMNS - 1, ROWS - 1, 0]) * SQUARE_M / 2
    for pose in range(poses):
        rotation = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3))[0]
        centre = np.array([*rng.uniform(-0.05, 0.05, 2), rng.uniform(0.45, 0.75)])
        output = folder / f"pose_{pose:02}"
        output.mkdir(parents=True)
        for row in range(8):
            for column in range(8):
                pinhole = BASELINE_M * np.array([column - 4, row - 4, 0.0])
                image = np.zeros((HEIGHT, WIDTH))
                for ray in rays:
                    at_focus = FOCUS_M * np.concatenate([ray, np.ones((HEIGHT, WIDTH, 1))], axis=-1)
                    direction = at_focus - pinhole
                    # The plane: rotation @ (u, v, 0) + centre - rotation @ middle
                    t = (centre - pinhole) @ rotation[:, 2] / (direction @ rotation[:, 2])
                    image += board_at(((pinhole + t[..., None] * direction - centre) @ rotation + middle)[..., :2])
                cv2.imwrite(str(output / f"{row:02}_{column:02}.png"), np.round(255 * image / len(rays)))
    (folder / "true_lens.json").write_text(json.dumps({
        "width": WIDTH, "height": HEIGHT, "focal_px": [FOCAL, FOCAL], "centre_px": CENTRE,
        "distortion": DISTORTION.tolist(), "baseline_m": BASELINE_M, "focus_m": FOCUS_M}, indent=2) + "\n")


if __name__ == "__main__":
    main()
