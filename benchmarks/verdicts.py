# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the scores of one cell say: paired comparison with the baselines, rms against the bound, NEES, failures."""

from dataclasses import dataclass

import numpy as np

Table = dict[str, np.ndarray]
ERRORS = ("rotation_deg", "translation_m", "landmark_m")
NO_ANSWER = {"rotation_deg": 180.0, "translation_m": 1000.0, "landmark_m": np.nan}
"""What a view without a pose counts as in the means of `map`: knowing nothing. Views where a baseline has no pose are
left out of its means and of the comparison with it, which favours the baseline."""
Z999 = 3.29
"""Two-sided 99.9 % point of the normal distribution."""
BOUND_RATIO = 1.15
NEES_BAND = (0.8, 1.25)


@dataclass(frozen=True, kw_only=True)
class Paired:
    """Mean of one error of `map` and of a baseline over the same runs."""

    ours: float
    theirs: float
    difference: float
    standard_error: float

    @property
    def not_worse(self) -> bool:
        """Ours <= theirs within the Monte Carlo error (99.9 %)."""
        return self.difference <= Z999 * self.standard_error

    @property
    def clearly_better(self) -> bool:
        """Ours < theirs beyond the Monte Carlo error (99.9 %)."""
        return self.difference < -Z999 * self.standard_error


def per_run(scores: Table, key: str) -> np.ndarray:
    """Mean over views (or landmarks) of each run, with views that have no pose counted as NO_ANSWER."""
    return np.where(np.isnan(scores[key]), NO_ANSWER[key], scores[key]).astype(float).mean(axis=1)


def paired(ours: Table, theirs: Table, key: str) -> Paired:
    """Compare run by run over the views where the baseline has a pose."""
    a = np.where(np.isnan(ours[key]), NO_ANSWER[key], ours[key]).astype(float)
    b = theirs[key].astype(float)
    use = np.isfinite(b)
    runs = use.any(axis=1)
    count = np.maximum(use.sum(axis=1), 1)
    mean_a = (np.where(use, a, 0.0).sum(axis=1) / count)[runs]
    mean_b = (np.where(use, b, 0.0).sum(axis=1) / count)[runs]
    d = mean_a - mean_b
    return Paired(
        ours=float(mean_a.mean()),
        theirs=float(mean_b.mean()),
        difference=float(d.mean()),
        standard_error=float(d.std(ddof=1) / np.sqrt(len(d))),
    )


def rms_ratio(scores: Table, bound: Table, key: str) -> tuple[float, float]:
    """sqrt(sum of squares / sum of bounds) over all runs and views, and its standard error, docs/bound.md eq. (16)."""
    a = (np.where(np.isnan(scores[key]), NO_ANSWER[key], scores[key]).astype(float) ** 2).mean(axis=1)
    b = (bound[key].astype(float) ** 2).mean(axis=1)
    ratio = float(a.mean() / b.mean())
    spread = (a - ratio * b) / b.mean()
    return float(np.sqrt(ratio)), float(0.5 / np.sqrt(ratio) * spread.std(ddof=1) / np.sqrt(len(a)))


def normalised_nees(scores: Table, key: str) -> tuple[float, float]:
    """Mean NEES per degree of freedom over all runs (and views that have a pose), and its standard error."""
    dof = 6 if key == "pose_nees" else 3 * scores["landmark_m"].shape[1]
    values = scores[key].astype(float)
    values = values[np.isfinite(values).any(axis=1)]
    if not len(values):
        return float("nan"), float("nan")
    each = np.nanmean(values, axis=1) / dof
    return float(each.mean()), float(each.std(ddof=1) / np.sqrt(len(each)))


def failures(scores: Table) -> float:
    """Share of views without a pose."""
    return float(np.isnan(scores["rotation_deg"]).mean())


def summarise(
    name: str, ours: Table, baselines: dict[str, Table], bound: Table, *, judge_bound: bool
) -> dict[str, object]:
    """One line of the table, with `misses`: which demands this cell does not meet."""
    line: dict[str, object] = {"method": name}
    misses: list[str] = []
    for key in ERRORS:
        line[key] = float(per_run(ours, key).mean())
        for other, theirs in baselines.items():
            pair = paired(ours, theirs, key)
            line[f"{other}_{key}"] = pair.theirs
            line[f"{other}_{key}_difference"] = pair.difference
            line[f"{other}_{key}_error"] = pair.standard_error
            if not pair.not_worse:
                misses.append(f"{key}>{other}")
        line[f"{key}_bound_ratio"], line[f"{key}_bound_ratio_error"] = rms_ratio(ours, bound, key)
        if judge_bound and line[f"{key}_bound_ratio"] > BOUND_RATIO:  # type: ignore[operator]
            misses.append(f"{key}_bound")
    for key in ("pose_nees", "landmark_nees"):
        value, error = normalised_nees(ours, key)
        line[key], line[f"{key}_error"] = value, error
        if judge_bound and not NEES_BAND[0] <= value <= NEES_BAND[1]:
            misses.append(key)
    line["failures"] = failures(ours)
    for other, theirs in baselines.items():
        line[f"{other}_failures"] = failures(theirs)
    line["milliseconds"] = 1e3 * float(np.median(ours["seconds"]))
    line["misses"] = " ".join(misses)
    return line
