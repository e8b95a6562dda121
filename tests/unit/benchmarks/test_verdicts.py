# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from benchmarks.verdicts import failures, normalised_nees, paired, per_run, rms_ratio


def table(rotation, nees=1.0):
    rotation = np.array(rotation, dtype=float)
    return {
        "rotation_deg": rotation,
        "pose_nees": np.where(np.isnan(rotation), np.nan, nees),
        "landmark_m": np.ones((len(rotation), 20)),
        "landmark_nees": np.full((len(rotation), 1), 66.0),
    }


def test_paired_by_hand():
    """Differences -1 and +2 of two runs: mean 0.5, standard deviation 3 / sqrt 2, standard error 1.5."""
    pair = paired(table([[1.0, 1.0], [4.0, 4.0]]), table([[2.0, 2.0], [2.0, 2.0]]), "rotation_deg")
    assert (pair.ours, pair.theirs, pair.difference) == (2.5, 2.0, 0.5)
    assert pair.standard_error == pytest.approx(1.5)
    assert pair.not_worse
    assert not pair.clearly_better


def test_clear_loss_is_seen():
    rng = np.random.default_rng(0)
    theirs = 1.0 + 0.01 * rng.normal(size=(50, 2))
    assert not paired(table(theirs + 0.05), table(theirs), "rotation_deg").not_worse
    assert paired(table(theirs - 0.05), table(theirs), "rotation_deg").clearly_better


def test_our_failure_counts_and_theirs_does_not():
    """A view without our pose is 180 degrees; a view without theirs is left out on both sides."""
    nan = float("nan")
    pair = paired(table([[1.0, nan], [9.0, 1.0]]), table([[1.0, 1.0], [nan, 1.0]]), "rotation_deg")
    assert pair.ours == pytest.approx(0.5 * (0.5 * 181 + 1))
    assert pair.theirs == 1.0
    np.testing.assert_allclose(per_run(table([[1.0, nan]]), "rotation_deg"), [90.5])
    assert failures(table([[1.0, nan], [1.0, 1.0]])) == 0.25


def test_rms_ratio_by_hand():
    """Squares 1 and 9 against bounds 2 and 3: sqrt(10 / 5)."""
    ratio, error = rms_ratio(table([[1.0], [3.0]]), {"rotation_deg": np.sqrt([[2.0], [3.0]])}, "rotation_deg")
    assert ratio == pytest.approx(np.sqrt(2.0))
    assert error > 0


def test_nees_by_hand():
    """12 and 6 over 6 degrees of freedom: 1.5; 66 over 60: 1.1."""
    scores = table([[1.0], [1.0]]) | {"pose_nees": np.array([[12.0], [6.0]])}
    value, error = normalised_nees(scores, "pose_nees")
    assert value == pytest.approx(1.5)
    assert error == pytest.approx(0.5)
    assert normalised_nees(scores, "landmark_nees")[0] == pytest.approx(1.1)
