# The names of `import e2lf`, for editors and type checkers. A test compares this file with the module.
from os import PathLike
from types import TracebackType
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

Path = Union[str, "PathLike[str]"]
Progress = Callable[[int, int], object]
Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float32]
Counts = npt.NDArray[np.int16]

__version__: str
event_dtype: np.dtype[Any]
trigger_dtype: np.dtype[Any]

class Error(Exception):
    code: str
    message: str
    location: str
    setting: str

class CameraSetup:
    def __init__(
        self,
        *,
        trigger_channels: Sequence[str] = [],
        biases: Path = "",
        max_events_per_s: Optional[int] = None,
        regions: Sequence[Tuple[int, int, int, int]] = [],
        encoding: str = "",
    ) -> None: ...

class Slice(NamedTuple):
    events: Array
    triggers: Array
    begin_us: int
    end_us: int

class Calibration(NamedTuple):
    camera: Camera
    report: Dict[str, Any]

class Cycle(NamedTuple):
    images: Counts
    number: int
    begin_us: int
    slices: List[Tuple[int, int]]
    events: int
    saturated: int
    confidence: float

class DisparityMap(NamedTuple):
    disparity: Floats
    confidence: Floats
    view: Tuple[int, int]
    range_px: Tuple[float, float]

class EventImageFile(NamedTuple):
    cycles: List[Counts]
    codes: Optional[Floats]
    camera: Optional[Camera] = ...
    views: Optional[str] = ...

class SensorConstants:
    eps: float
    tau: float
    sigma_w: float
    sigma_z: float
    def __init__(self, eps: float = 0.01, tau: float = 0.3, sigma_w: float = 0.175, sigma_z: float = 0.04) -> None: ...

class Camera:
    def __init__(self, name: Path) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def event_model(self) -> str: ...
    @property
    def constants(self) -> SensorConstants: ...
    @property
    def views(self) -> Optional[str]: ...
    @staticmethod
    def from_dict(content: Dict[str, Any]) -> Camera: ...
    @staticmethod
    def from_constants(constants: SensorConstants) -> Camera: ...
    def conditioning(self, num_patterns: int, cycles: int = 1) -> Floats: ...
    def to_dict(self) -> Dict[str, Any]: ...

