"""Reconstructs a light field of each pattern cycle of a recording and draws the middle view of each.

The simulated scene is on a turntable, which is turned between cycles.

python3 cycles_of_recording.py PICTURE.png [RECORDING]     without a recording: a simulated one
"""
import sys
import tempfile
from pathlib import Path

import numpy as np

import e2lf

model = e2lf.read_model(e2lf.bundled_model())
reconstructor = e2lf.Reconstructor(model)


def simulated(folder: str) -> Path:
    """Four cycles, each with the table turned by a tenth of a radian more."""
    assert model.codes is not None
    images = []
    for cycle in range(4):
        scene = e2lf.turntable_scene(0.1 * cycle, 160, 120)
        images.append(e2lf.simulate(scene, model.codes, constants=model.constants, seed=cycle))
    path = Path(folder) / "recording.raw"
    e2lf.synthesise_recording(path, images, model.codes)
    return path


with tempfile.TemporaryDirectory() as folder:
    path = Path(sys.argv[2]) if len(sys.argv) > 2 else simulated(folder)
    views, gain = [], 0.0
    for cycle in e2lf.accumulate(path):
        light_field = reconstructor.reconstruct(cycle.images, gain=1)
        gain = gain or e2lf.auto_gain(light_field)  # one brightness for all
        views.append(gain * light_field[4, 4])
        print(f"cycle {cycle.number}: {cycle.events} events from {cycle.begin_us} us on, confidence {cycle.confidence:.2f}")
e2lf.write_png(sys.argv[1], np.hstack(views), overwrite=True)
