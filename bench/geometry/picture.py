"""Trains the network of the central picture of e2lf-any for a trained network of disparity, and stores it.

usage: picture.py DATA POOL NETWORK.pt OUT --camera FILE --template MODEL [--seconds S]
DATA is a folder made by prepare.py, POOL one that draw.py fills at the same time, NETWORK a network.pt of train.py, which stays as it is, and
MODEL the model file of e2lf-depth, from which sensor and constants are taken. Continues from OUT/checkpoint.pt, and writes
OUT/e2lf-any.safetensors. Requires torch and numpy; runs on the CPU.
"""
import argparse
import json
import pathlib
import time

import numpy as np
import torch
import torch.nn.functional as F

import model_files
import patterns
import train
from sensor import CYCLES_STEP, FIXED_CONDITIONS, Conditions, count_events, event_planes

WIDTHS = 32, 64, 96
VIEW = 36  # view (4, 4)
PLANES = 4 * patterns.SLOTS + 5  # as the first ones of model::InputKind::kCentral
CONSTANTS = patterns.CONSTANTS + FIXED_CONDITIONS - 1 + patterns.SLOTS  # its last ones
FARTHEST = 3.6  # disparity by which pictures are moved, px per view step
DEPTH_SCALE = 0.3  # of disparity and scale among the planes
SAMPLES, STEPS_PER_BATCH, BATCH, CROP = 500, 5, 6, 128  # kept samples; steps after each new batch; crops of a step, px
NEWEST = 0.002  # weight of the newest weights in their average


