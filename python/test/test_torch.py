"""e2lf.torch computes what the library computes, and its models run in the command line."""
import os
import subprocess
import sys
import unittest
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest import mock

import numpy as np

import e2lf
from common import InFolder, command_line, command_line_json, model

try:
    import torch
    from torch.autograd import gradcheck
    from torch.utils._python_dispatch import TorchDispatchMode
    from e2lf.torch import (BasicLFSRPatches, CodedAperture, ConvGraph, EventSimulator, LightFieldPatches, from_macpi, from_sai,
                            load_module, new_module, psnr, save_module, ssim, synthesise, to_macpi, to_sai)
    from e2lf.torch.geometry import _compose, shift
except ImportError as error:
    print(f"skipped: {error}; python3-torch is not installed for {sys.executable}")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[2]
RELEASE = Path(os.environ.get("E2LF_DATA", "")) / "official"
EXACT = 1e-5  # largest difference between the module and the engine


class WrittenElements(TorchDispatchMode):
    """Counts the elements that operations write, views excluded: a measure of work that depends on no machine."""

    def __init__(self):
        super().__init__()
        self.count = 0

    def __torch_dispatch__(self, function, types, args=(), kwargs=None):
        outputs = function(*args, **(kwargs or {}))
        if not any(each.alias_info and not each.alias_info.is_write for each in function._schema.returns):
            tensors = outputs if isinstance(outputs, (tuple, list)) else [outputs]
            self.count += sum(each.numel() for each in tensors if isinstance(each, torch.Tensor))
        return outputs


def counts_of(model, seed=2):
    """Event images of a scene whose size is no multiple of anything."""
    scene = e2lf.demo_scene(45, 38)
    codes = model.codes if model.codes is not None else e2lf.default_codes()
    if model.camera and model.camera.event_model == "pixel":
        return e2lf.simulate(scene, codes, camera=model.camera, seed=seed)
    return e2lf.simulate(scene, codes, constants=model.constants, seed=seed)


def batch(array):
    return torch.from_numpy(np.array(array, np.float32))[None]


def difference(model, module=None):
    """The largest difference between the module and the engine."""
    counts = counts_of(model)
    module = module or load_module(model)
    engine = e2lf.Reconstructor(model, precision="float32")
    expected = engine.depth(counts).disparity if module.gives_disparity else engine.reconstruct(counts, gain=1)
    with torch.no_grad():
        found = module(batch(counts))[0].numpy()
    if module.gives_disparity:
        found = found[0]
    assert found.shape == expected.shape, (found.shape, expected.shape)
    return float(np.abs(found - expected).max())


