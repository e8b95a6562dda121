# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Is the covariance honest, is the bound reached, and is EPnP beaten, on a seeded part of the accuracy grid?

The bands of the first test come from statistics alone. 100 flights of 60 landmark coordinates are 6,000 degrees of
freedom if the posterior is Gaussian; it is nearly so at a model error of 0.1 m. The views of a flight share the error
of the model, so its pose NEES is judged as if all of them had one error: 6 degrees of freedom a flight, the widest
band that can be right. Where a metre of model error bends the posterior, the demands of the whole study hold instead:
NEES per degree of freedom in 0.8 to 1.25, rms within 1.15 of the bound, plus three standard errors of 40 flights.
"""

import pytest
from scipy.stats import chi2

from benchmarks.cells import Cell, run_cell
from benchmarks.verdicts import BOUND_RATIO, ERRORS, NEES_BAND, failures, normalised_nees, paired, rms_ratio

pytestmark = pytest.mark.slow


def band(dof: int, flights: int) -> tuple[float, float]:
    """Where the mean NEES per degree of freedom lies with probability 99.9 %."""
    low, high = chi2.ppf([0.0005, 0.9995], dof * flights) / (dof * flights)
    return float(low), float(high)


@pytest.mark.parametrize("angle", [30.0, 90.0])
def test_covariance_is_true_where_the_posterior_is_gaussian(angle):
    flights = 100
    cell = Cell(sigma_px=1.0, angle_deg=angle, model_sigma_m=0.1)
    scores = run_cell(cell, "clean", flights, ["map"])["map"]
    assert failures(scores) == 0.0
    low, high = band(60, flights)
    assert low < normalised_nees(scores, "landmark_nees")[0] < high
    low, high = band(6, flights)
    assert low < normalised_nees(scores, "pose_nees")[0] < high


@pytest.mark.parametrize(
    "cell",
    [
        Cell(sigma_px=0.25, angle_deg=30.0, model_sigma_m=1.0),
        Cell(sigma_px=1.0, angle_deg=5.0, model_sigma_m=1.0),
        Cell(sigma_px=1.0, angle_deg=90.0, model_sigma_m=3.0),
        Cell(sigma_px=4.0, angle_deg=180.0, model_sigma_m=1.0),
    ],
    ids=lambda cell: cell.name,
)
def test_bound_and_nees(cell):
    scores = run_cell(cell, "clean", 40, ["bound", "map"])
    ours = scores["map"]
    assert failures(ours) == 0.0
    for key in ERRORS:
        ratio, error = rms_ratio(ours, scores["bound"], key)
        assert ratio - 3 * error <= BOUND_RATIO, key
    for key in ("pose_nees", "landmark_nees"):
        value, error = normalised_nees(ours, key)
        assert NEES_BAND[0] - 3 * error <= value <= NEES_BAND[1] + 3 * error, key


@pytest.mark.parametrize(
    ("data", "cell"),
    [
        ("clean", Cell(sigma_px=0.25, angle_deg=5.0, model_sigma_m=0.5)),
        ("clean", Cell(sigma_px=8.0, angle_deg=90.0, model_sigma_m=0.1)),
        ("outliers-30", Cell(sigma_px=1.0, angle_deg=90.0, model_sigma_m=1.0)),
    ],
    ids=lambda value: value if isinstance(value, str) else value.name,
)
def test_never_worse_than_the_baselines(data, cell):
    """Flight by flight, within the Monte Carlo error; the clean cells are where least is to be gained."""
    scores = run_cell(cell, data, 16, ["epnp", "window", "map"])
    for key in ERRORS:
        assert paired(scores["map"], scores["epnp"], key).not_worse, key
        assert paired(scores["map"], scores["window"], key).not_worse, key
