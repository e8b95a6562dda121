# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What can be seen: against a ray caster written another way, and by hand."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from fairlead.raycast import CHUNK, hidden, load_triangles
from fairlead.simulate import Dropout, Occlusion
from fairlead.simulate.outages import draw_outages, first_of_run
from fairlead.simulate.streams import Streams


def crosses(triangle, start, end, clear):
    """Whether the segment meets the plane within the triangle's three edge planes, further than `clear` from start."""
    a, b, c = triangle
    normal = np.cross(b - a, c - a)
    before, after = normal @ (start - a), normal @ (end - a)
    if before * after > 0.0 or before == after:
        return False
    share = before / (before - after)
    meeting = start + share * (end - start)
    inside = all(normal @ np.cross(q - p, meeting - p) >= 0.0 for p, q in ((a, b), (b, c), (c, a)))
    return inside and share * np.linalg.norm(end - start) > clear


@given(st.integers(0, 100_000))
def test_every_ray_against_every_triangle(seed):
    """Random soups of triangles, points and cameras: the same answer as one segment and one triangle at a time."""
    rng = np.random.default_rng(seed)
    triangles = rng.normal(0.0, 5.0, (8, 1, 3)) + rng.normal(0.0, 3.0, (8, 3, 3))
    point, centres = rng.normal(0.0, 5.0, 3), rng.normal(0.0, 20.0, (6, 3))
    expected = [any(crosses(t, point, c, 0.5) for t in triangles) for c in centres]
    assert hidden(triangles, point, centres, 0.5).tolist() == expected


def test_a_box_hides_its_far_corners(tmp_path, ship):
    """A cube of 2 m; a camera on +x sees the four corners there, one at (5, 5, 5) all but the one opposite."""
    mesh = tmp_path / "cube.ply"
    trimesh.creation.box((2.0, 2.0, 2.0)).export(mesh)
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    names = tuple("abcdefgh")
    box = replace(
        ship[0], landmarks=names, positions=corners, covariance=np.eye(24), mesh=mesh, touchdown=None, distances=()
    )
    centres = np.array([[50.0, 0.3, 0.2], [5.0, 5.1, 5.2]])
    seen = Occlusion(kind="mesh", tolerance_m=1e-6).visible(box, {}, centres)
    assert seen[0].tolist() == [False] * 4 + [True] * 4
    assert seen[1].tolist() == [False] + [True] * 7
    np.testing.assert_array_equal(Occlusion(kind="mesh").visible(box, {}, centres), seen)
    assert Occlusion(kind="mesh", tolerance_m=4.0).visible(box, {}, centres).all()
    assert Occlusion().visible(box, {}, centres).all()


def test_what_lies_behind_the_camera_or_the_landmark_hides_nothing():
    """A wall at x = 5: a camera at x = 10 is hidden from the origin, one at x = 4 or on the other side is not."""
    wall = np.array([[[5.0, -9.0, -9.0], [5.0, 9.0, -9.0], [5.0, 0.0, 9.0]]])
    centres = np.array([[10.0, 0.1, 0.2], [4.0, 0.1, 0.2], [-10.0, 0.1, 0.2]])
    for triangles in (wall, wall[:, ::-1]):
        assert hidden(triangles, np.zeros(3), centres, 0.0).tolist() == [True, False, False]


def test_many_cameras_are_tried_in_turns():
    """More rays times triangles than are tried at once."""
    rng = np.random.default_rng(2)
    triangles = np.concatenate(
        [np.array([[[1.0, -1, -1], [1, 3, -1], [1, -1, 3]]]), rng.normal(-50, 1.0, (2000, 3, 3))]
    )
    centres = np.column_stack([np.full(1500, 2.0), np.linspace(-4.0, 4.0, 1500), np.zeros(1500)])
    assert len(centres) > 2 * CHUNK
    middle = 0.5 * centres[:, 1]
    np.testing.assert_array_equal(hidden(triangles, np.zeros(3), centres, 0.0), (middle >= -1.0) & (middle <= 2.0))


def test_normals_by_hand(ship):
    """A landmark that faces aft is seen from astern, edge on at 90 degrees, and not from ahead; others always are."""
    target = ship[0]
    j = target.landmarks.index("hangar_base")
    X = target.positions[j]
    rays = np.array([[-1.0, 0, 0], [0, 1.0, 0], [1e-3, 1.0, 0], [1.0, 0, 0]])
    seen = Occlusion(kind="normals").visible(target, {"hangar_base": (-2.0, 0.0, 0.0)}, X + 500.0 * rays)
    assert seen[:, j].tolist() == [True, True, False, False]
    assert np.delete(seen, j, axis=1).all()
    wide = Occlusion(kind="normals", max_incidence_deg=180.0)
    assert wide.visible(target, {"hangar_base": (-2.0, 0.0, 0.0)}, X + 500.0 * rays).all()


@given(st.floats(0.05, 0.95), st.floats(0.2, 3.0), st.integers(0, 1000))
def test_outages_have_their_share_and_their_length(share, mean_s, seed):
    """300 chains over 60 s: the share and the chance to stay out within 6 standard errors.

    A chain has about 60 share (1 - share) / mean_s independent pieces; the first image has the share, too.
    """
    t = np.arange(0.0, 60.0, 0.05)
    out = draw_outages(t, 300, share, mean_s, np.random.default_rng(seed))
    correlation_s = mean_s * (1.0 - share)
    pieces = 300 * 60.0 / (2 * correlation_s + 0.05)
    assert out.mean() == pytest.approx(share, abs=6 * np.sqrt(share * (1 - share) / pieces))
    assert out[0].mean() == pytest.approx(share, abs=6 * np.sqrt(share * (1 - share) / 300))
    # one step of the chain: an outage ends with rate 1 / mean_s
    kept = out[1:][out[:-1]].mean()
    expected = share + (1 - share) * np.exp(-0.05 / correlation_s)
    assert kept == pytest.approx(expected, abs=6 * np.sqrt(expected * (1 - expected) / out.sum()) + 1e-6)


def test_more_dropout_contains_less():
    few, many = (draw_outages(np.arange(50.0), 20, s, 0.0, np.random.default_rng(1)) for s in (0.1, 0.4))
    assert (many | ~few).all()
    assert many.sum() > few.sum()


def test_what_is_held_begins_where_it_began():
    states = np.array([[True], [True], [False], [True], [True], [True]])
    assert first_of_run(states, held=True)[:, 0].tolist() == [0, 0, 2, 3, 3, 3]
    assert first_of_run(states, held=False)[:, 0].tolist() == list(range(6))


def test_a_blackout_takes_all_and_ends():
    missed = Dropout(blackout_s=((1.0, 2.0),)).missed(np.arange(0.0, 4.0, 0.5), 3, Streams(1))
    assert missed.all(axis=1).tolist() == [False, False, True, True, True, False, False, False]
    assert Dropout().missed(np.arange(3.0), 3, Streams(1)) is None


def test_a_broken_mesh_is_one_line(tmp_path):
    path = tmp_path / "broken.ply"
    path.write_bytes(b"ply\nformat ascii 1.0\n")
    with pytest.raises(ValueError, match=r"broken\.ply"):
        load_triangles(path)
