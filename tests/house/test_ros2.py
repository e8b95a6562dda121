# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What can be tested of the ROS 2 package without ROS."""

import ast
import dataclasses
import re
import shutil
import subprocess
import sysconfig
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from fairlead.tracker import TrackerOptions

DECLARED = re.compile(r'options\.(\w+) =[^;]*?declare_parameter<[\w:]+>\(\s*"(\w+)",([^;]*);', re.DOTALL)


@pytest.fixture
def package(repository: Path) -> Path:
    return repository / "interfaces" / "ros2"


def test_every_option_of_the_core_is_a_parameter_with_its_default(package: Path) -> None:
    declared = DECLARED.findall((package / "src" / "node.cpp").read_text(encoding="utf-8"))
    assert [(field, name) for field, name, _ in declared] == [(name, name) for _, name, _ in declared]
    assert sorted(name for _, name, _ in declared) == sorted(each.name for each in dataclasses.fields(TrackerOptions))
    for _, name, default in declared:
        assert f"options.{name}" in default, "the default is the core's"
        assert not re.search(r"\d\.\d|\b\d+\b", default), "and no other"


def test_the_manifest_names_what_is_built_against(package: Path, repository: Path) -> None:
    manifest = ET.fromstring((package / "package.xml").read_text(encoding="utf-8"))
    depends = {each.text for each in manifest.findall("depend")}
    found = set(re.findall(r"find_package\((\w+)", (package / "CMakeLists.txt").read_text(encoding="utf-8")))
    assert depends - {"eigen"} == found - {"ament_cmake", "fairlead"}
    assert manifest.findtext("version") == (repository / "VERSION").read_text().strip()
    included = re.findall(
        r"#include <(\w+)/(?:msg/)?\w+\.h", (package / "src" / "node.cpp").read_text(encoding="utf-8")
    )
    assert set(included) - {"fairlead"} <= depends


def test_the_launch_file_is_python_and_the_page_says_that_nothing_was_run(package: Path, repository: Path) -> None:
    ast.parse((package / "launch" / "track.launch.py").read_text(encoding="utf-8"))
    assert "not built or run here" in (repository / "docs" / "ros.md").read_text(encoding="utf-8")


def test_what_needs_no_ros_compiles_against_the_core(package: Path, repository: Path) -> None:
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        pytest.skip("no C++ compiler")
    eigen = Path(sysconfig.get_path("purelib")) / "cmeel.prefix" / "include" / "eigen3"
    folders = [f"-I{package / 'include'}", f"-I{repository / 'cpp' / 'include'}", f"-isystem{eigen}"]
    program = '#include "fairlead_ros/conversions.hpp"\n'
    command = [compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", *folders, "-x", "c++", "-"]
    done = subprocess.run(command, input=program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
