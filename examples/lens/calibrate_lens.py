#!/usr/bin/env python3
"""Calibrates the lens from light fields of a checkerboard that stands still in ten or more poses.

    python3 calibrate_lens.py lens.json LIGHT_FIELD... [--corners 9x6] [--square-mm 25]      needs python3-opencv

Each light field is a folder of views as `e2lf reconstruct` writes it. OpenCV determines focal length, principal point
and distortion from the middle views. The disparity of a corner at depth z is D - f * baseline / z: its shift from view
to view, with the depths that OpenCV finds, determines the baseline and the focus distance. `e2lf depth --lens
lens.json` then measures in metres.
"""

import argparse
import json
from pathlib import Path
from typing import Any, Callable

import cv2
import numpy as np

Array = np.ndarray[Any, Any]
MIDDLE = 4  # the calibrated view, of 8x8


def corners_of(folder: Path, row: int, column: int, size: tuple[int, int]) -> Array | None:
    image = cv2.imread(str(folder / f"{row:02}_{column:02}.png"), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SystemExit(f"{folder} has no view {row:02}_{column:02}.png; give folders of `e2lf reconstruct`")
    found, corners = cv2.findChessboardCornersSB(image, size, flags=cv2.CALIB_CB_ACCURACY)
    return np.asarray(corners).reshape(-1, 2) if found else None


def shifts_of(folder: Path, size: tuple[int, int], undistorted: Callable[[Array], Array]) -> Array:
    """Returns the disparity of each corner: the slope of its position over the views of the middle row and column."""
    offsets, positions = [], []
    for step in range(-3, 4):
        for axis, view in ((0, (MIDDLE, MIDDLE + step)), (1, (MIDDLE + step, MIDDLE))):
            corners = corners_of(folder, *view, size)
            if corners is None:
                continue
            offsets.append((axis, step))
            positions.append(undistorted(corners)[:, axis])
    slopes = []
    for axis in (0, 1):
        steps = np.array([step for each, step in offsets if each == axis], float)
        places = np.array([place for (each, _), place in zip(offsets, positions) if each == axis])
        steps -= steps.mean()
        slopes.append(steps @ (places - places.mean(axis=0)) / (steps @ steps))
    return np.asarray(np.mean(slopes, axis=0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("light_fields", type=Path, nargs="+")
    parser.add_argument("--corners", default="9x6", help="number of inner corners, COLUMNSxROWS")
    parser.add_argument("--square-mm", type=float, default=25, help="side of a square")
    arguments = parser.parse_args()
    columns, rows = map(int, arguments.corners.split("x"))
    board = np.zeros((rows * columns, 3), np.float32)
    board[:, :2] = np.mgrid[:columns, :rows].T.reshape(-1, 2) * arguments.square_mm / 1000

    seen = {folder: corners_of(folder, MIDDLE, MIDDLE, (columns, rows)) for folder in arguments.light_fields}
    used = {folder: corners for folder, corners in seen.items() if corners is not None}
    print(f"the board was found in {len(used)} of {len(seen)} light fields")
    if len(used) < 4:
        raise SystemExit("at least four poses are necessary; check --corners, and record sharper, larger boards")
    first = cv2.imread(str(next(iter(used)) / f"{MIDDLE:02}_{MIDDLE:02}.png"), cv2.IMREAD_GRAYSCALE)
    height, width = first.shape
    error, matrix, distortion, rotations, translations = cv2.calibrateCamera(
        [board] * len(used), [corners.astype(np.float32) for corners in used.values()], (width, height), None, None,
        flags=cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST)

    def undistorted(corners: Array) -> Array:
        return np.asarray(cv2.undistortPoints(corners.reshape(-1, 1, 2), matrix, distortion, P=matrix)).reshape(-1, 2)

    disparities, nearness = [], []
    for folder, rotation, translation in zip(used, rotations, translations):
        disparities.append(shifts_of(folder, (columns, rows), undistorted))
        nearness.append(1 / (cv2.Rodrigues(rotation)[0] @ board.T + translation)[2])
    slope, infinity = np.polyfit(np.concatenate(nearness), np.concatenate(disparities), 1)
    focal = (matrix[0, 0] + matrix[1, 1]) / 2
    baseline = -slope / focal
    lens = {"width": width, "height": height, "focal_px": [matrix[0, 0], matrix[1, 1]],
            "centre_px": [matrix[0, 2], matrix[1, 2]], "distortion": distortion.ravel()[:5].tolist(),
            "baseline_m": baseline, "focus_m": focal * baseline / infinity}
    if baseline <= 0 or infinity <= 0:
        raise SystemExit("nearer boards do not have smaller disparities; check the orientation of the views")
    arguments.output.write_text(json.dumps(lens, indent=2) + "\n")
    print(f"reprojection error {error:.2f} px, focal length {matrix[0, 0]:.1f} x {matrix[1, 1]:.1f} px, "
          f"baseline {1000 * baseline:.2f} mm, focus at {lens['focus_m']:.3f} m")


if __name__ == "__main__":
    main()
