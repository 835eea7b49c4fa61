"""Light fields from events alone: recordings, event images, light fields, models.

Arrays are numpy arrays. Light fields are float32 [view_y, view_x, y, x] in [0, 1], event images int16 [transition, y, x],
patterns ("codes") float32 [N, view_y, view_x]. Events are structured arrays with fields x, y, p, t, as in the Metavision
tools. Times are in microseconds (us), lengths in pixels (px). Bad data raises Error. Messages go to the logger "e2lf".
"""
from ._e2lf import *  # noqa: F403
from ._e2lf import __version__
from ._types import Calibration, Cycle, DisparityMap, EventImageFile, FusedCycles, LightFieldPicture, Slice, show

__all__ = [name for name in dir() if not name.startswith("_")]
