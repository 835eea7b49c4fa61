"""Trains four aperture patterns and a small network together, and writes them as a model that `e2lf reconstruct` runs.

python3 train_patterns.py MODEL.safetensors [STEPS [LIGHT_FIELD ...]]     without light fields: synthesised ones
"""
import sys

import torch
from torch.nn.utils.clip_grad import clip_grad_norm_
from torch.utils.data import DataLoader

import e2lf
from e2lf.torch import CodedAperture, EventSimulator, LightFieldPatches, new_module, save_module

BATCH = 8
steps = int(sys.argv[2]) if len(sys.argv) > 2 else 2000
patches = DataLoader(LightFieldPatches(sys.argv[3:], size=48, length=BATCH * steps), BATCH, num_workers=1)

torch.manual_seed(1)
device = "cuda" if torch.cuda.is_available() else "cpu"
constants = e2lf.SensorConstants()
aperture = CodedAperture(num_patterns=4, tie="black-first").to(device)
simulator = EventSimulator(constants)
network = new_module(num_patterns=4, width=48, blocks=3, name="mine").to(device)

optimiser = torch.optim.Adam([
    {"params": network.parameters(), "lr": 1e-3},
    {"params": aperture.parameters(), "lr": 1e-2}])
schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, [1e-3, 1e-2], total_steps=steps)

for step, truth in enumerate(patches, 1):
    truth = truth.to(device)
    events = simulator(aperture(truth))
    loss = ((network(events) - truth) ** 2).mean()
    optimiser.zero_grad()
    loss.backward()
    clip_grad_norm_(network.parameters(), 1.0)
    optimiser.step()
    schedule.step()
    if step % 100 == 0 or step == steps:
        print(f"step {step}: {-10 * loss.log10().item():.2f} dB, open cells {aperture.codes().sum((1, 2)).tolist()}")

save_module(sys.argv[1], network, codes=aperture.codes(), constants=constants, provenance={"samples": BATCH * steps},
            overwrite=True)
