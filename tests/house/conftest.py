# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The files that the rules of the house are checked on."""

import subprocess
from pathlib import Path

import pytest

UNTRACKED = {".git", ".venv", "build", "dist", "runs", "__pycache__"}


@pytest.fixture(scope="session")
def project_files(repository: Path) -> list[Path]:
    """Every file under version control or about to be; in a plain archive, every file that make did not make."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=False)
    if listing.returncode == 0:
        files = [repository / name for name in listing.stdout.split("\0") if name]
    else:
        files = [f for f in repository.rglob("*") if not UNTRACKED.intersection(f.relative_to(repository).parts)]
    return sorted(f for f in files if f.is_file())


@pytest.fixture(scope="session")
def sources(project_files: list[Path]) -> list[Path]:
    """Program text: Python, C++, CMake, the Makefile and shell."""
    suffixes = {".py", ".pyi", ".cpp", ".hpp", ".cmake", ".sh"}
    names = {"CMakeLists.txt", "Makefile", "run"}
    return [f for f in project_files if f.suffix in suffixes or f.name in names]


@pytest.fixture(scope="session")
def code(sources: list[Path], repository: Path) -> list[Path]:
    """C++ and Python of the package, of the core and of what stands beside them; no tests."""
    folders = {"cpp", "bindings", "python", "reference", "benchmarks", "examples"}
    kept = [f for f in sources if f.suffix in {".py", ".cpp", ".hpp"}]
    return [f for f in kept if f.relative_to(repository).parts[0] in folders]