class NetworkTest(InFolder):
    def test_bundled_models_give_the_light_field_of_the_engine(self):
        for path in sorted(Path(e2lf.bundled_model()).parent.glob("*.safetensors")):
            needs_patterns = path.stem in ("e2lf-any", "e2lf-depth", "e2lf-n4-capture-geometry")
            largest = difference(e2lf.Model(path, codes=e2lf.read_codes("e2lf-n4") if needs_patterns else None))
            print(f"{path.stem}: {largest:.1e}")
            self.assertLess(largest, EXACT, path.stem)

    @unittest.skipUnless((RELEASE / "RecNet.safetensors").exists(), "the release of the paper is not here")
    def test_the_release_gives_the_light_field_of_the_engine(self):
        command_line("model", "import", "--release", RELEASE, "-o", "release.safetensors", "--quiet")
        largest = difference(e2lf.Model("release.safetensors"))
        print(f"release: {largest:.1e}")
        self.assertLess(largest, EXACT)

    def test_every_operation_gives_the_light_field_of_the_engine(self):
        conv = {"op": "conv", "kernel": 3}
        layers = [
            {**conv, "name": "a", "inputs": ["input"], "out_channels": 8, "relu": True},
            {**conv, "name": "b", "inputs": ["a"], "out_channels": 8, "stride": 2},
            {"op": "layer-norm", "name": "c", "inputs": ["b"]},
            {"op": "position-code", "name": "d", "inputs": ["c"]},
            {"op": "attention", "name": "e", "inputs": ["d", "c", "b"], "heads": 2},
            {"op": "upsample", "name": "f", "inputs": ["e"], "stride": 2},
            {"op": "upsample-bilinear", "name": "g", "inputs": ["b"], "stride": 2},
            {"op": "conv-transposed", "name": "h", "inputs": ["c"], "out_channels": 8, "kernel": 2, "stride": 2},
            {"op": "mean", "name": "i", "inputs": ["f", "g", "h"]},
            {"op": "add", "name": "j", "inputs": ["i", "a"], "relu": True},
            {"op": "tanh", "name": "k", "inputs": ["j"]},
            {**conv, "name": "l0", "inputs": ["k"], "out_channels": 9},
            {**conv, "name": "l", "inputs": ["l0"], "out_channels": 9, "residual": "l0"},
            {"op": "dynamic-filter", "name": "m", "inputs": ["k", "l"], "kernel": 3},
            {"op": "concat", "name": "n", "inputs": ["m", "l"]},
            {"op": "sigmoid", "name": "o", "inputs": ["n"]},
            {"op": "pixel-unshuffle", "name": "p", "inputs": ["o"], "stride": 2},
            {"op": "pixel-shuffle", "name": "q", "inputs": ["p"], "stride": 2},
            {"op": "conv", "name": "r", "inputs": ["q"], "out_channels": 4, "kernel": 1},
            {"op": "plane-sweep", "name": "s", "inputs": ["r"], "kernel": 3, "offsets": [-1.5, 0.75, 0.5, -2],
             "disparities": [-1.2, 0, 0.7]},
            {"op": "conv", "name": "s1", "inputs": ["r"], "out_channels": 1, "kernel": 1},
            {"op": "warp", "name": "s2", "inputs": ["r", "s1"], "offsets": [-1.5, 0.75, 0.5, -2], "disparities": [-1.2, 0.7]},
            {"op": "concat", "name": "s3", "inputs": ["s", "s2"]},
            {"op": "conv", "name": "t", "inputs": ["s3"], "out_channels": 6, "kernel": 1},
            {"op": "render-layers", "name": "u", "inputs": ["t"], "disparities": [-1.2, 0.1, 0.7],
             "rows": [view - 3.5 for view in range(8)], "columns": [view - 3.5 for view in range(8)]}]
        torch.manual_seed(1)
        module = new_module(layers=layers)
        save_module("all.safetensors", module, codes=model().codes)
        saved = e2lf.Model("all.safetensors")
        self.assertEqual([layer["op"] for layer in saved.header["network"]["layers"]], [layer["op"] for layer in layers])
        self.assertLess(difference(saved, module), EXACT)

    def test_a_depth_network_gives_the_disparity_of_the_engine(self):
        module = new_module(layers=[{"op": "conv", "name": "a", "inputs": ["input"], "out_channels": 2, "kernel": 3}])
        save_module("depth.safetensors", module, codes=model().codes)
        saved = e2lf.Model("depth.safetensors")
        self.assertLess(difference(saved, module), EXACT)
        with self.assertRaises(ValueError):
            e2lf.Reconstructor(saved).reconstruct(counts_of(saved))

    def test_networks_for_frames_give_the_frames_of_the_engine(self):
        torch.manual_seed(6)
        cell = {"kernel": 3, "out_channels": 6}
        layers = [
            {"op": "previous", "name": "last", "inputs": [], "out_channels": 1},
            {"op": "concat", "name": "all", "inputs": ["input", "last"]},
            {**cell, "op": "conv-gru", "name": "gru", "inputs": ["all"]},
            {**cell, "op": "conv-lstm", "name": "lstm", "inputs": ["gru"]},
            {"op": "conv", "name": "frame", "inputs": ["lstm"], "out_channels": 1, "kernel": 1}]
        header = {"format_version": 1, "measurement": "voxel-grid", "name": "cells", "bins": 5, "normalises_voxels": False,
                  "pad_multiple": 1, "tone": "none", "provenance": {},
                  "network": {"type": "conv-graph", "input_channels": 5, "layers": layers}}
        weights = {name: value.numpy() for name, value in ConvGraph(header["network"]).state_dict().items()}
        video = e2lf.VideoModel.of(header, weights)
        module, engine, state = load_module(video), e2lf.FrameReconstructor(video, 21, 17, precision="float32"), {}
        for _ in range(3):
            grid = torch.randn(1, 5, 17, 21)
            with torch.no_grad():
                found = module(grid, state)[0, 0].numpy()
            self.assertLess(np.abs(found - engine.next(grid[0].numpy(), toned=False)).max(), EXACT)

    def test_a_saved_module_is_reconstructed_by_the_command_line(self):
        torch.manual_seed(2)
        module, codes = new_module(width=8, blocks=1), CodedAperture(4).codes()
        with torch.no_grad():
            for parameter in module.parameters():
                parameter.add_(0.02 * torch.randn_like(parameter))
        constants = e2lf.SensorConstants(tau=0.25)
        save_module("mine.safetensors", module, codes=codes, constants=constants, name="mine", provenance={"samples": 3})
        saved = e2lf.Model("mine.safetensors")
        self.assertEqual((saved.name, saved.constants, saved.header["provenance"]), ("mine", constants, {"samples": 3}))
        self.assertTrue(np.array_equal(saved.codes, codes.detach().numpy()))
        counts = counts_of(saved)
        e2lf.write_event_images("events.npz", [counts], saved.codes)
        command_line("reconstruct", "events.npz", "-m", "mine.safetensors", "-o", "out", "--format", "npy", "--gain", 1,
                     "--precision", "float32", "--quiet")
        again = load_module("mine.safetensors")(batch(counts))[0].detach().numpy()
        self.assertLess(np.abs(again - np.load("out/lightfield.npy")).max(), EXACT)
        with self.assertRaises(e2lf.Error):
            save_module("mine.safetensors", module)
        with torch.no_grad():
            module.network.layer("stem").weight[0, 0, 0, 0] = float("nan")
        with self.assertRaises(e2lf.Error):
            save_module("nan.safetensors", module)
        self.assertFalse(Path("nan.safetensors").exists())


    def test_layers_are_modules_of_torch_with_the_names_of_the_file(self):
        network, model_ = load_module("e2lf-n4"), model()
        self.assertEqual(set(network.network.state_dict()), set(model_.weights))
        layers = {layer["name"]: layer for layer in model_.header["network"]["layers"]}
        kinds = {"conv": torch.nn.Conv2d, "conv-transposed": torch.nn.ConvTranspose2d, "pixel-shuffle": torch.nn.PixelShuffle}
        for name, layer in layers.items():
            self.assertIsInstance(network.network.layer(name), kinds.get(layer["op"], torch.nn.Module), name)
        self.assertRegex(repr(network), r"\(stem\): Conv2d\(\d+, 80, kernel_size=\(3, 3\)")
        seen = []
        network.network.layer("stem").register_forward_hook(lambda module, inputs, output: seen.append(output.shape[1]))
        network(torch.zeros(1, 3, 16, 16))
        self.assertEqual(seen, [80])

    def test_modules_are_traced_and_exported(self):
        warnings.simplefilter("ignore")  # sizes become constants, which is what a trace is
        network = load_module("e2lf-n4").eval()
        events = torch.randint(-4, 5, (1, 3, 16, 24)).float()
        with torch.no_grad():
            self.assertLess(float((torch.jit.trace(network, events)(events) - network(events)).abs().max()), EXACT)
            torch.onnx.export(network, events, "n4.onnx", opset_version=13)
        self.assertGreater(Path("n4.onnx").stat().st_size, 4e6)
        layers = [{"op": "plane-sweep", "name": "a", "inputs": ["input"], "offsets": [-1.5, 0.75, 0.5, -2, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 0, 1],
                   "disparities": [-1.2, 0, 0.7, 1]},
                  {"op": "render-layers", "name": "b", "inputs": ["a"], "disparities": [-1.2, 0.7], "rows": [-1.5, 0.5],
                   "columns": [-1.0, 0, 2]}]
        network = new_module(layers=layers, views=(2, 3))
        with torch.no_grad():
            self.assertLess(float((torch.jit.trace(network, events)(events) - network(events)).abs().max()), EXACT)

    def test_a_reconstructor_computes_on_a_device_of_torch(self):
        images = counts_of(e2lf.Model("e2lf-n4"))
        for name, precision in (("e2lf-n4", "float32"), ("e2lf-n4-geometry", "auto")):
            engine = e2lf.Reconstructor(name, precision="float32")
            on_torch = e2lf.Reconstructor(name, precision=precision, device="torch-cpu")
            self.assertEqual(on_torch.precision, "float32")
            self.assertRegex(on_torch.kernels[0], "^torch .* on cpu")
            fields = [network.reconstruct(images, gain=1) for network in (engine, on_torch)]
            self.assertLess(np.abs(fields[0] - fields[1]).max(), EXACT, name)
            self.assertFalse(np.array_equal(*fields), "the engine computed both")
        told = []
        on_torch.reconstruct(images, progress=lambda done, total: told.append(done / total))
        self.assertEqual(told, [0, 1])
        maps = [e2lf.Reconstructor("e2lf-n4-depth", precision="float32", device=device).depth(images) for device in ("cpu", "torch-cpu")]
        self.assertLess(np.abs(maps[0].disparity - maps[1].disparity).max(), EXACT)
        for precision in ("int16", "float16", "bfloat16"):
            with self.assertRaises(e2lf.Error) as raised:
                e2lf.Reconstructor("e2lf-n4", precision=precision, device="torch-cpu")
            self.assertIn(f"does not compute in {precision}", raised.exception.message)
        # Threads of Python: each waits for the GIL, which the engine does not hold.
        with ThreadPoolExecutor(2) as threads:
            networks = [e2lf.Reconstructor("e2lf-n4", precision="float32", device="torch-cpu") for _ in range(2)]
            for field in threads.map(lambda network: network.reconstruct(images, gain=1), networks):
                self.assertTrue(np.array_equal(field, networks[0].reconstruct(images, gain=1)))

    def test_a_shift_has_its_gradient_and_its_values(self):
        torch.manual_seed(7)
        x = torch.randn(3, 4, 2, 5, dtype=torch.float64, requires_grad=True)
        for is_cubic in (False, True):
            for axis, offsets in ((1, [-20.5, 0.25, 2]), (3, [1.5, -2.75, 40])):
                self.assertTrue(gradcheck(lambda x: shift(x, axis, offsets, is_cubic), (x,)))
        ramp = torch.arange(8.0).expand(1, 8)
        self.assertTrue(torch.equal(shift(ramp, 1, [2.0], True)[0], torch.tensor([2.0, 3, 4, 5, 6, 7, 7, 7])))
        self.assertTrue(torch.equal(shift(ramp, 1, [-1.5], False)[0], torch.tensor([0.0, 0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5])))

    def test_what_is_seen_of_planes_has_its_gradient(self):
        torch.manual_seed(9)
        opacities, last = torch.rand(3, 2, 5, dtype=torch.float64), torch.ones(1, 2, 5, dtype=torch.float64)
        opacities[1, 0], opacities[0, 1] = 1, 0
        intensities = torch.rand(4, 2, 5, dtype=torch.float64, requires_grad=True)
        seen = _compose(torch.cat([opacities, last]), intensities)
        behind = torch.lerp(intensities[3], intensities[2], opacities[2])
        self.assertTrue(torch.allclose(seen[1], torch.lerp(behind, intensities[1], opacities[1])[1]))  # the first is clear there
        self.assertTrue(gradcheck(lambda a, x: _compose(torch.cat([a, last]), x), (opacities.requires_grad_(), intensities)))

    def test_the_gradient_of_a_geometry_network_writes_at_most_1_75_times_what_the_network_writes(self):
        models = [e2lf.Model(path) for path in sorted(Path(e2lf.bundled_model()).parent.glob("*geometry*.safetensors"))]
        networks = [load_module(each) for each in models if each.codes is not None]  # others need patterns for their geometry
        self.assertGreaterEqual(len(networks), 5)
        for network in networks:
            name = network.header["name"]
            with WrittenElements() as forward:
                loss = network(torch.randint(-4, 5, (1, network.num_patterns - 1, 64, 64)).float()).square().mean()
            with WrittenElements() as backward:
                loss.backward()
            # The gradient of a slice is a whole tensor: with slices in place of _Shift, it writes 3.2 times as much.
            self.assertLess(backward.count, 1.75 * forward.count, name)
            self.assertLess(forward.count / (64 * 64 * 64), 1000, f"{name}, per ray")
            for parameter, value in network.named_parameters():
                self.assertTrue(value.grad is not None and value.grad.isfinite().all(), f"{name}: {parameter}")

    def test_wrong_arguments_are_told_in_one_sentence(self):
        network, aperture, codes = load_module("e2lf-n4"), CodedAperture(4), model().codes
        with self.assertRaisesRegex(e2lf.Error, "adapted to the patterns"):
            load_module("e2lf-any")
        cases = [
            (lambda: network.set_camera(e2lf.Camera("evk4-lcos")), "trained for a single camera"),
            (lambda: network(torch.zeros(3, 64, 64)), "event images must be [batch, transition, y, x]"),
            (lambda: network(torch.zeros(1, 4, 64, 64)), "sizes 3"),
            (lambda: aperture(torch.zeros(8, 8, 32, 32)), "add the batch axis"),
            (lambda: aperture(torch.zeros(1, 7, 7, 32, 32)), "sizes 8, 8"),
            (lambda: EventSimulator()(torch.zeros(4, 32, 32)), "coded intensities must be"),
            (lambda: psnr(torch.zeros(8, 8, 9, 9), torch.zeros(8, 8, 9, 9)), "[batch, view_y"),
            (lambda: save_module("a.safetensors", torch.nn.Linear(2, 2), codes=codes), "not a Linear"),
            (lambda: from_sai(torch.zeros(1, 1, 30, 64)), "30x64"),
            (lambda: BasicLFSRPatches("nowhere"), "no patches")]
        for call, expected in cases:
            with self.assertRaises((ValueError, TypeError)) as raised:
                call()
            self.assertIn(expected, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


class LightFieldTest(InFolder):
    def test_layouts_put_each_pixel_where_it_belongs(self):
        fields = torch.rand(2, 8, 8, 5, 6)
        sai, macpi = to_sai(fields), to_macpi(fields)
        self.assertEqual((sai.shape, macpi.shape), ((2, 1, 40, 48), (2, 1, 40, 48)))
        self.assertEqual(sai[1, 0, 3 * 5 + 2, 7 * 6 + 4], fields[1, 3, 7, 2, 4])
        self.assertEqual(macpi[1, 0, 2 * 8 + 3, 4 * 8 + 7], fields[1, 3, 7, 2, 4])
        colour = torch.rand(2, 5, 5, 4, 6, 3)
        self.assertEqual(to_sai(colour)[0, 2, 4 * 4 + 1, 3 * 6 + 5], colour[0, 4, 3, 1, 5, 2])
        for field, views in ((fields, (8, 8)), (colour, (5, 5))):
            self.assertTrue(torch.equal(from_sai(to_sai(field), views), field))
            self.assertTrue(torch.equal(from_macpi(to_macpi(field), views), field))

    def test_measures_are_those_of_the_library(self):
        torch.manual_seed(8)
        for shape in ((2, 3, 2, 20, 24), (2, 2, 2, 16, 18, 3)):
            a = torch.rand(shape, dtype=torch.float64).float()
            b = (a + 0.1 * torch.randn(shape)).clamp(0, 1)
            for n in range(2):
                self.assertAlmostEqual(float(psnr(a, b)[n]), e2lf.psnr(a[n].numpy(), b[n].numpy()), delta=1e-4)
                for window in ("uniform7", "gaussian"):
                    self.assertAlmostEqual(float(ssim(a, b, window)[n]), e2lf.ssim(a[n].numpy(), b[n].numpy(), window=window),
                                           delta=1e-5)
        self.assertEqual(float(psnr(a, a)[0]), float("inf"))


class EventTest(InFolder):
    def setUp(self):
        super().setUp()
        self.scene = e2lf.demo_scene(64, 48)
        self.light = torch.from_numpy(self.scene)[None]
        self.codes = model().codes
        self.intensities = CodedAperture(codes=self.codes, trained=False)(self.light)
        self.full = self.light.mean((1, 2))

    def test_coded_intensities_are_those_of_the_sensor(self):
        self.assertLess(np.abs(self.intensities[0].numpy() - e2lf.coded_intensities(self.scene, self.codes)).max(), 1e-6)

    def test_the_paper_s_models_without_noise_give_the_counts_of_the_sensor(self):
        still = e2lf.SensorConstants(sigma_w=0, sigma_z=0)
        for event_model in ("reference-aware", "quantised"):
            expected = e2lf.simulate(self.scene, self.codes, constants=still, event_model=event_model)
            for simulator in (EventSimulator(still, event_model=event_model),
                              EventSimulator(e2lf.SensorConstants(), event_model=event_model, noise=False)):
                self.assertTrue(np.array_equal(simulator(self.intensities)[0].numpy(), expected), event_model)

    def still_pixels(self):
        text = e2lf.Camera("evk4-lcos").to_dict()
        for name in ("noise", "shot_noise", "dark_off", "dark_on", "mismatch", "mismatch_each", "reset_span"):
            text["constants"][name]["value"] = 0
        return e2lf.Camera.from_dict(text)

    def test_physical_pixels_without_noise_give_the_counts_of_the_sensor(self):
        camera, codes = self.still_pixels(), self.codes
        expected = e2lf.simulate(self.scene, codes, camera=camera)
        self.assertTrue(np.array_equal(EventSimulator(camera=camera)(self.intensities, self.full)[0].numpy(), expected))
        whole = np.concatenate([codes, 1 - codes, codes[:1]])
        expected = e2lf.simulate(self.scene, whole, camera=camera)
        simulator = EventSimulator(camera=camera, whole_cycle=True)
        found = simulator(CodedAperture(codes=whole, trained=False)(self.light), self.full)
        self.assertTrue(np.array_equal(found[0].numpy(), expected))

    def test_noise_has_the_distribution_of_the_sensor(self):
        torch.manual_seed(3)
        camera = e2lf.Camera("evk4-lcos")
        cases = [
            (EventSimulator(), {}),
            (EventSimulator(event_model="quantised", residue=1.0), {"event_model": "quantised", "residue": 1.0}),
            (EventSimulator(camera=camera), {"camera": camera})]
        bins = np.arange(-20.5, 21)
        for simulator, options in cases:
            expected = [e2lf.simulate(self.scene, self.codes, seed=seed, **options) for seed in range(40)]
            found = simulator(self.intensities.expand(40, -1, -1, -1), self.full.expand(40, -1, -1)).numpy()
            for k in range(3):
                a, b = (np.histogram(np.stack(counts)[:, k], bins, density=True)[0] for counts in (expected, list(found)))
                self.assertLess(np.abs(a - b).sum() / 2, 0.01, (options, k))

    def test_patterns_have_the_gradient_of_the_loss(self):
        torch.manual_seed(4)
        aperture = CodedAperture(4)
        for simulator in (EventSimulator(), EventSimulator(camera=e2lf.Camera("evk4-lcos"))):
            aperture.zero_grad()
            simulator(aperture(self.light), self.full).square().mean().backward()
            gradient = aperture.weight.grad
            self.assertTrue(bool(torch.isfinite(gradient).all()) and float(gradient.abs().max()) > 0)

    def test_patterns_keep_their_ties(self):
        torch.manual_seed(5)
        codes = CodedAperture(4).codes()
        self.assertEqual((codes[0].sum(), set(codes.flatten().tolist())), (0, {0.0, 1.0}))
        pairs = CodedAperture(6, tie="complementary").codes()
        self.assertTrue(bool((pairs[0::2] + pairs[1::2] == 1).all()))
        whole = CodedAperture(9, tie="whole-cycle").codes()
        self.assertTrue(bool((whole[:4] + whole[4:8] == 1).all()) and not whole[8].any())
        self.assertTrue(np.array_equal(CodedAperture(codes=self.codes).codes().detach().numpy(), self.codes))
        soft = CodedAperture(4, binary=False).codes()
        self.assertTrue(bool((soft[1:] > 0).all() and (soft[1:] < 1).all()))
        for wrong in ({"tie": "triple"}, {"trained": False}, {"num_patterns": 1}):
            with self.assertRaises(ValueError):
                CodedAperture(**wrong)


class DataTest(InFolder):
    def test_patches_are_parts_of_the_light_fields(self):
        scene = e2lf.demo_scene(48, 40)
        e2lf.write_light_field("scene", scene)
        patches = LightFieldPatches(["scene", scene], size=32, length=6, synthesised=0)
        self.assertEqual([patch.shape for patch in patches], [(8, 8, 32, 32)] * 6)
        self.assertTrue(torch.equal(patches[3], LightFieldPatches(["scene", scene], size=32, synthesised=0)[3]))
        for patch in patches:
            # Flips of views and pixels together keep the sign of the disparity.
            self.assertLess(abs(np.median(e2lf.depth(patch.numpy()).disparity)), 3)
            self.assertLess(abs(float(patch.mean()) - scene.mean()), 0.2)
        for wrong in ([np.zeros((8, 8, 16, 16), np.float32)], [np.zeros((8, 8, 64), np.float32)]):
            with self.assertRaises(ValueError):
                LightFieldPatches(wrong, size=32)

    def test_patches_are_in_colour_if_the_light_fields_are(self):
        scene = e2lf.demo_scene(48, 40)[..., None] * np.array([1, 0.5, 0.25], np.float32)
        for patch in LightFieldPatches([scene], size=32, length=6, synthesised=0.5):
            self.assertEqual(patch.shape, (8, 8, 32, 32, 3))
        patch = LightFieldPatches([scene], size=32, synthesised=0)[1]
        self.assertLess(float((patch[..., 1] - 0.5 * patch[..., 0]).abs().max()), 1e-3)
        with self.assertRaises(ValueError):
            LightFieldPatches([scene, scene[..., 0]], size=32)

    def test_patches_of_basic_lfsr_are_read_by_split_and_data_set(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("python3-h5py is not installed")
        scene = torch.from_numpy(e2lf.demo_scene(72, 32))[:5, :5]
        fields = torch.stack([scene[..., :32, 20 * n : 20 * n + 28] for n in range(3)])
        # As its script writes them: the image of the views, transposed.
        for number, place in enumerate(("data_for_training/SR_5x5_2x/EPFL", "data_for_training/SR_5x5_2x/HCI_new",
                                        "data_for_test/SR_5x5_2x/EPFL")):
            Path(place).mkdir(parents=True)
            with h5py.File(f"{place}/000001.h5", "w") as file:
                file.create_dataset("Hr_SAI_y", data=to_sai(fields[number : number + 1])[0, 0].numpy().T, dtype="single")
                file.create_dataset("Lr_SAI_y", data=np.zeros((15, 15), np.float32))
        training = BasicLFSRPatches(".")
        self.assertEqual(len(training), 2)
        self.assertTrue(torch.allclose(training[1], fields[1], atol=1e-6))
        self.assertTrue(torch.allclose(BasicLFSRPatches(".", "test")[0], fields[2], atol=1e-6))
        only = BasicLFSRPatches(".", datasets=["EPFL"], augmented=True)
        self.assertEqual((len(only), only[0].sum()), (1, only[0].sum()))
        self.assertAlmostEqual(float(only[0].sum()), float(fields[0].sum()), delta=1e-2)

    def test_synthesised_surfaces_have_their_disparity(self):
        draws = torch.Generator()
        for seed in range(3):
            field = synthesise(48, draws.manual_seed(seed), max_disparity=2.0, max_layers=1)
            self.assertTrue(bool((field >= 0).all() and (field <= 1).all()) and float(field.std()) > 0.01)
            draws.manual_seed(seed)
            torch.randint(1, (), generator=draws)
            drawn = float((2 * torch.rand(1, generator=draws) - 1) * 2.0)
            found = np.median(e2lf.depth(field.numpy()).disparity[12:-12, 12:-12])
            self.assertAlmostEqual(found, drawn, delta=0.1)


class ExampleTest(InFolder):
    def run_example(self, name, *arguments):
        done = subprocess.run([sys.executable, ROOT / "examples" / "pytorch" / name, *map(str, arguments)],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_network_of_one_s_own_is_trained_and_scored(self):
        self.run_example("own_network.py", "train", "out/own.pt", 2)
        small = 'scenes=[{"name": "small", "scenes": ["demo:1"], "width": 48, "height": 32}]'
        # As the page has it, with the Python of this test.
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        with mock.patch.dict(os.environ, PATH=path):
            scores = command_line_json("compare", ROOT / "examples" / "pytorch" / "own_network.json", "-o", "out/own", "--set", small,
                                       "--set", "pictures=false")
        figures = {row["method"]: row for row in scores["results"]}
        self.assertEqual(set(figures), {"own network", "e2lf-n4", "inversion"})
        # The same by a call of Python.
        events = e2lf.simulate(e2lf.demo_scene(48, 32), e2lf.read_codes("e2lf-n4"), seed=1)
        e2lf.write_event_images("events.npz", [events], overwrite=True)
        self.run_example("own_network.py", "out/own.pt", "events.npz", "own.npy")
        measured = e2lf.compare(e2lf.demo_scene(48, 32), np.load("own.npy"))
        self.assertAlmostEqual(figures["own network"]["psnr_db"], measured["psnr_db"], delta=1e-3)

    def test_the_examples_write_models(self):
        self.run_example("train_patterns.py", "trained.safetensors", 2)
        trained = e2lf.Model("trained.safetensors")
        e2lf.write_codes("codes.json", trained.codes)
        self.run_example("fine_tune.py", "codes.json", "tuned.safetensors", 1)
        tuned = e2lf.Model("tuned.safetensors")
        self.assertTrue(np.array_equal(tuned.codes, trained.codes))
        for result in (trained, tuned):
            self.assertEqual(e2lf.Reconstructor(result).reconstruct(counts_of(result)).shape, (8, 8, 38, 45))


if __name__ == "__main__":
    unittest.main()
