# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import pytest

from benchmarks.metrics import Metric, compare, load_baseline, save_baseline

BASE = Metric(key="accuracy/a", value=10.0, unit="m", better="lower", tolerance=0.02)


def judged(value: float, better: str) -> list[str]:
    baseline = replace(BASE, better=better)
    return compare([replace(baseline, value=value)], {baseline.key: baseline})


@pytest.mark.parametrize(
    ("better", "value", "fine"),
    [
        ("lower", 10.19, True),
        ("lower", 10.21, False),
        ("lower", 1.0, True),
        ("higher", 9.81, True),
        ("higher", 9.79, False),
        ("higher", 99.0, True),
        ("same", 10.19, True),
        ("same", 10.21, False),
        ("same", 9.79, False),
    ],
)
def test_direction_and_tolerance(better, value, fine):
    assert (judged(value, better) == []) is fine


def test_baseline_decides_not_the_measurement():
    """A looser tolerance or another direction in the code does not help."""
    loose = replace(BASE, value=20.0, better="higher", tolerance=5.0)
    assert compare([loose], {BASE.key: BASE}) == ["accuracy/a: 10 -> 20 m (allowed 0.2)"]


def test_missing_and_new_numbers_are_told():
    other = replace(BASE, key="accuracy/b")
    lines = compare([other], {BASE.key: BASE})
    assert lines == ["accuracy/a: in the baseline, no longer measured", "accuracy/b: measured, not in the baseline"]


def test_file_round_trip(tmp_path):
    other = replace(BASE, key="accuracy/0", value=1 / 3)
    save_baseline([BASE, other], tmp_path / "baseline.json")
    assert load_baseline(tmp_path / "baseline.json") == {other.key: other, BASE.key: BASE}
    assert (tmp_path / "baseline.json").read_text().splitlines()[1].startswith('{"key": "accuracy/0"')


def test_impossible_metric_is_refused():
    with pytest.raises(ValueError, match="better"):
        replace(BASE, better="nearer")
    with pytest.raises(ValueError, match="number"):
        replace(BASE, value=float("nan"))
