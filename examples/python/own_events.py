"""Writes a recording of your own events, reads it, and draws the events at its end.

python3 own_events.py PICTURE.png
"""
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import e2lf

Array = NDArray[Any]
WIDTH, HEIGHT = 320, 240


def turning_edge(turns: int = 2, events_per_us: float = 0.5) -> Array:
    """Events of a half disc that turns: ON at one edge, OFF at the other."""
    random = np.random.default_rng(1)
    t = np.arange(0, turns * 100_000, 1 / events_per_us).astype(np.int64)
    is_on = random.integers(0, 2, len(t))
    angle = 2 * np.pi * t / 100_000 + np.pi * is_on
    radius = 100 * np.sqrt(random.random(len(t)))
    events = np.zeros(len(t), e2lf.event_dtype)
    events["x"] = WIDTH / 2 + radius * np.cos(angle)
    events["y"] = HEIGHT / 2 + radius * np.sin(angle)
    events["p"] = is_on
    events["t"] = t
    return events


def draw(events: Array) -> Array:
    """White where nothing happened, red where the last event was ON, blue where it was OFF; older ones paler."""
    picture = np.ones((HEIGHT, WIDTH, 3), np.float32)
    age = 1 - (events["t"] - events["t"][0]) / max(np.ptp(events["t"]), 1)
    colour = np.where(events["p"][:, None] == 1, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    picture[events["y"], events["x"]] = colour + (1 - colour) * age[:, None]  # later events come later
    return picture


with tempfile.TemporaryDirectory() as folder:
    recording = Path(folder) / "edge.raw"
    with e2lf.create_recording(recording, WIDTH, HEIGHT) as writer:
        writer.write(turning_edge())
    *_, last = e2lf.open_recording(recording).events(delta_t=30_000)
e2lf.write_png(sys.argv[1], draw(last), overwrite=True)
