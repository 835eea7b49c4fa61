"""Trains a network from events to disparity.

usage: train.py DATA OUT [--whole-cycle] [--camera FILE] [--seconds S] [--profile]
DATA is a folder made by prepare.py. Continues from OUT/checkpoint.pt, or else from --start, a network.pt or a model file, of which it
takes what fits.
Requires torch, numpy, pillow and a C++ compiler, or nvcc; runs on the CPU or on one GPU.
"""
import argparse
import contextlib
import io
import json
import math
import pathlib
import queue
import re
import threading
import time

import numpy as np
import torch
import torch.nn.functional as F
from PIL import Image

import convert
import networks
from scenes import Batches
from sensor import FIXED_CONDITIONS, Conditions, count_events, network_input

AVERAGED_CYCLES = 0.2  # share of the steps with the mean of several cycles of a still scene, for networks that are told their number
NEWEST = 0.001  # weight of the newest weights in their average
MULTIPLE = 64  # of the height and width of pictures, px
TOLERANCE = 0.2  # error of a disparity that counts as wrong, px per view step


def read_weights(path):
    """Returns the weights of a network.pt, or of a model file by the same names; of two scales, those of the full one."""
    if path.suffix != ".safetensors":
        return torch.load(path, map_location="cpu")["weights"]
    return {re.sub(r"\.(weight|bias)$", r"/\1", name): torch.tensor(values) for name, values in convert.read_model(path)[1].items()}


def read_photos(folder):
    packed = np.load(folder / "photos.npz")
    ends = np.cumsum(packed["sizes"])
    images = [np.asarray(Image.open(io.BytesIO(packed["bytes"][end - size:end].tobytes()))) for end, size in zip(ends, packed["sizes"])]
    return torch.as_tensor(np.stack(images))


def centroids(codes):
    """Returns where the patterns lie relative to view (4, 4), in view steps: (row, column) for each but the first."""
    cells, weights = torch.arange(8.0), codes[1:].cpu().view(-1, 8, 8)
    total = weights.sum((1, 2))
    return [(float(row), float(column)) for row, column in
            zip((weights.sum(2) @ cells) / total - 4, (weights.sum(1) @ cells) / total - 4)]


class Optimiser:
    """Muon for convolutions, as in src/e2lf/learn/optimisers/, Adam for the rest, and a moving average of all weights."""

    def __init__(self, network):
        self.weights = dict(network.weights.items())
        last = network.layers[-1]["name"] if "out_channels" in network.layers[-1] else network.layers[-2]["name"]
        self.matrices = {k: v for k, v in self.weights.items() if k.endswith("weight") and v.shape[2] > 1 and not k.startswith(last + "/")}
        self.momenta = {k: torch.zeros_like(v) for k, v in self.matrices.items()}
        self.adam = torch.optim.Adam([v for k, v in self.weights.items() if k not in self.matrices], betas=(0.9, 0.99))
        self.average, self.steps = {k: v.detach().clone() for k, v in self.weights.items()}, 0

    @torch.no_grad()
    def step(self, rate):
        self.adam.param_groups[0]["lr"] = rate
        self.adam.step()
        shapes = {}
        for name, weight in self.matrices.items():
            shapes.setdefault(tuple(weight.shape), []).append(name)
        for shape, names in shapes.items():  # weights of one shape at once
            for name in names:
                self.momenta[name].lerp_(self.weights[name].grad, 0.05)
            ahead = torch.stack([self.momenta[name].lerp(self.weights[name].grad, 0.05) for name in names])
            steps = orthogonalise(ahead.flatten(2)).view(len(names), *shape)
            for name, step in zip(names, steps):
                self.weights[name].sub_(step, alpha=rate * 0.2 * math.sqrt(max(shape[0], math.prod(shape[1:]))))
        self.steps += 1
        for name, weight in self.weights.items():
            self.average[name].lerp_(weight, max(NEWEST, 9 / (10 + self.steps)))
            weight.grad = None

    @torch.no_grad()
    def begin(self):
        """Starts the average at the present weights."""
        self.average = {k: v.detach().clone() for k, v in self.weights.items()}

    def state(self):
        return {"momenta": self.momenta, "adam": self.adam.state_dict(), "average": self.average, "steps": self.steps}

    def restore(self, state):
        self.momenta, self.average, self.steps = state["momenta"], state["average"], state["steps"]
        self.adam.load_state_dict(state["adam"])


def orthogonalise(matrices):
    """Makes the singular values of matrices [number, out, in] about equal by five steps of the Newton-Schulz iteration."""
    is_tall = matrices.shape[1] > matrices.shape[2]
    x = matrices.transpose(1, 2) if is_tall else matrices
    x = x / (x.flatten(1).norm(dim=1).view(-1, 1, 1) + 1e-8)
    for _ in range(5):
        gram = x @ x.transpose(1, 2)
        x = 3.4445 * x + (-4.775 * gram + 2.0315 * gram @ gram) @ x
    return x.transpose(1, 2) if is_tall else x


