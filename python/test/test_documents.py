"""The Python of the documents runs as it is written, on a recording of the demo scene; only "cuda" becomes "cpu"."""
import re
import unittest
from pathlib import Path

import e2lf
from common import InFolder, event_images, make_recording

DOCUMENTS = Path(__file__).resolve().parents[2] / "docs"


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", (DOCUMENTS / page).read_text(), flags=re.S | re.M)


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


if __name__ == "__main__":
    unittest.main()
