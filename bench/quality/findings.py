#!/usr/bin/env python3
"""Counts how often each finding is right and wrong on simulated recordings whose mistake is known.

    python3 bench/quality/findings.py [--parts images,triggers,motion] [--lights 1,0.2] [--seeds N] SCENE...

with e2lf in PATH; SCENE is a light field, which only the images need. "Stated" counts the runs in which e2lf says that
the patterns are undecided, "unsure" those with a confidence below 0.3. "motion" counts how often `--transitions auto` uses the lit transitions alone.
"""

import argparse
import json
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from rigs import CAMERA, CYCLES, PATTERNS, TRIGGERS, run, with_triggers

MODEL, SIDE = "e2lf-n4-camera", 256
SPEEDS = (0.25, 0.5, 1, 2, 4, 8, 16)  # px per cycle at the rim of the turntable

# The change of the event images [cycle, transition, y, x].
IMAGES = {"right": lambda events: events,
          "inverted polarity": lambda events: -events,
          "event images rotated by one": lambda events: np.roll(events, 1, axis=1),
          "first two event images swapped": lambda events: events[:, [1, 0, 2]],
          "last two event images swapped": lambda events: events[:, [0, 2, 1]]}
EXPECTED = {"inverted polarity": "polarity-inverted", "event images rotated by one": "order-better-changed",
            "first two event images swapped": "order-better-changed",
            "last two event images swapped": "order-better-changed"} | \
    {way: "order-better-changed" if "exchanged" in way else "orientation-better-changed" for way in PATTERNS}

OF_TRIGGERS = {"right triggers": "", "triggers 1 ms late": "trigger-delay", "triggers 3 ms late": "trigger-delay",
               "triggers 3 ms early": "trigger-delay", "one trigger 500 us late": "triggers-late",
               "every second trigger missing": "triggers-halved", "one trigger in ten missing": "triggers-missing",
               "one trigger per cycle": "triggers-of-cycles"}


def simulate(scene: object, output: Path, codes: object, light: float, *options: object) -> None:
    run("simulate", scene, "--codes", codes, "--camera", CAMERA, "--scene-gain", light, "-o", output, *options,
        "--overwrite", "--quiet")


def middle_of(file: Path) -> dict:
    arrays = dict(np.load(file))
    arrays.pop("codes")  # as a real recording, which does not state its patterns
    events = arrays["events"] if arrays["events"].ndim == 4 else arrays["events"][None]
    y, x = ((extent - SIDE) // 2 for extent in events.shape[2:])
    arrays["events"] = events[:, :, y:y + SIDE, x:x + SIDE]
    return arrays


def check_images(way: str, light: float, arrays: dict, folder: Path, found: Counter) -> None:
    np.savez(folder / "events.npz", **arrays)
    check = json.loads(run("check", folder / "events.npz", "-m", MODEL, "--codes", MODEL, "--json", check=False).stdout)
    codes = [finding["code"] for finding in check["findings"]]
    for row in (way, f"{way}, light {light}"):
        found[row, "runs"] += 1
        found[row, "warned"] += check["verdict"] == "doubtful"
        found[row, "named"] += EXPECTED.get(way) in codes
        found[row, "stated"] += "patterns-undecided" in codes
    fit = check["fits"][0]
    print(f"{way}, light {light}: ratio {fit['ratio']:.3f}, contrast {fit['contrast']:.2f}, {codes}", file=sys.stderr, flush=True)


def check_triggers(recording: Path, folder: Path, found: Counter) -> None:
    for way, expected in OF_TRIGGERS.items():
        size = with_triggers(recording, TRIGGERS.get(way, lambda pulses: pulses), folder / "rig.csv")
        result = run("accumulate", folder / "rig.csv", "-o", folder / "events.npz", "--source", "triggers", "--json", "--quiet",
                     *size, "--overwrite", check=False)
        codes = [finding["code"] for finding in json.loads(result.stdout)["findings"]] if result.returncode == 0 else \
            [result.stderr]
        confidence = json.loads(result.stdout)["least_confidence"] if result.returncode == 0 else 0
        found[way, "unsure"] += confidence < 0.3  # is_doubtful() of cycles from triggers
        found[way, "runs"] += 1
        found[way, "warned"] += codes != []
        found[way, "named"] += any(expected in code for code in codes) if expected else 0
        print(f"{way}: confidence {confidence:.2f}, {codes}", file=sys.stderr, flush=True)


def check_motion(speed: float, folder: Path) -> str:
    """Returns how many cycles of a turntable were reconstructed from their lit transitions."""
    width, cycle_s, rim = 160, 0.095, 0.84
    rpm = 60 * speed / (2 * np.pi * rim * width * cycle_s)
    whole = "e2lf-n4-cycle-camera"
    run("simulate", "--turntable", rpm, "--width", width, "--height", 120, "-m", whole, "--camera", CAMERA, "--cycles", 4,
        "-o", folder / "turning.npz", "--overwrite", "--quiet")
    run("reconstruct", folder / "turning.npz", "-m", whole, "-o", folder / "turned", "--overwrite")
    cycles = json.loads((folder / "turned" / "run.json").read_text())["notes"]["cycles"]
    motion = [cycle["motion"] for cycle in cycles]
    return f"| {speed} | {min(motion):.3f} | {max(motion):.3f} | {sum(c['transitions'] == 'lit' for c in cycles)} of {len(cycles)} |"


def print_table(found: Counter, last: str, ways: list) -> None:
    if ways:
        print(f"| mistake | runs | warned | named | {last} |\n|---|---|---|---|---|")
    for way in ways:
        print("| " + " | ".join([way, *(str(found[way, what]) for what in ("runs", "warned", "named", last))]) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--parts", default="images,triggers,motion")
    parser.add_argument("--lights", default="1,0.2", help="brightness of the scenes")
    parser.add_argument("--seeds", type=int, default=10, help="recordings with triggers")
    arguments = parser.parse_args()
    parts, lights = arguments.parts.split(","), [float(light) for light in arguments.lights.split(",")]
    found: Counter = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run("codes", "show", "-m", MODEL, "-o", folder / "codes.npy")
        codes = np.load(folder / "codes.npy")
        for scene in arguments.scenes if "images" in parts else []:
            for light in lights:
                simulate(scene, folder / "right.npz", MODEL, light)
                for way, change in IMAGES.items():
                    arrays = middle_of(folder / "right.npz")
                    check_images(way, light, arrays | {"events": change(arrays["events"])}, folder, found)
                for way, change in PATTERNS.items():
                    np.save(folder / "other.npy", np.ascontiguousarray(change(codes)))
                    simulate(scene, folder / "other.npz", folder / "other.npy", light)
                    check_images(way, light, middle_of(folder / "other.npz"), folder, found)
        run("demo", "-o", folder / "demo", "--width", 96, "--height", 64)
        for seed in range(arguments.seeds if "triggers" in parts else 0):
            simulate(folder / "demo" / "scene", folder / "rig.raw", MODEL, 1.0, "--cycles", CYCLES, "--seed", seed)
            check_triggers(folder / "rig.raw", folder, found)
        if "motion" in parts:
            print("| px per cycle | least motion | most | lit |\n|---|---|---|---|")
            print(*(check_motion(speed, folder) for speed in SPEEDS), sep="\n", flush=True)
    ways = [row for way in [*IMAGES, *PATTERNS] for row in (way, *(f"{way}, light {light}" for light in lights))]
    print_table(found, "stated", ways if "images" in parts else [])
    print_table(found, "unsure", list(OF_TRIGGERS) if "triggers" in parts else [])


if __name__ == "__main__":
    main()
