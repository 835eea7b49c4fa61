"""Reading and writing recordings: every event once, whatever the slices, and as the command line has them."""
import threading
import os
import unittest
from pathlib import Path

import numpy as np

import e2lf
from common import InFolder, command_line, command_line_json, make_recording, same


def with_types(events, **types):
    """The same events with fields of other types."""
    other = np.zeros(len(events), list(types.items()))
    for name in types:
        other[name] = events[name]
    return other


def joined(parts):
    return np.concatenate(list(parts))


class ReadingTest(InFolder):
    def setUp(self):
        super().setUp()
        make_recording("rec.raw")
        self.events, self.triggers = e2lf.read_events("rec.raw")

    def test_the_arrays_have_the_fields_of_the_metavision_tools(self):
        self.assertEqual(self.events.dtype.names, ("x", "y", "p", "t"))
        self.assertEqual([self.events.dtype[name].str for name in self.events.dtype.names], ["<u2", "<u2", "<i2", "<i8"])
        self.assertEqual((self.events.dtype.itemsize, self.triggers.dtype.itemsize), (16, 24))
        self.assertEqual(self.triggers.dtype.names, ("p", "t", "id"))

    def test_read_events_gives_what_convert_writes(self):
        command_line("convert", "rec.raw", "rec.csv", "--quiet")
        table = np.loadtxt("rec.csv", delimiter=",", comments="%", dtype=np.int64)
        for column, name in zip(table.T, ("x", "y", "p", "t")):
            self.assertEqual(column.tolist(), self.events[name].tolist())
        table = np.genfromtxt("rec_triggers.csv", delimiter=",", names=True, dtype=np.int64)
        for name in ("p", "t", "id"):
            self.assertEqual(table[name].tolist(), self.triggers[name].tolist())

    def test_batches_cover_all_events(self):
        with e2lf.open_recording("rec.raw") as recording:
            parts = list(recording)
        self.assertTrue(same(joined(part.events for part in parts), self.events))
        self.assertTrue(same(joined(part.triggers for part in parts), self.triggers))

    def test_slices_of_time_cover_all_and_hold_what_is_of_their_time(self):
        for delta_t in (1000, 777, 10_000_000):
            parts = list(e2lf.open_recording("rec.raw").slices(delta_t=delta_t))
            self.assertTrue(same(joined(part.events for part in parts), self.events))
            self.assertTrue(same(joined(part.triggers for part in parts), self.triggers))
            self.assertEqual(parts[0].begin_us % delta_t, 0)
            for before, after in zip(parts, parts[1:]):
                self.assertEqual(before.end_us, after.begin_us)
            for part in parts:
                self.assertEqual(part.end_us - part.begin_us, delta_t)
                inside = (self.events["t"] >= part.begin_us) & (self.events["t"] < part.end_us)
                self.assertEqual(len(part.events), np.count_nonzero(inside))
                for array in (part.events, part.triggers):
                    self.assertTrue(np.all((array["t"] >= part.begin_us) & (array["t"] < part.end_us)))

    def test_slices_of_events_cover_all_and_are_full(self):
        for n_events in (1, 64, 1000) if len(self.events) < 20000 else (64, 1000):
            parts = list(e2lf.open_recording("rec.raw").slices(n_events=n_events))
            self.assertTrue(same(joined(part.events for part in parts), self.events))
            self.assertTrue(same(joined(part.triggers for part in parts), self.triggers))
            self.assertTrue(all(len(part.events) == n_events for part in parts[:-2]))

    def test_slices_of_both_end_with_what_comes_first(self):
        parts = list(e2lf.open_recording("rec.raw").slices(delta_t=5000, n_events=500))
        self.assertTrue(same(joined(part.events for part in parts), self.events))
        self.assertTrue(same(joined(part.triggers for part in parts), self.triggers))
        self.assertTrue(all(len(part.events) <= 500 and part.end_us - part.begin_us <= 5000 for part in parts))
        self.assertTrue(any(len(part.events) == 500 for part in parts))
        self.assertTrue(any(part.end_us - part.begin_us == 5000 for part in parts))

    def test_events_alone(self):
        self.assertTrue(same(joined(e2lf.open_recording("rec.raw").events(delta_t=3000)), self.events))

    def test_any_stretch_in_any_order(self):
        recording = e2lf.open_recording("rec.raw")
        t = self.events["t"]
        for begin, end in ((250_000, 260_000), (0, 150_000), (150_000, 150_000), (-5, 2**40)):
            part = recording.between(begin, end)
            self.assertTrue(same(part.events, self.events[(t >= begin) & (t < end)]))
            trigger_t = self.triggers["t"]
            self.assertTrue(same(part.triggers, self.triggers[(trigger_t >= begin) & (trigger_t < end)]))
        recording.between(0, 200_000)
        self.assertTrue(same(joined(recording.events()), self.events[t >= 200_000]))

    def test_a_range_of_time(self):
        part, _ = e2lf.read_events("rec.raw", from_us=150_000, to_us=250_000)
        t = self.events["t"]
        self.assertTrue(same(part, self.events[(t >= 150_000) & (t < 250_000)]))
        first = next(iter(e2lf.open_recording("rec.raw", from_us=150_001).slices(delta_t=1000)))
        self.assertEqual((first.begin_us, first.end_us), (150_001, 151_001))
        shifted, _ = e2lf.read_events("rec.raw", shift_time=True)
        self.assertEqual(shifted["t"][-1] - shifted["t"][0], t[-1] - t[0])

    def test_info_and_summary_say_what_the_command_line_says(self):
        expected = command_line_json("info", "rec.raw")
        self.assertEqual(e2lf.info("rec.raw"), expected)
        recording = e2lf.open_recording("rec.raw")
        joined(recording.events())
        for key, value in recording.summary().items():
            self.assertEqual(value, expected[key])
        self.assertEqual(recording.summary()["events"], len(self.events))
        self.assertEqual((recording.width, recording.height, recording.format), (48, 32, "evt3"))

    def test_the_patterns_of_the_header(self):
        self.assertEqual(e2lf.open_recording("rec.raw").codes.shape, (4, 8, 8))

    def test_wrong_slices_are_refused(self):
        recording = e2lf.open_recording("rec.raw")
        for wrong in ({"delta_t": 0}, {"n_events": 0}, {"delta_t": -1}):
            with self.assertRaises(ValueError):
                recording.slices(**wrong)
        recording.close()
        with self.assertRaises(ValueError):
            next(iter(recording))


