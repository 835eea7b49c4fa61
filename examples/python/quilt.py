"""Writes a row of views as a quilt, the picture that light-field displays such as the Looking Glass show.

python3 quilt.py QUILT.png [LIGHT_FIELD]     without a light field: the demo scene

A quilt holds the views from the leftmost to the rightmost, row by row from the left bottom corner. The printed line is
the end of the name by which such displays know the number of columns and rows, and the aspect ratio of the views.
"""
import sys

import numpy as np

import e2lf

light_field = e2lf.read_light_field(sys.argv[2]) if len(sys.argv) > 2 else e2lf.demo_scene(192, 144)
views = light_field[light_field.shape[0] // 2]  # from left to right: [view_x, y, x] or [view_x, y, x, channel]
rows = 2 if len(views) % 2 == 0 else 1
columns = len(views) // rows
quilt = np.vstack([np.hstack(views[row * columns:(row + 1) * columns]) for row in reversed(range(rows))])
e2lf.write_png(sys.argv[1], quilt, overwrite=True)
print(f"_qs{columns}x{rows}a{views.shape[2] / views.shape[1]:.2f}.png")
