# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Every Python example runs alone; test_find_package.py runs the one in C++."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples" / "python").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_it_runs(example: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-W", "error", str(example), str(tmp_path)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    if example.stem == "landing_on_a_frigate":
        shape_m = [float(number) for number in re.findall(r"shape ([0-9.]+) m rms", done.stdout)]
        assert shape_m[-1] < 0.2 * shape_m[0]
        assert (tmp_path / "target_refined.toml").is_file()
