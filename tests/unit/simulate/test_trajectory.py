# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from fairlead.simulate import ArcScenario, OrbitScenario, arc_centres, look_at


def test_arc_centre_by_hand():
    """Dead astern at 15 degrees: c = 1000 (-cos 15, 0, sin 15)."""
    centre = arc_centres(np.array([np.pi]), 1000.0, np.radians(15.0))
    np.testing.assert_allclose(centre, [[-965.9258262890683, 0.0, 258.8190451025207]], atol=1e-9)


def test_look_at_from_astern():
    """Level camera astern: forward is the ship's x, right is starboard (-y), down is -z; t = -R c."""
    T = look_at(np.array([[-100.0, 0.0, 10.0]]), np.array([50.0, 0.0, 10.0]))[0]
    np.testing.assert_allclose(T[:3, :3], [[0, -1, 0], [0, 0, -1], [1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(T[:3, 3], [0.0, 10.0, 100.0], atol=1e-12)
    np.testing.assert_array_equal(T[3], [0, 0, 0, 1])


def test_point_is_on_the_axis_and_camera_upright():
    """The point looked at lies on +z of every camera; the target's up has no part to the camera's right."""
    centres = arc_centres(np.linspace(0, 6, 25), 800.0, 0.4)
    point = np.array([70.0, 3.0, 16.0])
    T = look_at(centres, point)
    p = T[:, :3, :3] @ point + T[:, :3, 3]
    np.testing.assert_allclose(p[:, :2], 0.0, atol=1e-9)
    np.testing.assert_allclose(p[:, 2], np.linalg.norm(point - centres, axis=1))
    np.testing.assert_allclose(T[:, 0, 2], 0.0, atol=1e-12)
    assert (T[:, 1, 2] < 0).all()
    np.testing.assert_allclose(np.linalg.det(T[:, :3, :3]), 1.0)


def test_look_straight_down_is_refused():
    with pytest.raises(ValueError, match="straight above"):
        look_at(np.array([[5.0, 5.0, 100.0]]), np.array([5.0, 5.0, 0.0]))


def test_arc_is_symmetric_about_astern():
    """Mirrored in the ship's plane of symmetry, the arc is itself in reverse; its ends are the whole angle apart."""
    X0 = np.array([[0.0, -8.0, 0.0], [140.0, 8.0, 30.0]])
    T = ArcScenario(angle_deg=60.0, views=7).poses(X0)
    centres = -np.einsum("kji,kj->ki", T[:, :3, :3], T[:, :3, 3])
    np.testing.assert_allclose(centres * [1, -1, 1], centres[::-1], atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(centres, axis=1), 1000.0)
    ends = centres[[0, -1], :2] / np.linalg.norm(centres[[0, -1], :2], axis=1, keepdims=True)
    assert np.degrees(np.arccos(ends[0] @ ends[1])) == pytest.approx(60.0)


def test_orbit_speed():
    """52 m/s at 25 Hz: 2.08 m of arc per frame, on a circle of 1000 cos 15 m; starts astern and goes to port."""
    X0 = np.array([[0.0, -8.0, 0.0], [140.0, 8.0, 30.0]])
    T = OrbitScenario().poses(X0, np.arange(2000))
    centres = -np.einsum("kji,kj->ki", T[:, :3, :3], T[:, :3, 3])
    steps = np.linalg.norm(np.diff(centres, axis=0), axis=1)
    np.testing.assert_allclose(steps, 2.08, rtol=1e-6)
    np.testing.assert_allclose(centres[0], arc_centres(np.array([np.pi]), 1000.0, np.radians(15.0))[0], atol=1e-9)
    assert centres[1, 1] > 0.0
