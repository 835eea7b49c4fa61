"""Fine-tunes the network of a model for the patterns of your own aperture.

python3 fine_tune.py CODES MODEL.safetensors [STEPS [LIGHT_FIELD ...]]     without light fields: synthesised ones
"""
import sys

import torch
from torch.utils.data import DataLoader

import e2lf
from e2lf.torch import CodedAperture, EventSimulator, LightFieldPatches, load_module, save_module

BATCH = 4
codes = e2lf.read_codes(sys.argv[1])
steps = int(sys.argv[3]) if len(sys.argv) > 3 else 500
network = load_module("e2lf-n4")
aperture = CodedAperture(codes=codes, trained=False)
simulator = EventSimulator(network.constants)
patches = DataLoader(LightFieldPatches(sys.argv[4:], length=BATCH * steps), BATCH, num_workers=1)
optimiser = torch.optim.Adam(network.parameters(), lr=1e-4)

for step, truth in enumerate(patches, 1):
    loss = ((network(simulator(aperture(truth))) - truth) ** 2).mean()
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
    if step % 20 == 0 or step == steps:
        print(f"step {step}: {-10 * loss.log10().item():.2f} dB")

save_module(sys.argv[2], network, codes=codes, name="fine-tuned", provenance={"from": "e2lf-n4", "steps": steps}, overwrite=True)
