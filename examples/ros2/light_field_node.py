"""A node that publishes the central view and the disparity of each cycle of a coded-aperture event camera.

python3 light_field_node.py --ros-args -r events:=/event_camera/events -p model:=e2lf-n4 -p focal_px:=1700.0

Subscribes to `events` (event_camera_msgs/EventPacket, "evt3"); publishes `view/image`, `disparity/image` and `camera_info`. It was
not run with ROS 2; the functions of conversions.py are tested.
"""
import os
import tempfile
import threading
from pathlib import Path
from typing import Any

import rclpy
from conversions import RawStream, camera_info_fields, central_view, image_fields
from event_camera_msgs.msg import EventPacket
from rclpy.qos import qos_profile_sensor_data
from rosidl_runtime_py import set_message_fields
from sensor_msgs.msg import CameraInfo, Image

import e2lf


def publish(publisher: Any, kind: Any, fields: Any) -> None:
    message = kind()
    set_message_fields(message, fields)
    publisher.publish(message)


def reconstruct(node: Any, pipe: Path, stream: RawStream, frame_id: str) -> None:
    """Publishes the light field of each cycle that arrives in the pipe, until it is closed."""
    reconstructor = e2lf.Reconstructor(node.get_parameter("model").value)
    focal_px = node.get_parameter("focal_px").value
    views, maps = (node.create_publisher(Image, f"{name}/image", 10) for name in ("view", "disparity"))
    infos = node.create_publisher(CameraInfo, "camera_info", 10)
    first_us = None
    for cycle in e2lf.accumulate(pipe):
        first_us = cycle.begin_us if first_us is None else first_us
        light_field = reconstructor.reconstruct(cycle.images)
        time_ns = stream.header_ns(cycle.begin_us, first_us)
        view, disparity = central_view(light_field), e2lf.depth(light_field).disparity
        publish(views, Image, image_fields(view, time_ns, frame_id))
        publish(maps, Image, image_fields(disparity, time_ns, frame_id))
        publish(infos, CameraInfo, camera_info_fields(view.shape[1], view.shape[0], focal_px, time_ns, frame_id))


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("light_field")
    node.declare_parameter("model", "e2lf-n4")
    node.declare_parameter("focal_px", 1000.0)
    node.declare_parameter("frame_id", "event_camera")
    pipe = Path(tempfile.mkdtemp()) / "events.raw"
    os.mkfifo(pipe)
    with open(os.open(pipe, os.O_RDWR), "wb", buffering=0) as file:  # opened for both, so that it does not wait for the reader
        stream = RawStream(file)
        arguments = (node, pipe, stream, node.get_parameter("frame_id").value)
        threading.Thread(target=reconstruct, args=arguments, daemon=True).start()
        node.create_subscription(EventPacket, "events", stream.add, qos_profile_sensor_data)
        rclpy.spin(node)


if __name__ == "__main__":
    main()
