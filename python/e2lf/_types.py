"""The named tuples that functions of e2lf return."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

if TYPE_CHECKING:
    from . import Array, Camera, Counts, Floats


class Slice(NamedTuple):
    """A slice of a recording: the events and triggers with begin_us <= t < end_us."""

    events: Array  #: of event_dtype
    triggers: Array  #: of trigger_dtype
    begin_us: int
    end_us: int


class Calibration(NamedTuple):
    """The constants of a camera that were estimated from events."""

    camera: Camera
    report: Dict[str, Any]  #: the content of `e2lf calibrate --json`


class Cycle(NamedTuple):
    """One pass over the patterns."""

    images: Counts  #: int16 [transition, y, x]
    number: int  #: number in the recording, including dropped cycles
    begin_us: int  #: start of its first pattern
    slices: List[Tuple[int, int]]  #: (begin_us, end_us) of each event image
    events: int  #: number of events in the images
    saturated: int  #: number of events that were lost because counts saturate
    confidence: float  #: 0..1, confidence that the patterns changed at the stated times


class DisparityMap(NamedTuple):
    """The disparity of each pixel of a view."""

    disparity: Floats  #: float32 [y, x], px per view step; a point at x in one view is at x + disparity in the next
    confidence: Floats  #: float32 [y, x], 0..1; 0.5 means an expected error of 0.07 px
    view: Tuple[int, int]  #: (view_y, view_x), the view to which the pixels belong
    range_px: Tuple[float, float]  #: (least, most), the range that was searched, px per view step


class EventImageFile(NamedTuple):
    """The content of a file of event images."""

    cycles: List[Counts]  #: int16 [transition, y, x] each
    codes: Optional[Floats]  #: float32 [N, view_y, view_x]
    camera: Optional[Camera] = None  #: the e2lf.Camera that recorded them
    views: Optional[str] = None  #: orientation of the views: "upright", "turned", "flipped-x" or "flipped-y"
