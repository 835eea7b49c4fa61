"""What the tests of the Python package share. They run in a new empty folder each; $E2LF is the command line."""
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import e2lf


def command_line(*arguments):
    """Runs the command line; its standard output."""
    done = subprocess.run([os.environ["E2LF"], *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def command_line_json(*arguments):
    return json.loads(command_line(*arguments, "--json"))


def command_line_error(*arguments):
    """What a failing run says, without "e2lf: verb: " and the flag at the end."""
    done = subprocess.run([os.environ["E2LF"], *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    return done.stderr.split(": ", 2)[2].rstrip("\n").rsplit(" (--", 1)[0]


class InFolder(unittest.TestCase):
    """A test in a folder of its own."""

    def setUp(self):
        before = os.getcwd()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, before)
        os.chdir(folder.name)


def same(a, b):
    """Types, shapes and values; of structured arrays the fields, since joining them takes their padding away."""
    if a.dtype.names:
        return a.dtype.names == b.dtype.names and all(same(a[name], b[name]) for name in a.dtype.names)
    return a.dtype == b.dtype and a.shape == b.shape and bool(np.all(a == b))


def model():
    return e2lf.read_model(e2lf.bundled_model())


def event_images(cycles=3, width=48, height=32):
    """Event images of the demo scene, each cycle with noise of its own, and their patterns."""
    scene, codes = e2lf.demo_scene(width, height), model().codes
    return [e2lf.simulate(scene, codes, seed=seed) for seed in range(1, cycles + 1)], codes


def make_recording(path, cycles=3, triggers=True):
    images, codes = event_images(cycles)
    e2lf.synthesise_recording(path, images, codes, triggers=triggers)
    return images
