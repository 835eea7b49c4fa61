"""Trains a network of your own, here with 4-D convolutions, on events of e2lf with its patterns, and serves `e2lf compare`.

python3 own_network.py train WEIGHTS.pt [STEPS [LIGHT_FIELD ...]]       without light fields: synthesised ones
python3 own_network.py WEIGHTS.pt EVENTS.npz LIGHT_FIELD.npy            as own_network.json calls it
"""
from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import DataLoader

import e2lf
from e2lf.torch import CodedAperture, EventSimulator, LightFieldPatches, psnr

BATCH, WIDTH, VIEWS = 2, 8, (8, 8)


class Convolution4D(nn.Module):
    """A separable 4-D convolution of [batch, channel, view_y, view_x, y, x]: over the pixels of a view, then over the views."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.pixels = nn.Conv2d(channels, channels, 3, padding=1)
        self.views = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, x: Tensor) -> Tensor:
        batch, channels, rows, columns, height, width = x.shape
        x = x.permute(0, 2, 3, 1, 4, 5).reshape(-1, channels, height, width)
        x = torch.relu(self.pixels(x)).reshape(batch, rows, columns, channels, height, width)
        x = x.permute(0, 4, 5, 3, 1, 2).reshape(-1, channels, rows, columns)
        x = self.views(x)
        return x.reshape(batch, height, width, channels, rows, columns).permute(0, 3, 4, 5, 1, 2)


class OwnNetwork(nn.Module):
    """Event images [batch, N - 1, y, x] to light fields [batch, view_y, view_x, y, x]."""

    def __init__(self, transitions: int) -> None:
        super().__init__()
        self.spread = nn.Conv2d(2 * transitions, WIDTH * VIEWS[0] * VIEWS[1], 5, padding=2)
        self.blocks = nn.ModuleList([Convolution4D(WIDTH) for _ in range(2)])

    def forward(self, events: Tensor) -> Tensor:
        planes = torch.cat([events, events.cumsum(1)], 1) / 8
        x: Tensor = self.spread(planes).reshape(len(events), WIDTH, *VIEWS, *events.shape[2:])
        for block in self.blocks:
            x = x + block(x)
        return x.mean(1) + 0.5


def train(weights: Path, steps: int, light_fields: list[str]) -> None:
    torch.manual_seed(1)
    codes = e2lf.read_codes("e2lf-n4")
    aperture = CodedAperture(codes=codes, trained=False)  # or trained=True, with its parameters in the optimiser
    simulator = EventSimulator(e2lf.SensorConstants())
    network = OwnNetwork(len(codes) - 1)
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
    patches = DataLoader(LightFieldPatches(light_fields, size=32, length=BATCH * steps), BATCH, num_workers=1)
    for step, truth in enumerate(patches, 1):
        output = network(simulator(aperture(truth)))
        loss = (output - truth).square().mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        if step % 50 == 0 or step == steps:
            print(f"step {step}: {psnr(output.detach(), truth).mean():.2f} dB")
    weights.parent.mkdir(parents=True, exist_ok=True)
    torch.save(network.state_dict(), weights)


def reconstruct(weights: Path, events: Path, output: Path) -> None:
    """Reconstructs the mean of the light fields of all cycles."""
    cycles = torch.from_numpy(np.stack(e2lf.read_event_images(events).cycles)).float()
    network = OwnNetwork(cycles.shape[1])
    network.load_state_dict(torch.load(weights))
    with torch.no_grad():
        np.save(output, network(cycles).mean(0).numpy())


if sys.argv[1] == "train":
    train(Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1000, sys.argv[4:])
else:
    reconstruct(*map(Path, sys.argv[1:4]))