class WritingTest(InFolder):
    def setUp(self):
        super().setUp()
        make_recording("rec.raw", cycles=1)
        self.events, self.triggers = e2lf.read_events("rec.raw")

    def write(self, path, **options):
        middle = len(self.events) // 2
        split = np.searchsorted(self.triggers["t"], self.events["t"][middle])
        with e2lf.create_recording(path, 48, 32, **options) as writer:
            has = writer.holds_triggers
            writer.write(self.events[:middle], self.triggers[:split] if has else None)
            writer.write(self.events[middle:], self.triggers[split:] if has else None)
        return has

    def test_every_format_gives_the_events_back(self):
        in_order = np.sort(self.events, order=["t", "y", "x", "p"])
        for path in ("a.raw", "b.dat", "c.hdf5", "d.csv", "f.npz"):
            has_triggers = self.write(path)
            events, triggers = e2lf.read_events(path, sensor_width=48, sensor_height=32)
            self.assertTrue(same(np.sort(events, order=["t", "y", "x", "p"]), in_order), path)
            self.assertTrue(same(triggers, self.triggers) if has_triggers else len(triggers) == 0, path)
        for encoding in ("evt2", "evt2.1", "evt3"):
            self.write("g.raw", format=encoding, overwrite=True)
            self.assertEqual(e2lf.open_recording("g.raw").format, encoding)
            self.assertTrue(same(np.sort(e2lf.read_events("g.raw")[0], order=["t", "y", "x", "p"]), in_order), encoding)

    def test_fields_of_other_types_are_taken_and_wrong_values_refused(self):
        wide = with_types(self.events, t="i8", x="i4", y="i4", p="u1")
        with e2lf.create_recording("wide.csv", 48, 32) as writer:
            writer.write(wide)
        self.assertTrue(same(e2lf.read_events("wide.csv")[0], self.events))
        writer = e2lf.create_recording("x.csv", 48, 32)
        for field, value, text in (("x", 70000, "70000"), ("p", -1, "-1"), ("x", 48, "")):
            wrong = with_types(wide[:3], t="i8", x="i4", y="i4", p="i2")
            wrong[field][1] = value
            with self.assertRaisesRegex(e2lf.Error, text):
                writer.write(wrong)
        with self.assertRaisesRegex(e2lf.Error, "field t"):
            writer.write(self.events[["x", "y", "p"]])
        with self.assertRaisesRegex(e2lf.Error, "integers"):
            writer.write(with_types(self.events, x="u2", y="u2", p="i2", t="f8"))

    def test_triggers_are_never_lost(self):
        with self.assertRaisesRegex(e2lf.Error, "cannot hold triggers"):
            with e2lf.create_recording("lost.csv", 48, 32) as writer:
                writer.write(self.events, self.triggers)
        self.assertFalse(os.path.exists("lost.csv"))

    def test_a_file_appears_whole_or_not_at_all(self):
        with self.assertRaises(KeyError):
            with e2lf.create_recording("half.raw", 48, 32) as writer:
                writer.write(self.events)
                raise KeyError
        self.assertEqual(os.listdir(), ["rec.raw"])
        with self.assertRaises(e2lf.Error) as caught:
            e2lf.create_recording("rec.raw", 48, 32)
        self.assertEqual((caught.exception.code, caught.exception.option), ("exists", "overwrite"))

    def test_convert_gives_what_the_command_line_gives(self):
        report = e2lf.convert("rec.raw", "python.hdf5")
        expected = command_line_json("convert", "rec.raw", "program.hdf5")
        self.assertEqual(report, {key: expected[key] for key in report})
        for one, other in zip(e2lf.read_events("python.hdf5"), e2lf.read_events("program.hdf5")):
            self.assertTrue(same(one, other))
        with self.assertRaisesRegex(e2lf.Error, "input"):
            e2lf.convert("rec.raw", "rec.raw", overwrite=True)


