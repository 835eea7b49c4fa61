"""The named tuples that functions of e2lf return."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

from . import _html

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

    def __repr__(self) -> str:
        count, height, width = self.images.shape
        return (f"<e2lf.Cycle {self.number} at {self.begin_us} us: {count} event images of {width}x{height} px, "
                f"{self.events} events, confidence {self.confidence:.2f}>")

    def _repr_html_(self) -> str:
        return _html.of_event_images(self.images)


class DisparityMap(NamedTuple):
    """The disparity of each pixel of a view."""

    disparity: Floats  #: float32 [y, x], px per view step; a point at x in one view is at x + disparity in the next
    confidence: Floats  #: float32 [y, x], 0..1; 0.5 means an expected error of 0.07 px
    view: Tuple[int, int]  #: (view_y, view_x), the view to which the pixels belong
    range_px: Tuple[float, float]  #: (least, most), the range that was searched, px per view step

    def __repr__(self) -> str:
        height, width = self.disparity.shape[:2]
        return (f"<e2lf.DisparityMap of view {self.view}: {width}x{height} px, searched {self.range_px[0]:.2f} to "
                f"{self.range_px[1]:.2f} px per view step>")

    def _repr_html_(self) -> str:
        return _html.of_disparity(self.disparity, self.range_px)


class FusedCycles(NamedTuple):
    """The event images of a cycle, fused with those of the cycles before."""

    images: Counts  #: int16 [transition, y, x], of the last cycle
    counts: Counts  #: int16 [transition, y, x], means over the cycles in 1/64 of an event
    cycles: Floats  #: float32 [y, x], effective number of cycles of each pixel, at least 1

    def __repr__(self) -> str:
        height, width = self.cycles.shape
        return f"<e2lf.FusedCycles of {width}x{height} px: {self.cycles.mean():.1f} cycles on average>"


class EventImageFile(NamedTuple):
    """The content of a file of event images."""

    cycles: List[Counts]  #: int16 [transition, y, x] each
    codes: Optional[Floats]  #: float32 [N, view_y, view_x]
    camera: Optional[Camera] = None  #: the e2lf.Camera that recorded them
    views: Optional[str] = None  #: orientation of the views: "upright", "turned", "flipped-x" or "flipped-y"

    def __repr__(self) -> str:
        sizes = "x".join(str(size) for size in self.cycles[0].shape[::-1]) if self.cycles else "none"
        return f"<e2lf.EventImageFile of {len(self.cycles)} cycles, event images [x, y, transition] {sizes}>"


class LightFieldPicture:
    """A light field as a picture of a notebook: the central view, and then those on a circle around it."""

    def __init__(self, light_field: Floats) -> None:
        if light_field.ndim not in (4, 5):
            raise ValueError(f"a light field has the axes [view_y, view_x, y, x], but the shape is {list(light_field.shape)}")
        self.light_field = light_field

    def _repr_html_(self) -> str:
        return _html.of_light_field(self.light_field)


def show(light_field: Floats) -> LightFieldPicture:
    """Returns a light field [view_y, view_x, y, x] as what a notebook shows: its central view with the parallax of the others."""
    return LightFieldPicture(light_field)
