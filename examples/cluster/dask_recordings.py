"""Reconstructs the light fields of all recordings below a folder on the workers of dask.distributed, and scores them.

The score is the mean difference between the events of a light field and those that were recorded: it needs no truth.

python3 dask_recordings.py FOLDER OUTPUT [SCHEDULER]     without a scheduler: two worker processes on this machine
"""
import csv
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any, Dict, List

from distributed import Client

import e2lf


EXTENSIONS = {".raw", ".hdf5", ".h5", ".dat", ".aedat4"}


@lru_cache(maxsize=1)
def reconstructor_of(model: e2lf.Model) -> e2lf.Reconstructor:
    """The reconstructor of a worker, which is made once: models are sent, reconstructors are not."""
    return e2lf.Reconstructor(model)


def score(path: Path, folder: Path, output: Path, model: e2lf.Model) -> List[Dict[str, Any]]:
    """Writes the light fields of a recording in `folder` to the same place in `output`; returns a row for each."""
    assert model.codes is not None
    place = output / path.relative_to(folder)
    place.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    for cycle in e2lf.accumulate(path):
        light_field = reconstructor_of(model).reconstruct(cycle.images, gain=1)
        e2lf.write_light_field(place.with_name(f"{path.name}_{cycle.number}.h5"), light_field, overwrite=True)
        error = e2lf.event_error(light_field, cycle.images, model.codes, constants=model.constants)
        rows.append({"recording": str(path.relative_to(folder)), "cycle": cycle.number, "events": cycle.events, "event_error": error["least"]})
    return rows


def main(folder: Path, output: Path, client: Client) -> None:
    output.mkdir(exist_ok=True)
    recordings = sorted(path for path in folder.rglob("*") if path.suffix in EXTENSIONS)
    if not recordings:
        sys.exit(f"{folder} contains no recordings ({', '.join(sorted(EXTENSIONS))})")
    model = client.scatter(e2lf.Model("e2lf-n4"), broadcast=True)
    # Recordings of a worker that ends are taken over by the others.
    rows = client.gather(client.map(score, recordings, folder=folder, output=output, model=model))
    with open(output / "scores.csv", "w", newline="") as file:
        table = csv.DictWriter(file, ["recording", "cycle", "events", "event_error"])
        table.writeheader()
        table.writerows(row for rows_of_recording in rows for row in rows_of_recording)


if __name__ == "__main__":
    scheduler = sys.argv[3] if len(sys.argv) > 3 else None
    with Client(scheduler) if scheduler else Client(n_workers=2, threads_per_worker=1) as client:
        main(Path(sys.argv[1]), Path(sys.argv[2]), client)
