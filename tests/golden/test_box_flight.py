# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Did the numbers move? A small flight, its poses as recorded; `pytest --update-golden` accepts new ones."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from fairlead.geometry import difference
from fairlead.io.poses import read_poses
from tests.regression.conftest import make_flight

FOLDER = Path(__file__).parent / "box_flight"
TOLERANCE = 1e-6
"""Of poses [m, rad] and, relatively, of covariances: more than a compiler's freedom, less than any changed rule."""


@pytest.mark.parametrize("verb", ["track", "refine"])
def test_poses_are_as_recorded(
    verb: str, tmp_path: Path, update_golden: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    flight = make_flight(tmp_path, 20)
    assert flight.run(verb) == 0
    recorded = FOLDER / f"{verb}.csv"
    now = read_poses(flight.out / "poses.csv")
    before = read_poses(recorded) if recorded.exists() else []
    moved = [
        float(np.abs(difference(old.T_camera_target, new.T_camera_target)).max())
        for old, new in zip(before, now, strict=False)
    ]
    if update_golden:
        with capsys.disabled():
            for old, new, change in zip(before, now, moved, strict=False):
                pixels = f"{old.reprojection_rms_px:.6f} -> {new.reprojection_rms_px:.6f} px"
                inliers = f"{old.n_inliers} -> {new.n_inliers} inliers"
                sys.stdout.write(f"{verb} frame {new.frame}: moved {change:.2e}, {inliers}, {pixels}\n")
        FOLDER.mkdir(exist_ok=True)
        shutil.copy(flight.out / "poses.csv", recorded)
        return
    assert [(each.status, each.reason, each.n_inliers) for each in now] == [
        (each.status, each.reason, each.n_inliers) for each in before
    ]
    assert max(moved) < TOLERANCE
    for old, new in zip(before, now, strict=True):
        assert np.allclose(old.covariance, new.covariance, rtol=TOLERANCE, atol=TOLERANCE * old.covariance.max())