class PictureNetwork(torch.nn.Module):
    """A residual U-Net at half the resolution, whose layers are named as in the model file."""

    def __init__(self):
        super().__init__()
        self.layers = torch.nn.ModuleDict()
        self.description = []
        self._conv("stem", "input", WIDTHS[0], PLANES + CONSTANTS, 2, stride=2, relu=True)
        last = self._conv("start", "stem", WIDTHS[0], WIDTHS[0], 3)
        skips = []
        for i, width in enumerate(WIDTHS):
            last = self._block(f"down{i}", last, width)
            if i + 1 < len(WIDTHS):
                skips.append(last)
                last = self._conv(f"half{i}", last, WIDTHS[i + 1], width, 2, stride=2)
        for i in reversed(range(len(WIDTHS) - 1)):
            double = self._conv(f"double{i}", last, WIDTHS[i], WIDTHS[i + 1], 2, stride=2, op="conv-transposed")
            self.description.append({"name": f"join{i}", "op": "add", "inputs": [double, skips[i]]})
            last = self._block(f"up{i}", f"join{i}", WIDTHS[i])
        self._conv("head", last, 4, WIDTHS[0], 3, gain=0.02)
        self.description.append({"name": "sharp", "op": "pixel-shuffle", "inputs": ["head"], "stride": 2})

    def _conv(self, name, source, out, inputs, kernel, stride=1, relu=False, residual="", op="conv", gain=1.0):
        make = torch.nn.ConvTranspose2d if op == "conv-transposed" else torch.nn.Conv2d
        layer = make(inputs, out, kernel, stride, 0 if kernel == stride else kernel // 2)
        torch.nn.init.kaiming_normal_(layer.weight)
        with torch.no_grad():
            layer.weight.mul_(gain)
            layer.bias.zero_()
        self.layers[name] = layer
        fields = {"stride": stride if stride > 1 else None, "relu": relu or None, "residual": residual or None}
        self.description.append({"name": name, "op": op, "inputs": [source], "out_channels": out, "kernel": kernel,
                                 **{key: value for key, value in fields.items() if value}})
        return name

    def _block(self, name, source, width):
        self._conv(name + "a", source, width, width, 3, relu=True)
        return self._conv(name + "b", name + "a", width, width, 3, residual=source, gain=0.3)

    def forward(self, planes, constants):
        """planes: [batch, PLANES, y, x]; constants: [batch, CONSTANTS], the same at all pixels."""
        stem = self.layers["stem"]
        done = {"stem": F.relu(F.conv2d(planes, stem.weight[:, :PLANES], stem.bias, 2) +
                               (constants @ stem.weight[:, PLANES:].sum((2, 3)).t())[:, :, None, None])}
        for layer in self.description[1:]:
            inputs = [done[name] for name in layer["inputs"]]
            if layer["op"] == "add":
                result = sum(inputs)
            elif layer["op"] == "pixel-shuffle":
                result = F.pixel_shuffle(inputs[0], layer["stride"])
            else:
                result = self.layers[layer["name"]](inputs[0])
            if layer.get("residual"):
                result = result + done[layer["residual"]]
            done[layer["name"]] = F.relu(result) if layer.get("relu") else result
        return done["sharp"]


def warp(pictures, y, x):
    """Reads pictures [batch, n, y, x] at places [batch, y, x], linearly with edges repeated."""
    height, width = pictures.shape[2:]
    places = torch.stack([2 * x / (width - 1) - 1, 2 * y / (height - 1) - 1], -1)
    return F.grid_sample(pictures, places, mode="bilinear", padding_mode="border", align_corners=True)


@torch.no_grad()
def central_planes(task, views, codes, conditions, cycles):
    """Returns the planes and the constants of the input, and the picture to which the network adds its output."""
    black_lit_open = np.concatenate([np.zeros_like(codes[:, :1]), codes, np.ones_like(codes[:, :1])], 1) / 64
    coded = torch.einsum("bpv,bvyx->bpyx", torch.from_numpy(black_lit_open).to(views), views)
    number = codes.shape[1]
    groups = event_planes(count_events(coded, conditions, False, cycles)[:, :number], conditions)
    known, aperture = conditions.conditioning(), patterns.Aperture(codes, task.device)
    transmissions, of_cycles = conditions.transmissions(number, number), CYCLES_STEP * torch.log2(cycles)
    with torch.autocast(task.device.type, torch.bfloat16):
        output = task.network(groups, known, of_cycles, transmissions, aperture).float()
    disparity, log_scale = output[:, 0].clamp(-FARTHEST, FARTHEST), output[:, 1].clamp(-4, 4)
    rows, columns = torch.meshgrid(*(torch.arange(n, device=task.device).float() for n in views.shape[2:]), indexing="ij")
    offset = lambda p, axis: aperture.offsets[:, p, axis][:, None, None]
    moved = torch.stack([warp(groups[:, 1:, p], rows + offset(p, 0) * disparity, columns + offset(p, 1) * disparity)
                         for p in range(number)], 2)  # [batch, level or intensity, P, y, x]
    areas = torch.from_numpy(codes.sum(2)).float().to(task.device) / 64
    mean = lambda weights: ((moved[:, 1] / 4 / areas[:, :, None, None]) * (weights / weights.sum(1, keepdim=True))[:, :, None, None]).sum(1)
    base = mean(areas)
    slots = lambda pictures: torch.einsum("bsp,bpyx->bsyx", aperture.slots, pictures)
    planes = torch.cat([slots(moved[:, 0]), slots(moved[:, 1]), slots(groups[:, 1]), slots(groups[:, 2]), base[:, None],
                        mean(aperture.weights)[:, None], DEPTH_SCALE * disparity[:, None], DEPTH_SCALE * log_scale[:, None],
                        of_cycles[:, None]], 1)
    return planes, torch.cat([aperture.constants, known, torch.einsum("bsp,bp->bs", aperture.slots, transmissions)], 1), base


class Samples:
    """The newest simulated samples, of which each step takes crops."""

    def __init__(self, task, pool):
        self.task, self.next_batch, self.kept, self.made = task, pool.next, [], 0

    def add(self):
        views, disparity, _ = self.next_batch()
        rng = self.task.rng
        conditions = Conditions(len(views), rng, self.task.device, self.task.camera, camera_share=self.task.camera_share, residue_share=0.3)
        number = int(rng.choice(train.NUMBERS, p=train.NUMBER_SHARES))
        codes = np.stack([patterns.draw_patterns(rng, number, self.task.known) for _ in views])
        planes, constants, base = central_planes(self.task, views, codes, conditions, self.task._draw_cycles(disparity))
        for i in range(len(views)):
            self.kept.append((planes[i].half(), constants[i], base[i].half(), views[i, VIEW].half(), float(conditions.gain[i])))
        self.kept, self.made = self.kept[-SAMPLES:], self.made + len(views)

    def crops(self):
        parts = []
        for i in self.task.rng.integers(len(self.kept), size=BATCH):
            planes, constants, base, view, gain = self.kept[i]
            y, x = (2 * int(at) for at in self.task.rng.integers(0, (view.shape[-1] - CROP) // 2 + 1, 2))
            cut = lambda maps: maps[..., y:y + CROP, x:x + CROP].float()
            parts.append((cut(planes), constants, cut(base), cut(view), torch.tensor(gain)))
        return [torch.stack(each) for each in zip(*parts)]


def store(path, network, weights, template):
    """Writes the model file, which names e2lf-depth as its network of disparity."""
    header = model_files.read_model(template)[0]
    kept = ("format_version", "num_patterns", "views_y", "views_x", "event_model", "black_first", "constants", "camera")
    header = {key: header[key] for key in kept} | {
        "name": "e2lf-any", "input": [{"kind": "central", "scale": 1.0}], "composed_of": {"disparity": "e2lf-depth"},
        "network": {"type": header["network"]["type"], "input_channels": PLANES + CONSTANTS, "layers": network.description},
        "provenance": {"script": "bench/geometry/picture.py"}}
    model_files.write(path, header, {name.removeprefix("layers."): value.float().numpy() for name, value in weights.items()}, is_half=True)


def learn(options):
    torch.set_flush_denormal(True)
    options.out.mkdir(parents=True, exist_ok=True)
    options.judge, options.bfloat16 = [], True
    task = train.Task(options)
    task.start_from(options.network)
    network, checkpoint = PictureNetwork(), options.out / "checkpoint.pt"
    optimiser = torch.optim.Adam(network.parameters(), options.rate, betas=(0.9, 0.98))
    average, steps, trained_s = {name: value.clone() for name, value in network.state_dict().items()}, 0, 0.0
    if checkpoint.exists():
        state = torch.load(checkpoint)
        network.load_state_dict(state["network"])
        optimiser.load_state_dict(state["optimiser"])
        average, steps, trained_s = state["average"], state["steps"], state["trained_s"]
    samples, begin, sums = Samples(task, train.Pool(options.pool, 4, task.device)), time.time() - trained_s, []
    for _ in range(8):
        samples.add()
    while (share := (time.time() - begin) / options.seconds) < 1:
        samples.add()
        for _ in range(STEPS_PER_BATCH):
            # A constant rate first, then down to zero.
            optimiser.param_groups[0]["lr"] = options.rate * min(1, (steps + 1) / 100) * min(1, (1 - share) / 0.8)
            planes, constants, base, view, gain = samples.crops()
            with torch.autocast("cpu", torch.bfloat16):
                detail = network(planes.contiguous(memory_format=torch.channels_last), constants)[:, 0]
            error = (((base + detail.float()) / gain[:, None, None] - view)[:, 8:-8, 8:-8] ** 2).mean((1, 2))
            torch.log(error + 1e-5).mean().backward()
            torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
            optimiser.step()
            optimiser.zero_grad()
            steps += 1
            with torch.no_grad():
                for name, value in network.state_dict().items():
                    average[name].lerp_(value, max(NEWEST, 9 / (10 + steps)))
            sums.append(float(-10 * torch.log10(error.detach() + 1e-9).mean()))
        if steps % 200 == 0:
            print(f"{share:.1%} {steps} steps, {samples.made} samples, {np.mean(sums):.2f} dB", flush=True)
            sums = []
            torch.save({"network": network.state_dict(), "optimiser": optimiser.state_dict(), "average": average, "steps": steps,
                        "trained_s": time.time() - begin}, checkpoint)
    store(options.out / "e2lf-any.safetensors", network, average, options.template)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in "data", "pool", "network", "out":
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--camera", type=pathlib.Path, required=True, help="a camera file of physical pixels")
    parser.add_argument("--camera-share", type=float, default=0.45, help="share of the samples of the camera; the others have the model of the paper")
    parser.add_argument("--template", type=pathlib.Path, required=True, help="the model file of e2lf-depth")
    parser.add_argument("--seconds", type=float, default=4900)
    parser.add_argument("--rate", type=float, default=2e-3, help="largest rate of learning")
    parser.add_argument("--seed", type=int, default=1)
    learn(parser.parse_args())


if __name__ == "__main__":
    main()
