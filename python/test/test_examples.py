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
        self.assertEqual(len(scripts), 5)
        for script in scripts:
            done = subprocess.run([sys.executable, script, "picture.png"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{script.name}: {done.stderr}")
            picture = e2lf.read_image("picture.png")
            self.assertGreater(picture.std(), 0.05, script.name)
            self.assertIn(script.name, script.read_text())


if __name__ == "__main__":
    unittest.main()
