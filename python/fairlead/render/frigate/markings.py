# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Paint: flight deck with its landing circle, and the pendant number on bow and quarter."""

import numpy as np

from fairlead.render.frigate.hull import DECK, hull_point, station
from fairlead.render.modelling import Modeller

LINE = DECK + 0.04
"""Height of painted lines, as thick as the landmark `helo_spot` wants them [m]."""

_SEGMENTS = {
    "a": (0.0, 0.84, 0.6, 1.0),
    "b": (0.44, 0.5, 0.6, 1.0),
    "c": (0.44, 0.0, 0.6, 0.5),
    "d": (0.0, 0.0, 0.6, 0.16),
    "e": (0.0, 0.0, 0.16, 0.5),
    "f": (0.0, 0.5, 0.16, 1.0),
    "g": (0.0, 0.42, 0.6, 0.58),
}
_CHARACTERS: dict[str, str] = dict(
    (
        *(("0", "abcdef"), ("1", "bc"), ("2", "abged"), ("3", "abgcd"), ("4", "fgbc"), ("5", "afgcd")),
        *(("6", "afgedc"), ("7", "abc"), ("8", "abcdefg"), ("9", "abcdfg"), ("F", "aefg")),
    )
)


def add_flight_deck(modeller: Modeller) -> None:
    """Dark anti-slip paint, lines, and the circle round `helo_spot`."""
    m = modeller
    spot = 13.83
    paint = DECK + 0.02
    m.patch("flight", [(1.0, -7.0, paint), (26.4, -7.4, paint), (26.4, 7.4, paint), (1.0, 7.0, paint)])
    _rectangle(m, (1.8, 25.5), (-0.2, 0.2))
    _rectangle(m, (1.6, 2.0), (-6.4, 6.4))
    _rectangle(m, (25.2, 25.6), (-6.6, 6.6))
    _rectangle(m, (1.6, 25.6), (6.3, 6.7))
    _rectangle(m, (1.6, 25.6), (-6.7, -6.3))
    _rectangle(m, (spot - 0.25, spot + 0.25), (-4.4, 4.4))
    angles = np.linspace(0.0, 2.0 * np.pi, 49)
    for inner, outer in ((4.4, 4.9), (1.5, 1.8)):
        rings = [
            np.column_stack([spot + r * np.cos(angles), r * np.sin(angles), np.full(49, LINE)]) for r in (outer, inner)
        ]
        m.sheet("line", np.stack(rings)[:, ::1])


def add_number(modeller: Modeller, text: str) -> None:
    """Pendant number in seven segments on both bows and both quarters."""
    for side in (1, -1):
        for aft, height, middle in ((114.0, 3.0, 3.6), (9.5, 1.6, 2.6)):
            pitch = 0.78 * height
            start = aft if side < 0 else aft + len(text) * pitch
            for place, character in enumerate(text):
                x = start + (1 if side < 0 else -1) * pitch * place
                for name in _CHARACTERS[character]:
                    _segment(modeller, side, x, middle - 0.5 * height, height, _SEGMENTS[name])


def _segment(m: Modeller, side: int, x: float, z: float, height: float, box: tuple[float, float, float, float]) -> None:
    columns, rows = np.linspace(box[0], box[2], 4), np.linspace(box[1], box[3], 3)
    along = x + (1 if side < 0 else -1) * height * columns
    grid = [
        [hull_point(station(float(a), z + height * float(r)), z + height * float(r), side, 0.05) for a in along]
        for r in rows
    ]
    m.sheet("line", np.array(grid))


def _rectangle(m: Modeller, x: tuple[float, float], y: tuple[float, float]) -> None:
    m.patch("line", [(x[0], y[0], LINE), (x[1], y[0], LINE), (x[1], y[1], LINE), (x[0], y[1], LINE)])
