# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables and figures of what a network found: by condition, range, aspect and landmark. docs/networks.md section 5."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from fairlead.design_effect import GATE
from fairlead.io.network_card import Calibration
from fairlead.train.calibration import nees, squared
from fairlead.train.findings import Findings

RANGES_M = (0.0, 350.0, 700.0, 1400.0, 2500.0, np.inf)
ASPECTS = (("ahead", 0.0, 30.0), ("bow", 30.0, 75.0), ("beam", 75.0, 105.0), ("quarter", 105.0, 150.0),
           ("astern", 150.0, 180.1))  # fmt: skip
"""Angle between the target's x axis and the direction to the camera, level [deg]."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """Of the landmarks that are visible, and of those that a tracker would be told of."""

    group: str
    name: str
    visible: int
    median_px: float
    """Of the flight's image; all visible landmarks, found or not."""
    mean_px: float
    median_crop_px: float
    mean_crop_px: float
    told: float
    """Share of the visible landmarks that are called visible [-]."""
    false: float
    """Share of those called visible that are outside the crop [-]."""
    nees: float
    """Mean of min(e^T S^-1 e, 18.42) / 2 of those called visible."""
    gross: float
    """Share of them beyond 18.42 [-]; of Gaussian errors 0.01 %."""
    inside_50: float
    """Share of them within the ellipse that should hold half."""
    inside_99: float


def lines(findings: Findings, calibration: Calibration, landmarks: Sequence[str], folders: Sequence[str]) -> list[Line]:
    """Every grouping, with the whole first."""
    return [
        _line(group, name, findings.where(mask), calibration, len(landmarks))
        for group, name, mask in _groups(findings, landmarks, folders)
        if (findings.visibility[mask] == 2).any()
    ]


def _groups(f: Findings, landmarks: Sequence[str], folders: Sequence[str]) -> Iterator[tuple[str, str, np.ndarray]]:
    yield "all", "", np.ones(len(f.landmark), bool)
    for k, folder in enumerate(folders):
        yield "condition", folder, f.condition == k
    for low, high in pairwise(RANGES_M):
        name = f"{low:g} to {high:g} m" if np.isfinite(high) else f"beyond {low:g} m"
        yield "range", name, (f.range_m >= low) & (f.range_m < high)
    for name, low, high in ASPECTS:
        aspect = np.abs(f.azimuth_deg)
        yield "aspect", name, (aspect >= low) & (aspect < high)
    for k, name in enumerate(landmarks):
        yield "landmark", name, f.landmark == k


def _line(group: str, name: str, f: Findings, calibration: Calibration, landmarks: int) -> Line:
    seen, called = f.visibility == 2, f.visible > calibration.visible_threshold
    distance = f.distance
    told = called & (f.visibility > 0)
    s = squared(f.where(told), calibration, landmarks)
    return Line(
        group=group,
        name=name,
        visible=int(seen.sum()),
        median_px=float(np.median((distance * f.unit)[seen])),
        mean_px=float(np.mean((distance * f.unit)[seen])),
        median_crop_px=float(np.median(distance[seen])),
        mean_crop_px=float(np.mean(distance[seen])),
        told=float(np.mean(called[seen])),
        false=float(np.mean((f.visibility == 0)[called])) if called.any() else 0.0,
        nees=float(np.mean(nees(s))) if len(s) else float("nan"),
        gross=float(np.mean(s > GATE)) if len(s) else float("nan"),
        inside_50=float(np.mean(s < 2.0 * np.log(2.0))) if len(s) else float("nan"),
        inside_99=float(np.mean(s < 2.0 * np.log(100.0))) if len(s) else float("nan"),
    )


HEADINGS = ("", "visible", "median px", "mean px", "median crop px", "mean crop px", "told", "false", "NEES",
            "gross", "in 50 %", "in 99 %")  # fmt: skip


def markdown(table: Sequence[Line]) -> str:
    """One table a group."""
    texts: list[str] = []
    for group in dict.fromkeys(line.group for line in table):
        texts.append(f"\n| {group} {' | '.join(HEADINGS)} |\n|{'---|' * len(HEADINGS)}\n")
        for line in (each for each in table if each.group == group):
            numbers = (line.median_px, line.mean_px, line.median_crop_px, line.mean_crop_px)
            shares = (line.told, line.false, line.nees, line.gross, line.inside_50, line.inside_99)
            cells = [f"{value:.2f}" for value in numbers] + [f"{value:.3f}" for value in shares]
            texts.append(f"| {line.name} | {line.visible} | {' | '.join(cells)} |\n")
    return "".join(texts).lstrip("\n")


def draw_reliability(path: Path, findings: Findings, calibration: Calibration, landmarks: Sequence[str]) -> None:
    """What share of the errors lies within the ellipse that should hold so many; NEES of every landmark."""
    from matplotlib.figure import Figure

    rows = findings.where((findings.visible > calibration.visible_threshold) & (findings.visibility > 0))
    told = np.linspace(0.01, 0.995, 100)
    raw = Calibration(visible_threshold=calibration.visible_threshold)
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.3))
    left.plot([0, 1], [0, 1], color="0.7", linewidth=1.0)
    for name, each in (("as the network says", raw), ("calibrated", calibration)):
        s = squared(rows, each, len(landmarks))
        left.plot(told, [np.mean(s < -2.0 * np.log1p(-p)) for p in told], label=name)
    if calibration.tail_dof is not None:
        nu, s = calibration.tail_dof, squared(rows, calibration, len(landmarks))
        # Bivariate t: the share within s is 1 - (1 + s / (nu - 2))^(-nu / 2).
        bound = (nu - 2.0) * ((1.0 - told) ** (-2.0 / nu) - 1.0)
        left.plot(told, [np.mean(s < b) for b in bound], label=f"calibrated, Student t of {nu:g}", linestyle="--")
    left.set_xlabel("should lie inside [-]")
    left.set_ylabel("lie inside [-]")
    left.legend(fontsize=8)
    values = nees(squared(rows, calibration, len(landmarks)))
    means = [np.mean(values[rows.landmark == k]) if (rows.landmark == k).any() else 0.0 for k in range(len(landmarks))]
    right.bar(range(len(landmarks)), means, color="tab:blue")
    right.axhspan(0.8, 1.25, color="tab:green", alpha=0.15)
    right.set_xticks(range(len(landmarks)), landmarks, rotation=60, ha="right", fontsize=8)
    right.set_ylabel("mean NEES / 2 [-]")
    figure.savefig(path, dpi=110)
