# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A number that a page quotes is that of docs/results, to the digits shown. docs/reproduce.md section 11."""

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from fairlead.reproduce.content import significant

MARKER = re.compile(r"<!-- results (?P<file>[\w.-]+\.csv): (?P<tokens>[^>]+?) -->")
NUMBER = re.compile(r"(?<![\w.,])-?\d+(?:,\d{3})*(?:\.\d+)?(?![\w]*-\w)")
CONDITION = re.compile(r"(?P<key>\w+)=(?P<value>\S+)")


def numbers(text: str) -> list[str]:
    """Those that stand alone: not part of a name such as RTMPose-t2 or s1-a90."""
    return [found.replace(",", "") for found in NUMBER.findall(text)]


def quoted(line: str, before: int, count: int) -> list[re.Match[str]]:
    """What a marker at `before` speaks of: of a table row all numbers but the first cell's, else the last ones."""
    found = list(NUMBER.finditer(line[:before]))
    if line.startswith("|"):
        second = line.index("|", 1)
        return [each for each in found if each.start() > second]
    return found[-count:]


def looked_up(folder: Path, file: str, tokens: str) -> Iterator[tuple[str, float]]:
    """(what was asked, value) for each column; KeyError, LookupError where it does not lead to one row."""
    with (folder / file).open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    conditions: dict[str, str] = {}
    for token in tokens.split():
        condition = CONDITION.fullmatch(token)
        if condition:
            conditions[condition["key"]] = condition["value"]
            continue
        found = [row for row in rows if all(row[key] == value for key, value in conditions.items())]
        if len(found) != 1:
            raise LookupError(f"{file}: {len(found)} rows with {conditions}")
        column = token.removesuffix("%")
        yield f"{token} of {conditions}", float(found[0][column]) * (100.0 if token.endswith("%") else 1.0)


def agrees(text: str, value: float) -> bool:
    """To half of the last digit shown."""
    decimals = len(text.partition(".")[2])
    return abs(float(text) - value) <= 0.5 * 10.0**-decimals * (1.0 + 1e-6)


def faults(text: str, folder: Path, *, every_table: bool) -> list[str]:
    """What a page says that its results do not."""
    found: list[str] = []
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        markers = list(MARKER.finditer(line))
        if not markers and every_table and is_row(lines, number - 1) and numbers(" ".join(line.split("|")[2:])):
            found.append(f"line {number}: numbers without a source")
        for marker in markers:
            expected = list(looked_up(folder, marker["file"], marker["tokens"]))
            shown = quoted(line, marker.start(), len(expected))
            if len(shown) != len(expected):
                found.append(f"line {number}: {len(shown)} numbers, {len(expected)} columns")
                continue
            for one, (what, value) in zip(shown, expected, strict=True):
                if not agrees(one[0].replace(",", ""), value):
                    found.append(f"line {number}: {one[0]}, but {what} is {value:g}")
    return found


def renewed(text: str, folder: Path) -> str:
    """The page with the numbers that its results have now, to as many significant digits as before."""
    return "\n".join(_renewed_line(line, folder) for line in text.split("\n"))


def _renewed_line(line: str, folder: Path) -> str:
    for marker in reversed(list(MARKER.finditer(line))):
        expected = list(looked_up(folder, marker["file"], marker["tokens"]))
        spots = quoted(line, marker.start(), len(expected))
        for spot, (_, value) in reversed(list(zip(spots, expected, strict=True))):
            if not agrees(spot[0].replace(",", ""), value):
                line = line[: spot.start()] + significant(value, _digits(spot[0])) + line[spot.end() :]
    return line


def _digits(shown: str) -> int:
    return max(len(shown.replace(",", "").replace(".", "").lstrip("-0")), 1)


def pages(files: list[Path]) -> list[Path]:
    """All that may quote; docs/reproduce.md shows what a marker looks like."""
    return [f for f in files if f.suffix == ".md" and f.name != "reproduce.md"]


def is_row(lines: list[str], at: int) -> bool:
    """A row of a table's body: not the head, nor the line below it."""
    head = at + 1 < len(lines) and re.match(r"\|[\s:|-]+\|$", lines[at + 1]) is not None
    return lines[at].startswith("|") and not head and re.match(r"\|[\s:|-]+\|$", lines[at]) is None


def test_pages_quote_the_results(project_files: list[Path], repository: Path, *, update_golden: bool) -> None:
    folder = repository / "docs" / "results"
    found: dict[str, list[str]] = {}
    for page in pages(project_files):
        text = page.read_text(encoding="utf-8")
        if update_golden and (new := renewed(text, folder)) != text:
            page.write_text(new, encoding="utf-8")
            text = new
        found[str(page.relative_to(repository))] = faults(text, folder, every_table=False)
    assert {page: each for page, each in found.items() if each} == {}


def test_the_readme_quotes_the_results(repository: Path) -> None:
    text = (repository / "README.md").read_text(encoding="utf-8")
    assert MARKER.search(text) is not None
    assert faults(text, repository / "docs" / "results", every_table=True) == []


def test_results_say_what_they_were_made_with(repository: Path) -> None:
    records = sorted((repository / "docs" / "results" / "sections").glob("*.json"))
    assert records
    for path in records:
        record = json.loads(path.read_text(encoding="utf-8"))
        assert re.fullmatch(r"[0-9a-f]{40}", record["commit"])
        assert record["facts"]


@pytest.fixture
def results(tmp_path: Path) -> Path:
    (tmp_path / "t.csv").write_text("case,method,deg,share\na,x,1.984,0.123\na,y,2.5,\nb,x,30.26,1\n", encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    "line",
    [
        "| 90 deg | 1.98 deg, 12 % | **2.5** | <!-- results t.csv: case=a method=x deg share% method=y deg -->",
        "Over 20,000 views it is 30.3 m <!-- results t.csv: case=b method=x deg --> and no more.",
    ],
)
def test_what_agrees_passes(line: str, results: Path) -> None:
    assert faults(line, results, every_table=True) == []


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("| a | 1.99 | <!-- results t.csv: case=a method=x deg -->", "1.99, but deg"),
        ("| a | 1.98, 3 | <!-- results t.csv: case=a method=x deg -->", "2 numbers, 1 columns"),
        ("| a | 1.98 |", "without a source"),
        ("It is 30.2 m. <!-- results t.csv: case=b method=x deg -->", "30.2, but deg"),
    ],
)
def test_what_differs_is_found(line: str, fault: str, results: Path) -> None:
    assert fault in faults(line, results, every_table=True)[0]


@pytest.mark.parametrize(
    ("line", "new"),
    [
        (
            "| 90 deg | 1.99 deg, 13 % | **2.51** | <!-- results t.csv: case=a method=x deg share% method=y deg -->",
            "| 90 deg | 1.98 deg, 12 % | **2.50** |",
        ),
        ("In 3 flights 1.98 and 29 m <!-- results t.csv: case=b method=x deg -->", "In 3 flights 1.98 and 30 m"),
    ],
)
def test_a_page_is_renewed(line: str, new: str, results: Path) -> None:
    found = renewed(line, results)
    assert found == f"{new} {line[line.index('<') :]}"
    assert faults(found, results, every_table=True) == []


def test_a_lookup_of_two_rows_is_refused(results: Path) -> None:
    with pytest.raises(LookupError, match="2 rows"):
        faults("| a | 1.98 | <!-- results t.csv: case=a deg -->", results, every_table=True)
