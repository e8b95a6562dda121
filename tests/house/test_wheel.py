# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a user installs is whole: the wheel alone tracks the recording that it carries."""

import os
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

# Tests that use build/python run one after the other.
pytestmark = pytest.mark.xdist_group("build")

# -S keeps the editable package of this environment out; what the wheel depends on comes by its path.
PROGRAM = """
import sys
sys.path[:0] = sys.argv[1:]
import fairlead as fl
from fairlead.io.shipped import shipped_data
assert fl.__file__.startswith(sys.argv[1]), fl.__file__
pen = shipped_data("marker_pen")
assert str(pen).startswith(sys.argv[1]), pen
tracker = fl.Tracker(fl.load_target(pen / "target.toml"), fl.load_camera(pen / "camera.yaml"))
print(sum(tracker.update(view).ok for view in fl.read_views(pen / "observations.csv")))
"""


@pytest.fixture(scope="module")
def wheel(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built in the folder where `make setup` has built, so that nothing is compiled again."""
    folder = tmp_path_factory.mktemp("wheel")
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "-w", folder, "."]
    done = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.whl"))


@pytest.mark.slow
def test_the_wheel_holds_what_the_package_needs_and_nothing_else(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {"fairlead/py.typed", "fairlead/_core.pyi", "fairlead/data/marker_pen/observations.csv"} <= set(names)
    assert any(name.startswith("fairlead/_core.") and name.endswith(".so") for name in names)
    assert any(name.startswith("fairlead/evaluate/templates/") for name in names)
    assert {name.split("/")[0] for name in names} == {"fairlead", f"{wheel.name.split('-cp')[0]}.dist-info"}
    assert wheel.stat().st_size < 40_000_000  # most of it the clip of the demo, and two networks


@pytest.mark.slow
def test_the_wheel_tracks_alone(wheel: Path, tmp_path: Path) -> None:
    zipfile.ZipFile(wheel).extractall(tmp_path)
    command = [sys.executable, "-S", "-c", PROGRAM, str(tmp_path), sysconfig.get_path("purelib")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) >= 12  # of 16 photographs
