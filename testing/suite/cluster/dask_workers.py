"""dask_workers.py: the example for dask gives the same table when one of its two worker processes is killed."""
import os
import signal
import sys
import tempfile
from pathlib import Path

from distributed import Client

import e2lf

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "cluster"
# The workers import the example, too.
os.environ["PYTHONPATH"] = f"{EXAMPLES}:{os.environ.get('PYTHONPATH', '')}"
sys.path.insert(0, str(EXAMPLES))
import dask_recordings as example  # noqa: E402


def main():
    model = e2lf.Model("e2lf-n4")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        recordings = folder / "recordings"
        recordings.mkdir()
        scene = e2lf.demo_scene(48, 32)
        (recordings / "second").mkdir()
        for number in range(4):
            images = [e2lf.simulate(scene, model.codes, constants=model.constants, seed=10 * number + n) for n in range(2)]
            e2lf.synthesise_recording(recordings / (f"{number}.raw" if number < 3 else "second/0.raw"), images, model.codes)
        expected = [row for path in sorted(recordings.rglob("*.raw")) for row in example.score(path, recordings, folder / "expected", model)]

        honest, killed = example.score, recordings / "killed"

        def score(path, folder, output, model):
            if path.name == "2.raw" and not killed.exists():
                killed.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return honest(path, folder, output, model)

        example.score = score
        with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
            example.main(recordings, folder / "out", client)
        lines = (folder / "out" / "scores.csv").read_text().splitlines()
        assert killed.exists(), "no worker was killed"
        assert lines[1:] == [",".join(map(str, row.values())) for row in expected], lines
    print("dask: two workers, of which one was killed, gave the table of one process")


if __name__ == "__main__":
    main()
