# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The bytes of the MCAP file against two readers that share no code with the writer: rosbags and mcap-ros2-support."""

import contextlib
import shutil
from pathlib import Path

import numpy as np
import pytest
from mcap.exceptions import EndOfFile
from mcap.reader import NonSeekingReader, make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from fairlead.geometry import matrix_from_quat_xyzw, perturb
from fairlead.sinks.ros.mcap import TOPICS, McapSink, frame_name
from fairlead.sinks.ros.messages import (
    DIAGNOSTICS,
    POSE,
    TRANSFORMS,
    definition,
    diagnostic_message,
    pose_message,
    ros_covariance,
    transform_message,
)
from fairlead.sinks.sink import Outcome
from tests.clip import true_pose
from tests.outcomes import estimate, lost, no_view

STORE = get_typestore(Stores.ROS2_HUMBLE)


def spread(seed: int = 0) -> np.ndarray:
    A = np.random.default_rng(seed).normal(size=(6, 6)) * 1e-3
    return A @ A.T


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        (POSE, pose_message(estimate(true_pose(3), spread(), stamp_ns=7_000_000_009), "cam")),
        (TRANSFORMS, transform_message(estimate(true_pose(3), spread(), stamp_ns=7), "camera", "a ship")),
        (DIAGNOSTICS, diagnostic_message(estimate(true_pose(3), spread()), "frigate")),
        (DIAGNOSTICS, diagnostic_message(lost(), "frigate \u00e9")),
    ],
)
def test_bytes_are_those_of_rosbags(kind: str, data: bytes) -> None:
    message = STORE.deserialize_cdr(data, kind)
    assert bytes(STORE.serialize_cdr(message, kind)) == data


@pytest.mark.parametrize("kind", sorted(TOPICS.values()))
def test_definitions_are_those_of_rosbags(kind: str) -> None:
    ours = get_types_from_msg(definition(kind), kind)
    for name, (_, fields) in ours.items():
        if name != "std_msgs/msg/Header":
            assert [each[0] for each in fields] == [each[0] for each in STORE.fielddefs[name][1]], name
            assert [each[1] for each in fields] == [each[1] for each in STORE.fielddefs[name][1]], name


def test_fields_hold_what_they_should() -> None:
    T, S = true_pose(5), spread(2)
    message = STORE.deserialize_cdr(pose_message(estimate(T, S, stamp_ns=12_000_000_034), "cam"), POSE)
    assert (message.header.stamp.sec, message.header.stamp.nanosec, message.header.frame_id) == (12, 34, "cam")
    p, q = message.pose.pose.position, message.pose.pose.orientation
    np.testing.assert_array_equal([p.x, p.y, p.z], T[:3, 3])
    np.testing.assert_allclose(matrix_from_quat_xyzw(np.array([q.x, q.y, q.z, q.w])), T[:3, :3], atol=1e-15)
    np.testing.assert_array_equal(message.pose.covariance.reshape(6, 6), ros_covariance(estimate(T, S)))


def test_the_covariance_is_that_of_position_and_of_turns_about_the_cameras_axes() -> None:
    T, S = true_pose(5), spread(3)
    rng = np.random.default_rng(1)
    errors = []
    for xi in rng.multivariate_normal(np.zeros(6), S, size=4000):
        moved = perturb(T, xi)
        turn = moved[:3, :3] @ T[:3, :3].T  # fixed axes: applied on the left
        errors.append([*(moved[:3, 3] - T[:3, 3]), turn[2, 1], turn[0, 2], turn[1, 0]])
    # 4000 draws know a variance to 2.2 %; four sigma.
    np.testing.assert_allclose(ros_covariance(estimate(T, S)), np.cov(np.array(errors).T), atol=0.09 * S.max())


def written(path: Path) -> McapSink:
    sink = McapSink(path, camera="front camera", target="frigate")
    for i in range(4):
        answer = estimate(true_pose(i), spread(i), stamp_ns=100 * i, frame=i) if i != 2 else lost()
        sink.write(Outcome(estimate=answer, view=no_view()))
    return sink


def test_readers_find_every_message(tmp_path: Path) -> None:
    sink = written(tmp_path / "a.mcap")
    sink.close()
    sink.close()
    with (tmp_path / "a.mcap").open("rb") as stream:
        found = list(make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages())
    assert (
        sorted(channel.topic for _, channel, _, _ in found)
        == ["/diagnostics"] * 4 + ["/fairlead/pose"] * 3 + ["/tf"] * 3
    )
    transform = next(content for _, channel, _, content in found if channel.topic == "/tf").transforms[0]
    assert (transform.header.frame_id, transform.child_frame_id) == ("front_camera", "frigate")
    levels = [content.status[0].level for _, channel, _, content in found if channel.topic == "/diagnostics"]
    assert sorted(int.from_bytes(level, "little") if isinstance(level, bytes) else int(level) for level in levels) == [
        *(0, 0, 0, 2)
    ]


def test_a_killed_file_holds_every_frame(tmp_path: Path) -> None:
    sink = written(tmp_path / "a.mcap")
    shutil.copy(tmp_path / "a.mcap", tmp_path / "killed.mcap")
    sink.close()
    topics = []
    with (tmp_path / "killed.mcap").open("rb") as stream, contextlib.suppress(EndOfFile):
        for _, channel, _ in NonSeekingReader(stream).iter_messages(log_time_order=False):
            topics.append(channel.topic)
    assert len(topics) == 10


def test_names_of_frames() -> None:
    assert frame_name("front camera/1") == "front_camera_1"
    assert frame_name("7") == "f_7"
