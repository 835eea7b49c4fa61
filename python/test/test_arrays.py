"""Memory, errors, threads: what numpy and Python expect of a module."""
import gc
import logging
import pickle
import subprocess
import sys
import threading
import unittest
from pathlib import Path

import numpy as np

import e2lf
from common import InFolder, command_line_error, event_images, make_recording, model, same


def address(array):
    return array.__array_interface__["data"][0]


class MemoryTest(unittest.TestCase):
    def test_arrays_own_the_library_s_memory_and_outlive_their_maker(self):
        scene = e2lf.demo_scene(48, 32)
        self.assertIsNotNone(scene.base)
        self.assertTrue(scene.flags.writeable and scene.flags.c_contiguous)
        part = scene[3, 4]
        expected = part.copy()
        del scene
        gc.collect()
        self.assertTrue(same(part, expected))

    def test_a_change_of_an_array_is_a_change_of_what_goes_in(self):
        scene, codes = e2lf.demo_scene(48, 32), model().codes
        before = e2lf.coded_intensities(scene, codes)
        scene *= np.float32(0.5)  # in the library's memory
        self.assertTrue(np.allclose(e2lf.coded_intensities(scene, codes), before / 2))
        self.assertTrue(same(e2lf.coded_intensities(scene, codes), e2lf.coded_intensities(scene.copy(), codes)))

    def test_parts_and_other_layouts_are_taken_for_what_they_show(self):
        scene, codes = e2lf.demo_scene(48, 32), model().codes
        turned = scene[:, :, ::-1, ::2]
        self.assertTrue(same(e2lf.coded_intensities(turned, codes),
                             e2lf.coded_intensities(np.ascontiguousarray(turned), codes)))
        half = scene[:, :, :16]  # begins where the whole does
        self.assertEqual(e2lf.coded_intensities(half, codes).shape, (4, 16, 48))
        self.assertTrue(same(e2lf.coded_intensities(scene.astype(np.float64), codes),
                             e2lf.coded_intensities(scene, codes)))
        images, _ = event_images(1)
        self.assertEqual(e2lf.event_statistics(images[0]), e2lf.event_statistics(images[0].astype(np.int64)))

    def test_results_go_into_memory_of_the_caller(self):
        images, _ = event_images(1)
        reconstructor = e2lf.Reconstructor(model())
        for options in ({}, {"gain": 2.0, "flip_x": True}):
            expected = reconstructor.reconstruct(images[0], **options)
            wide = np.zeros((8, 8, 32, 96), np.float32)
            for out in (np.empty_like(expected), wide[..., ::2], wide[:, ::-1, :, 48:]):
                self.assertIs(reconstructor.reconstruct(images[0], out=out, **options), out)
                self.assertTrue(same(out, expected))
        for wrong in (np.zeros((8, 8, 32, 48)), np.zeros((8, 8, 32, 47), np.float32), np.broadcast_to(expected, expected.shape)):
            with self.assertRaises(e2lf.Error):
                reconstructor.reconstruct(images[0], out=wrong)

    def test_arrays_of_the_caller_are_not_copied(self):
        # A light field of 1 GB by its shape, in 8 kB, with 512 MB of address space left.
        done = subprocess.run([sys.executable, "-c", """
import re, resource
import numpy as np, e2lf
e2lf.set_num_threads(2)
codes = e2lf.Model("e2lf-n4").codes
scene = np.broadcast_to(np.linspace(0, 1, 2000, dtype=np.float32), (8, 8, 2000, 2000))
images = np.broadcast_to(np.int16(1), (3, 2000, 2000))
used = int(re.search(r"VmSize:\\s*(\\d+)", open("/proc/self/status").read())[1]) * 1024
resource.setrlimit(resource.RLIMIT_AS, (used + (512 << 20),) * 2)
e2lf.coded_intensities(scene, codes)
e2lf.event_error(scene, images, codes)
e2lf.event_statistics(images)
assert e2lf.psnr(scene, scene) == np.inf and e2lf.auto_gain(scene) == 1
"""], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_wrong_arrays_are_refused(self):
        codes = model().codes
        for wrong, text in ((np.zeros((8, 8, 4), np.float32), r"\[8, 8, 4\]"),
                            (np.zeros((8, 8, 4, 4), np.uint8), "uint8")):
            with self.assertRaisesRegex(e2lf.Error, text):
                e2lf.coded_intensities(wrong, codes)
        for wrong in (np.zeros((3, 4, 4), np.float32), np.full((3, 4, 4), 40000)):
            with self.assertRaises(e2lf.Error):
                e2lf.event_statistics(wrong)
        with self.assertRaises(e2lf.Error):
            e2lf.coded_intensities(np.zeros((8, 8, 4, 4), np.float32), np.full((4, 8, 8), 2.0))

    def test_nan_and_negative_numbers_are_refused_with_one_line(self):
        scene, codes = e2lf.demo_scene(48, 32), model().codes
        for value in (np.nan, np.inf, -1):
            wrong = scene.copy()
            wrong[3, 4, 5, 6] = value
            for call in (lambda: e2lf.simulate(wrong, codes), lambda: e2lf.coded_intensities(wrong, codes)):
                with self.assertRaises(e2lf.Error) as caught:
                    call()
                self.assertNotIn("\n", str(caught.exception))
        wrong[3, 4, 5, 6] = np.nan
        for call in (lambda: e2lf.psnr(scene, wrong), lambda: e2lf.ssim(scene, wrong), lambda: e2lf.compare(scene, wrong),
                     lambda: e2lf.depth(wrong), lambda: e2lf.refocus(wrong, 1), lambda: e2lf.write_light_field("nan.npy", wrong)):
            with self.assertRaisesRegex(e2lf.Error, "NaN"):
                call()
        self.assertFalse(Path("nan.npy").exists())
        for call in (lambda: e2lf.demo_scene(-5, 32), lambda: e2lf.simulate(scene, codes, seed=-1),
                     lambda: e2lf.paper_schedule(-4), lambda: e2lf.horizontal_epi(scene, -1, 0)):
            with self.assertRaises(ValueError) as caught:
                call()
            self.assertRegex(str(caught.exception), r"^-\d is negative[^\n]*$")


class ErrorTest(InFolder):
    def test_the_text_is_that_of_the_command_line(self):
        Path("bad.raw").write_bytes(b"% evt 3.0\n% format EVT9\n% end\n")
        Path("bad.safetensors").write_bytes(b"\xff" * 32)
        e2lf.write_light_field("scene", e2lf.demo_scene(48, 32))
        cases = [
            (lambda: e2lf.read_model("bad.safetensors"), ("model", "info", "bad.safetensors")),
            (lambda: e2lf.info("nothing"), ("info", "nothing")),
            (lambda: e2lf.info("bad.raw"), ("info", "bad.raw")),
            (lambda: e2lf.convert("bad.raw", "out.xyz"), ("convert", "bad.raw", "out.xyz")),
        ]
        for call, arguments in cases:
            with self.assertRaises(e2lf.Error) as caught:
                call()
            error = caught.exception
            text = str(error).removesuffix(f" ({error.option})")
            self.assertEqual(text, command_line_error(*arguments))
            self.assertEqual(text, f"{error.location}: {error.message}" if error.location else error.message)
            self.assertTrue(error.code)

    def test_models_cameras_and_codes_are_given_by_name(self):
        self.assertEqual(e2lf.Model("e2lf-n4").name, "e2lf-n4")
        self.assertEqual(e2lf.read_model("e2lf-n8.safetensors").num_patterns, 8)
        self.assertEqual(e2lf.Camera("evk4-lcos"), e2lf.read_camera(Path(e2lf.data_file("cameras/evk4-lcos.json"))))
        self.assertEqual(e2lf.read_codes("e2lf-n8").shape, (8, 8, 8))
        # A file of exactly this name goes before the bundled one.
        Path("e2lf-n4").write_bytes(Path(e2lf.bundled_model("e2lf-n8")).read_bytes())
        self.assertEqual(e2lf.Model("e2lf-n4").name, "e2lf-n8")
        for call, known in ((e2lf.Model, "e2lf-n4-camera"), (e2lf.Camera, "evk4-lcos"), (e2lf.read_codes, "e2lf-n8")):
            with self.assertRaisesRegex(e2lf.Error, f"nobodys: there is no such .*{known}"):
                call("nobodys")
        with self.assertRaisesRegex(FileNotFoundError, "e2lf-n4-camera"):
            e2lf.bundled_model("nobodys")

    def test_an_error_says_which_argument_mends_it(self):
        e2lf.write_png("p.png", np.zeros((4, 4), np.float32))
        with self.assertRaises(e2lf.Error) as caught:
            e2lf.write_png("p.png", np.zeros((4, 4), np.float32))
        self.assertEqual((caught.exception.code, caught.exception.option), ("exists", "overwrite"))
        e2lf.write_png("p.png", np.ones((4, 4), np.float32), overwrite=True)
        self.assertTrue(np.all(e2lf.read_image("p.png") == 1))

    def test_what_was_left_out_is_logged(self):
        make_recording("rec.raw", cycles=1)
        Path("rec.raw").write_bytes(Path("rec.raw").read_bytes()[:-1])
        with self.assertLogs("e2lf", logging.WARNING) as log:
            events, _ = e2lf.read_events("rec.raw")
        self.assertGreater(len(events), 0)
        self.assertRegex("\n".join(log.output), "rec.raw: left out")
        with self.assertRaises(e2lf.Error):
            e2lf.read_events("rec.raw", strict=True)

    def test_data_is_pickled_and_nothing_else(self):
        make_recording("rec.raw", cycles=1)
        setup = e2lf.CameraSetup(trigger_channels=["main"], max_events_per_s=5, regions=[(0, 1, 2, 3)], encoding="evt3")
        for value in (e2lf.SensorConstants(tau=0.25), e2lf.paper_schedule(3), e2lf.paper_schedule(3).patterns[1], setup,
                      e2lf.read_camera("evk4-lcos")):
            self.assertEqual(pickle.loads(pickle.dumps(value)), value)
        again = pickle.loads(pickle.dumps(model()))
        self.assertEqual(again.header, model().header)
        self.assertTrue(same(again.codes, model().codes))
        self.assertTrue(all(same(again.weights[name], values) for name, values in model().weights.items()))
        part = next(iter(e2lf.open_recording("rec.raw")))
        again = pickle.loads(pickle.dumps(part))
        self.assertTrue(same(again.events, part.events) and again.begin_us == part.begin_us)
        with self.assertRaises(e2lf.Error) as caught:
            e2lf.read_model("nothing")
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.code), (str(caught.exception), "not_found"))
        codes = model().codes
        for name in ("e2lf-any", "e2lf-n4-capture-geometry"):
            with self.assertRaisesRegex(e2lf.Error, "adapted to the patterns"):
                pickle.dumps(e2lf.Model(name))
        again = pickle.loads(pickle.dumps(e2lf.Model("e2lf-any", codes=codes)))
        self.assertTrue(same(again.codes, codes))
        for value in (e2lf.Reconstructor(model()), e2lf.open_recording("rec.raw")):
            with self.assertRaises(TypeError):
                pickle.dumps(value)


