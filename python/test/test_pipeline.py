"""Simulation, cycles, reconstruction, pictures and measures give the numbers of the command line."""
import os
import pickle
import unittest
from pathlib import Path

import numpy as np

import e2lf
from common import InFolder, command_line, command_line_json, event_images, model, same


class PipelineTest(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.model = model()
        cls.path = e2lf.bundled_model()

    def setUp(self):
        super().setUp()
        self.scene = e2lf.demo_scene(48, 32)
        e2lf.write_light_field("scene.npy", self.scene)

    def test_simulate(self):
        command_line("simulate", "scene.npy", "-m", self.path, "-o", "events.npz", "--cycles", 2, "--quiet")
        file = e2lf.read_event_images("events.npz")
        for cycle, images in enumerate(file.cycles):
            own = e2lf.simulate(self.scene, self.model.codes, constants=self.model.constants,
                                event_model=self.model.event_model, seed=1 + cycle)
            self.assertTrue(same(own, images))
        self.assertTrue(same(file.codes, self.model.codes))
        self.assertEqual(file.camera.name, "paper")
        e2lf.write_event_images("again.npz", *file[:2], camera=file.camera)
        self.assertEqual(e2lf.read_event_images("again.npz").camera, file.camera)
        self.assertEqual(pickle.loads(pickle.dumps(file)).camera, file.camera)

    def test_simulate_physical_pixels(self):
        command_line("simulate", "scene.npy", "-m", self.path, "--camera", "evk4-lcos", "-o", "events.npz", "--cycles", 2,
                     "--quiet")
        camera = e2lf.read_camera("evk4-lcos")
        for cycle, images in enumerate(e2lf.read_event_images("events.npz").cycles):
            own = e2lf.simulate(self.scene, self.model.codes, camera=camera, seed=1 + cycle, map_seed=1)
            self.assertTrue(same(own, images))
        with self.assertRaises(e2lf.Error):
            e2lf.simulate(self.scene, self.model.codes, camera=camera, residue=0.5)

    def test_accumulate(self):
        images, codes = event_images()
        paper = e2lf.read_camera("paper")
        e2lf.synthesise_recording("rec.raw", images, codes, camera=paper)
        self.assertEqual(e2lf.open_recording("rec.raw").camera, paper)
        command_line("simulate", "scene.npy", "-m", self.path, "--camera", "paper", "-o", "program.raw", "--cycles", 3,
                     "--quiet")
        of_program = e2lf.accumulate("program.raw")
        self.assertTrue(all(same(cycle.images, truth) for cycle, truth in zip(of_program, images, strict=True)))
        self.assertEqual(e2lf.open_recording("program.raw").camera, paper)
        cases = [({}, (), 3), ({"schedule": e2lf.paper_schedule()}, (), 3),
                 ({"source": "bursts"}, ("--source", "bursts"), None),
                 # The first trigger shows that the first cycle was not cut.
                 ({"source": "schedule", "origin_us": 100_000}, ("--source", "schedule", "--origin-us", 100_000), 3)]
        for options, flags, count in cases:
            report = command_line_json("accumulate", "rec.raw", "-o", "events.npz", "--overwrite", *flags)
            cycles = e2lf.accumulate("rec.raw", **options)
            found = list(cycles)
            expected = e2lf.read_event_images("events.npz").cycles
            self.assertEqual(len(found), len(expected))
            for cycle, images_of_file, said in zip(found, expected, report["each"]):
                self.assertTrue(same(cycle.images, images_of_file))
                self.assertEqual((cycle.number, cycle.begin_us, cycle.events),
                                 (said["number"], said["begin_us"], said["events"]))
            if count:
                self.assertEqual(len(found), count)
                self.assertTrue(all(same(cycle.images, truth) for cycle, truth in zip(found, images[-count:])))
            self.assertTrue(same(cycles.codes, codes))
            for key, value in cycles.report().items():
                self.assertEqual(value, report[key], key)
        self.assertEqual(e2lf.accumulate("rec.raw").source, "triggers")
        with self.assertRaisesRegex(e2lf.Error, "bursts"):
            e2lf.accumulate("rec.raw", source="burst")

    def test_reconstruct_in_a_forked_process(self):
        images, _ = event_images(1)
        reconstructor = e2lf.Reconstructor(self.model)
        own = reconstructor.reconstruct(images[0], gain=1)
        child = os.fork()
        if child == 0:
            os._exit(0 if same(reconstructor.reconstruct(images[0], gain=1), own) else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)

    def test_reconstruct(self):
        images, codes = event_images(1)
        e2lf.write_event_images("events.npz", images, codes)
        for gain in (1, "auto"):
            command_line("reconstruct", "events.npz", "-m", self.path, "-o", f"out{gain}", "--format", "npy", "--gain",
                         gain, "--quiet")
            own = e2lf.Reconstructor(self.model).reconstruct(images[0], gain=gain)
            self.assertTrue(same(own, np.load(f"out{gain}/lightfield.npy")))
        command_line("reconstruct", "events.npz", "--method", "inversion", "-o", "inverted", "--format", "npy", "--gain",
                     1, "--quiet")
        self.assertTrue(same(e2lf.invert(images[0], codes, gain=1), np.load("inverted/lightfield.npy")))
        record = e2lf.Reconstructor(self.model).reconstruct(images[0], gain=1)
        error = e2lf.event_error(record, images[0], codes, constants=self.model.constants)
        self.assertGreaterEqual(error["at_first"], error["least"])
        self.assertGreater(error["least"], 0)

    def test_devices(self):
        images, _ = event_images(1)
        own = e2lf.Reconstructor(self.model).reconstruct(images[0], gain=1)
        self.assertTrue(same(e2lf.Reconstructor("e2lf-n4", device="cpu").reconstruct(images[0], gain=1), own))
        with self.assertRaises(e2lf.Error) as raised:
            e2lf.Reconstructor("e2lf-n4", device="tpu")
        self.assertEqual(raised.exception.code, "missing_dependency")
        with self.assertRaises(e2lf.Error) as raised:  # without PyTorch, or there is no such GPU
            e2lf.Reconstructor("e2lf-n4", device="cuda:99")
        self.assertEqual(raised.exception.code, "missing_dependency")

    def test_fused_cycles(self):
        images, codes = event_images(4)
        still = np.stack([images[0], images[0], images[0], images[1]])
        for name, verb, result in (("e2lf-n4-camera", "reconstruct", "lightfield.npy"), ("e2lf-n4-depth", "depth", "disparity.npy")):
            camera = e2lf.Camera("evk4-lcos")
            e2lf.write_event_images("events.npz", still, codes, camera=camera, overwrite=True)
            gain = ("--gain", 1, "--format", "npy") if verb == "reconstruct" else ()
            command_line(verb, "events.npz", "-m", name, "-o", verb, "--fuse", 4, "--quiet", *gain)
            fusion, network = e2lf.CycleFusion(camera, 4), e2lf.Reconstructor(name, camera=camera)
            for number, cycle in enumerate(still):
                fused = fusion.add(cycle)
                own = network.reconstruct(fused, gain=1) if verb == "reconstruct" else network.depth(fused).disparity
                folder = next(Path(verb).glob(f"*_0000{number}"))
                self.assertTrue(same(own, np.load(folder / result)), f"{name}, cycle {number}")
                if number == 2:
                    self.assertTrue((fused.cycles == 3).all())
                    self.assertTrue((abs(fused.counts - 64 * still[0].astype(int)) <= 1).all())
            self.assertTrue(same(fused.images, still[3]))
        self.assertGreater(fusion.changed, 0)
        with self.assertRaises(e2lf.Error):
            e2lf.Reconstructor("e2lf-n4").reconstruct(fused)  # has no input for the number of cycles
        for wrong in (fused._replace(cycles=fused.cycles[1:]), fused._replace(cycles=0 * fused.cycles),
                      fused._replace(counts=fused.counts[:1])):
            with self.assertRaises(ValueError):
                network.depth(wrong)
        with self.assertRaises(ValueError):
            network.depth(fused, cycles=2)
        for cycles in (0, 65):
            with self.assertRaises(ValueError):
                e2lf.CycleFusion(camera, cycles)

    def test_orientation(self):
        turned = np.ascontiguousarray(self.scene[::-1, ::-1])
        self.assertTrue(same(e2lf.depth(turned, turn_views=True).disparity, e2lf.depth(self.scene).disparity))
        np.save("turned.npy", turned)
        self.assertTrue(same(e2lf.read_light_field("turned.npy", flip_x=True, flip_y=True), self.scene))
        images, codes = event_images(1)
        plain = e2lf.invert(images[0], codes, gain=1)
        self.assertTrue(same(e2lf.invert(images[0], codes, gain=1, flip_x=True), plain[:, ::-1]))
        e2lf.write_event_images("told.npz", images, codes, views="turned")
        self.assertEqual(e2lf.read_event_images("told.npz").views, "turned")
        command_line("reconstruct", "told.npz", "--method", "inversion", "-o", "out", "--format", "npy", "--gain", 1, "--quiet")
        self.assertTrue(same(np.load("out/lightfield.npy"), plain))
        self.assertTrue(same(e2lf.read_light_field("out", range="keep"), plain[::-1, ::-1]))
        with self.assertRaises(e2lf.Error):
            e2lf.write_event_images("wrong.npz", images, codes, views="sideways")

    def test_depth(self):
        command_line("depth", "scene.npy", "-o", "depth", "--quiet")
        told = []
        found = e2lf.depth(self.scene, progress=lambda done, total: told.append(done == total))
        self.assertTrue(same(found.disparity, np.load("depth/disparity.npy")))
        self.assertTrue(same(found.confidence, np.load("depth/confidence.npy")))
        self.assertEqual(found.view, (4, 4))
        self.assertTrue(told[-1])
        self.assertTrue(np.all((found.confidence >= 0) & (found.confidence <= 1)))
        command_line("depth", "scene.npy", "-o", "corner.npy", "--view-row", 0, "--view-column", 7, "--min-disparity=-3",
                     "--max-disparity=2", "--quiet")
        corner = e2lf.depth(self.scene, view=(0, 7), range_px=(-3, 2))
        self.assertTrue(same(corner.disparity, np.load("corner.npy")))
        self.assertEqual((corner.view, corner.range_px), ((0, 7), (-3, 2)))
        same_map = e2lf.compare_disparity(found.disparity, found.disparity, confidence=found.confidence, border=8)
        self.assertEqual((same_map["bad_07_percent"], same_map["most_certain"][9]["mean_absolute_px"]), (0, 0))
        self.assertAlmostEqual(e2lf.compare_disparity(found.disparity, 0.5 * found.disparity, border=8)["slope"], 0.5, 4)
        colour = np.repeat(self.scene[..., None], 3, axis=-1)
        self.assertLess(np.abs(e2lf.depth(colour).disparity - found.disparity).mean(), 0.01)
        for wrong in ({"view": (8, 0)}, {"range_px": (1, 0)}):
            with self.assertRaises(e2lf.Error):
                e2lf.depth(self.scene, **wrong)

    def test_compare_is_eval(self):
        noisy = np.clip(self.scene + 0.05 * np.random.default_rng(1).standard_normal(self.scene.shape), 0, 1)
        noisy = noisy.astype(np.float32)
        np.save("noisy.npy", noisy)
        expected = command_line_json("eval", "scene.npy", "noisy.npy")
        self.assertEqual(expected.pop("channels"), 1)  # arrays are grey
        found = e2lf.compare(self.scene, noisy)
        self.assertEqual(found, {key: expected[key] for key in found})
        view = expected["views"][9]
        pair = self.scene[1, 1], noisy[1, 1]
        self.assertAlmostEqual(e2lf.psnr(*pair), view["psnr_db"], places=6)
        self.assertAlmostEqual(e2lf.ssim(*pair), view["ssim_uniform7"], places=6)
        self.assertAlmostEqual(e2lf.ssim(*pair, window="gaussian"), view["ssim_gaussian"], places=6)
        for name, value in (("psnr_db", e2lf.psnr(self.scene, noisy)), ("ssim_uniform7", e2lf.ssim(self.scene, noisy))):
            self.assertAlmostEqual(value, expected[name], places=6)
        colour, colour_noisy = (np.stack([field, 0.5 * field, field], axis=-1) for field in (self.scene, noisy))
        self.assertAlmostEqual(e2lf.ssim(colour, colour_noisy), e2lf.compare(colour, colour_noisy)["ssim_uniform7"], places=6)
        self.assertEqual(e2lf.psnr(self.scene, self.scene), float("inf"))
        self.assertAlmostEqual(e2lf.psnr(self.scene, self.scene + np.float32(0.1)), 20, places=4)

    def test_brightness_is_fitted(self):
        dim = 0.5 * self.scene + np.float32(0.1)
        found = e2lf.compare(self.scene, dim, fit="gain-and-black")
        self.assertAlmostEqual(found["fitted_gain"], 2, places=4)
        self.assertAlmostEqual(found["fitted_black"], 0.1, places=4)
        self.assertGreater(found["psnr_db"], 90)
        half = e2lf.compare(self.scene, 0.5 * self.scene, fit="gain")
        self.assertAlmostEqual(half["fitted_gain"], 2, places=4)
        self.assertEqual(half["fitted_black"], 0)
        with self.assertRaises(e2lf.Error):
            e2lf.compare(self.scene, dim, fit="offset")

    def test_event_images_of_arrays(self):
        images, codes = event_images(2)
        e2lf.synthesise_recording("rec.raw", images, codes)
        events, _ = e2lf.read_events("rec.raw")
        for cycle in e2lf.accumulate("rec.raw"):
            times = [begin for begin, _ in cycle.slices] + [cycle.slices[-1][1]]
            self.assertTrue(same(e2lf.event_images(events, times, 48, 32), cycle.images))
        for wrong in (lambda: e2lf.event_images(events, times, 47, 32), lambda: e2lf.event_images(events[::-1], times, 48, 32)):
            with self.assertRaises(e2lf.Error):
                wrong()
        with self.assertRaises(ValueError):
            e2lf.event_images(events, times[::-1], 48, 32)

    def test_voxel_grids_and_frames(self):
        events = np.zeros(3, e2lf.event_dtype)
        events["x"], events["y"], events["p"], events["t"] = [1, 2, 3], [0, 1, 2], [1, 0, 1], [100, 125, 200]
        grid = e2lf.voxel_grid(events, 3, 5, 4)
        expected = np.zeros((3, 4, 5), np.float32)
        expected[0, 0, 1], expected[2, 2, 3] = 1, 1
        expected[0, 1, 2], expected[1, 1, 2] = -0.5, -0.5
        self.assertTrue(np.allclose(grid, expected))
        layers = [{"name": "all", "op": "conv", "inputs": ["input"], "out_channels": 1, "kernel": 1},
                  {"name": "cell", "op": "conv-gru", "inputs": ["all"], "out_channels": 1, "kernel": 1}]
        weights = {"all.weight": np.ones((1, 3, 1, 1)), "all.bias": np.zeros(1)}
        for part, outputs in (("gates", 2), ("candidate", 1)):
            weights |= {f"cell.{part}.weight": np.ones((outputs, 2, 1, 1)), f"cell.{part}.bias": np.zeros(outputs)}
        header = {"format_version": 1, "measurement": "voxel-grid", "name": "sum", "bins": 3, "normalises_voxels": False,
                  "pad_multiple": 1, "tone": "none", "provenance": {},
                  "network": {"type": "conv-graph", "input_channels": 3, "layers": layers}}
        video = e2lf.VideoModel.of(header, {name: values.astype(np.float32) for name, values in weights.items()})
        self.assertEqual(pickle.loads(pickle.dumps(video)).header, video.header)
        frames = e2lf.FrameReconstructor(video, 5, 4, precision="float32")
        first, second = frames.next(grid, toned=False), frames.next(grid, toned=False)
        h = np.tanh(1) / (1 + np.exp(-1))
        self.assertAlmostEqual(first[0, 1], h, places=5)
        self.assertNotAlmostEqual(second[0, 1], h, places=3)
        frames.reset()
        self.assertTrue(same(frames.next(grid, toned=False), first))
        with self.assertRaises(e2lf.Error):
            frames.next(grid[:2])

    def test_calibrate(self):
        camera, codes = e2lf.Camera("evk4-lcos"), self.model.codes
        levels = np.linspace(0.05, 0.9, 4, dtype=np.float32).repeat(16)
        scene = np.broadcast_to(levels, (8, 8, 64, 64)).copy()
        cycles = [e2lf.simulate(scene, codes, camera=camera, seed=seed, map_seed=1) for seed in range(3)]
        constants = camera.to_dict()["constants"]
        held = [name for name in constants if not name.startswith(("threshold", "eps")) and not name.endswith("time_s")]
        found = e2lf.calibrate([cycles], codes, camera, held=held, even=True)
        for name in ("threshold_on", "threshold_off"):
            true = constants[name]["value"]
            self.assertAlmostEqual(found.camera.to_dict()["constants"][name]["value"], true, delta=0.1 * true)
        self.assertTrue(found.report["constants"])
        with self.assertRaises(e2lf.Error):
            e2lf.calibrate([cycles], codes, camera, held=["nothing"])

    def test_cameras_from_their_parts(self):
        camera = e2lf.Camera("evk4-lcos")
        self.assertEqual(e2lf.Camera.from_dict(camera.to_dict()), camera)
        self.assertEqual(e2lf.Camera.from_constants(e2lf.SensorConstants(tau=0.2)).constants.tau, np.float32(0.2))
        self.assertEqual(len(camera.conditioning(4)), 18)
        self.assertIsInstance(e2lf.find_cameras(), list)
        with self.assertRaises(e2lf.Error):
            e2lf.Camera.from_dict({"name": "nothing"})

    def test_pictures(self):
        self.assertTrue(same(e2lf.horizontal_epi(self.scene, 3, 7), self.scene[3, :, 7, :]))
        self.assertTrue(same(e2lf.vertical_epi(self.scene, 2, 5), self.scene[:, 2, :, 5].T.copy()))
        self.assertTrue(np.allclose(e2lf.refocus(self.scene, 0), self.scene.mean(axis=(0, 1)), atol=1e-5))
        one = np.zeros((8, 8), np.float32)
        one[2, 6] = 1
        at_zero = e2lf.refocus(self.scene, 0, weights=one)
        self.assertTrue(np.allclose(at_zero, self.scene[2, 6], atol=1e-6))
        for wrong in (lambda: e2lf.horizontal_epi(self.scene, 8, 0), lambda: e2lf.vertical_epi(self.scene, 0, 48)):
            with self.assertRaises(IndexError):
                wrong()
        with self.assertRaises(ValueError):
            e2lf.refocus(self.scene, 0, radius=1, centre_x=50)

    def test_files_of_light_fields_and_pictures(self):
        for path in ("views", "field.npy", "field.h5"):
            e2lf.write_light_field(path, self.scene)
            self.assertTrue(np.allclose(e2lf.read_light_field(path), self.scene, atol=0.5 / 255 + 1e-6), path)
        colour = np.repeat(self.scene[..., None], 3, axis=-1)
        e2lf.write_light_field("colour.npy", colour)
        self.assertTrue(same(e2lf.read_light_field("colour.npy", colour=True), colour))
        self.assertEqual(e2lf.read_light_field("views", views=3).shape, (3, 3, 32, 48))
        picture = self.scene[0, 0]
        e2lf.write_png("p.png", picture, bits=16)
        self.assertTrue(np.allclose(e2lf.read_image("p.png"), picture, atol=1 / 65535))
        self.assertEqual(e2lf.info("views"), command_line_json("info", "views"))
        self.assertEqual(e2lf.info(self.path), command_line_json("info", self.path))

    def test_schedules_and_codes(self):
        schedule = e2lf.paper_schedule()
        self.assertEqual((len(schedule), schedule.num_images, schedule.cycle_us), (8, 3, 94736))
        Path("schedule.json").write_text(schedule.to_json())
        self.assertEqual(e2lf.read_schedule("schedule.json"), schedule)
        self.assertEqual(e2lf.Schedule(schedule.patterns), schedule)
        with self.assertRaises(e2lf.Error):
            e2lf.Schedule([])
        for path in ("codes.json", "codes.npy", "codes.npz"):
            e2lf.write_codes(path, self.model.codes)
            self.assertTrue(same(e2lf.read_codes(path), self.model.codes))
        self.assertTrue(np.all(e2lf.coded_intensities(self.scene, e2lf.default_codes())[0] == 0))

    def test_model_says_what_the_command_line_says(self):
        self.assertEqual({**self.model.summary(), "kind": "model"}, command_line_json("model", "info", self.path))
        self.assertEqual((self.model.name, self.model.num_patterns, self.model.views), ("e2lf-n4", 4, (8, 8)))


if __name__ == "__main__":
    unittest.main()
