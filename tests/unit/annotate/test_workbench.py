# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the page can do, without the page: poses in step with labels, marks carried on, drawings."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fairlead.annotate.labels import Labels, Landmark, Mark
from fairlead.annotate.overlay import BAD, CARRIED, GOOD, draw_marks, draw_mesh
from fairlead.annotate.project import Frame, open_project
from fairlead.annotate.workbench import Workbench
from fairlead.io.target import load_target
from fairlead.opencv.filters import encode_png, write_image
from tests.unit.annotate.conftest import Scene
from tests.unit.annotate.test_propagate import texture


@pytest.fixture
def bench(scene: Scene, tmp_path: Path) -> Iterator[Workbench]:
    frames = [Frame(number=k, stamp_ns=k * 10**8, path=tmp_path / f"{k:03d}.png") for k in range(4)]
    project = open_project(tmp_path, surface=scene.surface, camera=scene.camera, target=scene.target, frames=frames)
    yield Workbench(project)
    project.journal.close()


def test_poses_follow_the_labels(scene: Scene, bench: Workbench) -> None:
    labels = scene.labels(np.random.default_rng(0))
    assert bench.labelled() == []
    bench.document.set_marks(1, labels.frames[1], "labels")
    first = bench.solution(1)
    assert first is not None
    assert first.estimate.ok
    assert bench.solution(1) is first  # not solved again
    number = next(iter(labels.frames[1]))
    bench.document.clear(1, number)
    second = bench.solution(1)
    assert second is not None
    assert number not in second.residuals
    bench.document.set_all_sigmas(0.0)
    assert bench.solution(1) is not second
    assert [each.number for each in bench.labelled()] == [1]


def test_joint_poses_are_the_truth_until_something_changes(scene: Scene, bench: Workbench) -> None:
    labels = scene.labels(np.random.default_rng(0))
    for k in range(3):
        bench.document.set_marks(k, labels.frames[k], "labels")
    joint = bench.solve_all()
    assert bench.truth(1) is bench.solution(1)
    bench.take_joint(joint)
    assert bench.truth(1) is joint.solutions[1]
    assert {path.name for path in bench.save().files} >= {"target_refined.toml", "truth.csv"}
    bench.document.clear(0, next(iter(labels.frames[0])))
    assert not bench.joint_is_current
    assert bench.truth(1) is bench.solution(1)
    bench.document.undo()
    assert not bench.joint_is_current  # solved again rather than believed by chance


def test_suggestions_become_landmarks_with_free_names_in_one_action(scene: Scene, tmp_path: Path) -> None:
    project = open_project(tmp_path, surface=scene.surface)
    bench = Workbench(project)
    bench.document.add_landmark("p2", (1.2, 0.9, 1.0), (0.0, 0.0, 0.0))
    assert bench.suggest(5) == 5
    assert [each.name for each in bench.labels.landmarks] == ["p2", "p1", "p3", "p4", "p5", "p6"]
    assert bench.labels.landmarks[1].sigma_m == pytest.approx((0.07, 0.07, 0.07))
    bench.document.undo()
    assert [each.name for each in bench.labels.landmarks] == ["p2"]
    bench.save()
    assert load_target(tmp_path / "target.toml").landmarks == ("p2",)
    project.journal.close()


def test_a_pick_near_a_corner_is_the_corner(bench: Workbench) -> None:
    corner = (1.2, 0.9, 1.0)
    assert bench.pick((1.15, 0.85, 1.0), snap=True) == pytest.approx(corner, abs=0.1)
    picked = bench.pick((1.3, 0.3, 0.75), snap=False)
    assert picked == pytest.approx((1.2, 0.3, 0.75), abs=0.1)


def test_without_mesh_or_camera_each_says_what_it_lacks(tmp_path: Path) -> None:
    project = open_project(tmp_path)
    bench = Workbench(project)
    with pytest.raises(ValueError, match="expected a mesh"):
        bench.suggest(3)
    with pytest.raises(ValueError, match="expected a camera"):
        bench.solve_all()
    with pytest.raises(ValueError, match="expected landmarks"):
        bench.save()
    assert bench.pick((1.0, 2.0, 3.0), snap=True) == (1.0, 2.0, 3.0)
    project.journal.close()


def test_marks_are_carried_to_the_next_frame_as_one_action(tmp_path: Path) -> None:
    frames = [Frame(number=10 * k, stamp_ns=k, path=tmp_path / f"{k}.png") for k in range(3)]
    for k, frame in enumerate(frames):
        write_image(frame.path, np.repeat(texture(2.0 * k, 1.0 * k)[..., None], 3, axis=2))
    project = open_project(tmp_path, frames=frames)
    bench = Workbench(project)
    for u, v in ((60.0, 60.0), (160.0, 120.0), (250.0, 190.0)):
        landmark = bench.document.add_landmark(bench.document.free_name(), (u, v, 0.0), (0.0, 0.0, 0.0))
        bench.document.mark(0, landmark.number, u, v)
    done = bench.propagate(0)
    assert (done.frame, done.carried, done.lost) == (10, 3, 0)
    assert str(done) == "frame 10: 3 marks carried"
    mark = bench.labels.marks(10)[1]
    assert (mark.u_px, mark.v_px) == pytest.approx((162.0, 121.0), abs=0.1)
    bench.document.undo()
    assert bench.labels.marks(10) == {}
    with pytest.raises(ValueError, match="last frame"):
        bench.propagate(20)
    project.journal.close()


def test_drawings_say_what_is_good_carried_bad_and_hidden(scene: Scene, bench: Workbench) -> None:
    labels = scene.labels(np.random.default_rng(0))
    marks = dict(labels.frames[2])
    a, b, c, d = list(marks)[:4]
    marks[a] = Mark(u_px=marks[a].u_px, v_px=marks[a].v_px, origin="flow")
    marks[b] = Mark(u_px=marks[b].u_px + 50.0, v_px=marks[b].v_px)
    marks[c] = Mark(hidden=True)
    bench.document.set_marks(2, marks, "labels")
    solution = bench.solution(2)
    assert solution is not None
    svg = draw_marks(bench.labels, marks, solution, d, 2.0)
    assert svg.count(f'stroke="{CARRIED}" stroke-width="2"') == 1
    assert svg.count(f'stroke="{BAD}" stroke-width="2"') == 1
    assert svg.count(f'stroke="{GOOD}" stroke-width="2"') == len(marks) - 3
    dashed = svg.count('stroke-dasharray="2 2"')
    assert dashed == len(set(range(18)) - solution.in_sight - set(marks)) + 1
    # A cross is drawn half a pixel from the number of the pixel: SVG counts from the corner.
    assert f"M{marks[d].u_px + 0.5 + 1.5:.2f} {marks[d].v_px + 0.5:.2f}L" in svg
    mesh = draw_mesh(scene.surface, scene.camera, solution.estimate.T_camera_target)
    assert mesh.count("M") > 100


def test_names_cannot_break_out_of_the_drawing() -> None:
    landmark = Landmark(number=0, name='<b>"&x', position_m=(0.0, 0.0, 0.0), sigma_m=(0.0, 0.0, 0.0))
    svg = draw_marks(Labels(landmarks=(landmark,)), {0: Mark(u_px=1.0, v_px=2.0)}, None, None, 1.0)
    assert "&lt;b&gt;&quot;&amp;x" in svg
    assert "<b>" not in svg


def test_other_formats_are_shown_as_png() -> None:
    assert encode_png(np.zeros((4, 5, 3), np.uint8))[:4] == b"\x89PNG"
