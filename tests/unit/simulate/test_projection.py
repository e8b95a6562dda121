# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fairlead.geometry import exp_se3, project, transform
from fairlead.simulate import project_all


@given(st.integers(0, 100_000), st.sampled_from(["plumb_bob", "pinhole", "rational_polynomial"]))
def test_without_distortion_the_short_way_gives_the_same_bits(ship, seed, model):
    """Points in front of, at and behind the camera, some of them not finite."""
    camera = replace(ship[1], model=model, distortion=np.zeros({"plumb_bob": 5, "pinhole": 0}.get(model, 8)))
    rng = np.random.default_rng(seed)
    X = rng.normal(0.0, 10.0, (12, 3))
    X[0, 1] = np.nan
    T = np.stack([exp_se3(np.concatenate([rng.normal(0, 8, 3), rng.normal(0, 1, 3)])) for _ in range(3)])
    expected = np.stack(
        [project(camera, each) for each in np.einsum("kij,nj->kni", T[:, :3, :3], X) + T[:, None, :3, 3]]
    )
    np.testing.assert_array_equal(project_all(camera, X, T), expected)


def test_distortion_is_not_left_out(ship):
    camera = replace(ship[1], distortion=np.array([-0.3, 0.1, 0.001, -0.002, 0.0]))
    X, T = np.array([[1.0, 2.0, 0.0], [3.0, -1.0, 1.0]]), exp_se3(np.array([0.0, 0, 10, 0, 0, 0]))
    np.testing.assert_array_equal(project_all(camera, X, T[None])[0], project(camera, transform(T, X)))
