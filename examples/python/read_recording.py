"""Draws the event rate of a recording over time, ON above and OFF below, with lines at its triggers.

python3 read_recording.py PICTURE.png [RECORDING]     without a recording: a simulated one
"""
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import e2lf

Array = NDArray[Any]
SLICE_US = 500
HEIGHT = 240


def simulated(folder: str) -> Path:
    """Three cycles of the demo scene."""
    model = e2lf.read_model(e2lf.bundled_model())
    assert model.codes is not None
    scene = e2lf.demo_scene(160, 120)
    images = [e2lf.simulate(scene, model.codes, constants=model.constants, seed=seed) for seed in (1, 2, 3)]
    path = Path(folder) / "recording.raw"
    e2lf.synthesise_recording(path, images, model.codes)
    return path


def draw(on: Array, off: Array, triggers: Array) -> Array:
    """A column of pixels for each slice."""
    picture = np.ones((HEIGHT, len(on), 3), np.float32)
    picture[:, triggers > 0] = 0.85
    middle, most = HEIGHT // 2, max(on.max(), off.max(), 1)
    for column, (n_on, n_off) in enumerate(zip(on, off)):
        picture[middle - n_on * middle // most : middle, column] = (0.8, 0.1, 0.1)
        picture[middle : middle + n_off * middle // most, column] = (0.1, 0.2, 0.8)
    return picture


with tempfile.TemporaryDirectory() as folder:
    path = Path(sys.argv[2]) if len(sys.argv) > 2 else simulated(folder)
    counts = []
    with e2lf.open_recording(path) as recording:
        for part in recording.slices(delta_t=SLICE_US):
            on = np.count_nonzero(part.events["p"])
            counts.append((on, len(part.events) - on, len(part.triggers)))
        summary = recording.summary()
        print(f"{recording.format}, {recording.width}x{recording.height} px: {summary['events']} events, "
              f"{summary['triggers']} triggers, {(summary['last_t_us'] - summary['first_t_us']) / 1e6:.3f} s")
e2lf.write_png(sys.argv[1], draw(*np.array(counts).T), overwrite=True)
