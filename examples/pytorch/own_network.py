"""Trains a network of your own, here with 4-D convolutions, on events of e2lf with its patterns, and scores it as `e2lf eval` does.

python3 own_network.py FOLDER [STEPS [LIGHT_FIELD ...]]     writes the reconstruction of the demo scene into the folder
"""
import json
import sys

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


torch.manual_seed(1)
folder, steps = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
codes, constants = e2lf.read_codes("e2lf-n4"), e2lf.SensorConstants()
aperture = CodedAperture(codes=codes, trained=False)  # or trained=True, with its parameters in the optimiser
simulator = EventSimulator(constants)
network = OwnNetwork(len(codes) - 1)
optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
patches = DataLoader(LightFieldPatches(sys.argv[3:], size=32, length=BATCH * steps), BATCH, num_workers=1)

for step, truth in enumerate(patches, 1):
    output = network(simulator(aperture(truth)))
    loss = (output - truth).square().mean()
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
    if step % 50 == 0 or step == steps:
        print(f"step {step}: {psnr(output.detach(), truth).mean():.2f} dB")

scene = e2lf.demo_scene(96, 64)
events = e2lf.simulate(scene, codes, constants=constants, seed=7)  # the simulator of the library, not that of the training
with torch.no_grad():
    light_field = network(torch.from_numpy(events).float()[None])[0].numpy()
e2lf.write_light_field(folder, light_field, overwrite=True)
for name, result in (("own network", light_field), ("e2lf-n4", e2lf.Reconstructor("e2lf-n4").reconstruct(events, gain=1))):
    scores = e2lf.compare(scene, result)
    print(json.dumps({"method": name, **{key: scores[key] for key in ("psnr_db", "ssim_gaussian", "epi_rms_error")}}))
