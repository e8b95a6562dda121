# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What an experiment hands over: words, tables and pictures, without saying how they are written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Cell = float | int | str | None
"""None and NaN are empty cells."""
Row = Mapping[str, Cell]


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column that people see; the CSV has every key of the rows."""

    key: str
    title: str
    digits: int = 3
    """Significant ones."""
    interval: bool = False
    """Show the 95 % interval of `<key>_low95` and `<key>_high95` behind the number."""
    plain: bool = False
    """A setting and not a measurement: as short as it is."""
    percent: bool = False
    """The number is a share: show it times 100."""
    mark: str = ""
    """Key of a row that says true where the number is to be marked as a missed target."""


@dataclass(frozen=True, kw_only=True)
class Table:
    """One table; its name is that of its CSV file."""

    name: str
    title: str
    columns: Sequence[Column]
    """None of them: the table is written as CSV and not shown."""
    rows: Sequence[Row]
    note: str = ""
    """Below the table."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """One figure: drawn as lines, or an image that is a PNG or JPEG already."""

    name: str
    caption: str
    figure: "Figure | None" = None
    bitmap: bytes | None = None
    """With its file's suffix in `suffix`."""
    suffix: str = ".png"


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """All that one experiment has to say."""

    name: str
    title: str
    published: str = ""
    """What the publication reports, in our words."""
    words: Sequence[str] = ()
    """Paragraphs."""
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()
    missing: Sequence[str] = ()
    """What could not be done here, a line each, with the reason."""
    facts: Mapping[str, str] = field(default_factory=dict)
    """What was run: seeds, networks, runs."""


def shown(column: Column, row: Row) -> str:
    """The text of a cell."""
    value = row.get(column.key)
    text = _number(value, column)
    if column.interval and text:
        low, high = (_number(row.get(f"{column.key}_{end}95"), column) for end in ("low", "high"))
        text += f" ({low}-{high})" if low and high else ""
    return text


def missed(column: Column, row: Row) -> bool:
    """Whether the cell is to be marked."""
    return bool(column.mark and row.get(column.mark))


def _number(value: Cell, column: Column) -> str:
    if value is None or (isinstance(value, float) and value != value):
        return ""
    if isinstance(value, str):
        return value
    scaled = 100.0 * value if column.percent else value
    if column.plain:
        return f"{scaled:g}"
    return f"{scaled}" if isinstance(scaled, int) else significant(scaled, column.digits)


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits, never in powers of ten below a million; what is rounding error is 0."""
    if not abs(value) < float("inf"):
        return "inf"
    if value == 0.0 or abs(value) >= 1e6:
        return f"{value:.{digits}g}"
    decimals = max(digits - 1 - _exponent(value, digits), 0)
    return f"{value:.{decimals}f}" if decimals < 9 else "0"


def _exponent(value: float, digits: int) -> int:
    """Power of ten of the rounded number."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])
