#!/usr/bin/env python3
"""Prints what each command says about a rig that is set up in a known wrong way.

    python3 bench/quality/rigs.py [--model NAME] [--ways NAME,...] SCENE...      with e2lf in PATH; SCENE is a light field

`accumulate` is given the patterns that should be shown. Each way is a RAW recording without the header lines by which
simulated recordings state their patterns and camera.
"""

import argparse
import csv
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CAMERA, CYCLES = "evk4-lcos", 8

# The change of the patterns on the aperture [pattern, view_y, view_x], and of the pulses of a recording [pulse, edge],
# each a row [rising, channel, us].
PATTERNS = {"a2 and a3 exchanged": lambda codes: codes[[0, 2, 1, 3]],
            "a2 and a4 exchanged": lambda codes: codes[[0, 3, 2, 1]],
            "a3 and a4 exchanged": lambda codes: codes[[0, 1, 3, 2]],
            "mirrored patterns": lambda codes: codes[:, :, ::-1],
            "patterns turned by 90 degrees": lambda codes: np.rot90(codes, axes=(1, 2)),
            "patterns mirrored and turned by 90 degrees": lambda codes: codes.transpose(0, 2, 1),
            "patterns turned by 180 degrees": lambda codes: codes[:, ::-1, ::-1]}
TRIGGERS = {"triggers 1 ms late": lambda pulses: pulses + [0, 0, 1000],
            "triggers 3 ms late": lambda pulses: pulses + [0, 0, 3000],
            "triggers 3 ms early": lambda pulses: pulses - [0, 0, 3000],
            "one trigger 500 us late": lambda pulses: pulses + [0, 0, 500] *
            (np.arange(len(pulses)) == 21)[:, None, None],
            "every second trigger missing": lambda pulses: pulses[::2],
            "one trigger in ten missing": lambda pulses: pulses[np.arange(len(pulses)) % 10 != 7],
            "one trigger per cycle": lambda pulses: pulses[::8],
            "triggers on two channels": lambda pulses: np.concatenate([pulses, other_clock(pulses)])}
WAYS = ["right", "inverted polarity", "a2 and a3 exchanged", "a2 and a4 exchanged", "a3 and a4 exchanged",
        "mirrored patterns", "patterns turned by 90 degrees", "triggers 3 ms late", "one trigger per cycle",
        "triggers on two channels", "no triggers"]


def other_clock(pulses: np.ndarray) -> np.ndarray:
    """Returns the pulses of another clock, such as a camera's 30 Hz, on channel 1."""
    times = np.arange(pulses[0, 0, 2], pulses[-1, -1, 2], 33_333)
    return np.array([[[edge, 1, t + 400 * (1 - edge)] for edge in (1, 0)] for t in times])


def run(*command: object, check: bool = True) -> subprocess.CompletedProcess:
    result = subprocess.run(["e2lf", *map(str, command)], capture_output=True, text=True)
    if check and result.returncode != 0:
        raise RuntimeError(result.stderr)
    return result


def strip_setup(recording: Path) -> None:
    """Leaves out the header lines that only simulated recordings have."""
    content = recording.read_bytes()
    header, events = content.split(b"% end\n", 1)
    lines = [line for line in header.splitlines(keepends=True) if not line.startswith(b"% e2lf")]
    recording.write_bytes(b"".join(lines) + b"% end\n" + events)
    recording.with_name(recording.name + ".run.json").unlink(missing_ok=True)


def simulate(scene: str, codes: object, output: Path, light: float, *options: object) -> None:
    run("simulate", scene, "--codes", codes, "--camera", CAMERA, "--cycles", CYCLES, "--scene-gain", light, "-o", output,
        "--overwrite", "--quiet", *options)
    strip_setup(output)


def with_triggers(recording: Path, change, table: Path) -> list:
    """Writes the recording as a table of events with other triggers. Returns the options of its size."""
    triggers = table.with_name(table.stem + "_triggers.csv")
    triggers.unlink(missing_ok=True)  # e2lf does not replace what others have changed
    run("convert", recording, table, "--overwrite", "--quiet")
    names, *rows = csv.reader(open(triggers))
    rows = change(np.array(rows, int).reshape(-1, 2, 3)).reshape(-1, 3)
    with open(triggers, "w") as file:
        csv.writer(file).writerows([names, *rows[np.argsort(rows[:, 2], kind="stable")].tolist()])
    size = json.loads(run("info", recording, "--json").stdout)
    return ["--sensor-width", size["width"], "--sensor-height", size["height"]]


