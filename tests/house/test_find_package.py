# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A C++ program that has no Python finds the installed package, builds and runs: examples/cpp."""

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

# Tests that use build/python run one after the other.
pytestmark = pytest.mark.xdist_group("build")

EIGEN = Path(sysconfig.get_path("purelib")) / "cmeel.prefix"


def run(*command: str | Path) -> str:
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run([str(c) for c in command], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_core_configures_without_python(repository: Path, tmp_path: Path) -> None:
    hidden = ["-DCMAKE_DISABLE_FIND_PACKAGE_Python=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_nanobind=ON"]
    run("cmake", "-S", repository, "-B", tmp_path, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={EIGEN}", *hidden)
    targets = re.findall(r"^(\w+): phony$", run("cmake", "--build", tmp_path, "--target", "help"), re.MULTILINE)
    assert "fairlead_tracker" in targets
    assert "_core" not in targets


@pytest.fixture(scope="module")
def program(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """examples/cpp, built against the package installed under a prefix of its own."""
    core = repository / "build" / "python"
    assert (core / "CMakeCache.txt").is_file(), "`make setup` builds the core there"
    prefix, example = tmp_path_factory.mktemp("prefix"), tmp_path_factory.mktemp("example")
    run("cmake", "--install", core, "--prefix", prefix, "--component", "development")
    path = f"-DCMAKE_PREFIX_PATH={prefix};{EIGEN}"
    run("cmake", "-S", repository / "examples" / "cpp", "-B", example, "-G", "Ninja", path)
    run("cmake", "--build", example)
    return example / "docking"


@pytest.mark.slow
def test_the_example_finds_the_port_and_betters_the_model(program: Path) -> None:
    lines = run(program).splitlines()
    shape_mm = [float(m[1]) for line in lines if (m := re.search(r"shape ([0-9.]+) mm", line))]
    error_m = [float(m[1]) for line in lines if (m := re.search(r"error ([0-9.]+) m", line))]
    sigma_m = [float(m[1]) for line in lines if (m := re.search(r"1 sigma ([0-9.]+) m", line))]
    assert len(shape_mm) == len(error_m) == len(sigma_m) == len(lines) > 2
    assert all("tracking" in line for line in lines)
    # 200 views of 0.5 px at 800 px focal length and 4 to 12 m: 5 mm / sqrt(200) across the line of sight, some times
    # that along it.
    assert shape_mm[-1] < 3.0
    # sigma is that of all three coordinates together; five of it is beyond what chance does in six lines.
    assert all(error < 5 * sigma for error, sigma in zip(error_m, sigma_m, strict=True))
