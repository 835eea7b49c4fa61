"""Each script of examples/python runs as it is, and writes a picture that shows something."""
import subprocess
import sys
import unittest
from pathlib import Path

import e2lf
from common import InFolder

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "python"


class ExampleTest(InFolder):
    def test_every_script_writes_its_picture(self):
        # aedat2_to_csv.py converts files; the case event_arrays runs it.
        scripts = sorted(script for script in FOLDER.glob("*.py") if script.name != "aedat2_to_csv.py")
        self.assertEqual(len(scripts), 6)
        for script in scripts:
            done = subprocess.run([sys.executable, script, "picture.png"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{script.name}: {done.stderr}")
            picture = e2lf.read_image("picture.png")
            self.assertGreater(picture.std(), 0.05, script.name)
            self.assertIn(script.name, script.read_text())

    def test_a_quilt_begins_with_the_leftmost_view_at_the_left_bottom(self):
        views = e2lf.demo_scene(64, 48)
        e2lf.write_light_field("scene.npy", views)
        done = subprocess.run([sys.executable, FOLDER / "quilt.py", "quilt.png", "scene.npy"], capture_output=True, text=True)
        self.assertEqual(done.stdout, "_qs4x2a1.33.png\n", done.stderr)
        quilt = e2lf.read_image("quilt.png")
        self.assertEqual(quilt.shape[:2], (96, 256))
        for view in range(8):
            row, column = 1 - view // 4, view % 4
            part = quilt[48 * row:48 * (row + 1), 64 * column:64 * (column + 1)].reshape(48, 64, -1)[..., 0]
            self.assertLess(abs(part - views[4, view]).max(), 0.003, view)


if __name__ == "__main__":
    unittest.main()
