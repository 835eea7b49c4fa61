"""Logs the events, views, disparity and points of each cycle of a recording to the viewer of rerun (`pip install rerun-sdk`, 0.23
or newer).

python3 log_light_fields.py RECORDING [FOCAL_PX]

It was not run with rerun, which could not be installed where it was written. A test runs it with a substitute that keeps what is
logged.
"""
import sys
from typing import Any, Tuple

import numpy as np

import e2lf

LEAST_CONFIDENCE = 0.3
BASELINE = 1.0  # of a view step; the points have its unit


def points_of(disparity: Any, confidence: Any, view: Any, focal_px: float) -> Tuple[Any, Any]:
    """Returns points [n, 3] (x, y, z) and grey colours uint8 [n, 3] of the certain pixels that are nearer than the plane in focus."""
    certain = (confidence >= LEAST_CONFIDENCE) & (disparity < -0.01)
    y, x = np.nonzero(certain)
    z = focal_px * BASELINE / -disparity[certain]
    height, width = disparity.shape
    points = np.stack([(x - (width - 1) / 2) * z / focal_px, (y - (height - 1) / 2) * z / focal_px, z], 1)
    grey = np.round(255 * np.clip(view[certain], 0, 1)).astype(np.uint8)
    return points, np.repeat(grey[:, None], 3, 1)


def main() -> None:
    import rerun as rr

    path, focal_px = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 1000.0
    rr.init("e2lf", spawn=True)
    reconstructor = e2lf.Reconstructor("e2lf-n4")
    for cycle in e2lf.accumulate(path):
        rr.set_time("sensor", duration=cycle.begin_us * 1e-6)
        for number, counts in enumerate(cycle.images):
            rr.log(f"events/transition_{number}", rr.Image(np.clip(128 + 32 * counts.astype(int), 0, 255).astype(np.uint8)))
        light_field = reconstructor.reconstruct(cycle.images)
        for row, column in ((4, 4), (4, 0), (4, 7), (0, 4), (7, 4)):
            rr.log(f"views/{row}_{column}", rr.Image(np.round(255 * np.clip(light_field[row, column], 0, 1)).astype(np.uint8)))
        found = e2lf.depth(light_field)
        rr.log("disparity", rr.DepthImage(found.disparity - found.range_px[0], meter=1.0))
        points, colours = points_of(found.disparity, found.confidence, light_field[found.view], focal_px)
        rr.log("points", rr.Points3D(points, colors=colours))


if __name__ == "__main__":
    main()
