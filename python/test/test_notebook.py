"""What notebooks show: the HTML is parsed and its pictures are read."""
import base64
import re
import unittest
import warnings
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np

import e2lf
from common import InFolder, make_recording


class Pictures(HTMLParser):
    """The pictures and captions of HTML whose elements are closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.pictures, self.captions = [], [], []
        self.feed(text)
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        if tag != "img":
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        source = dict(attributes)["src"]
        self.pictures.append(base64.b64decode(source.removeprefix("data:image/png;base64,")))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.captions.append(data)


def read(picture):
    Path("picture.png").write_bytes(picture)
    return e2lf.read_image("picture.png")


class NotebookTest(InFolder):
    def test_a_light_field_is_its_central_view_with_parallax(self):
        scene = e2lf.demo_scene(48, 32)
        html = Pictures(e2lf.show(scene)._repr_html_())
        self.assertLess(np.abs(read(html.pictures[0]) - scene[4, 4]).max(), 0.5 / 255 + 1e-6)
        self.assertIn("8x8 views, 48x32 px", html.captions[0])
        frames = re.findall(rb"fdAT(.{4})(x.*?).{4}(?=.{4}(?:fcTL|IEND))", html.pictures[0], flags=re.S)
        self.assertEqual(len(frames), 16)
        rows = np.frombuffer(zlib.decompress(frames[0][1]), np.uint8).reshape(32, 49)[:, 1:]
        self.assertLess(np.abs(rows / 255 - scene[4, 7]).max(), 0.5 / 255 + 1e-6)  # the first place of the circle
        colour = np.repeat(scene[..., None], 3, -1) * np.array([1, 0.5, 0], np.float32)
        picture = read(Pictures(e2lf.show(colour)._repr_html_()).pictures[0])
        self.assertLess(np.abs(picture - colour[4, 4]).max(), 0.5 / 255 + 1e-6)
        with self.assertRaises(ValueError):
            e2lf.show(scene[0])

    def test_a_cycle_is_its_event_images(self):
        make_recording("a.raw")
        cycle = next(iter(e2lf.accumulate("a.raw")))
        html = Pictures(cycle._repr_html_())
        self.assertEqual(len(html.pictures), len(cycle.images))
        self.assertEqual(html.captions[0], f"transition 0: {np.abs(cycle.images[0].astype(int)).sum()} events")
        picture = read(html.pictures[0])
        grew, fell = cycle.images[0] > 0, cycle.images[0] < 0
        self.assertTrue((picture[grew][:, 0] == 1).all() and (picture[fell][:, 2] == 1).all())
        self.assertTrue((picture[~grew & ~fell] == 1).all())
        self.assertLess(len(repr(cycle)), 150)
        self.assertIn("3 event images of 48x32 px", repr(cycle))

    def test_a_disparity_map_is_coloured_and_has_a_legend(self):
        disparity = np.linspace(-1, 2, 12, dtype=np.float32).reshape(3, 4)
        html = Pictures(e2lf.DisparityMap(disparity, np.ones_like(disparity), (4, 4), (-3.0, 3.0))._repr_html_())
        picture, legend = read(html.pictures[0]), read(html.pictures[1])
        self.assertEqual(html.captions[1], "-1.00 to 2.00 px")
        for place, end in (((0, 0), 0), ((2, 3), -1)):
            self.assertLess(np.abs(picture[place] - legend[0, end]).max(), 1e-6)

    def test_print_and_errors_hold_no_arrays(self):
        scene = e2lf.demo_scene(96, 64)
        self.assertLess(len(str(e2lf.depth(scene))), 150)
        with self.assertRaises(TypeError) as raised:
            e2lf.Reconstructor("e2lf-n4").reconstruct(scene, 5, wrong=scene)
        self.assertIn("Invoked with: (Reconstructor, ndarray[float32, (8, 8, 64, 96)], int, wrong: ndarray", str(raised.exception))
        self.assertLess(len(str(raised.exception)), 700)

    def test_intensities_above_1_are_told(self):
        scene, codes = e2lf.demo_scene(24, 16), e2lf.default_codes()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            e2lf.simulate(scene, codes)
            with self.assertRaisesRegex(UserWarning, "divide 8-bit values by 255"):
                e2lf.simulate(255 * scene, codes)


if __name__ == "__main__":
    unittest.main()
