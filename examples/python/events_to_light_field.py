"""Reconstructs a light field from event images and focuses it in front, in the middle and at the back.

python3 events_to_light_field.py PICTURE.png [EVENTS.npz]     without event images: simulated ones of the demo scene
"""
import sys

import numpy as np

import e2lf

model = e2lf.read_model(e2lf.bundled_model())
assert model.codes is not None
if len(sys.argv) > 2:
    images = e2lf.read_event_images(sys.argv[2]).cycles[0]
else:
    images = e2lf.simulate(e2lf.demo_scene(192, 144), model.codes, constants=model.constants)

light_field = e2lf.Reconstructor(model).reconstruct(images)  # float32 [8, 8, y, x]
focused = [e2lf.refocus(light_field, disparity) for disparity in (-1.0, 0.0, 1.2)]
e2lf.write_png(sys.argv[1], np.hstack(focused), overwrite=True)
