# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the .rrd file holds, also of a run that was killed."""

import shutil
import time
import warnings
from collections import Counter
from pathlib import Path

import pytest

from fairlead import Tracker, load_target
from fairlead.io.mesh import load_mesh
from fairlead.sinks.sink import Outcome
from fairlead.sinks.viewer import ViewerSink
from tests.clip import CAMERA, PERIOD_NS, Clip, true_pose
from tests.outcomes import estimate, lost, no_view


def rows(path: Path) -> Counter[str]:
    from rerun.chunk import RrdReader

    counts: Counter[str] = Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a killed file has no footer, and rerun says so
        for chunk in RrdReader(str(path)).stream():
            counts[chunk.entity_path] += chunk.num_rows
    return counts


def test_every_frame_is_in_the_file_even_if_it_was_killed(clip: Clip, tmp_path: Path) -> None:
    target = load_target(clip.folder / "target.toml")
    mesh = load_mesh(clip.folder / "book.ply")
    sink = ViewerSink(target, CAMERA, Tracker(target, CAMERA), mesh=mesh, rrd=tmp_path / "a.rrd")
    for i in range(4):
        answer = lost() if i == 2 else estimate(true_pose(i), frame=i, stamp_ns=PERIOD_NS * i)
        sink.write(Outcome(estimate=answer, view=no_view(), image=clip.images[i]))
    time.sleep(0.5)  # rerun writes five times a second
    shutil.copy(tmp_path / "a.rrd", tmp_path / "killed.rrd")
    sink.close()
    sink.close()
    for name in ("a.rrd", "killed.rrd"):
        found = rows(tmp_path / name)
        assert found["/target/camera/image"] == 4, name
        assert found["/target/landmarks/ellipsoids"] == 3
        assert found["/target/surface"] == 1
        assert found["/status"] == 4
        assert found["/plots/range_m"] == 3
        assert found["/target/path"] == 2


def test_a_file_that_cannot_be_written_is_an_os_error(clip: Clip, tmp_path: Path) -> None:
    target = load_target(clip.folder / "target.toml")
    with pytest.raises(OSError, match="none"):
        ViewerSink(target, CAMERA, Tracker(target, CAMERA), rrd=tmp_path / "none" / "a.rrd")
