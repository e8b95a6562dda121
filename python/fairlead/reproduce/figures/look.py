# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Colours and lines of the methods and networks."""

from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fairlead.evaluate.figures.style import COLOURS, INK, OTHERS
from fairlead.reproduce.methods import BATCH, BOUND, EPNP, LABELS, ONLINE, TRUE, WINDOW

TRUTH = "#f2d21f"
"""Of truth laid over an image, as in the publication."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Of a line."""

    colour: str
    dashes: Any = "-"
    width: float = 1.3


LOOKS = {
    EPNP: Look(colour=COLOURS["epnp"], width=1.0),
    WINDOW: Look(colour=COLOURS["window"]),
    ONLINE: Look(colour=COLOURS["map"], width=1.7),
    BATCH: Look(colour=COLOURS["refine"], width=1.7),
    TRUE: Look(colour=INK, dashes=(0, (1, 1.5)), width=1.1),
    BOUND: Look(colour=COLOURS["bound"], dashes=(0, (4, 2)), width=1.2),
}


def network_colour(index: int) -> str:
    """Of the networks, in their order; none of a method's."""
    return OTHERS[index % len(OTHERS)]


def legend(figure: Figure, methods: tuple[str, ...]) -> None:
    """One line above all panels."""
    handles: list[Line2D] = []
    for method in methods:
        look = LOOKS[method]
        dashes: Any = look.dashes
        handles.append(Line2D([], [], color=look.colour, ls=dashes, lw=look.width, label=LABELS[method]))
    figure.legend(handles=handles, loc="outside upper left", ncols=4 if len(methods) > 6 else 6, columnspacing=1.4)
