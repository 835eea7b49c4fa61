"""Draws scenes for train.py without end, of which a folder holds the newest.

usage: draw.py DATA POOL
DATA is a folder made by prepare.py. Requires torch, numpy, pillow and a C++ compiler.
"""
import argparse
import io
import pathlib
import time

import numpy as np
import torch
from PIL import Image

from scenes import Batches


def read_photos(folder):
    packed = np.load(folder / "photos.npz")
    ends = np.cumsum(packed["sizes"])
    images = [np.asarray(Image.open(io.BytesIO(packed["bytes"][end - size:end].tobytes()))) for end, size in zip(ends, packed["sizes"])]
    return torch.as_tensor(np.stack(images))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("pool", type=pathlib.Path)
    parser.add_argument("--size", type=int, default=256, help="height and width of the views in px")
    parser.add_argument("--batch", type=int, default=8, help="scenes of a file")
    parser.add_argument("--most", type=int, default=80, help="files in the folder")
    options = parser.parse_args()
    torch.set_flush_denormal(True)
    options.pool.mkdir(parents=True, exist_ok=True)
    batches = Batches(read_photos(options.data), sorted(options.data.glob("real-*.npz")), options.batch, options.size, time.time_ns() % 2**31,
                      torch.device("cpu"))
    while True:
        views, disparity, known = (part.numpy() for part in batches.next())
        path = options.pool / f"{time.time_ns()}.npz"
        with open(path.with_suffix(".part"), "wb") as file:
            np.savez(file, views=np.rint(255 * views).astype(np.uint8), disparity=disparity.astype(np.float16), known=known.astype(np.uint8))
        path.with_suffix(".part").rename(path)
        for old in sorted(options.pool.glob("*.npz"))[:-options.most]:
            old.unlink()


if __name__ == "__main__":
    main()
