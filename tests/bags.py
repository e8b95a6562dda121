# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of images written with rosbags, as other people's robots write them."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from fairlead.types import Camera

STORE = get_typestore(Stores.ROS2_HUMBLE)
_IMAGE, _COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
_INFO = "sensor_msgs/msg/CameraInfo"

Record = tuple[str, str, int, bytes]
"""Topic, kind, stamp [ns], bytes."""


def header(stamp_ns: int) -> object:
    time = STORE.types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return STORE.types["std_msgs/msg/Header"](stamp=time, frame_id="optical")


def image_bytes(image: np.ndarray, stamp_ns: int, encoding: str) -> bytes:
    """`png` or `jpeg` for a CompressedImage; else an Image of this encoding, its rows padded by 5 bytes."""
    if encoding in ("png", "jpeg"):
        data = cv2.imencode(f".{encoding}", image)[1].ravel()
        made = STORE.types[_COMPRESSED](header=header(stamp_ns), format=f"bgr8; {encoding} compressed", data=data)
        return bytes(STORE.serialize_cdr(made, _COMPRESSED))
    pixels = {"bgr8": image, "rgb8": image[..., ::-1], "mono8": image[..., :1]}[encoding]
    rows = np.pad(pixels.reshape(len(image), -1), ((0, 0), (0, 5)))
    made = STORE.types[_IMAGE](
        header=header(stamp_ns),
        height=image.shape[0],
        width=image.shape[1],
        encoding=encoding,
        is_bigendian=0,
        step=rows.shape[1],
        data=np.ascontiguousarray(rows).ravel(),
    )
    return bytes(STORE.serialize_cdr(made, _IMAGE))


def info_bytes(camera: Camera) -> bytes:
    roi = STORE.types["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    made = STORE.types[_INFO](
        header=header(0),
        height=camera.height,
        width=camera.width,
        distortion_model="plumb_bob",
        d=np.array(camera.distortion),
        k=np.array(camera.K).ravel(),
        r=np.eye(3).ravel(),
        p=np.zeros(12),
        binning_x=0,
        binning_y=0,
        roi=roi,
    )
    return bytes(STORE.serialize_cdr(made, _INFO))


def records(
    images: tuple[np.ndarray, ...], stamps_ns: list[int], camera: Camera | None, encoding: str = "png"
) -> Iterator[Record]:
    """Images under /cam/image, the calibration of the camera, if given, before them."""
    if camera is not None:
        yield "/cam/camera_info", _INFO, 0, info_bytes(camera)
    kind = _COMPRESSED if encoding in ("png", "jpeg") else _IMAGE
    for image, stamp_ns in zip(images, stamps_ns, strict=True):
        yield "/cam/image", kind, stamp_ns, image_bytes(image, stamp_ns, encoding)


def write_mcap(path: Path, recorded: Iterator[Record], *, chunk_size: int = 200_000) -> Path:
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=chunk_size)
        writer.start(profile="ros2", library="test")
        channels: dict[str, int] = {}
        for topic, kind, stamp_ns, data in recorded:
            if topic not in channels:
                text = STORE.generate_msgdef(kind, ros_version=2)[0]
                schema = writer.register_schema(kind, "ros2msg", text.encode())
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            log_ns = stamp_ns + 3_000_000  # recorded later than taken
            writer.add_message(channels[topic], log_time=log_ns, data=data, publish_time=log_ns)
        writer.finish()
    return path


def write_bag(folder: Path, recorded: Iterator[Record]) -> Path:
    """A ROS 2 bag on SQLite."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections: dict[str, object] = {}
        for topic, kind, stamp_ns, data in recorded:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], stamp_ns + 3_000_000, data)  # pyright: ignore[reportArgumentType]
    return folder