def make(way: str, scene: str, model: str, folder: Path, light: float) -> Path:
    right, output = folder / "right.raw", folder / f"{way.replace(' ', '_')}.raw"
    if way in PATTERNS:
        np.save(folder / "shown.npy", np.ascontiguousarray(PATTERNS[way](np.load(folder / "codes.npy"))))
        simulate(scene, folder / "shown.npy", output, light)
        return output
    simulate(scene, model, right, light, *(["--no-triggers"] if way == "no triggers" else []))
    if way == "inverted polarity":
        run("convert", right, output, "--invert-polarity", "--overwrite", "--quiet")
    elif way in TRIGGERS:
        table = output.with_suffix(".csv")
        run("convert", table, output, *with_triggers(right, TRIGGERS[way], table), "--overwrite", "--quiet")
    else:
        return right
    strip_setup(output)
    return output


def said(result: subprocess.CompletedProcess, is_json: bool = True) -> tuple[str, list[str]]:
    """Returns the figures and codes of a command, and its warnings."""
    text = []
    if result.returncode != 0:
        text.append("fails")
    lines = [line for line in result.stderr.splitlines() if line.startswith("e2lf: ")]
    codes = [code for line in lines for code in re.findall(r": ([a-z]+(?:-[a-z]+)+): ", line)]
    if result.stdout.startswith("{") and is_json and result.returncode == 0:
        answer = json.loads(result.stdout)
        if "least_confidence" in answer:
            text.append(f"confidence {answer['least_confidence']:.2f}")
        check = next((c["check"] for c in answer.get("cycles", []) if isinstance(c, dict) and c.get("check")), None) \
            if isinstance(answer.get("cycles"), list) else None
        if "fits" in answer:
            check = {"verdict": answer["verdict"], "ratio": answer["fits"][0]["ratio"]} if answer["fits"] else None
            codes += [finding["code"] for finding in answer["findings"]]
        if check:
            text.append(f"{check['verdict']} ({check['ratio']:.2f})" if "verdict" in check else str(check))
    return ", ".join([*text, *dict.fromkeys(codes)]) or "none", lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--model", default="e2lf-n4-camera")
    parser.add_argument("--light", type=float, default=1.0, help="brightness of the scene")
    parser.add_argument("--ways", help="only these, comma-separated")
    parser.add_argument("--commands", default="check,accumulate,reconstruct .npz,reconstruct,live")
    parser.add_argument("--words", action="store_true", help="print the messages as well")
    arguments = parser.parse_args()
    model = arguments.model
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run("codes", "show", "-m", model, "-o", folder / "codes.npy")
        ways = arguments.ways.split(",") if arguments.ways else WAYS
        for scene in arguments.scenes:
            print(f"\n{scene}\n| rig | {' | '.join(arguments.commands.split(','))} |")
            for way in ways:
                recording = make(way, scene, model, folder, arguments.light)
                images = folder / "events.npz"
                images.unlink(missing_ok=True)
                results = {"accumulate": run("accumulate", recording, "--codes", model, "-o", images, "--json", check=False)}
                if "check" in arguments.commands:
                    results["check"] = run("check", recording, "--codes", model, "-m", model, "--json", check=False)
                if images.exists() and "reconstruct .npz" in arguments.commands:
                    results["reconstruct .npz"] = run("reconstruct", images, "-m", model, "-o", folder / "from_images",
                                                      "--max-cycles", 1, "--json", "--overwrite", check=False)
                if "reconstruct" in arguments.commands.split(","):
                    results["reconstruct"] = run("reconstruct", recording, "-m", model, "-o", folder / "straight",
                                                 "--max-cycles", 2, "--json", "--overwrite", check=False)
                if "live" in arguments.commands:
                    results["live"] = run("live", f"replay:{recording}", "-m", model, "--no-page", check=False)
                cells = {command: said(result) for command, result in results.items()}
                print(f"| {way} | " + " | ".join(cells[c][0] if c in cells else "-"
                                                 for c in arguments.commands.split(",")) + " |", flush=True)
                for command, (_, lines) in cells.items() if arguments.words else ():
                    print(*(f"    {command}: {line}" for line in lines), sep="\n", flush=True)


if __name__ == "__main__":
    main()
