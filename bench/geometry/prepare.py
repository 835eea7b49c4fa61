"""Packs what train.py reads into one folder for a machine that has only torch: photographs, real light fields, and scenes for the evaluation.

usage: prepare.py OUT --patterns FILE ... --textures FOLDER --real FOLDER ... --scene FOLDER ... [--e2lf PROGRAM]
Scenes are folders of 8x8 views. Disparities of real light fields for the training are those that `e2lf depth`
estimates for the four middle views. Scenes for the evaluation have the true disparities of gt_disparity.npy, or else estimated ones. Requires numpy and pillow.
"""
import argparse
import io
import json
import pathlib
import struct
import subprocess

import numpy as np
from PIL import Image

HEIGHT, WIDTH = 256, 384
SURE = 0.2  # least confidence of a disparity for the training


def pack_photo(path):
    """Returns a photograph as JPEG in grey, of HEIGHT x WIDTH px."""
    image = Image.open(path).convert("L")
    if image.height > image.width:
        image = image.transpose(Image.ROTATE_90)
    image = image.resize((max(WIDTH, round(image.width * HEIGHT / image.height)), HEIGHT), Image.LANCZOS)
    left = (image.width - WIDTH) // 2
    return jpeg(np.asarray(image.crop((left, 0, left + WIDTH, HEIGHT))), 88)


def jpeg(picture, quality):
    packed = io.BytesIO()
    Image.fromarray(picture).save(packed, "JPEG", quality=quality)
    return np.frombuffer(packed.getvalue(), np.uint8)


def read_codes(model):
    """Returns the patterns of a model file, [N, 64]."""
    content = model.read_bytes()
    length = struct.unpack("<Q", content[:8])[0]
    entry = json.loads(content[8:8 + length])["aperture.codes"]
    begin, end = (8 + length + offset for offset in entry["data_offsets"])
    return np.frombuffer(content[begin:end], np.float32).reshape(-1, 64)


def read_views(scene):
    """Returns the views of a scene, uint8 [64, y, x]."""
    return np.stack([np.asarray(Image.open(scene / f"{row:02d}_{column:02d}.png").convert("L")) for row in range(8) for column in range(8)])


def depth(options, scene, row, column):
    """Returns the disparity of a view as estimated from all views, and its confidence."""
    out = options.out / "depth" / f"{scene.name}-{row}{column}"
    if not (out / "run.json").exists():
        out.parent.mkdir(exist_ok=True)
        subprocess.run([options.e2lf, "depth", scene, "-o", out, "--view-row", str(row), "--view-column", str(column), "--quiet"], check=True)
    return np.load(out / "disparity.npy"), np.load(out / "confidence.npy")


def pack_real(options, scene):
    views = read_views(scene)
    height, width = views.shape[1:]
    sheet = views.reshape(8, 8, height, width).transpose(0, 2, 1, 3).reshape(8 * height, 8 * width)
    maps = [depth(options, scene, row, column) for row in (3, 4) for column in (3, 4)]
    np.savez_compressed(options.out / f"real-{scene.name}.npz", sheet=jpeg(sheet, options.quality),
                        disparity=np.stack([d for d, _ in maps]).astype(np.float16), is_sure=np.stack([c for _, c in maps]) > SURE)


def pack_evaluation(options, scene):
    truth = scene / "gt_disparity.npy"
    disparity = np.load(truth) if truth.exists() else depth(options, scene, 4, 4)[0]
    np.savez_compressed(options.out / f"scene-{scene.name}.npz", views=read_views(scene), disparity=disparity.astype(np.float16))


def pack_patterns(options):
    """Packs the lit patterns of model files and of .npy files, by name."""
    sets = {}
    for path in options.patterns:
        codes = np.load(path).reshape(-1, 64) if path.suffix == ".npy" else read_codes(path)
        sets[path.stem] = codes[codes.sum(1) > 0].astype(np.float32)
    np.savez(options.out / "patterns.npz", **sets)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--textures", type=pathlib.Path, required=True)
    parser.add_argument("--real", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--scene", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--e2lf", default="e2lf", help="the program")
    parser.add_argument("--patterns", type=pathlib.Path, nargs="+", required=True, help="model files, and .npy files of patterns; those named test-* are for the evaluation")
    parser.add_argument("--quality", type=int, default=92, help="of the views of real light fields, as JPEG")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    pack_patterns(options)
    photos = [pack_photo(path) for path in sorted(options.textures.rglob("*.jpg"))]
    np.savez(options.out / "photos.npz", sizes=[len(photo) for photo in photos], bytes=np.concatenate(photos))
    for scene in options.real:
        pack_real(options, scene)
    for scene in options.scene:
        pack_evaluation(options, scene)


if __name__ == "__main__":
    main()
