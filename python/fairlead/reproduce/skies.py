# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The same flight under every weather, rendered where it is not there yet: docs/reproduce.md section 10."""

from pathlib import Path

from fairlead.progress import ProgressFactory
from fairlead.render.command import render
from fairlead.render.weather import Kind

CLEAR = "clear"
KINDS: tuple[Kind, ...] = ("fog", "rain", "snow", "glare", "night")
STRENGTHS = (0.2, 0.4, 0.7)
FLIGHT, STRIDE = "rendezvous-20", 60
"""A picture every 2.4 s."""


def names() -> dict[str, tuple[Kind | None, float]]:
    """Folder -> kind and strength."""
    skies: list[tuple[Kind | None, float]] = [(None, 0.0), *((kind, s) for kind in KINDS for s in STRENGTHS)]
    return {f"{kind or CLEAR}-{strength:g}": (kind, strength) for kind, strength in skies}


def render_skies(folder: Path, progress: ProgressFactory) -> None:
    """Fill the folder by the fast renderer; pictures that are there stay, and so does a folder of somebody else's.

    Raises RenderError where this machine has no renderer.
    """
    there = {each.parent.name for each in folder.glob("*/truth.csv")}
    if there - set(names()):
        return
    for name, (kind, strength) in names().items():
        if not (folder / name / "scene_gt.json").is_file():  # written when all pictures are there
            render(
                FLIGHT,
                folder / name,
                quality="draft",
                stride=STRIDE,
                weather=kind,
                strength=strength,
                progress=progress,
            )
