"""Pictures for notebooks: PNG files as text of HTML, made with nothing but numpy."""
from __future__ import annotations

import base64
import html
import struct
import zlib
from typing import Any, List, Sequence, Tuple

import numpy as np

MAX_SIDE = 320  # px of a picture
FRAME_MS = 80
PARALLAX_FRAMES = 16
# Viridis at equal distances.
COLOURS = np.array([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], float)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(frames: Sequence[Any]) -> bytes:
    """Returns uint8 pictures [y, x] or [y, x, 3] of equal shape as a PNG, which is animated if there are several."""
    height, width = frames[0].shape[:2]
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if frames[0].ndim == 3 else 0, 0, 0, 0)
    parts = [b"\x89PNG\r\n\x1a\n", _chunk(b"IHDR", header)]
    if len(frames) > 1:
        parts.append(_chunk(b"acTL", struct.pack(">II", len(frames), 0)))
    sequence = 0
    for number, frame in enumerate(frames):
        rows = np.ascontiguousarray(frame).reshape(height, -1)
        data = zlib.compress(np.concatenate([np.zeros((height, 1), np.uint8), rows], 1).tobytes())
        if len(frames) > 1:
            parts.append(_chunk(b"fcTL", struct.pack(">IIIIIHHBB", sequence, width, height, 0, 0, FRAME_MS, 1000, 0, 0)))
            sequence += 1
        if number == 0:
            parts.append(_chunk(b"IDAT", data))
        else:
            parts.append(_chunk(b"fdAT", struct.pack(">I", sequence) + data))
            sequence += 1
    return b"".join([*parts, _chunk(b"IEND", b"")])


def image(frames: Sequence[Any], caption: str) -> str:
    """Returns a figure with a picture and a caption."""
    step = -(-max(frames[0].shape[:2]) // MAX_SIDE)
    data = base64.b64encode(png([frame[::step, ::step] for frame in frames])).decode()
    text = html.escape(caption)
    return (f'<figure style="display:inline-block;margin:4px"><img alt="{text}" src="data:image/png;base64,{data}"/>'
            f"<figcaption>{text}</figcaption></figure>")


def bytes_of(values: Any) -> Any:
    return np.round(255 * np.clip(np.nan_to_num(values), 0, 1)).astype(np.uint8)


def of_light_field(field: Any) -> str:
    """The central view; the viewpoint moves on a circle around it."""
    rows, columns = field.shape[:2]
    centre = (rows // 2, columns // 2)
    angles = 2 * np.pi * np.arange(PARALLAX_FRAMES) / PARALLAX_FRAMES
    places = [centre]
    for y, x in zip(np.sin(angles), np.cos(angles)):
        places.append((int(round((rows - 1) * (1 + y) / 2)), int(round((columns - 1) * (1 + x) / 2))))
    return image([bytes_of(field[place]) for place in places],
                 f"light field of {rows}x{columns} views, {field.shape[3]}x{field.shape[2]} px: view {centre}, then a circle")


def of_event_images(images: Any) -> str:
    """Each event image: red where brightness grew, blue where it fell."""
    limit = max(1.0, float(np.percentile(np.abs(images), 99)))
    figures: List[str] = []
    for number, counts in enumerate(images):
        strength = np.clip(np.asarray(counts, float) / limit, -1, 1)
        picture = np.stack([1 + np.minimum(strength, 0), 1 - np.abs(strength), 1 - np.maximum(strength, 0)], -1)
        figures.append(image([bytes_of(picture)], f"transition {number}: {int(np.abs(np.asarray(counts, np.int64)).sum())} events"))
    return "".join(figures)


def of_disparity(disparity: Any, range_px: Tuple[float, float]) -> str:
    """The map in colours, with a legend of the range that it covers."""
    finite = disparity[np.isfinite(disparity)]
    least, most = (float(finite.min()), float(finite.max())) if finite.size else range_px
    share = (np.nan_to_num(disparity, nan=least) - least) / max(most - least, 1e-6)
    legend = np.tile(np.linspace(0, 1, 256), (12, 1))
    return (image([coloured(share)], "disparity, px per view step")
            + image([coloured(legend)], f"{least:.2f} to {most:.2f} px"))


def coloured(share: Any) -> Any:
    """Returns the colours uint8 [y, x, 3] of numbers from 0 to 1."""
    places = np.linspace(0, 1, len(COLOURS))
    return np.stack([np.interp(share, places, COLOURS[:, c]) for c in range(3)], -1).round().astype(np.uint8)