class ScheduledPattern:
    def __init__(
        self, name: str, duration_us: int = 10000, overhead_us: int = 0, image: Optional[int] = None, sign: str = "any"
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def duration_us(self) -> int: ...
    @property
    def overhead_us(self) -> int: ...
    @property
    def image(self) -> Optional[int]: ...
    @property
    def sign(self) -> str: ...

class Schedule:
    def __init__(self, patterns: Sequence[ScheduledPattern]) -> None: ...
    @property
    def patterns(self) -> List[ScheduledPattern]: ...
    @property
    def views(self) -> Optional[str]: ...
    @property
    def num_images(self) -> int: ...
    @property
    def cycle_us(self) -> int: ...
    def to_json(self) -> str: ...
    def __len__(self) -> int: ...

class Slices:
    def __iter__(self) -> Iterator[Slice]: ...
    def __next__(self) -> Slice: ...

class EventSlices:
    def __iter__(self) -> Iterator[Array]: ...
    def __next__(self) -> Array: ...

class Recording:
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def header(self) -> Dict[str, str]: ...
    @property
    def assumptions(self) -> List[str]: ...
    @property
    def codes(self) -> Optional[Floats]: ...
    @property
    def camera(self) -> Optional[Camera]: ...
    @property
    def views(self) -> Optional[str]: ...
    def summary(self) -> Dict[str, Any]: ...
    def slices(self, delta_t: Optional[int] = None, n_events: Optional[int] = None) -> Slices: ...
    def events(self, delta_t: Optional[int] = None, n_events: Optional[int] = None) -> EventSlices: ...
    def between(self, begin_us: int, end_us: int) -> Slice: ...
    def seek(self, t_us: int) -> None: ...
    def next_part(self) -> bool: ...
    def close(self) -> None: ...
    def __iter__(self) -> Iterator[Slice]: ...
    def __enter__(self) -> Recording: ...
    def __exit__(
        self, type: Optional[Type[BaseException]], value: Optional[BaseException], traceback: Optional[TracebackType]
    ) -> None: ...

class RecordingWriter:
    @property
    def holds_triggers(self) -> bool: ...
    def write(self, events: Array, triggers: Optional[Array] = None) -> None: ...
    def finish(self) -> None: ...
    def __enter__(self) -> RecordingWriter: ...
    def __exit__(
        self, type: Optional[Type[BaseException]], value: Optional[BaseException], traceback: Optional[TracebackType]
    ) -> None: ...

class Cycles:
    @property
    def source(self) -> str: ...
    @property
    def codes(self) -> Optional[Floats]: ...
    @property
    def views(self) -> Optional[str]: ...
    def report(self) -> Dict[str, Any]: ...
    def __iter__(self) -> Iterator[Cycle]: ...
    def __next__(self) -> Cycle: ...

class Model:
    def __init__(self, name: Path) -> None: ...
    @staticmethod
    def of(header: Dict[str, Any], weights: Mapping[str, Array], codes: Optional[Array] = None) -> Model: ...
    @property
    def name(self) -> str: ...
    @property
    def header(self) -> Dict[str, Any]: ...
    @property
    def weights(self) -> Dict[str, Floats]: ...
    @property
    def num_patterns(self) -> int: ...
    @property
    def views(self) -> Tuple[int, int]: ...
    @property
    def codes(self) -> Optional[Floats]: ...
    @property
    def event_model(self) -> str: ...
    @property
    def black_first(self) -> bool: ...
    @property
    def constants(self) -> SensorConstants: ...
    @property
    def camera(self) -> Optional[Camera]: ...
    @property
    def is_conditioned_on_camera(self) -> bool: ...
    def summary(self) -> Dict[str, Any]: ...

class VideoModel:
    def __init__(self, path: Path) -> None: ...
    @staticmethod
    def of(header: Dict[str, Any], weights: Mapping[str, Array]) -> VideoModel: ...
    @property
    def name(self) -> str: ...
    @property
    def bins(self) -> int: ...
    @property
    def header(self) -> Dict[str, Any]: ...
    @property
    def weights(self) -> Dict[str, Floats]: ...
    def summary(self) -> Dict[str, Any]: ...

class Reconstructor:
    def __init__(self, model: Model, *, precision: str = "auto", camera: Optional[Camera] = None) -> None: ...
    def reconstruct(
        self,
        images: Array,
        *,
        gain: Union[float, str] = "auto",
        passes: int = 1,
        cycles: int = 1,
        colour_filter: str = "",
        turn_views: bool = False,
        flip_x: bool = False,
        flip_y: bool = False,
        progress: Optional[Progress] = None,
    ) -> Floats: ...
    def depth(
        self,
        images: Array,
        *,
        cycles: int = 1,
        turn_views: bool = False,
        flip_x: bool = False,
        flip_y: bool = False,
        progress: Optional[Progress] = None,
    ) -> DisparityMap: ...
    @property
    def precision(self) -> str: ...
    @property
    def kernels(self) -> List[str]: ...

class FrameReconstructor:
    def __init__(self, model: VideoModel, width: int, height: int, *, precision: str = "auto") -> None: ...
    def next(self, grid: Array, *, toned: bool = True) -> Floats: ...
    def reset(self) -> None: ...

# Files that are distributed with e2lf
def data_file(name: str) -> str: ...
def bundled_model(name: str = "e2lf-n4") -> str: ...
def read_camera(name: Path) -> Camera: ...

# The process
def num_threads() -> int: ...
def set_num_threads(threads: int) -> None: ...
def instruction_set() -> str: ...

# Recordings
def open_recording(
    path: Path,
    *,
    format: str = "",
    width: int = 0,
    height: int = 0,
    stream: str = "",
    columns: str = "",
    time_unit: str = "auto",
    polarities: str = "",
    from_us: Optional[int] = None,
    to_us: Optional[int] = None,
    relative: bool = False,
    shift_time: bool = False,
    strict: bool = False,
    threads: int = 0,
    restart: str = "continue",
    camera_setup: Optional[CameraSetup] = None,
) -> Recording: ...
def read_events(
    path: Path,
    *,
    format: str = "",
    width: int = 0,
    height: int = 0,
    stream: str = "",
    columns: str = "",
    time_unit: str = "auto",
    polarities: str = "",
    from_us: Optional[int] = None,
    to_us: Optional[int] = None,
    relative: bool = False,
    shift_time: bool = False,
    strict: bool = False,
    threads: int = 0,
    restart: str = "continue",
    camera_setup: Optional[CameraSetup] = None,
) -> Tuple[Array, Array]: ...
def info(
    path: Path,
    *,
    format: str = "",
    width: int = 0,
    height: int = 0,
    stream: str = "",
    columns: str = "",
    time_unit: str = "auto",
    polarities: str = "",
    progress: Optional[Progress] = None,
) -> Dict[str, Any]: ...
def create_recording(
    path: Path,
    width: int,
    height: int,
    *,
    format: str = "",
    header: Mapping[str, str] = {},
    codes: Optional[Array] = None,
    overwrite: bool = False,
) -> RecordingWriter: ...
def convert(
    path: Path,
    output: Path,
    *,
    output_format: str = "",
    overwrite: bool = False,
    progress: Optional[Progress] = None,
    format: str = "",
    width: int = 0,
    height: int = 0,
    stream: str = "",
    columns: str = "",
    time_unit: str = "auto",
    polarities: str = "",
    from_us: Optional[int] = None,
    to_us: Optional[int] = None,
    relative: bool = False,
    shift_time: bool = False,
    strict: bool = False,
    threads: int = 0,
    restart: str = "continue",
    camera_setup: Optional[CameraSetup] = None,
) -> Dict[str, Any]: ...

def find_cameras() -> List[str]: ...

# Patterns, schedules, cycles, event images
def read_codes(path: Path) -> Floats: ...
def write_codes(path: Path, codes: Array, *, overwrite: bool = False) -> None: ...
def default_codes() -> Floats: ...
def read_schedule(path: Path) -> Schedule: ...
def paper_schedule(num_codes: int = 4) -> Schedule: ...
def plain_schedule(num_codes: int, duration_us: int) -> Schedule: ...
def accumulate(
    path: Path,
    *,
    source: str = "auto",
    schedule: Union[Schedule, Path, None] = None,
    num_codes: int = 4,
    edge: str = "rising",
    channel: Optional[int] = None,
    first_pattern: Optional[int] = None,
    one_trigger_per_cycle: bool = False,
    origin_us: Optional[int] = None,
    filter_pixels: bool = False,
    transitions: str = "lit",
    invert_polarity: bool = False,
    format: str = "",
    width: int = 0,
    height: int = 0,
    stream: str = "",
    columns: str = "",
    time_unit: str = "auto",
    polarities: str = "",
    from_us: Optional[int] = None,
    to_us: Optional[int] = None,
    relative: bool = False,
    shift_time: bool = False,
    strict: bool = False,
    threads: int = 0,
    restart: str = "continue",
    camera_setup: Optional[CameraSetup] = None,
) -> Cycles: ...
def event_images(events: Array, times_us: Sequence[int], width: int, height: int) -> Counts: ...
def voxel_grid(events: Array, bins: int, width: int, height: int) -> Floats: ...
def synthesise_recording(
    path: Path,
    cycles: Union[Sequence[Array], Array],
    codes: Optional[Array] = None,
    *,
    schedule: Union[Schedule, Path, None] = None,
    triggers: bool = True,
    begin_us: int = 100000,
    seed: int = 1,
    camera: Optional[Camera] = None,
    overwrite: bool = False,
) -> None: ...
def read_event_images(path: Path) -> EventImageFile: ...
def write_event_images(
    path: Path,
    cycles: Union[Sequence[Array], Array],
    codes: Optional[Array] = None,
    *,
    camera: Optional[Camera] = None,
    views: Optional[str] = None,
    overwrite: bool = False,
) -> None: ...
def event_picture(images: Array) -> Floats: ...

# Light fields and pictures
def read_light_field(
    path: Path,
    *,
    views: int = 8,
    step: int = 1,
    colour: bool = False,
    reverse_rows: bool = False,
    range: str = "refuse",
    white: float = 0.0,
    view_columns: int = 0,
    lenslet_views: int = 0,
    turn_views: bool = False,
    flip_x: bool = False,
    flip_y: bool = False,
    progress: Optional[Progress] = None,
) -> Floats: ...
def write_light_field(
    path: Path, light_field: Array, *, format: str = "", overwrite: bool = False, progress: Optional[Progress] = None
) -> None: ...
def refocus(
    light_field: Array,
    disparity: float,
    *,
    radius: Optional[float] = None,
    centre_y: float = 0.0,
    centre_x: float = 0.0,
    weights: Optional[Array] = None,
) -> Floats: ...
def horizontal_epi(light_field: Array, view_y: int, y: int) -> Floats: ...
def vertical_epi(light_field: Array, view_x: int, x: int) -> Floats: ...
def epi_picture(light_field: Array, *, y: Optional[int] = None, x: Optional[int] = None) -> Floats: ...
def contact_sheet(light_field: Array, *, max_width: int = 1600) -> Floats: ...
def read_image(path: Path) -> Floats: ...
def write_png(path: Path, image: Array, *, bits: int = 8, overwrite: bool = False) -> None: ...
def demo_scene(width: int = 512, height: int = 384, *, views: int = 8, seed: int = 1) -> Floats: ...
def turntable_scene(turn: float, width: int = 512, height: int = 384, *, views: int = 8, seed: int = 1) -> Floats: ...

# Simulation and reconstruction
def simulate(
    light_field: Array,
    codes: Array,
    *,
    camera: Optional[Camera] = None,
    constants: Optional[SensorConstants] = None,
    event_model: str = "",
    scene_gain: float = 1.0,
    residue: float = 0.0,
    seed: int = 1,
    map_seed: Optional[int] = None,
    colour_filter: str = "",
) -> Counts: ...
def coded_intensities(light_field: Array, codes: Array) -> Floats: ...
def read_model(path: Path) -> Model: ...
def write_model(path: Path, model: Model, *, overwrite: bool = False) -> None: ...
def invert(
    images: Array,
    codes: Array,
    *,
    constants: Optional[SensorConstants] = None,
    gain: Union[float, str] = "auto",
    colour_filter: str = "",
    turn_views: bool = False,
    flip_x: bool = False,
    flip_y: bool = False,
) -> Floats: ...
def auto_gain(light_field: Array) -> float: ...
def event_error(
    light_field: Array,
    images: Array,
    codes: Array,
    *,
    gain: float = 1.0,
    constants: Optional[SensorConstants] = None,
    event_model: str = "reference-aware",
    camera: Optional[Camera] = None,
) -> Dict[str, float]: ...

def calibrate(
    scenes: Sequence[Union[Sequence[Array], Array]],
    codes: Array,
    start: Camera,
    *,
    held: Sequence[str] = [],
    even: bool = False,
    progress: Optional[Progress] = None,
) -> Calibration: ...
def depth(
    light_field: Array,
    *,
    view: Optional[Tuple[int, int]] = None,
    range_px: Optional[Tuple[float, float]] = None,
    turn_views: bool = False,
    flip_x: bool = False,
    flip_y: bool = False,
    progress: Optional[Progress] = None,
) -> DisparityMap: ...
def compare_disparity(
    truth: Array, estimate: Array, *, confidence: Optional[Array] = None, border: int = 15
) -> Dict[str, Any]: ...

# Measures
def psnr(a: Array, b: Array) -> float: ...
def ssim(a: Array, b: Array, *, window: str = "uniform7") -> float: ...
def compare(
    truth: Array, reconstruction: Array, *, clamp: bool = True, fit: str = "none", progress: Optional[Progress] = None
) -> Dict[str, Any]: ...
def event_statistics(images: Array) -> Dict[str, Any]: ...
