# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What autopilots are told: bytes, frames, covariances, clocks."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import common
from pymavlink.generator import mavgen

import fairlead.sinks.mavlink
from fairlead.geometry import exp_se3, exp_so3, hat, perturb
from fairlead.io.errors import InputError
from fairlead.io.mount import Gimbal, Mount, load_mount, rotation_from_euler
from fairlead.sinks.mavlink.clocks import TimeSync
from fairlead.sinks.mavlink.dialect import messages_in, target_relative
from fairlead.sinks.mavlink.link import load_key
from fairlead.sinks.mavlink.report import landing_target, relative_target, sight
from fairlead.sinks.mavlink.vehicle import UNKNOWN, History, VehicleState, mix_rotations, mix_vectors
from tests.outcomes import estimate

X_DECK = np.array([13.8, 0.5, 6.2])
DOWN = Mount(T_carrier_camera=np.array([[0, -1, 0, 0.1], [1, 0, 0, 0.0], [0, 0, 1, 0.3], [0, 0, 0, 1.0]]))
"""Looks down, the top of the image forward."""


def matrix_from_wxyz(q: list[float]) -> np.ndarray:
    """By the formula of MAVLink's common.xml, not by the package."""
    w, x, y, z = q
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The module that mavgen makes of the shipped XML."""
    xml = Path(fairlead.sinks.mavlink.__file__).with_name("target_relative.xml")
    out = tmp_path_factory.mktemp("mavgen") / "generated.py"
    assert mavgen.mavgen(mavgen.Opts(str(out), wire_protocol="2.0", language="Python3", validate=False), [str(xml)])
    spec = importlib.util.spec_from_file_location("generated", out)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["generated"] = module
    spec.loader.exec_module(module)
    return module


def test_target_relative_is_what_mavgen_makes_of_the_xml(generated: Any) -> None:
    theirs = generated.MAVLink_target_relative_message
    ours = target_relative()
    assert (theirs.crc_extra, theirs.unpacker.size) == (28, 71)
    assert (ours.crc_extra, ours.unpacker.size) == (28, 71)
    values = (123456789012, 3, 2, 1.5, -2.5, 3.5, [0.1, 0.2, 0.3], 0.05, [0.5, 0.5, -0.5, 0.5], [1.0, 0.0, 0.0, 0.0], 2)
    mav = common.MAVLink(None, srcSystem=1, srcComponent=191)
    data = ours(*values).pack(mav)
    assert data == theirs(*values).pack(generated.MAVLink(None, srcSystem=1, srcComponent=191))
    read = generated.MAVLink(None).decode(bytearray(data))
    assert (read.timestamp, read.id, read.frame, read.type) == (123456789012, 3, 2, 2)
    np.testing.assert_allclose(read.pos_std, [0.1, 0.2, 0.3], rtol=1e-6)


def test_a_camera_that_looks_down_sees_what_is_below() -> None:
    """A point 10 m ahead of the lens, 2 m to the top of the image: 10.3 m below, 2.1 m forward of the vehicle."""
    T = exp_se3(np.array([0.0, -2.0, 10.0, 0.0, 0.0, 0.0]))
    sighting = sight(estimate(T), np.zeros(3), DOWN, UNKNOWN, 5)
    assert sighting is not None
    np.testing.assert_allclose(sighting.p_body, [2.1, 0.0, 10.3])
    message = landing_target(sighting, "ardupilot")
    assert (message.frame, message.position_valid, message.time_usec) == (12, 1, 5)
    direction = np.array([message.x, message.y, message.z]) / message.distance
    np.testing.assert_allclose(direction, np.array([2.1, 0.0, 10.3]) / np.hypot(2.1, 10.3))
    assert landing_target(sighting, "px4") is None


def test_px4_is_told_a_place_in_its_local_frame() -> None:
    R = rotation_from_euler(0.1, -0.2, 2.0)
    state = VehicleState(R_ned_body=R, p_ned=np.array([100.0, -50.0, -80.0]), R_ned_gimbal=None)
    T = exp_se3(np.array([0.0, -2.0, 10.0, 0.3, 0.2, 0.1]))
    sighting = sight(estimate(T), X_DECK, DOWN, state, 5)
    assert sighting is not None
    message = landing_target(sighting, "px4")
    p_body = DOWN.T_carrier_camera[:3, :3] @ (T[:3, :3] @ X_DECK + T[:3, 3]) + DOWN.T_carrier_camera[:3, 3]
    assert (message.frame, message.position_valid) == (1, 1)
    np.testing.assert_allclose([message.x, message.y, message.z], state.p_ned + R @ p_body)
    expected = R @ DOWN.T_carrier_camera[:3, :3] @ T[:3, :3]
    np.testing.assert_allclose(matrix_from_wxyz(message.q), expected, atol=1e-12)


def test_standard_deviations_are_those_of_drawn_poses() -> None:
    rng = np.random.default_rng(3)
    A = rng.normal(size=(6, 6)) * 0.02
    S = A @ A.T
    R = rotation_from_euler(0.2, 0.1, -1.0)
    state = VehicleState(R_ned_body=R, p_ned=np.zeros(3), R_ned_gimbal=None)
    T = exp_se3(np.array([1.0, -2.0, 30.0, 0.3, 0.2, 0.1]))
    sighting = sight(estimate(T, S), X_DECK, DOWN, state, 0)
    assert sighting is not None
    message = relative_target(sighting)
    assert (message.frame, message.q_sensor) == (2, [1.0, 0.0, 0.0, 0.0])
    T_ned_camera = np.eye(4)
    T_ned_camera[:3] = np.hstack([R, np.zeros((3, 1))]) @ DOWN.T_carrier_camera
    places, turns = [], []
    mean = T_ned_camera @ T
    for xi in rng.multivariate_normal(np.zeros(6), S, size=4000):
        drawn = T_ned_camera @ perturb(T, xi)
        places.append(drawn[:3, :3] @ X_DECK + drawn[:3, 3])
        turns.append((drawn[:3, :3] @ mean[:3, :3].T)[1, 0])
    # 4000 draws know a deviation to 1.1 %; four sigma.
    np.testing.assert_allclose(message.pos_std, np.std(places, axis=0), rtol=0.045)
    np.testing.assert_allclose(message.yaw_std, np.std(turns), rtol=0.045)
    np.testing.assert_allclose([message.x, message.y, message.z], np.mean(places, axis=0), atol=0.1)


def test_without_attitude_the_relative_target_is_in_body_axes() -> None:
    sighting = sight(estimate(exp_se3(np.array([0.0, 0.0, 9.0, 0.0, 0.0, 0.0]))), np.zeros(3), DOWN, UNKNOWN, 0)
    assert sighting is not None
    message = relative_target(sighting)
    assert (message.frame, message.q_sensor) == (1, [0.0] * 4)


def test_a_gimbal_turns_the_camera() -> None:
    """Gimbal pitched to 90 degrees down on a rolling vehicle: what is ahead of the lens is below in the world."""
    forward = np.eye(4)
    forward[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    mount = Mount(T_carrier_camera=forward, gimbal=Gimbal(position=np.array([0.2, 0.0, 0.1]), device_id=0))
    R_ned_body = rotation_from_euler(0.3, 0.1, 1.0)
    state = VehicleState(R_ned_body=R_ned_body, p_ned=None, R_ned_gimbal=rotation_from_euler(0.0, -np.pi / 2, 1.0))
    T = exp_se3(np.array([0.0, 0.0, 7.0, 0.0, 0.0, 0.0]))
    sighting = sight(estimate(T), np.zeros(3), mount, state, 0)
    assert sighting is not None
    np.testing.assert_allclose(R_ned_body @ sighting.p_body, [0, 0, 7.0] + R_ned_body @ [0.2, 0.0, 0.1], atol=1e-12)
    assert sight(estimate(T), np.zeros(3), mount, UNKNOWN, 0) is None


def test_histories_interpolate_and_say_when_they_do_not_know() -> None:
    turns: History[np.ndarray] = History(mix_rotations)
    places: History[np.ndarray] = History(mix_vectors)
    rate = np.array([0.3, -0.2, 0.5])
    for i in range(5):
        turns.add(100_000_000 * i, exp_so3(0.1 * i * rate))
        places.add(100_000_000 * i, np.array([0.1 * i, 0.0, 1.0]))
    np.testing.assert_allclose(turns.at(137_000_000), exp_so3(0.137 * rate), atol=1e-12)
    np.testing.assert_allclose(places.at(450_000_000), [0.45, 0.0, 1.0])  # on from the last two
    assert places.at(-1) is None
    assert places.at(600_000_000) is None
    places.add(399_000_000, np.zeros(3))  # late: not taken
    np.testing.assert_allclose(places.at(400_000_000), [0.4, 0.0, 1.0])
    places.add(1_000_000_000, np.zeros(3))
    assert places.at(700_000_000) is None, "600 ms without a message"


def test_the_quickest_answer_tells_the_clock() -> None:
    clock = TimeSync()
    assert clock.offset_ns is None
    for asked, theirs, now in [(1_000, 51_000, 9_000), (20_000, 70_900, 21_000), (40_000, 95_000, 60_000)]:
        assert clock.answer(theirs, clock.ask(asked), now)
    assert clock.offset_ns == 70_900 - 20_500
    assert not clock.answer(1, 20_000, 21_000), "answered already"
    assert not clock.answer(1, 77, 78), "never asked"
    assert clock.offset_ns == 70_900 - 20_500


def test_frames_are_cut_out_of_anything() -> None:
    mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
    one = common.MAVLink_timesync_message(1, 2).pack(mav)
    frames, rest = messages_in(b"junk" + one + one[:7])
    assert (frames, rest) == ([one], one[:7])
    assert messages_in(b"\xfd") == ([], b"\xfd")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "camera: missing"),
        ("[camera]", "camera.pitch_deg: missing"),
        ("[camera]\npitch_deg = 1\nquat_xyzw = [0, 0, 0, 1]", "expected either quat_xyzw or angles"),
        ("[camera]\nquat_xyzw = [0, 0, 0, 2]", "expected a unit quaternion"),
        ("[camera]\npitch_deg = -90\n[gimbal]\ndevice_id = 300", "expected 0 to 255"),
        ("[camera]\npitchdeg = -90", "did you mean 'pitch_deg'"),
    ],
)
def test_a_mount_that_means_nothing_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "mount.toml").write_text(text)
    with pytest.raises(InputError, match=r"mount\.toml") as caught:
        load_mount(tmp_path / "mount.toml")
    assert message in str(caught.value)


def test_angles_and_quaternion_of_a_mount_agree(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("[camera]\nposition_m = [0.1, 0.0, 0.3]\npitch_deg = -90.0\n")
    (tmp_path / "b.toml").write_text("[camera]\nquat_xyzw = [0.0, 0.0, 0.70710678, 0.70710678]\n")
    down = load_mount(tmp_path / "a.toml").T_carrier_camera
    np.testing.assert_allclose(down, DOWN.T_carrier_camera, atol=1e-12)
    np.testing.assert_allclose(load_mount(tmp_path / "b.toml").T_carrier_camera[:3, :3], down[:3, :3], atol=1e-8)
    assert hat(np.zeros(3)).shape == (3, 3)


def test_keys(tmp_path: Path) -> None:
    key = bytes(range(32))
    (tmp_path / "raw").write_bytes(key)
    (tmp_path / "hex").write_text(key.hex() + "\n")
    (tmp_path / "short").write_text("abc")
    assert load_key(tmp_path / "raw") == load_key(tmp_path / "hex") == key
    for name in ("short", "none"):
        with pytest.raises(InputError):
            load_key(tmp_path / name)
