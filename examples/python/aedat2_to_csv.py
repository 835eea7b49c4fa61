"""Converts the events of an AEDAT 2 recording (jAER, v2e) to CSV, which e2lf reads: aedat2_to_csv.py IN.aedat OUT.csv

Known are the cameras DVS128 and DAVIS of any size, whose name the header states; --size WIDTHxHEIGHT names the size for
other headers. Frames, inertial data and external signals are left out.
"""

import argparse
import re

import numpy as np
from numpy.typing import NDArray

SIZES = {"dvs128": (128, 128), "davis240": (240, 180), "davis346": (346, 260), "davis128": (128, 128),
         "davis208": (208, 192), "davis640": (640, 480)}


def read(path: str) -> tuple[str, NDArray[np.uint32]]:
    """Returns the lines of the header and the records: big-endian addresses and times in us."""
    data = open(path, "rb").read()
    if not data.startswith(b"#!AER-DAT2"):
        raise SystemExit(f"{path}: not an AEDAT 2 recording")
    begin = 0
    while data[begin:begin + 1] == b"#":
        begin = data.index(b"\n", begin) + 1
    count = (len(data) - begin) // 8
    return data[:begin].decode("latin-1").lower(), np.frombuffer(data, ">u4", 2 * count, begin).reshape(count, 2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("input")
    parser.add_argument("output")
    parser.add_argument("--size", help="WIDTHxHEIGHT of the sensor, if the header does not name the camera")
    arguments = parser.parse_args()
    header, records = read(arguments.input)
    camera = re.search(r"dvs128|davis\d{3}", header)
    if arguments.size:
        width, height = map(int, arguments.size.split("x"))
    elif camera and camera.group() in SIZES:
        width, height = SIZES[camera.group()]
    else:
        raise SystemExit(f"{arguments.input}: the header names no known camera; give --size WIDTHxHEIGHT")
    address, t = records[:, 0].astype(np.int64), records[:, 1].astype(np.int64)
    t += (np.cumsum(np.diff(t, prepend=t[:1]) < -(1 << 31))) << 32  # the clock has 32 bits
    if camera and camera.group() == "dvs128":
        is_event = (address & 0x80008000) == 0
        x, y, p = address >> 1 & 0x7F, address >> 8 & 0x7F, 1 - (address & 1)
    else:
        is_event = (address & 0x80000400) == 0
        x, y, p = address >> 12 & 0x3FF, address >> 22 & 0x1FF, address >> 11 & 1
    # The origin of jAER is the lower right corner.
    events = np.stack([width - 1 - x, height - 1 - y, p, t], 1)[is_event]
    np.savetxt(arguments.output, events, "%d", ",", header=f"geometry:{width},{height}", comments="%")


if __name__ == "__main__":
    main()
