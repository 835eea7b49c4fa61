"""The networks, patterns and event models of e2lf as modules of PyTorch. Requires torch 1.13 or newer.

Light fields are float [batch, view_y, view_x, y, x], event images [batch, N - 1, y, x], and patterns [N, view_y, view_x].
"""
from .aperture import CodedAperture
from .data import BasicLFSRPatches, LightFieldPatches, synthesise
from .events import EventSimulator
from .light_fields import from_macpi, from_sai, psnr, ssim, to_macpi, to_sai
from .model_file import FrameNetwork, LightFieldNetwork, load_module, new_module, save_module
from .network import ConvGraph

__all__ = [
    "BasicLFSRPatches",
    "CodedAperture",
    "ConvGraph",
    "EventSimulator",
    "FrameNetwork",
    "LightFieldNetwork",
    "LightFieldPatches",
    "from_macpi",
    "from_sai",
    "load_module",
    "new_module",
    "psnr",
    "save_module",
    "ssim",
    "synthesise",
    "to_macpi",
    "to_sai",
]