class ThreadTest(InFolder):
    def test_progress_is_told_and_what_it_raises_ends_the_work(self):
        images, _ = event_images(1)
        reconstructor = e2lf.Reconstructor(model())
        told = []
        reconstructor.reconstruct(images[0], progress=lambda done, total: told.append((done, total)))
        self.assertEqual(told[-1][0], told[-1][1])
        self.assertEqual(told, sorted(told))

        def stop(done, total):
            raise RuntimeError("enough")

        script = ("import e2lf\ndef stop(done, total): raise RuntimeError\n"
                  "try: e2lf.depth(e2lf.demo_scene(96, 64), progress=stop)\nexcept RuntimeError: print('caught')")
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        self.assertEqual((ended.returncode, ended.stdout), (0, "caught\n"))  # the interpreter ends after an exception
        for call in (lambda: reconstructor.reconstruct(images[0], progress=stop),
                     lambda: e2lf.write_light_field("views", e2lf.demo_scene(48, 32), progress=stop)):
            with self.assertRaisesRegex(RuntimeError, "enough"):
                call()
        reconstructor.reconstruct(images[0])  # works again

    def test_an_object_at_work_refuses_a_second_call(self):
        images, _ = event_images(1)
        reconstructor = e2lf.Reconstructor(model())
        refused = []

        def call_again(done, total):
            try:
                reconstructor.reconstruct(images[0])
            except RuntimeError as error:
                refused.append(str(error))

        reconstructor.reconstruct(images[0], progress=call_again)
        self.assertIn("at work", refused[0])

    def test_other_threads_run_while_the_library_works(self):
        images, _ = event_images(1)
        started, answered = threading.Event(), threading.Event()
        threading.Thread(target=lambda: (started.wait(), answered.set()), daemon=True).start()

        def ask(done, total):
            started.set()
            self.assertTrue(answered.wait(60))

        e2lf.Reconstructor(model()).reconstruct(images[0], progress=ask)

    def test_threads_of_the_process(self):
        before = e2lf.num_threads()
        e2lf.set_num_threads(1)
        self.assertEqual(e2lf.num_threads(), 1)
        e2lf.set_num_threads(before)
        with self.assertRaises(ValueError):
            e2lf.set_num_threads(-1)
        self.assertIn(e2lf.instruction_set(), ("scalar", "sse4", "avx2", "avx512", "amx"))


if __name__ == "__main__":
    unittest.main()
