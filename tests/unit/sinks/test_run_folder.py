# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The folder of a run: complete when all goes well, readable when it does not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.io.camera import load_camera
from fairlead.io.errors import InputError
from fairlead.io.model_history import read_model_history
from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses
from fairlead.io.run_record import RunRecord, read_run_record
from fairlead.io.target import load_target
from fairlead.io.timing import Timing, read_timing
from fairlead.sinks import model as model_sink
from fairlead.sinks.model import ModelHistorySink, ModelSink
from fairlead.sinks.run_folder import RunFolder
from fairlead.types import Camera, Estimate, Status, Target, View

CAMERA = Camera(
    name="c",
    width=640,
    height=480,
    model="plumb_bob",
    K=np.array([[500.0, 0.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]]),
    distortion=np.zeros(5),
)
TARGET = Target(name="t", landmarks=("a", "b"), positions=np.zeros((2, 3)), covariance=np.eye(6))
RECORD = RunRecord(command="track", state="running", options=None, inputs=())


class Growing:
    """An estimator whose model is where the test puts it."""

    offset_m = 1.0

    def update(self, view: View) -> Estimate:
        raise NotImplementedError

    @property
    def model(self) -> Target:
        return replace(TARGET, positions=np.full((2, 3), self.offset_m))


def make_frame(number: int, status: Status = "tracking") -> tuple[View, Estimate, Timing]:
    view = View(
        frame=number,
        stamp_ns=number,
        landmarks=("a",) if status == "tracking" else (),
        pixels=np.ones((1, 2)) if status == "tracking" else np.zeros((0, 2)),
        covariances=np.tile(np.eye(2), (1 if status == "tracking" else 0, 1, 1)),
    )
    ok = status == "tracking"
    estimate = Estimate(
        frame=number,
        stamp_ns=number,
        status=status,
        reason="" if ok else "too_few",
        T_camera_target=np.eye(4) if ok else np.full((4, 4), np.nan),
        covariance=np.eye(6) if ok else np.full((6, 6), np.nan),
        n_inliers=4,
        reprojection_rms_px=1.0,
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )
    return view, estimate, Timing(frame=number, stamp_ns=number, detect_ms=1.0, update_ms=2.0)


def write_frame(folder: RunFolder, number: int, status: Status = "tracking") -> None:
    view, estimate, timing = make_frame(number, status)
    folder.write_view(view)
    folder.write(estimate, timing)


def test_a_run_leaves_every_file(tmp_path: Path) -> None:
    out = tmp_path / "new" / "run"
    with RunFolder(out, RECORD, TARGET, CAMERA) as folder:
        folder.open_sinks(Growing())
        assert read_run_record(out / "run.json").state == "running"
        write_frame(folder, 0)
        write_frame(folder, 1, "lost")
    record = read_run_record(out / "run.json")
    assert (record.state, record.frames, record.frames_with_pose) == ("done", 2, 1)
    assert [estimate.status for estimate in read_poses(out / "poses.csv")] == ["tracking", "lost"]
    assert [view.landmarks for view in read_views(out / "observations.csv")] == [("a",), ()]
    assert len(read_timing(out / "timing.csv")) == 2
    assert len((out / "trajectory.tum").read_text().splitlines()) == 1
    assert load_target(out / "target.toml").name == "t"
    assert load_camera(out / "camera.yaml").width == 640
    assert load_target(out / "target_refined.toml").positions[0, 0] >= 1.0
    assert not list(out.glob(".*")), "temporary files are gone"


@pytest.mark.parametrize(("error", "state"), [(RuntimeError, "failed"), (KeyboardInterrupt, "interrupted")])
def test_what_was_written_stays(tmp_path: Path, error: type[BaseException], state: str) -> None:
    def run() -> None:
        with RunFolder(tmp_path, RECORD, TARGET, CAMERA) as folder:
            folder.open_sinks(Growing())
            write_frame(folder, 0)
            raise error

    with pytest.raises(error):
        run()
    record = read_run_record(tmp_path / "run.json")
    assert (record.state, record.frames) == (state, 1)
    assert len(read_poses(tmp_path / "poses.csv")) == 1
    assert load_target(tmp_path / "target_refined.toml").landmarks == ("a", "b")


def test_lines_are_there_before_the_run_ends(tmp_path: Path) -> None:
    with RunFolder(tmp_path, RECORD, TARGET, CAMERA) as folder:
        folder.open_sinks(None)
        write_frame(folder, 0)
        assert len(read_poses(tmp_path / "poses.csv")) == 1
        assert len(list(read_views(tmp_path / "observations.csv"))) == 1
        assert len(read_timing(tmp_path / "timing.csv")) == 1
        assert (tmp_path / "trajectory.tum").read_text().endswith("\n")


def test_the_history_of_the_model_does_not_grow_with_the_frames(tmp_path: Path) -> None:
    estimator = Growing()
    sink = ModelHistorySink(tmp_path / "model_history.csv", estimator)
    for number in range(1000):
        estimator.offset_m = float(number)
        sink.write(make_frame(number)[1])
    sink.close()
    samples = read_model_history(tmp_path / "model_history.csv", ("a", "b"))
    assert [sample.frame for sample in samples[:40]] == list(range(40))
    assert samples[-1].frame == 999
    assert len(samples) < 120
    assert samples[3].positions.tolist() == [[3.0] * 3] * 2
    assert samples[3].sigmas_m.tolist() == [[1.0] * 3] * 2
    with pytest.raises(InputError, match="every landmark of the target in turn"):
        read_model_history(tmp_path / "model_history.csv", ("b", "a"))


def test_the_model_is_saved_every_second_and_seldomer_where_that_is_slow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [0.0]
    saved: list[float] = []

    def slow_save(path: Path, target: Target) -> None:
        assert path == tmp_path / "m.toml"
        assert target.name == "t"
        saved.append(clock[0])
        clock[0] += 0.1

    monkeypatch.setattr(model_sink.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(model_sink, "save_target", slow_save)
    sink = ModelSink(tmp_path / "m.toml", Growing())
    _, estimate, _ = make_frame(0)
    for _ in range(100):
        sink.write(estimate)
        clock[0] += 0.1
    # first after 1 s; saving takes 0.1 s, which may be 2 % of the time: the next ones 5 s apart
    assert np.allclose(np.diff(saved), 5.1, atol=0.21)
    assert abs(saved[0] - 1.0) < 0.11
    count = len(saved)
    sink.write(estimate)
    sink.close()
    sink.close()
    assert len(saved) == count + 1