def drawn_ahead(batches, uses=2):
    """Returns a function that returns batches of scenes.Batches, which a thread draws ahead, each `uses` times: on a CPU, drawing takes
    as long as training."""
    ready = queue.Queue(2)

    def draw():
        while True:
            batch = batches.next()
            for _ in range(uses):
                ready.put(batch)

    threading.Thread(target=draw, daemon=True).start()
    return ready.get


class Task:
    """What a kind of network learns: its inputs, loss and figures."""

    def __init__(self, options, codes):
        self.device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        self.whole_cycle, self.camera_share = options.whole_cycle, options.camera_share
        self.is_half = self.device.type == "cuda" or options.bfloat16
        text = options.camera.read_text() if options.camera else ""
        self.camera = json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M)) if text else None
        self.codes = torch.from_numpy(codes).to(self.device)
        self.num_patterns = 2 * len(self.codes) + 1 if options.whole_cycle else len(self.codes)
        of_events = 4 * (self.num_patterns - 1)
        channels = of_events + (FIXED_CONDITIONS + self.num_patterns - 2 if self.camera else 0)
        self.share_of_events = of_events / channels
        self.network = networks.Network(networks.depth_network(centroids(self.codes), options.whole_cycle), channels).to(self.device)
        networks.start_features(self.network, self.num_patterns)
        self.network.to(memory_format=torch.channels_last)
        self.rng = np.random.default_rng(options.seed)

    @torch.no_grad()
    def start_from(self, path):
        """Takes the weights of another network, which may lack the inputs of the camera, where their names are those of this one."""
        other = read_weights(path)
        for name, weight in self.network.weights.items():
            known = other.get(name, torch.empty(0))
            if known.shape == weight.shape:
                weight.copy_(known)
            elif known.shape[:1] == weight.shape[:1] and known.shape[1] == round(self.share_of_events * weight.shape[1]):
                weight.zero_()[:, :known.shape[1]] = known
            else:
                print("starts at random:", name)

    def _autocast(self):
        """Half precision for the steps of the training: an evaluation in it would be pessimistic."""
        is_step = self.is_half and torch.is_grad_enabled()
        return torch.autocast(self.device.type, torch.bfloat16) if is_step else contextlib.nullcontext()

    def apply(self, coded, conditions, cycles):
        """Returns the output of the network for the events of the intensities through the codes and the open aperture."""
        with torch.no_grad():
            events = count_events(coded, conditions, self.whole_cycle, cycles)
            known = conditions.conditioning(self.num_patterns, cycles) if self.camera else None
            x = network_input(events, conditions, known).contiguous(memory_format=torch.channels_last)
        with self._autocast():
            return self.network(x)

    def loss(self, coded, disparity, known):
        """Returns the loss of a batch of scenes.Batches, and its figures."""
        batch = len(coded)
        conditions = Conditions(batch, self.rng, self.device, self.camera, camera_share=self.camera_share, residue_share=0.3 if self.camera else 0.0)
        cycles = 2 ** int(self.rng.integers(1, 5)) if self.camera and self.rng.random() < AVERAGED_CYCLES else 1
        return self._likelihood(self.apply(coded, conditions, cycles).float(), disparity, known)

    def _likelihood(self, y, disparity, known):
        """The negative logarithm of a Laplace likelihood, and a bounded error that prefers the likeliest disparity to the median."""
        error, log_scale = (y[:, 0] - disparity).abs(), y[:, 1].clamp(-4, 4)
        each = error * torch.exp(-log_scale) + log_scale + 0.05 * error + 0.5 * error / (error + TOLERANCE)
        share = known / known.sum().clamp_min(1)
        loss = (each * share).sum()
        return loss, {"loss": loss, "off by 0.2": ((error > TOLERANCE) * share).sum()}

    @torch.no_grad()
    def evaluate(self, folder, is_pixel, cycles=1):
        """Returns the share of disparities off by 0.2 px in %."""
        figures, inside = {}, slice(15, -15)
        for path in sorted(folder.glob("scene-*.npz")):
            scene = np.load(path)
            height, width = scene["coded"].shape[1:]
            coded = torch.as_tensor(scene["coded"][None].astype(np.float32), device=self.device)
            coded = F.pad(coded, (0, -width % MULTIPLE, 0, -height % MULTIPLE), mode="reflect")
            torch.manual_seed(11)
            y = self.apply(coded, Conditions(1, self.rng, self.device, self.camera, camera_share=float(is_pixel), stated=True), cycles)
            y = y[:, :, :height, :width].float()
            disparity, scale = y[0]
            name = path.stem[6:] + ("@camera" if is_pixel else "") + (f"x{cycles}" if cycles > 1 else "")
            truth = torch.as_tensor(scene["disparity"].astype(np.float32), device=self.device)
            off = ((disparity - truth).abs() > TOLERANCE).float()[inside, inside]
            figures[name] = f"{100 * float(off.mean()):.1f} %"
            scale = scale[inside, inside]
            figures[name] += f" (surer half {100 * float(off[scale < scale.median()].mean()):.1f} %)"
        return figures


