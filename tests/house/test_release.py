# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One version, one set of defaults: what is written in two places says the same."""

import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import yaml


def test_every_version_is_the_version(repository: Path) -> None:
    import fairlead
    from fairlead import _core

    version = (repository / "VERSION").read_text(encoding="utf-8").strip()
    citation = yaml.safe_load((repository / "CITATION.cff").read_text(encoding="utf-8"))
    changelog = re.search(r"^## (\S+)", (repository / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert changelog is not None
    assert {
        "fairlead": fairlead.__version__,
        "_core": _core.__version__,
        "metadata": importlib.metadata.version("fairlead"),
        "citation": citation["version"],
        "changelog": changelog[1],
    } == dict.fromkeys(("fairlead", "_core", "metadata", "citation", "changelog"), version)


def test_citation_says_what_the_format_wants(repository: Path) -> None:
    citation = yaml.safe_load((repository / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors", "version", "license"} <= citation.keys()
    assert citation["license"] == tomllib.loads((repository / "pyproject.toml").read_text())["project"]["license"]


def test_every_dependency_is_locked_with_a_hash(repository: Path) -> None:
    lock = (repository / "requirements" / "dev.txt").read_text(encoding="utf-8").replace("\\\n", " ")
    pins = {re.split("[=<>!; ]", line)[0]: line for line in lock.splitlines() if line and not line.startswith("#")}
    assert [name for name, line in pins.items() if "--hash=sha256:" not in line] == []
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))
    groups = [d for group in project["dependency-groups"].values() for d in group if isinstance(d, str)]
    wanted = {re.split(r"[\[=<>!; ]", d)[0].lower() for d in [*project["project"]["dependencies"], *groups]}
    assert wanted - pins.keys() == set()


def test_stubs_say_what_the_core_has(repository: Path, tmp_path: Path) -> None:
    """`make stubs` was run after the last change of the bindings."""
    stubs = tmp_path / "_core.pyi"
    python = Path(sys.executable)
    generate = [python, "-m", "nanobind.stubgen", "--quiet", "--module", "fairlead._core", "--output-file", stubs]
    subprocess.run(generate, check=True, cwd=repository)
    ruff, config = python.with_name("ruff"), repository / "pyproject.toml"
    subprocess.run([ruff, "format", "--quiet", "--config", config, stubs], check=True)
    committed = repository / "python" / "fairlead" / "_core.pyi"
    assert stubs.read_text(encoding="utf-8") == committed.read_text(encoding="utf-8")


def test_every_make_target_that_is_named_exists(repository: Path) -> None:
    targets = set(re.findall(r"^([a-z-]+):", (repository / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    pages = [repository / name for name in ("README.md", "CONTRIBUTING.md", ".ci/run", ".github/workflows/ci.yml")]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    named = set(re.findall(r"(?:^|`|run: )make ([a-z-]+)", text, re.MULTILINE))
    assert named
    assert named - targets == set()
