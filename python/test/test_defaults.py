"""The defaults of Python, which the bindings take from the library, are those of the command line."""
import ast
import json
import unittest
from pathlib import Path

import e2lf
from common import InFolder, command_line, make_recording


def defaults_of(function):
    """{argument: default} by the signature in the documentation."""
    line = (function.__doc__ or "").split("\n")[0]
    arguments = ast.parse(f"def {line}: ...").body[0].args
    pairs = list(zip(arguments.kwonlyargs, arguments.kw_defaults))
    if arguments.defaults:
        pairs += list(zip(arguments.args[-len(arguments.defaults):], arguments.defaults))
    return {argument.arg: ast.literal_eval(default) for argument, default in pairs if default is not None}


def plain(value):
    """One word for what is not given, and numbers as such: the record of the command line contains texts."""
    if value in (None, "", "0", "false", False, 0, [], [""]):
        return None
    try:
        return float(value)
    except (TypeError, ValueError):
        return value


# The options of the command line with other names than in Python.
CYCLES = {"num_codes": "patterns"}
# What the command line does not have: it never shifts times, and it takes the camera's settings one by one.
ONLY_PYTHON = {"shift_time", "camera_setup", "progress", "out", "range_px"}
# Unset, the command line records the end of time.
TIMES = {"from_us", "to_us"}


class DefaultsTest(InFolder):
    def options(self, verb, *arguments, record):
        command_line(verb, *arguments, "--quiet")
        return json.loads(Path(record).read_text())["options"]

    def compare(self, function, options, names, leave_out=()):
        compared = 0
        for argument, default in defaults_of(function).items():
            if argument in ONLY_PYTHON | TIMES | set(leave_out):
                continue
            flag = names.get(argument, argument.replace("_", "-"))
            self.assertEqual(plain(default), plain(options.get(flag)), f"{function.__name__}({argument}), --{flag}")
            compared += 1
        return compared

    def test_cycles_of_recordings(self):
        make_recording("a.raw")
        options = self.options("accumulate", "a.raw", "-o", "a.npz", record="a.npz.run.json")
        # The record tells the source that was found.
        self.assertGreater(self.compare(e2lf.accumulate, options, CYCLES, {"source"}), 15)
        self.assertEqual(defaults_of(e2lf.accumulate)["source"], "auto")

    def test_reconstruction(self):
        make_recording("a.raw", cycles=1)
        options = self.options("reconstruct", "a.raw", "-m", "e2lf-n4", "-o", "out", "--precision", "auto",
                               record="out/run.json")
        # The record tells the precision and the gain that were used instead of "auto".
        names = {"cycles": "cycles-per-field"}
        self.assertGreater(self.compare(e2lf.Reconstructor.reconstruct, options, names, {"gain"}), 4)
        self.assertEqual(defaults_of(e2lf.Reconstructor.reconstruct)["gain"], "auto")

    def test_simulation(self):
        e2lf.write_light_field("scene", e2lf.demo_scene(48, 32))
        options = self.options("simulate", "scene", "-m", "e2lf-n4", "-o", "e.npz", record="e.npz.run.json")
        # The model states constants and event model.
        self.compare(e2lf.simulate, options, {}, {"camera", "constants", "event_model", "map_seed"})
        options = self.options("depth", "scene", "-o", "depth", record="depth/run.json")
        self.compare(e2lf.depth, options, {}, {"view"})
        options = self.options("convert", "scene", "b.npy", record="b.npy.run.json")
        # A conversion keeps all views, colours and values, and does not record its steps.
        self.compare(e2lf.read_light_field, options, {}, {"views", "step", "colour", "range", "reverse_rows"})


if __name__ == "__main__":
    unittest.main()
