"""Between messages of ROS 2 and arrays. Needs e2lf and numpy alone; a message is any object with the fields of its type."""
from __future__ import annotations

from typing import Any, BinaryIO, Dict, Optional

import numpy as np

import e2lf

NS_PER_US, NS_PER_S = 1000, 1_000_000_000


def stamp_ns(header: Any) -> int:
    """Returns the time of a std_msgs/Header in ns."""
    return int(header.stamp.sec) * NS_PER_S + int(header.stamp.nanosec)


def events_of_mono(packet: Any) -> e2lf.Array:
    """Returns the events of an event_camera_msgs/EventPacket in the encoding "mono", with t in us of its clock."""
    words = np.frombuffer(bytes(packet.events), "<u8")
    events = np.zeros(len(words), e2lf.event_dtype)
    events["x"], events["y"] = words >> 32 & 0xFFFF, words >> 48 & 0x7FFF
    events["p"] = words >> 63
    events["t"] = (int(packet.time_base) + (words & 0xFFFFFFFF).astype(np.int64)) // NS_PER_US
    return events


class RawStream:
    """Writes the packets of one camera in the encoding "evt3" as a RAW recording, which e2lf reads, from a pipe, too.

    Its times are those of the sensor. header_ns() gives the time of the messages that belongs to one.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._is_begun = False
        self._first_ns: Optional[int] = None

    def add(self, packet: Any) -> None:
        if packet.encoding != "evt3":
            raise ValueError(f'the stream holds packets in "evt3", not in "{packet.encoding}"; set the encoding of the driver')
        if not self._is_begun:
            size = f"height={packet.height};width={packet.width}"
            self._file.write(f"% evt 3.0\n% format EVT3;{size}\n% end\n".encode())
            self._first_ns, self._is_begun = stamp_ns(packet.header), True
        self._file.write(bytes(packet.events))
        self._file.flush()

    def header_ns(self, t_us: int, first_us: int) -> int:
        """Returns the time of the clock of the headers at sensor time t_us; first_us is that of the first event."""
        if self._first_ns is None:
            raise ValueError("no packet has come yet")
        return self._first_ns + (t_us - first_us) * NS_PER_US


def header_fields(time_ns: int, frame_id: str) -> Dict[str, Any]:
    return {"stamp": {"sec": time_ns // NS_PER_S, "nanosec": time_ns % NS_PER_S}, "frame_id": frame_id}


def image_fields(picture: e2lf.Array, time_ns: int, frame_id: str) -> Dict[str, Any]:
    """Returns the fields of a sensor_msgs/Image: "mono8" of uint8 [y, x], "32FC1" of float32 [y, x]."""
    encodings = {np.dtype(np.uint8): "mono8", np.dtype(np.float32): "32FC1"}
    height, width = picture.shape
    return {"header": header_fields(time_ns, frame_id), "height": height, "width": width, "encoding": encodings[picture.dtype],
            "is_bigendian": 0, "step": width * picture.dtype.itemsize, "data": np.ascontiguousarray(picture).tobytes()}


def camera_info_fields(width: int, height: int, focal_px: float, time_ns: int, frame_id: str) -> Dict[str, Any]:
    """Returns the fields of a sensor_msgs/CameraInfo of a pinhole without distortion, with the principal point in the middle."""
    x, y = (width - 1) / 2, (height - 1) / 2
    return {"header": header_fields(time_ns, frame_id), "height": height, "width": width, "distortion_model": "plumb_bob",
            "d": [0.0] * 5, "k": [focal_px, 0.0, x, 0.0, focal_px, y, 0.0, 0.0, 1.0],
            "r": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            "p": [focal_px, 0.0, x, 0.0, 0.0, focal_px, y, 0.0, 0.0, 0.0, 1.0, 0.0]}


def central_view(light_field: e2lf.Array) -> e2lf.Array:
    """Returns the central view as uint8 [y, x]."""
    view = light_field[light_field.shape[0] // 2, light_field.shape[1] // 2]
    grey: e2lf.Array = np.round(255 * np.clip(view, 0, 1)).astype(np.uint8)
    return grey
