# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An option lives once, in the C++ aggregate; Python mirrors name, type and default of each."""

import dataclasses
import re
from pathlib import Path

from fairlead import _core
from fairlead.tracker import TrackerOptions

FIELD = re.compile(r"^    (int|double|bool|std::uint64_t|motion::Kind)\s+(\w+)\s*=\s", re.MULTILINE)
PYTHON_TYPE = {"int": int, "double": float, "bool": bool, "std::uint64_t": int, "motion::Kind": str}


def test_python_mirrors_every_option(repository: Path) -> None:
    header = (repository / "cpp" / "include" / "fairlead" / "tracker" / "options.hpp").read_text(encoding="utf-8")
    in_core = {name: PYTHON_TYPE[type_] for type_, name in FIELD.findall(header)}
    assert len(in_core) > 3
    assert {field.name: field.type for field in dataclasses.fields(TrackerOptions)} == in_core


def test_defaults_are_those_of_the_core() -> None:
    core, options = _core.TrackerOptions(), TrackerOptions()
    assert {n: getattr(core, n) for n in dataclasses.asdict(options)} == dataclasses.asdict(options)


def another(value: object) -> object:
    """A value of the same type that is not the default."""
    if isinstance(value, bool):
        return not value
    return "world" if isinstance(value, str) else value + 1  # pyright: ignore[reportOperatorIssue]


def test_each_option_reaches_the_core() -> None:
    changed = {name: another(value) for name, value in dataclasses.asdict(TrackerOptions()).items()}
    core = TrackerOptions(**changed).to_core()
    assert {name: getattr(core, name) for name in changed} == changed
