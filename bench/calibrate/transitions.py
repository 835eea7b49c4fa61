#!/usr/bin/env python3
"""How well the lit transitions and those of the whole cycle determine the constants of a camera.

    python3 bench/calibrate/transitions.py --e2lf build/dev/bin/e2lf --seeds 2 > table.md

A twin of `evk4-lcos` records a card with 5x3 even patches behind black, patterns that open an eighth, three quarters and
a quarter of every cell, and the inverses of all four. `e2lf calibrate --even` starts from values that are 10 to 30 %
off, without any uncertainty. Prints a table of the constants: the standard error that the report states, and the actual
error, each as a root mean square over the seeds, in % of the true value. Needs python3-numpy.
"""

import argparse
import json
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
WRONG = {"threshold_on": 1.12, "threshold_off": 0.9, "receptor_rate_hz": 0.75, "amplifier_rate_hz": 1.3, "mismatch": 1.3,
         "noise": 0.8}
QUANTILE = 1.96


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--e2lf", default="e2lf")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--cycles", type=int, default=2)
    arguments = parser.parse_args()

    def e2lf(*words) -> str:
        command = [arguments.e2lf, *map(str, words)]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    text = re.sub(r"^ *//.*$", "", (ROOT / "cameras/evk4-lcos.json").read_text(), flags=re.M)
    truth, guess = json.loads(text), json.loads(text)
    for key, constant in guess["constants"].items():
        constant["value"] *= WRONG.get(key, 1)
        constant.pop("uncertainty", None)
    guess["transmission"].pop("uncertainty")
    stated, actual = {}, {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "guess.json").write_text(json.dumps(guess))
        values = 0.01 * (0.6 / 0.01) ** (np.arange(15) * 7 % 15 / 14)
        card = np.kron(values.reshape(3, 5), np.ones((160, 128)))
        np.save(folder / "card.npy", np.broadcast_to(card, (8, 8, *card.shape)).astype(np.float32))
        shares = np.array([0, 0.125, 0.75, 0.25])
        whole = np.concatenate([shares, 1 - shares, shares[:1]])
        np.save(folder / "whole.npy", np.multiply.outer(whole, np.ones((8, 8))).astype(np.float32))
        for seed in range(arguments.seeds):
            e2lf("simulate", folder / "card.npy", "--codes", folder / "whole.npy", "--camera", "evk4-lcos", "--cycles",
                 arguments.cycles, "--seed", 1 + 100 * seed, "-o", folder / "events.npz", "--overwrite", "--quiet")
            for transitions in ("lit", "all"):
                report = json.loads(e2lf("calibrate", folder / "events.npz", "--even", "--transitions", transitions,
                                         "--camera", folder / "guess.json", "-o", folder / "found.json", "--overwrite",
                                         "--json"))
                for constant in report["constants"]:
                    key = constant["key"]
                    if "[" in key and "slope" in key:
                        continue
                    true = truth["transmission"]["value"][int(key[-2])] if "[" in key else truth["constants"][key]["value"]
                    place = (key, transitions)
                    width = (constant["high"] - constant["low"]) / 2 / QUANTILE
                    stated.setdefault(place, []).append(width / abs(true) if constant["is_determined"] else np.nan)
                    actual.setdefault(place, []).append(constant["value"] / true - 1)

    def percent(errors: list) -> str:
        return "kept" if np.isnan(errors).any() else f"{100 * np.sqrt(np.mean(np.square(errors))):.2f} %"

    print("| constant | stated, lit | all | actual, lit | all |\n|---|---|---|---|---|")
    for key in dict.fromkeys(key for key, _ in stated):
        cells = [percent(errors[key, transitions]) for errors in (stated, actual) for transitions in ("lit", "all")]
        print(f"| `{key}` | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
