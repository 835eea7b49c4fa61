"""Plain tuples that functions of e2lf return."""
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from ._e2lf import Camera


class Slice(NamedTuple):
    """A stretch of a recording: all t with begin_us <= t < end_us that were asked for."""

    events: np.ndarray  #: of event_dtype
    triggers: np.ndarray  #: of trigger_dtype
    begin_us: int
    end_us: int


class Cycle(NamedTuple):
    """One pass over the patterns."""

    images: np.ndarray  #: int16 [transition, y, x]
    number: int  #: in the recording, dropped ones counted
    begin_us: int  #: start of its first pattern
    slices: List[Tuple[int, int]]  #: (begin_us, end_us) of each event image
    events: int  #: in the images
    saturated: int  #: events for which the images had no room
    confidence: float  #: 0..1, that the patterns changed when they are said to


class DisparityMap(NamedTuple):
    """How far each pixel of a view moves from view to view."""

    disparity: np.ndarray  #: float32 [y, x], px per view step; a point at x in one view is at x + disparity in the next
    confidence: np.ndarray  #: float32 [y, x], 0..1; 0.5 where an error of 0.07 px is to be expected
    view: Tuple[int, int]  #: (view_y, view_x), whose pixels these are
    range_px: Tuple[float, float]  #: (least, most) that was looked for, px per view step


class EventImageFile(NamedTuple):
    """What a file of event images holds."""

    cycles: List[np.ndarray]  #: int16 [transition, y, x] each
    codes: Optional[np.ndarray]  #: float32 [N, view_y, view_x]
    camera: Optional[Camera] = None  #: the e2lf.Camera that recorded them
    views: Optional[str] = None  #: how the views come out: "upright", "turned", "flipped-x" or "flipped-y"
