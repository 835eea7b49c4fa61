"""Trains a network from events to disparity for any patterns, which are drawn anew for each sample.

usage: train.py DATA POOL OUT --camera FILE [--start NETWORK] [--seconds S]
DATA is a folder made by prepare.py, POOL one that draw.py fills at the same time. Continues from OUT/checkpoint.pt, or else from --start, a network.pt of this script or the model file
of a network for fixed patterns. Requires torch, numpy, pillow and a C++ compiler, or nvcc; runs on the CPU or on one GPU.
"""
import argparse
import contextlib
import json
import math
import pathlib
import re
import time

import numpy as np
import torch
import torch.nn.functional as F

import model_files
import networks
import patterns
from scenes import VIEWS
from sensor import CYCLES_STEP, Conditions, count_events, event_planes

AVERAGED_SHARE = 0.3  # of the steps with the mean of several cycles of a still scene
NUMBERS, NUMBER_SHARES = [2, 3, 4, 5, 6, 7], [0.02, 0.72, 0.04, 0.02, 0.02, 0.18]  # of lit patterns
WHOLE_CYCLE_SHARE = 0.15  # of the steps with three lit patterns
NEWEST = 0.001  # weight of the newest weights in their average
MULTIPLE = 64  # of the height and width of pictures, px
TOLERANCE = 0.2  # error of a disparity that counts as wrong, px per view step


def read_patterns(path):
    """Returns the sets of lit patterns of a .npz file, [number, 64]."""
    packed = np.load(path)
    return {name: packed[name] for name in packed.files}


class Optimiser:
    """Muon for convolutions, as in src/e2lf/learn/optimisers/, Adam for the rest, and a moving average of all weights."""

    def __init__(self, network):
        self.weights = dict(network.weights.items())
        others = ("head/", "pictures/", "features/")
        self.matrices = {k: v for k, v in self.weights.items() if k.endswith("weight") and not k.startswith(others)}
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


class Pool:
    """Scenes that draw.py keeps adding to a folder, of which each step takes a batch: on a CPU, drawing takes longer than training."""

    def __init__(self, folder, batch, device):
        self.folder, self.batch, self.device, self.rng = folder, batch, device, np.random.default_rng()

    def next(self):
        while not (paths := sorted(self.folder.glob("*.npz"))):
            time.sleep(1)
        samples = []
        while len(samples) < self.batch:
            with contextlib.suppress(OSError, ValueError):  # draw.py removes old files
                packed = np.load(paths[self.rng.integers(len(paths))])
                scenes = [packed[name] for name in ("views", "disparity", "known")]
                for at in self.rng.integers(len(scenes[0]), size=4):
                    samples.append([torch.from_numpy(part[at].astype(np.float32)) for part in scenes])
        views, disparity, known = (torch.stack(parts[:self.batch]).to(self.device) for parts in zip(*samples))
        return views / 255, disparity, known