class LiveTest(InFolder):
    def test_other_threads_run_while_a_pipe_is_read(self):
        make_recording("rec.raw")
        expected, _ = e2lf.read_events("rec.raw")
        os.mkfifo("pipe")

        def feed():  # needs the interpreter, so it gets nowhere where reading keeps it
            with open("rec.raw", "rb") as source, open("pipe", "wb") as pipe:
                pipe.write(source.read())

        feeder = threading.Thread(target=feed)
        feeder.start()
        events = joined(e2lf.open_recording("pipe").events())
        feeder.join()
        self.assertTrue(same(events, expected))

    def test_the_settings_of_a_camera_reach_it(self):
        make_recording("rec.raw", cycles=1)
        with e2lf.open_recording("replay:rec.raw", camera_setup=e2lf.CameraSetup()) as recording:
            self.assertEqual(recording.format, "evt3")
        for settings in ({"trigger_channels": ["main"]}, {"biases": "low.bias"}, {"max_events_per_s": 5},
                         {"regions": [(0, 0, 8, 8)]}, {"encoding": "evt3"}):
            with self.assertRaisesRegex(e2lf.Error, "settings of a camera"):
                e2lf.read_events("replay:rec.raw", camera_setup=e2lf.CameraSetup(**settings))
        with self.assertRaisesRegex(e2lf.Error, "evt9"):
            e2lf.CameraSetup(encoding="evt9")

    def test_an_interrupt_ends_the_wait_for_a_pipe(self):
        make_recording("rec.raw", cycles=1)
        os.mkfifo("pipe")
        done = threading.Event()

        def feed():
            with open("rec.raw", "rb") as source, open("pipe", "wb") as pipe:
                pipe.write(source.read())
                pipe.flush()
                while not done.wait(0.2):  # again, where it came before the wait
                    os.kill(os.getpid(), 2)

        feeder = threading.Thread(target=feed)
        feeder.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                joined(e2lf.open_recording("pipe").events())
        finally:
            while True:
                try:
                    done.set()
                    feeder.join()
                    break
                except KeyboardInterrupt:
                    pass
        self.assertGreater(len(e2lf.read_events("rec.raw")[0]), 0)  # the stop is over


class UnpluggedTest(InFolder):
    def setUp(self):
        super().setUp()
        make_recording("a.raw", cycles=2)
        # The simulated camera of the tests.
        os.environ["E2LF_STAND_IN"] = f"serial=A1;file={Path('a.raw').resolve()};buffer=4000;period_us=0;unplug_at=20000"
        self.addCleanup(os.environ.pop, "E2LF_STAND_IN")
        try:
            cameras = e2lf.find_cameras()
        except e2lf.Error:
            cameras = []
        if not any("stand_in" in name for name in cameras):
            self.skipTest("the build has no simulated camera")

    def test_an_unplugged_camera_is_no_end(self):
        for read in (lambda: e2lf.open_recording("camera://metavision"),
                     lambda: e2lf.open_recording("camera://metavision").events(n_events=100)):
            parts = read()
            number = 0
            with self.assertRaisesRegex(e2lf.Error, "connection to the camera is lost") as caught:
                for _ in parts:
                    number += 1
            self.assertEqual(caught.exception.code, "io")
            self.assertGreater(number, 0)
            self.assertEqual(list(parts), [])


if __name__ == "__main__":
    unittest.main()
