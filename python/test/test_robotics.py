"""The conversions of examples/ros2 and examples/rerun, with messages as the bags of ROS 2 hold them."""
import sqlite3
import struct
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import numpy as np

import e2lf
from common import InFolder, make_recording, same

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
sys.path[:0] = [str(EXAMPLES / "ros2"), str(EXAMPLES / "rerun")]
import log_light_fields  # noqa: E402
from conversions import RawStream, camera_info_fields, central_view, events_of_mono, image_fields, stamp_ns  # noqa: E402

STAMP = SimpleNamespace(sec=1700000000, nanosec=250_000_000)


def packet(encoding, events, sequence=0, time_base=0, size=(48, 32)):
    return SimpleNamespace(header=SimpleNamespace(stamp=STAMP, frame_id="cam"), width=size[0], height=size[1], seq=sequence,
                           time_base=time_base, encoding=encoding, is_bigendian=False, events=events)


def write_bag(path, packets):
    """A bag of ROS 2 (.db3) with these messages in CDR."""
    def text(word):
        return struct.pack("<I", len(word) + 1) + word.encode() + b"\0"

    def cdr(message):
        body = struct.pack("<iI", message.header.stamp.sec, message.header.stamp.nanosec) + text(message.header.frame_id)
        body += bytes(-len(body) % 4) + struct.pack("<II", message.height, message.width)
        body += bytes(-len(body) % 8) + struct.pack("<QQ", message.seq, message.time_base)
        body += text(message.encoding) + b"\0"
        body += bytes(-len(body) % 4) + struct.pack("<I", len(message.events)) + message.events
        return b"\0\1\0\0" + body

    Path(path).mkdir()
    bag = sqlite3.connect(f"{path}/bag_0.db3")
    bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)")
    bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    bag.execute("INSERT INTO topics VALUES(1, '/events', 'event_camera_msgs/msg/EventPacket', 'cdr', '')")
    for message in packets:
        bag.execute("INSERT INTO messages VALUES(NULL, 1, 0, ?)", (cdr(message),))
    bag.commit()
    Path(f"{path}/metadata.yaml").write_text("rosbag2_bagfile_information:\n  relative_file_paths:\n    - bag_0.db3\n")


class Ros2Test(InFolder):
    def test_packets_of_evt3_become_the_recording(self):
        make_recording("camera.raw")
        stored = Path("camera.raw").read_bytes()
        words = stored[stored.index(b"% end\n") + 6:]
        packets = [packet("evt3", words[at : at + 4096], number) for number, at in enumerate(range(0, len(words), 4096))]
        with open("stream.raw", "wb") as file:
            stream = RawStream(file)
            for each in packets:
                stream.add(each)
        events, triggers = e2lf.read_events("stream.raw")
        expected, expected_triggers = e2lf.read_events("camera.raw")
        self.assertTrue(len(packets) > 2 and same(events, expected) and same(triggers, expected_triggers))
        write_bag("bag", packets)
        self.assertTrue(same(e2lf.read_events("bag")[0], expected))
        self.assertEqual(stream.header_ns(5_000, 2_000), stamp_ns(packets[0].header) + 3_000_000)
        with self.assertRaises(ValueError):
            stream.add(packet("mono", b""))

    def test_packets_of_mono_are_those_of_the_reader_of_bags(self):
        rows = [(3, 5, 1, 7_000), (47, 31, 0, 9_500), (0, 0, 1, 4_000_000)]
        words = b"".join(struct.pack("<Q", p << 63 | y << 48 | x << 32 | t) for x, y, p, t in rows)
        message = packet("mono", words, time_base=12_000_000)
        events = events_of_mono(message)
        self.assertEqual(events.tolist(), [(3, 5, 1, 12_007), (47, 31, 0, 12_009), (0, 0, 1, 16_000)])
        write_bag("bag", [message])
        self.assertTrue(same(events, e2lf.read_events("bag")[0]))

    def test_images_have_the_fields_of_their_messages(self):
        field = np.linspace(0, 1, 8 * 8 * 2 * 3, dtype=np.float32).reshape(8, 8, 2, 3)
        view = central_view(field)
        self.assertEqual(view.tolist(), np.round(255 * field[4, 4]).astype(int).tolist())
        fields = image_fields(view, 1_700_000_000_250_000_123, "cam")
        self.assertEqual(fields["header"], {"stamp": {"sec": 1_700_000_000, "nanosec": 250_000_123}, "frame_id": "cam"})
        self.assertEqual((fields["encoding"], fields["step"], fields["height"], fields["data"]), ("mono8", 3, 2, view.tobytes()))
        self.assertEqual(image_fields(field[0, 0], 0, "cam")["encoding"], "32FC1")
        info = camera_info_fields(3, 2, 100.0, 0, "cam")
        self.assertEqual((info["k"][2], info["k"][5], len(info["p"]), info["p"][0]), (1.0, 0.5, 12, 100.0))


class RerunTest(InFolder):
    def test_points_lie_at_the_depth_of_their_disparity(self):
        disparity = np.array([[-2.0, 1.0], [-0.5, -1.0]])
        points, colours = log_light_fields.points_of(disparity, np.array([[1, 1], [1, 0.1]]), np.array([[1.0, 0], [0.5, 0]]), 100.0)
        self.assertTrue(np.allclose(points, [[-0.25, -0.25, 50], [-1, 1, 200]]))
        self.assertEqual(colours.tolist(), [[255] * 3, [128] * 3])

    def test_each_cycle_is_logged_at_its_time(self):
        images = make_recording("a.raw")
        times, logged = [], {}
        rerun = SimpleNamespace(
            init=lambda name, spawn: None, set_time=lambda timeline, duration: times.append(duration),
            log=lambda path, value: logged.setdefault(path, []).append(value),
            Image=np.asarray, DepthImage=lambda depth, meter: depth, Points3D=lambda points, colors: (points, colors))
        with mock.patch.dict(sys.modules, rerun=rerun), mock.patch.object(sys, "argv", ["log_light_fields.py", "a.raw"]):
            log_light_fields.main()
        cycles = list(e2lf.accumulate("a.raw"))
        self.assertEqual(times, [cycle.begin_us * 1e-6 for cycle in cycles])
        self.assertEqual({len(values) for values in logged.values()}, {len(images)})
        shape = cycles[0].images.shape[1:]
        self.assertTrue(all((value.dtype, value.shape) == (np.uint8, shape)
                            for path, values in logged.items() if path.startswith(("events", "views")) for value in values))
        self.assertTrue((logged["events/transition_0"][0] == np.clip(128 + 32 * cycles[0].images[0].astype(int), 0, 255)).all())
        self.assertGreaterEqual(logged["disparity"][0].min(), 0)
        self.assertEqual(logged["points"][0][0].shape, logged["points"][0][1].shape)


if __name__ == "__main__":
    unittest.main()
