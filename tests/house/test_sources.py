# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Header, length and names of every source; nothing in a file that belongs to one machine."""

import ast
import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml

MAX_LINES = 300
MAX_FUNCTION_LINES = 40
HEADER = ("SPDX-FileCopyrightText: fairlead contributors", "SPDX-License-Identifier: Apache-2.0")
FORBIDDEN_NAMES = re.compile(r"^(utils?|misc|helpers?|common|new_.*|.*_(v)?[2-9])$")

# Split, so that this file does not hold what it looks for.
MACHINE = [
    (
        "an absolute path of one machine",
        re.compile(r"(?<![\w.$}/])/(?:home|root|work|Users|mnt|opt/(?!conda))/" + r"\w"),
    ),
    (
        "a package index",
        re.compile("index" + "-url|find" + "-links|files.python" + "hosted.org|://[^ ]*/simple(?:/|\\b)"),
    ),
]


def test_every_source_names_its_licence(sources: list[Path], repository: Path) -> None:
    heads = {f: "\n".join(f.read_text(encoding="utf-8").splitlines()[:3]) for f in sources if f.name != "_core.pyi"}
    assert [str(f.relative_to(repository)) for f, head in heads.items() if not all(h in head for h in HEADER)] == []


def test_no_source_is_long(sources: list[Path], repository: Path) -> None:
    lengths = {f: len(f.read_text(encoding="utf-8").splitlines()) for f in sources if f.name != "_core.pyi"}
    assert {str(f.relative_to(repository)): n for f, n in lengths.items() if n > MAX_LINES} == {}


def function_lengths(text: str) -> dict[str, int]:
    """Lines of each function's body, docstring not counted."""
    lengths: dict[str, int] = {}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            body = node.body[1:] if ast.get_docstring(node) else node.body
            if body:
                lengths[node.name] = (body[-1].end_lineno or 0) - body[0].lineno + 1
    return lengths


def test_no_python_function_is_long(code: list[Path], repository: Path) -> None:
    found = {
        f"{f.relative_to(repository)}:{name}": n
        for f in code
        if f.suffix == ".py"
        for name, n in function_lengths(f.read_text(encoding="utf-8")).items()
        if n > MAX_FUNCTION_LINES
    }
    assert found == {}


def test_no_file_is_named_after_nothing(project_files: list[Path], repository: Path) -> None:
    named = [f.relative_to(repository) for f in project_files if f.suffix in {".py", ".cpp", ".hpp", ".md"}]
    assert [str(f) for f in named if any(FORBIDDEN_NAMES.match(part) for part in (*f.parts[:-1], f.stem))] == []


BARE_NAME = re.compile(r"^(pose|poses|transform|transformation|q|quat|quaternion)$")
ARRAY = re.compile(r"Matrix|Poses|Vector|ndarray|Array|Float")


def bare_arguments(text: str) -> list[str]:
    """`function(argument)` for each array argument whose name says neither its frames nor its order."""
    found: list[str] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs):
                annotation = ast.unparse(a.annotation) if a.annotation else "ndarray"
                if BARE_NAME.match(a.arg) and ARRAY.search(annotation):
                    found.append(f"{node.name}({a.arg})")
    return found


def test_a_pose_says_of_which_frame_in_which(code: list[Path], repository: Path) -> None:
    package = repository / "python" / "fairlead"
    found = {
        str(f.relative_to(repository)): bare_arguments(f.read_text(encoding="utf-8"))
        for f in code
        if f.is_relative_to(package) and f.suffix == ".py"
    }
    assert {name: arguments for name, arguments in found.items() if arguments} == {}


def test_a_pose_that_says_nothing_is_found() -> None:
    assert bare_arguments("def f(pose: Matrix4) -> None: ...") == ["f(pose)"]
    assert bare_arguments("def f(pose: SingleView, T_camera_target: Matrix4) -> None: ...") == []


def test_nothing_belongs_to_one_machine(project_files: list[Path], repository: Path) -> None:
    found: list[str] = []
    for f in project_files:
        try:
            lines = f.read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(lines, 1):
            found += [f"{f.relative_to(repository)}:{number}: {what}" for what, p in MACHINE if p.search(line)]
    assert found == []


@pytest.mark.parametrize(
    "line", ["see /home" + "/me/x", 'open("/work' + '/main/x")', "--extra-index" + "-url https://x"]
)
def test_what_belongs_to_one_machine_is_found(line: str) -> None:
    assert any(pattern.search(line) for _, pattern in MACHINE)


def test_documents_parse(project_files: list[Path], repository: Path) -> None:
    broken: list[str] = []
    for f in project_files:
        if f.relative_to(repository).parts[0] == "tests":
            continue  # malformed documents are what some tests are about
        try:
            if f.suffix == ".toml":
                tomllib.loads(f.read_text(encoding="utf-8"))
            elif f.suffix == ".json":
                json.loads(f.read_text(encoding="utf-8"))
            elif f.suffix in {".yaml", ".yml", ".cff"} or f.name in {".clang-format", ".clang-tidy"}:
                yaml.safe_load(f.read_text(encoding="utf-8"))
        except (ValueError, yaml.YAMLError) as error:
            broken.append(f"{f.relative_to(repository)}: {error}")
    assert broken == []