class Task:
    """The network, and what it learns from: inputs, loss and figures."""

    def __init__(self, options):
        self.device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        self.camera_share = options.camera_share
        self.is_half = self.device.type == "cuda" or options.bfloat16
        self.camera = json.loads(re.sub(r"^\s*//.*$", "", options.camera.read_text(), flags=re.M))
        sets = read_patterns(options.data / "patterns.npz")
        self.known = [codes for name, codes in sets.items() if not name.startswith("test-")]
        self.judged = {name: codes for name, codes in sets.items() if name in options.judge}
        self.network = networks.DepthNetwork().to(self.device)
        self.network.to(memory_format=torch.channels_last)
        self.rng = np.random.default_rng(options.seed)

    def start_from(self, path):
        if path.suffix == ".safetensors":
            tensors = model_files.read_model(path)[1]
            networks.start_from_fixed(self.network, tensors, tensors["aperture.codes"].reshape(-1, VIEWS**2)[1:])
        else:
            for name, weight in torch.load(path, map_location=self.device)["weights"].items():
                self.network.weights[name].data.copy_(weight)

    def _autocast(self):
        """Half precision for the steps of the training: an evaluation in it would be pessimistic."""
        is_step = self.is_half and torch.is_grad_enabled()
        return torch.autocast(self.device.type, torch.bfloat16) if is_step else contextlib.nullcontext()

    def apply(self, views, codes, conditions, cycles, whole_cycle):
        """Returns the output for the events of views [batch, 64, y, x] through lit patterns [batch, P, 64]; cycles [batch, y, x]."""
        with torch.no_grad():
            black_lit_open = np.concatenate([np.zeros_like(codes[:, :1]), codes, np.ones_like(codes[:, :1])], 1) / VIEWS**2
            coded = torch.einsum("bpv,bvyx->bpyx", torch.from_numpy(black_lit_open).to(views), views)
            lit = codes.shape[1]
            if whole_cycle:
                codes = np.stack([patterns.with_inverses(c) for c in codes])
            events = count_events(coded, conditions, whole_cycle, cycles)[:, :codes.shape[1]]
            groups, known = event_planes(events, conditions), conditions.conditioning()
            aperture, transmissions = patterns.Aperture(codes, self.device), conditions.transmissions(lit, codes.shape[1])
        with self._autocast():
            return self.network(groups, known, CYCLES_STEP * torch.log2(cycles), transmissions, aperture)

    def loss(self, views, disparity, known):
        """Returns the loss of a batch of scenes.Batches, and its figures."""
        batch, rng = len(views), self.rng
        conditions = Conditions(batch, rng, self.device, self.camera, camera_share=self.camera_share, residue_share=0.3)
        number = int(rng.choice(NUMBERS, p=NUMBER_SHARES))
        whole_cycle = number == 3 and rng.random() < WHOLE_CYCLE_SHARE
        codes = np.stack([patterns.draw_patterns(rng, number, self.known) for _ in range(batch)])
        y = self.apply(views, codes, conditions, self._draw_cycles(disparity), whole_cycle)
        return self._likelihood(y.float(), disparity, known)

    def _draw_cycles(self, like):
        """Returns the number of averaged cycles of each pixel: one, or several that differ between two parts of the picture."""
        cycles = torch.ones_like(like)
        if self.rng.random() < AVERAGED_SHARE:
            cycles *= 2 ** int(self.rng.integers(1, 5))
            if self.rng.random() < 0.6:
                field = F.interpolate(torch.randn(len(like), 1, 6, 6, device=like.device), like.shape[1:], mode="bicubic")[:, 0]
                cycles = torch.where(field > 0.4 * torch.randn(len(like), 1, 1, device=like.device), cycles, torch.full_like(cycles, 2 ** int(self.rng.integers(0, 2))))
        return cycles

    def _likelihood(self, y, disparity, known):
        """The negative logarithm of a Laplace likelihood, and a bounded error that prefers the likeliest disparity to the median."""
        error, log_scale = (y[:, 0] - disparity).abs(), y[:, 1].clamp(-4, 4)
        each = error * torch.exp(-log_scale) + log_scale + 0.05 * error + 0.5 * error / (error + TOLERANCE)
        share = known / known.sum().clamp_min(1)
        loss = (each * share).sum()
        return loss, {"loss": loss, "off by 0.2": ((error > TOLERANCE) * share).sum()}

    @torch.no_grad()
    def evaluate(self, folder):
        """Returns the share of disparities off by 0.2 px in %, by scene, patterns and sensor, and their mean."""
        figures, inside = {}, slice(15, -15)
        for path in sorted(folder.glob("scene-*.npz")):
            scene = np.load(path)
            height, width = scene["views"].shape[1:]
            views = torch.as_tensor(scene["views"][None].astype(np.float32) / 255, device=self.device)
            views = F.pad(views, (0, -width % MULTIPLE, 0, -height % MULTIPLE), mode="reflect")
            truth = torch.as_tensor(scene["disparity"].astype(np.float32), device=self.device)
            for name, codes in self.judged.items():
                for sensor in "paper", "pixel":
                    torch.manual_seed(11)
                    conditions = Conditions(1, self.rng, self.device, self.camera, camera_share=float(sensor == "pixel"), stated=True)
                    y = self.apply(views, codes[None], conditions, torch.ones_like(views[:, 0]), False)
                    off = ((y[0, 0, :height, :width].float() - truth).abs() > TOLERANCE).float()[inside, inside]
                    figures[f"{path.stem[6:]} {name} {sensor}"] = round(100 * float(off.mean()), 1)
        return figures, round(float(np.mean(list(figures.values()))), 2)


def train(options):
    torch.manual_seed(options.seed)
    torch.set_flush_denormal(True)
    torch.backends.cudnn.benchmark = torch.backends.cudnn.allow_tf32 = torch.backends.cuda.matmul.allow_tf32 = True
    options.out.mkdir(parents=True, exist_ok=True)
    task = Task(options)
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
    next_batch = Pool(options.pool, options.batch, task.device).next
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
        figures = task.evaluate(options.data)
        for name, weight in task.network.weights.items():
            weight.data.copy_(trained[name])
        return figures

    def step(rate):
        loss, figures = task.loss(*next_batch())
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(task.network.parameters(), 5.0)
        if torch.isfinite(norm):
            optimiser.step(rate)
        else:
            task.network.zero_grad()
            figures = {}
        return figures

    def save():
        torch.save({"network": task.network.state_dict(), "optimiser": optimiser.state(), "trained_s": time.time() - begin}, checkpoint)
        torch.save({"weights": optimiser.average}, options.out / "network.pt")
        torch.save({"weights": optimiser.average}, options.out / f"network-{optimiser.steps}.pt")

    while (share := (time.time() - begin) / options.seconds) < 1:
        # A constant rate first, then down to zero.
        rate = options.rate * min(1, (optimiser.steps + 1) / 100) * min(1, (1 - share) / 0.9)
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
    parser.add_argument("pool", type=pathlib.Path, help="the folder of draw.py")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--camera", type=pathlib.Path, required=True, help="a camera file of physical pixels")
    parser.add_argument("--judge", nargs="*", default=["e2lf-n4", "release", "test-1"], help="the patterns of the evaluation")
    parser.add_argument("--camera-share", type=float, default=0.45, help="share of the samples of the camera; the others have the model of the paper")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--report-s", type=float, default=150)
    parser.add_argument("--batch", type=int, default=48)
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
