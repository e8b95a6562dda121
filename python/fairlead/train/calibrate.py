# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Measure, fit on one half, judge on the other, write. docs/networks.md section 5."""

import csv
import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fairlead.io.documents import read_toml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields
from fairlead.io.network_card import Calibration
from fairlead.progress import ProgressFactory, silent
from fairlead.train.accuracy import draw_reliability, lines, markdown
from fairlead.train.alike import measured_design_effect
from fairlead.train.calibration import fit
from fairlead.train.checkpoint import load_lesson
from fairlead.train.findings import joined, look
from fairlead.train.pictures import is_sequence, open_pictures
from fairlead.types import Target

CALIBRATION = "calibration.toml"
HALF = 64
"""Pictures in a row that belong to the same half: crops of one block share their scene."""


def calibrate_network(
    checkpoint: Path,
    folders: Sequence[Path],
    output: Path,
    *,
    focal_px: float,
    target: Target,
    seed: int = 0,
    progress: ProgressFactory = silent,
) -> list[str]:
    """Write calibration.toml, accuracy.csv, accuracy.md and reliability.png; returns lines for people.

    Fitted on one half of the crops; tables and figure show the other half, sequences, and folders of few crops. Raises
    InputError.
    """
    lesson = load_lesson(checkpoint)
    if lesson.landmarks != target.landmarks:
        raise InputError(checkpoint, f"knows other landmarks than {target.name}; expected the --target of its crops")
    opened = [open_pictures(folder, lesson.landmarks, lesson.size, seed) for folder in folders]
    with progress("pictures", lambda: sum(count for count, _ in opened)) as advance:
        findings = joined([
            look(lesson, pictures, condition=k, focal_px=focal_px, positions=target.positions, advance=advance)
            for k, (_, pictures) in enumerate(opened)
        ])  # fmt: skip
    crops = np.array(
        [count >= 2 * HALF and not is_sequence(folder) for folder, (count, _) in zip(folders, opened, strict=True)]
    )
    fitted = crops[findings.condition] & ((findings.picture // HALF) % 2 == 0)
    if not (findings.visibility[fitted] == 2).any() or not (findings.visibility[~fitted] == 2).any():
        raise InputError(folders[0], f"expected crops, at least {2 * HALF}, to calibrate with")
    n, judged = len(lesson.landmarks), findings.where(~fitted)
    calibration = fit(findings.where(fitted), n)
    alike = measured_design_effect(findings.where(fitted), calibration, n)
    if np.isfinite(alike):
        calibration = dataclasses.replace(calibration, design_effect=alike)
    table = lines(judged, calibration, lesson.landmarks, [folder.name for folder in folders])
    output.mkdir(parents=True, exist_ok=True)
    write_calibration(output / CALIBRATION, calibration)
    with (output / "accuracy.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, [each.name for each in dataclasses.fields(table[0])])
        writer.writeheader()
        writer.writerows(dataclasses.asdict(line) for line in table)
    (output / "accuracy.md").write_text(markdown(table), encoding="utf-8")
    draw_reliability(output / "reliability.png", judged, calibration, lesson.landmarks)
    whole = table[0]
    empty = judged.where(np.isnan(judged.range_m))
    called = float(np.mean(empty.visible > calibration.visible_threshold)) if len(empty.visible) else float("nan")
    return [
        f"visible landmarks: median {whole.median_px:.2f} px, mean {whole.mean_px:.2f} px of the flight's image",
        f"NEES {whole.nees:.2f}, {whole.inside_50:.0%} in the 50 % ellipse, {whole.inside_99:.1%} in the 99 % ellipse",
        f"design effect {alike:.2f}; of what it was not fitted to {measured_design_effect(judged, calibration, n):.2f}",
        f"pictures without the target: {called:.2%} of the landmarks are called visible",
        str(output / CALIBRATION),
    ]


def write_calibration(path: Path, calibration: Calibration) -> None:
    """As TOML, six digits."""
    scale = ", ".join(f"{value:.6g}" for value in calibration.scale)
    text = f"visible_threshold = {calibration.visible_threshold:.6g}\nfloor_px = {calibration.floor_px:.6g}\n"
    text += f"scale = [{scale}]\ndesign_effect = {calibration.design_effect:.6g}\n"
    if calibration.tail_dof is not None:
        text += f"tail_dof = {calibration.tail_dof:.6g}\n"
    path.write_text(text, encoding="utf-8")


def read_calibration(path: Path, landmarks: int) -> Calibration:
    """What `write_calibration` wrote. Raises InputError."""
    fields = Fields(read_toml(path), ("visible_threshold", "floor_px", "scale", "tail_dof", "design_effect"), path)
    scale = tuple(fields.numbers("scale", landmarks))
    if min(scale) <= 0.0:
        raise fields.error("scale", "expected numbers above 0")
    return Calibration(
        visible_threshold=fields.number("visible_threshold"),
        floor_px=fields.number("floor_px", minimum=0.0),
        scale=scale,
        design_effect=fields.number("design_effect", minimum=1.0),
        tail_dof=fields.number("tail_dof", minimum=0.1) if "tail_dof" in fields else None,
    )
