"""Speed of iterating a RAW recording from Python, against reading it in C++ with the same reader.

PYTHONPATH=build/release/python python3 bench/python/iterate.py [RECORDING.raw ...] [--runs N]

Without recordings: a simulated one, which is written first. The file is in the system's cache. Each figure is that of the
fastest of N runs, which take turns: of one thread by the processor's time, which stands while other programs run.
"""
import argparse
import tempfile
import time
from pathlib import Path

import e2lf


def simulated(folder):
    model = e2lf.read_model(e2lf.bundled_model())
    scene = e2lf.demo_scene(1280, 720)
    images = [e2lf.simulate(scene, model.codes, constants=model.constants, seed=seed) for seed in range(2)]
    path = Path(folder) / "simulated.raw"
    e2lf.synthesise_recording(path, images, model.codes)
    return path


def iterate(path, threads, **size):
    recording = e2lf.open_recording(path, threads=threads)
    return sum(len(events) for events in recording.events(**size))


def seconds(work, clock):
    begin = clock()
    work()
    return clock() - begin


def measure(path, runs):
    events = e2lf._e2lf._count_events(path, 0)
    print(f"{Path(path).name}: {events / 1e6:.1f} M events")
    for threads, clock in ((1, time.thread_time), (0, time.perf_counter)):
        ways = {
            "C++": lambda: e2lf._e2lf._count_events(path, threads),
            "Python, as they come": lambda: iterate(path, threads),
            "Python, slices of 1 ms": lambda: iterate(path, threads, delta_t=1000),
            "Python, 10 ms": lambda: iterate(path, threads, delta_t=10_000),
        }
        best = dict.fromkeys(ways, float("inf"))
        for _ in range(runs):
            for name, work in ways.items():
                best[name] = min(best[name], seconds(work, clock))
        for name, best_s in best.items():
            print(f"  {'one thread' if threads == 1 else 'all threads':11}  {name:24} {events / 1e6 / best_s:7.1f} M events/s"
                  f"  {100 * best['C++'] / best_s:5.0f} %")


parser = argparse.ArgumentParser()
parser.add_argument("recordings", nargs="*")
parser.add_argument("--runs", type=int, default=7)
arguments = parser.parse_args()
with tempfile.TemporaryDirectory() as folder:
    for path in arguments.recordings or [str(simulated(folder))]:
        measure(path, arguments.runs)
