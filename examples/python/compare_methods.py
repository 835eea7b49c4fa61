"""Compares the network with the closed form: draws the errors of each view; brighter is worse.

python3 compare_methods.py PICTURE.png
"""
import sys

import numpy as np

import e2lf

model = e2lf.read_model(e2lf.bundled_model())
assert model.codes is not None
scene = e2lf.demo_scene(160, 120)
images = e2lf.simulate(scene, model.codes, constants=model.constants)
methods = {
    "network": e2lf.Reconstructor(model).reconstruct(images, gain=1),
    "inversion": e2lf.invert(images, model.codes, constants=model.constants, gain=1),
}
sheets = []
for name, light_field in methods.items():
    quality = e2lf.compare(scene, light_field)
    print(f"{name}: {quality['psnr_db']:.2f} dB, SSIM {quality['ssim_uniform7']:.3f}")
    sheets.append(e2lf.contact_sheet(5 * np.abs(light_field - scene), max_width=640))
e2lf.write_png(sys.argv[1], np.hstack(sheets), overwrite=True)
