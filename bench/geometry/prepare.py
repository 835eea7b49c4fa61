"""Packs what train.py reads into one folder for a machine that has only torch: photographs, and scenes for the evaluation.

usage: prepare.py MODEL OUT --textures FOLDER --scene FOLDER [--scene FOLDER ...]
MODEL provides the patterns and the initial weights. A scene is a folder of 8x8 views; true disparities of view (4, 4) are read from its
gt_disparity.npy. Requires numpy and pillow.
"""
import argparse
import io
import pathlib
import shutil

import numpy as np
from PIL import Image

HEIGHT, WIDTH = 256, 384


def pack_photo(path):
    """Returns a photograph as JPEG in grey, of HEIGHT x WIDTH px."""
    image = Image.open(path).convert("L")
    if image.height > image.width:
        image = image.transpose(Image.ROTATE_90)
    image = image.resize((max(WIDTH, round(image.width * HEIGHT / image.height)), HEIGHT), Image.LANCZOS)
    left, packed = (image.width - WIDTH) // 2, io.BytesIO()
    image.crop((left, 0, left + WIDTH, HEIGHT)).save(packed, "JPEG", quality=88)
    return np.frombuffer(packed.getvalue(), np.uint8)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--textures", type=pathlib.Path, required=True)
    parser.add_argument("--scene", type=pathlib.Path, action="append", default=[])
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    photos = [pack_photo(path) for path in sorted(options.textures.rglob("*.jpg"))]
    np.savez(options.out / "photos.npz", sizes=[len(photo) for photo in photos], bytes=np.concatenate(photos))
    for scene in options.scene:
        views = [np.asarray(Image.open(scene / f"{row:02d}_{column:02d}.png").convert("L")) for row in range(8) for column in range(8)]
        truth = scene / "gt_disparity.npy"
        disparity = {"disparity": np.load(truth).astype(np.float32)} if truth.exists() else {}
        np.savez_compressed(options.out / f"scene-{scene.name}.npz", views=np.stack(views), **disparity)
    shutil.copy(options.model, options.out / "start.safetensors")


if __name__ == "__main__":
    main()