def train(options):
    torch.manual_seed(options.seed)
    torch.set_flush_denormal(True)
    torch.backends.cudnn.benchmark = torch.backends.cudnn.allow_tf32 = torch.backends.cuda.matmul.allow_tf32 = True
    options.out.mkdir(parents=True, exist_ok=True)
    task = Task(options, np.load(options.data / "codes.npy"))
    optimiser = Optimiser(task.network)
    checkpoint, trained_s = options.out / "checkpoint.pt", 0.0
    if checkpoint.exists():
        state = torch.load(checkpoint, map_location=task.device)
        task.network.load_state_dict(state["network"])
        optimiser.restore(state["optimiser"])
        trained_s = state["trained_s"]
    elif options.start:
        task.start_from(options.start)
        optimiser.begin()
    batches = Batches(read_photos(options.data), sorted(options.data.glob("real-*.npz")), task.codes, options.batch, options.size,
                      options.seed + optimiser.steps, task.device)
    next_batch = batches.next if task.device.type == "cuda" else drawn_ahead(batches)
    began = reported = time.time()
    begin = reported - trained_s
    sums, count = {}, 0

    def report(share):
        figures = {name: round(float(value) / max(1, count), 4) for name, value in sums.items()}
        print(f"{share:4.0%} {optimiser.steps} steps, {optimiser.steps * options.batch} samples", figures, *evaluate(), flush=True)

    def evaluate():
        """Returns the figures of the averaged weights."""
        trained = {name: weight.detach().clone() for name, weight in task.network.weights.items()}
        for name, weight in task.network.weights.items():
            weight.data.copy_(optimiser.average[name])
        figures = [task.evaluate(options.data, False), task.evaluate(options.data, False, 16), *([task.evaluate(options.data, True)] if task.camera else [])]
        for name, weight in task.network.weights.items():
            weight.data.copy_(trained[name])
        return figures

    def step(rate):
        loss, figures = task.loss(*next_batch())
        loss.backward()
        torch.nn.utils.clip_grad_norm_(task.network.parameters(), 5.0)
        optimiser.step(rate)
        return figures

    def save():
        torch.save({"network": task.network.state_dict(), "optimiser": optimiser.state(), "trained_s": time.time() - begin}, checkpoint)
        torch.save({"layers": task.network.layers, "weights": optimiser.average, "num_patterns": task.num_patterns}, options.out / "network.pt")

    while (share := (time.time() - begin) / options.seconds) < 1:
        # A constant rate first, then down to zero.
        rate = options.rate * min(1, (optimiser.steps + 1) / 100) * min(1, (1 - share) / 0.55)
        if options.profile and count == 20:
            print_profile(lambda: step(rate))
        for name, value in step(rate).items():
            sums[name] = sums.get(name, 0) + value.detach()
        count += 1
        if count == 200 and not options.profile:
            print(f"{count * options.batch / (time.time() - reported):.0f} samples/s", flush=True)
        if time.time() - began > options.pause_s:
            break
        if time.time() - reported > options.report_s:
            report(share)
            save()
            sums, count, reported = {}, 0, time.time()
    report(min(1, (time.time() - begin) / options.seconds))
    save()


def print_profile(step):
    """Prints where the time of five steps goes."""
    with torch.profiler.profile() as profile:
        for _ in range(5):
            step()
    key = "self_cuda_time_total" if torch.cuda.is_available() else "self_cpu_time_total"
    print(profile.key_averages().table(sort_by=key, row_limit=25, max_name_column_width=60), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--whole-cycle", action="store_true")
    parser.add_argument("--camera", type=pathlib.Path, help="a camera file of physical pixels")
    parser.add_argument("--camera-share", type=float, default=0.3, help="share of the samples of the camera; the others have the model of the paper")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--report-s", type=float, default=150)
    parser.add_argument("--batch", type=int, default=48)
    parser.add_argument("--size", type=int, default=256, help="height and width of the synthesised views in px")
    parser.add_argument("--start", type=pathlib.Path, help="a network.pt or model file to start from")
    parser.add_argument("--pause-s", type=float, default=math.inf, help="stop after this time; another run continues")
    parser.add_argument("--rate", type=float, default=1e-3, help="largest rate of learning")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bfloat16", action="store_true", help="train in bfloat16 on a CPU that has it, as on a GPU")
    parser.add_argument("--profile", action="store_true", help="print where the time of five steps goes")
    options = parser.parse_args()
    train(options)


if __name__ == "__main__":
    main()
