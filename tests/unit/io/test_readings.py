# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fairlead as fl
from fairlead.geometry import exp_so3
from fairlead.io.errors import InputError

stamps = st.integers(-(2**63), 2**63 - 1)
names = st.text(st.characters(categories=["L", "N", "P"]), min_size=1, max_size=12)
numbers = st.floats(allow_nan=False)
angles = st.floats(-3.1, 3.1)


@given(st.lists(st.tuples(stamps, numbers, numbers, st.none() | names), max_size=5))
def test_ranges_come_back_to_the_last_bit(tmp_path_factory, rows):
    path = tmp_path_factory.mktemp("ranges") / "range.csv"
    readings = [fl.RangeReading(stamp_ns=t, range_m=r, sigma_m=s, landmark=name) for t, r, s, name in rows]
    fl.write_ranges(path, readings)
    assert fl.read_ranges(path) == readings


@given(st.lists(st.tuples(stamps, st.tuples(angles, angles, angles), numbers), max_size=5))
def test_attitudes_come_back(tmp_path_factory, rows):
    """A quaternion holds a rotation to rounding."""
    path = tmp_path_factory.mktemp("attitudes") / "attitude.csv"
    readings = [
        fl.AttitudeReading(stamp_ns=t, R_world_camera=exp_so3(np.array(phi)), sigma_rad=s) for t, phi, s in rows
    ]
    fl.write_attitudes(path, readings)
    back = fl.read_attitudes(path)
    assert [(each.stamp_ns, each.sigma_rad) for each in back] == [(each.stamp_ns, each.sigma_rad) for each in readings]
    for one, other in zip(back, readings, strict=True):
        np.testing.assert_allclose(one.R_world_camera, other.R_world_camera, atol=1e-14)


def test_a_level_camera_that_looks_along_x(tmp_path):
    """The example of docs/files.md section 9: right is -y of the world, down -z, forward x."""
    path = tmp_path / "attitude.csv"
    path.write_text("stamp_ns,qx,qy,qz,qw,sigma_rad\n5,-0.5,0.5,-0.5,0.5,0.01\n6,,,,,0.01\n")
    (reading,) = fl.read_attitudes(path)
    np.testing.assert_array_equal(reading.R_world_camera, [[0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def test_an_empty_landmark_is_the_origin_and_an_empty_range_is_nan(tmp_path):
    path = tmp_path / "range.csv"
    path.write_text("range_m,stamp_ns,landmark,sigma_m\n,7,,0.5\n12.5,8,bow,0.5\n")
    first, second = fl.read_ranges(path)
    assert np.isnan(first.range_m)
    assert first.landmark is None
    assert second == fl.RangeReading(stamp_ns=8, range_m=12.5, sigma_m=0.5, landmark="bow")


@pytest.mark.parametrize(
    ("read", "text", "message"),
    [
        (fl.read_ranges, "stamp_ns,range_m,sigma,landmark\n", "unknown column 'sigma'; did you mean 'sigma_m'?"),
        (fl.read_ranges, "stamp_ns,range_m,sigma_m,landmark\n1,far,1,\n", "range.csv:2: range_m: expected a number"),
        (fl.read_attitudes, "stamp_ns,qx,qy,qz,qw,sigma_rad\n1,1,1,0,0,0.1\n", "csv:2: qx,qy,qz,qw: expected a unit"),
        (fl.read_attitudes, "stamp_ns,qx,qy,qz,qw,sigma_rad\n1,nan,0,0,1,0.1\n", "expected a unit quaternion"),
        (fl.read_attitudes, "stamp_ns,qx,qy,qz,qw,sigma_rad\n1.5,0,0,0,1,0.1\n", "stamp_ns: expected a whole number"),
    ],
)
def test_a_wrong_file_is_one_line(tmp_path, read, text, message):
    path = tmp_path / "range.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read(path)
    assert message in str(caught.value)


def test_impossible_readings_are_refused():
    with pytest.raises(ValueError, match="expected a rotation"):
        fl.AttitudeReading(stamp_ns=0, R_world_camera=-np.eye(3), sigma_rad=0.1)
    with pytest.raises(ValueError, match="expected a name"):
        fl.RangeReading(stamp_ns=0, range_m=1.0, sigma_m=1.0, landmark="")
