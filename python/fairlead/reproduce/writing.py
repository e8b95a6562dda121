# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sections on disk: a JSON record and figures each, a CSV per table; then one Markdown and one HTML page of them all.

A section stays where it is until it is made again, so that a report may grow by several calls.
"""

import base64
import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fairlead.io.errors import InputError
from fairlead.io.run_record import write_json
from fairlead.reproduce.content import Picture, Section, Table, missed, shown

SECTIONS = "sections"
FIGURES = "figures"
_DPI = 160


@dataclass(frozen=True, kw_only=True)
class Made:
    """What a section was made with."""

    commit: str | None
    version: str
    machine: str
    quick: bool


def write_section(folder: Path, section: Section, made: Made) -> None:
    """CSV files, figures, and the record that the pages are made of; the record last."""
    for name in (SECTIONS, FIGURES):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for table in section.tables:
        write_csv(folder / f"{table.name}.csv", table)
    pictures = [_save(folder, picture) for picture in section.pictures]
    record: dict[str, Any] = {
        "name": section.name,
        "title": section.title,
        "published": section.published,
        "words": list(section.words),
        "missing": list(section.missing),
        "facts": dict(section.facts),
        "commit": made.commit,
        "version": made.version,
        "machine": made.machine,
        "quick": made.quick,
        "tables": [_table_record(table) for table in section.tables if table.columns],
        "pictures": pictures,
    }
    write_json(folder / SECTIONS / f"{section.name}.json", record)


def write_csv(path: Path, table: Table) -> None:
    """Every key of every row; numbers with six digits."""
    keys = list(dict.fromkeys(key for row in table.rows for key in row))
    temporary = path.with_name(f".{path.name}.part")
    with temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(keys)
        for row in table.rows:
            writer.writerow([_csv_cell(row.get(key)) for key in keys])
    temporary.replace(path)


def _csv_cell(value: object) -> str:
    if value is None or (isinstance(value, float) and value != value):
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _table_record(table: Table) -> dict[str, Any]:
    return {
        "name": table.name,
        "title": table.title,
        "note": table.note,
        "intervals": [column.interval for column in table.columns],
        "head": [column.title for column in table.columns],
        "cells": [[shown(column, row) for column in table.columns] for row in table.rows],
        "missed": [[missed(column, row) for column in table.columns] for row in table.rows],
    }


def _save(folder: Path, picture: Picture) -> dict[str, str]:
    """A drawing as SVG for the page and PNG for Markdown; a bitmap as it is."""
    record = {"name": picture.name, "caption": picture.caption}
    if picture.figure is None:
        assert picture.bitmap is not None
        path = folder / FIGURES / f"{picture.name}{picture.suffix}"
        path.write_bytes(picture.bitmap)
        return {**record, "file": f"{FIGURES}/{path.name}"}
    from fairlead.evaluate.figures.style import styled
    from fairlead.evaluate.figures.svg import figure_svg

    svg, png = (folder / FIGURES / f"{picture.name}{suffix}" for suffix in (".svg", ".png"))
    svg.write_text(figure_svg(picture.figure, picture.name) + "\n", encoding="utf-8")
    styled(picture.figure.savefig)(png, dpi=_DPI, facecolor="white")
    return {**record, "file": f"{FIGURES}/{png.name}", "svg": f"{FIGURES}/{svg.name}"}


_TABLE = {"head", "cells", "missed", "intervals"}


def read_sections(folder: Path, order: Sequence[str]) -> list[dict[str, Any]]:
    """The records that are there, in this order. Raises InputError for one that is none."""
    records: list[dict[str, Any]] = []
    for name in order:
        path = folder / SECTIONS / f"{name}.json"
        if path.is_file():
            try:
                record = json.loads(path.read_text(encoding="utf-8"))
                missing = {"name", "title", "facts", "tables", "pictures"} - set(record)
                missing |= _TABLE - set.intersection(_TABLE, *map(set, record.get("tables", ())))
            except (ValueError, TypeError) as error:
                raise InputError(path, f"no record of a section: {error}") from error
            if missing:
                raise InputError(path, f"no record of a section: it has no {min(missing)}")
            records.append(record)
    return records


def write_pages(folder: Path, records: Sequence[Mapping[str, Any]]) -> tuple[Path, Path]:
    """report.html, which holds everything, and report.md, which points to the figures."""
    html, markdown = folder / "report.html", folder / "report.md"
    _replace(html, _html(folder, records))
    _replace(markdown, "\n\n".join(_markdown(records)) + "\n")
    return html, markdown


def _replace(path: Path, text: str) -> None:
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    temporary.replace(path)


def _html(folder: Path, records: Sequence[Mapping[str, Any]]) -> str:
    import jinja2

    from fairlead.reproduce.published import SOURCE

    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(
            [jinja2.PackageLoader("fairlead.reproduce"), jinja2.PackageLoader("fairlead.evaluate")]
        ),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    inline = {each["name"]: _inline(folder, each) for record in records for each in record["pictures"]}
    return environment.get_template("reproduce.html.j2").render(records=records, inline=inline, source=SOURCE)


def _inline(folder: Path, picture: Mapping[str, str]) -> str:
    """An <svg> element, or an <img> that carries its data."""
    if "svg" in picture:
        return (folder / picture["svg"]).read_text(encoding="utf-8")
    path = folder / picture["file"]
    kind = "jpeg" if path.suffix in (".jpg", ".jpeg") else "png"
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="" src="data:image/{kind};base64,{data}">'


def _markdown(records: Sequence[Mapping[str, Any]]) -> list[str]:
    parts = [
        "<!-- SPDX-FileCopyrightText: fairlead contributors -->\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
        "# The published experiments, theirs beside ours",
        "Written by `fairlead reproduce` (docs/reproduce.md); `report.html` is the same on one page. **Bold with a "
        "cross** is a missed target. Intervals are 95 %.",
    ]
    for record in records:
        parts += [f"## {record['title']}", f"*{made_line(record)}*"]
        if record["published"]:
            parts.append(f"Theirs: {record['published']}")
        parts += record["words"]
        parts += [f"Not here: {line}" for line in record["missing"]]
        for table in record["tables"]:
            parts += [f"### {table['title']}", _markdown_table(table)]
            if table["note"]:
                parts.append(table["note"])
        parts += [f"![{each['caption']}]({each['file']})\n\n*{each['caption']}*" for each in record["pictures"]]
    return parts


def made_line(record: Mapping[str, Any]) -> str:
    """What a section was made with, in one line."""
    commit = record["commit"]
    facts = [f"{name}: {value}" for name, value in record["facts"].items()]
    facts += [f"commit {commit[:10]}" if commit else f"version {record['version']}", record["machine"]]
    return "; ".join((["quick"] if record["quick"] else []) + facts)


def _markdown_table(table: Mapping[str, Any]) -> str:
    rows = [table["head"], ["---"] * len(table["head"])]
    for cells, marks in zip(table["cells"], table["missed"], strict=True):
        rows.append([f"**{cell} ✗**" if mark else cell for cell, mark in zip(cells, marks, strict=True)])
    return "\n".join("| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows)
