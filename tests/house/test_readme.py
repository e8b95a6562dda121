# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Every Python and shell snippet of the README runs, each in a fresh folder that holds the files of data/marker_pen."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SNIPPET = re.compile(r"^```(?P<language>python|py|sh|bash|shell|console)\n(?P<text>.*?)^```", re.MULTILINE | re.DOTALL)
# What sets the project up has been done where this test runs; test_release.py checks that the targets of make exist.
SET_UP = re.compile(r"\s*(?:make\b|git clone\b|cd\b|pip install\b|sudo apt)")


def snippets(languages: set[str]) -> list[str]:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return [m["text"] for m in SNIPPET.finditer(text) if m["language"] in languages]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with target.toml, camera.yaml and observations.csv."""
    for file in (ROOT / "data" / "marker_pen").iterdir():
        if file.is_file():
            shutil.copy(file, tmp_path)
    (tmp_path / "data").symlink_to(ROOT / "data")
    return tmp_path


def run(command: list[str], folder: Path) -> None:
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command[-1]}\n{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("text", snippets({"python", "py"}))
def test_python(text: str, folder: Path) -> None:
    run([sys.executable, "-W", "error", "-c", text], folder)


@pytest.mark.parametrize("text", snippets({"sh", "bash", "shell", "console"}))
def test_shell(text: str, folder: Path) -> None:
    lines = [line.removeprefix("$ ") for line in text.splitlines()]
    script = "\n".join(line for line in lines if not SET_UP.match(line))
    run(["bash", "-euo", "pipefail", "-c", script], folder)


def test_the_readme_says_how_to_start() -> None:
    assert any("make demo" in text for text in snippets({"sh", "bash", "shell", "console"}))
