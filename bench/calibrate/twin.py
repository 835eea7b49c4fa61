#!/usr/bin/env python3
"""What a calibration from one ordinary scene costs or gains: a simulated twin of the camera.

    python3 bench/calibrate/twin.py --e2lf build/dev/bin/e2lf --codes codes.json -m models/e2lf-n4-capture.safetensors \\
        --draws 3 SCENE ...

Each constant of the true camera lies at one end of the 95 % range that `evk4-lcos` states for it, that is, two standard
deviations off; the draw decides which end (draw 0 is `evk4-lcos` itself). The camera records five cycles of the scene,
and `e2lf calibrate` starts from `evk4-lcos`. The first cycle is reconstructed with the starting, the found and the true
camera. Prints a line for each: PSNR in dB as computed, and with the gain that suits each result best, which is what is
left where brightness does not matter. A scene that cannot be calibrated has a line with the reason. Needs
python3-numpy.
"""

import argparse
import json
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]


def draw(camera: dict, rng: np.random.Generator) -> dict:
    """Returns the camera with each constant at one end of its range."""
    drawn = json.loads(json.dumps(camera))
    for constant in drawn["constants"].values():
        constant["value"] *= float(np.exp(rng.choice((-1, 1)) * constant.get("uncertainty", 0)))
    transmission = drawn["transmission"]
    for k in range(1, len(transmission["value"])):
        transmission["value"][k] *= float(np.exp(rng.choice((-1, 1)) * transmission["uncertainty"]))
    return drawn


def psnr_db(found: np.ndarray, truth: np.ndarray) -> float:
    errors = ((np.clip(found, 0, 1) - truth) ** 2).mean(axis=(2, 3))
    return float((-10 * np.log10(errors)).mean())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--e2lf", default="e2lf")
    parser.add_argument("--codes", required=True)
    parser.add_argument("-m", "--model", required=True)
    parser.add_argument("--draws", type=int, default=1)
    parser.add_argument("--first-draw", type=int, default=0)
    parser.add_argument("--crop", type=int, default=512, help="side of the middle of the scene that is used, px")
    parser.add_argument("scenes", nargs="+", type=Path)
    arguments = parser.parse_args()

    def e2lf(*words) -> str:
        command = [arguments.e2lf, *map(str, words)]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    text = (ROOT / "cameras/evk4-lcos.json").read_text()
    start = json.loads(re.sub(r"^ *//.*$", "", text, flags=re.M))
    print("scene                draw   start   found    true | best gain: start   found    true")
    for scene in arguments.scenes:
        for number in range(arguments.first_draw, arguments.first_draw + arguments.draws):
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                e2lf("convert", scene, folder / "whole.npy", "--quiet")
                truth = np.load(folder / "whole.npy")
                y, x = (max(0, (side - arguments.crop) // 2) for side in truth.shape[2:])
                truth = np.ascontiguousarray(truth[:, :, y : y + arguments.crop, x : x + arguments.crop])
                np.save(folder / "truth.npy", truth)
                camera = draw(start, np.random.default_rng(number)) if number else start
                for key, value in (("start", start), ("true", camera)):
                    (folder / f"{key}.json").write_text(json.dumps(value))
                events = folder / "events.npz"
                e2lf("simulate", folder / "truth.npy", "--codes", arguments.codes, "--camera", folder / "true.json",
                     "--cycles", 5, "--seed", 1 + number, "-o", events, "--quiet")
                try:
                    e2lf("calibrate", events, "--camera", folder / "start.json", "-m", arguments.model,
                         "-o", folder / "found.json", "--quiet")
                except subprocess.CalledProcessError as error:
                    print(f"{scene.name:20} {number:4} no camera: {error.stderr.strip()}", flush=True)
                    continue
                plain, scaled = [], []
                with np.load(events) as file:
                    np.savez(folder / "one.npz", events=file["events"][:1], codes=file["codes"])
                for key in ("start", "found", "true"):
                    e2lf("reconstruct", folder / "one.npz", "-m", arguments.model, "--camera", folder / f"{key}.json",
                         "-o", folder / key, "--format", "npy", "--gain", 1, "--black", 0, "--quiet")
                    field = np.load(folder / key / "lightfield.npy")
                    plain.append(psnr_db(field, truth))
                    scaled.append(psnr_db(field * ((field * truth).sum() / (field**2).sum()), truth))
                numbers = " ".join(f"{value:7.2f}" for value in plain) + " |           "
                numbers += " ".join(f"{value:7.2f}" for value in scaled)
                print(f"{scene.name:20} {number:4} {numbers}", flush=True)


if __name__ == "__main__":
    main()
