# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a source says of an equation, a section or a page is there to be read."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

PAGE = r"(?P<page>(?:docs/[\w/-]+|CONVENTIONS|CONTRIBUTING)\.md)"
EQUATIONS = re.compile(PAGE + r",? eqs?\. (?P<numbers>\(\d+\)(?:(?:-|, | and | to )\(\d+\))*)")
SECTION = re.compile(PAGE + r",? section (?P<number>\d+)")
LINK = re.compile(r"\]\((?!https?:|mailto:|#)(?P<target>[^)#\s]+)")
DEFINED = re.compile(r"\*\*\((\d+)\)\*\*")
COMMENT_BREAK = re.compile(r"\n[ \t]*(?:///?<?|#|\*)?[ \t]*")


def flowing(text: str) -> str:
    """The text with its lines joined, comment leaders gone."""
    return COMMENT_BREAK.sub(" ", text)


def equation_numbers(text: str) -> list[int]:
    """`(2)-(4), (9)` -> [2, 3, 4, 9]."""
    numbers: list[int] = []
    for first, last in re.findall(r"\((\d+)\)(?:(?:-| to )\((\d+)\))?", text):
        numbers.extend(range(int(first), int(last or first) + 1))
    return numbers


def references(text: str) -> Iterator[tuple[str, str, int]]:
    """(page, kind, number) of each reference in a source."""
    for match in EQUATIONS.finditer(flowing(text)):
        for number in equation_numbers(match["numbers"]):
            yield match["page"], "eq.", number
    for match in SECTION.finditer(flowing(text)):
        yield match["page"], "section", int(match["number"])


def missing(text: str, root: Path) -> list[str]:
    """References of a source that lead nowhere."""
    faults: list[str] = []
    for page, kind, number in references(text):
        pattern = rf"\*\*\({number}\)\*\*" if kind == "eq." else rf"^#+ {number}\b"
        target = root / page
        if not target.is_file() or not re.search(pattern, target.read_text(encoding="utf-8"), re.MULTILINE):
            faults.append(f"{page} {kind} {number}")
    faults.extend(page for page in re.findall(PAGE, text) if not (root / page).is_file())
    return faults


def test_every_reference_leads_to_an_equation(project_files: list[Path], repository: Path) -> None:
    texts = [f for f in project_files if f.suffix in {".py", ".cpp", ".hpp", ".md", ".toml"} and f != Path(__file__)]
    faults = {str(f.relative_to(repository)): missing(f.read_text(encoding="utf-8"), repository) for f in texts}
    assert {name: found for name, found in faults.items() if found} == {}


def test_equations_have_one_number_each_without_gaps(project_files: list[Path], repository: Path) -> None:
    for page in (f for f in project_files if f.suffix == ".md"):
        numbers = sorted(int(n) for n in DEFINED.findall(page.read_text(encoding="utf-8")))
        assert numbers == list(range(1, len(numbers) + 1)), page.relative_to(repository)


def test_links_between_pages_lead_somewhere(project_files: list[Path], repository: Path) -> None:
    pages = [f for f in project_files if f.suffix == ".md"]
    links = [(page, m["target"]) for page in pages for m in LINK.finditer(page.read_text(encoding="utf-8"))]
    assert [f"{page.relative_to(repository)} -> {to}" for page, to in links if not (page.parent / to).exists()] == []


def test_every_page_stands_in_the_index(project_files: list[Path], repository: Path) -> None:
    index = (repository / "docs" / "README.md").read_text(encoding="utf-8")
    pages = [
        f for f in project_files if f.parent == repository / "docs" and f.suffix == ".md" and f.name != "README.md"
    ]
    assert [page.name for page in pages if f"]({page.name})" not in index] == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/// docs/a.md eq. (3).", [("docs/a.md", "eq.", 3)]),
        ("# docs/a.md\n    # eq. (2)-(4), (9)", [("docs/a.md", "eq.", n) for n in (2, 3, 4, 9)]),
        ("CONVENTIONS.md eq. (1) and (2)", [("CONVENTIONS.md", "eq.", 1), ("CONVENTIONS.md", "eq.", 2)]),
        ("docs/a.md section 4", [("docs/a.md", "section", 4)]),
    ],
)
def test_references_are_found(text: str, expected: list[tuple[str, str, int]], tmp_path: Path) -> None:
    assert list(references(text)) == expected
    assert len(missing(text, tmp_path)) > len(expected) - 1
