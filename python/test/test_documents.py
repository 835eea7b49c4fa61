"""The Python of the documents runs as it is written, on a recording of the demo scene; only "cuda" becomes "cpu"."""
import json
import re
import subprocess
import sys
import textwrap
import unittest
from types import ModuleType
from pathlib import Path

import e2lf
from common import InFolder, event_images, make_recording

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ROOT / "docs"


def blocks(page):
    found = re.findall(r"^ *```python\n(.*?)^ *```", (DOCUMENTS / page).read_text(), flags=re.S | re.M)
    return [textwrap.dedent(block) for block in found]


class DocumentTest(InFolder):
    def test_python(self):
        make_recording("capture.raw", cycles=2)
        events, triggers = e2lf.read_events("capture.raw")
        names = {"e2lf": e2lf, "events": events, "triggers": triggers}
        for block in blocks("python.md"):
            names["events"] = events
            exec(compile(block, "docs/python.md", "exec"), names)
        self.assertEqual(e2lf.read_light_field("cycle_1").shape, (8, 8, 32, 48))
        self.assertEqual(len(e2lf.read_events("mine.raw")[0]), len(events))

    def test_pytorch(self):
        try:
            import torch
        except ImportError:
            self.skipTest("python3-torch is not installed")
        images, codes = event_images(1)
        names = {"events": torch.from_numpy(images[0]).float()[None], "codes": codes}
        for block in blocks("pytorch.md"):
            exec(compile(block.replace('"cuda"', '"cpu"'), "docs/pytorch.md", "exec"), names)
        self.assertEqual(names["light_fields"].shape, (1, 8, 8, 32, 48))
        self.assertEqual(names["events"].shape, (1, 3, 32, 48))
        self.assertTrue(e2lf.Model("mine.safetensors").codes.any())

    def test_checkpoints(self):
        try:
            import torch
        except ImportError:
            self.skipTest("python3-torch is not installed")
        saved = {}
        stand_in = ModuleType("safetensors.torch")  # Debian 12 has no package of it
        stand_in.save_file = lambda state, path: saved.update({path: state})
        sys.modules.update({"safetensors": ModuleType("safetensors"), "safetensors.torch": stand_in})
        self.addCleanup(lambda: [sys.modules.pop(name) for name in ("safetensors", "safetensors.torch")])

        subprocess.run([sys.executable, ROOT / "testing" / "suite" / "make_inputs.py", "firenet", "made.safetensors"], check=True)
        network = read_safetensors("made.safetensors", torch)
        torch.save({"state_dict": network}, "firenet.pth")
        for block in blocks("video.md"):
            exec(compile(block, "docs/video.md", "exec"), {})

        learned = torch.randn(64, 3)
        torch.save({name: value.double() for name, value in network.items()}, "RECNET")
        torch.save({"param": learned}, "ACQNET")
        for block in blocks("models.md"):
            exec(compile(block, "docs/models.md", "exec"), {})
        for path in ("checkpoint.safetensors", "DIR/RecNet.safetensors"):
            self.assertEqual(saved[path].keys(), network.keys())
            for name, value in saved[path].items():
                self.assertTrue(value.is_contiguous() and torch.equal(value, network[name]), name)
        masks = saved["DIR/AcqNet.safetensors"]["mask_4x64"]
        self.assertFalse(masks[0].any())
        self.assertTrue(torch.equal(masks[1:].T > 0, learned > 0))


def read_safetensors(path, torch):
    data = Path(path).read_bytes()
    size = int.from_bytes(data[:8], "little")
    begin = 8 + size
    return {name: torch.frombuffer(bytearray(data[begin + entry["data_offsets"][0]:begin + entry["data_offsets"][1]]),
                                   dtype=torch.float32).reshape(entry["shape"])
            for name, entry in json.loads(data[8:begin]).items() if name != "__metadata__"}


if __name__ == "__main__":
    unittest.main()
