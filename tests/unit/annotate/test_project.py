# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Opening a folder: labels, mesh and target must belong together; what is written can be read by everything else."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from fairlead.annotate.export import export_all
from fairlead.annotate.journal import Header, Journal, Written
from fairlead.annotate.project import JOURNAL, Frame, Project, open_project
from fairlead.annotate.solve import solve_frame, solve_jointly, view_of
from fairlead.annotate.surface import load_surface
from fairlead.geometry import difference
from fairlead.io.coco import read_coco
from fairlead.io.errors import InputError
from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses, read_truth
from fairlead.io.target import load_target
from fairlead.opencv.filters import write_image
from fairlead.types import KnownDistance, MotionPrior
from tests.unit.annotate.conftest import Scene


@pytest.fixture(autouse=True)
def journals_are_closed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """However a test ends."""
    opened: list[Journal] = []
    load = Journal._load

    def remembered(self: Journal, header: Header) -> Written:
        opened.append(self)
        return load(self, header)

    monkeypatch.setattr(Journal, "_load", remembered)
    yield
    for journal in opened:
        journal.close()


def labelled(scene: Scene, folder: Path) -> Project:
    """A project with every frame labelled."""
    frames = [Frame(number=10 * k, stamp_ns=k * 10**8, path=folder / f"{k:03d}.png") for k in range(4)]
    project = open_project(folder, surface=scene.surface, camera=scene.camera, target=scene.target, frames=frames)
    labels = scene.labels(np.random.default_rng(0), noise_px=0.5)
    for k, frame in enumerate(frames):
        project.document.set_marks(frame.number, labels.frames[k], "labels")
    return project


def test_landmarks_begin_as_the_target_has_them_and_come_back(scene: Scene, tmp_path: Path) -> None:
    project = labelled(scene, tmp_path)
    assert [each.name for each in project.document.labels.landmarks] == list(scene.target.landmarks)
    assert project.document.labels.landmarks[3].sigma_m == pytest.approx((0.05, 0.05, 0.05))
    project.journal.close()
    again = open_project(tmp_path, surface=scene.surface, camera=scene.camera, target=scene.target)
    assert again.document.labels == project.document.labels
    assert again.notices == ()
    again.journal.close()


def test_everything_that_is_saved_can_be_read(scene: Scene, tmp_path: Path) -> None:
    project = labelled(scene, tmp_path)
    labels = project.document.labels
    views = [view_of(labels, frame.number, frame.stamp_ns) for frame in project.frames]
    joint = solve_jointly(labels, views, scene.camera, scene.surface)
    exported = export_all(project, joint.solutions, joint)
    assert (exported.labelled, exported.posed) == (4, 4)
    assert {path.name for path in exported.files} == {
        *("target.toml", "target_refined.toml", "observations.csv", "truth.csv", "annotations.json")
    }
    for read, written in zip(read_views(tmp_path / "observations.csv"), views, strict=True):
        assert (read.frame, read.stamp_ns, read.landmarks) == (written.frame, written.stamp_ns, written.landmarks)
        np.testing.assert_array_equal(read.pixels, written.pixels)
    truth = read_truth(tmp_path / "truth.csv")
    assert [each.frame for each in truth] == [0, 10, 20, 30]
    for each, T in zip(truth, scene.T_camera_target, strict=False):
        assert np.linalg.norm(difference(each.T_camera_target, T)[:3]) < 1.0
    np.testing.assert_allclose(
        read_poses(tmp_path / "truth.csv")[2].covariance, joint.solutions[20].estimate.covariance, rtol=1e-9
    )
    assert load_target(tmp_path / "target_refined.toml").landmarks == scene.target.landmarks
    names, images = read_coco(tmp_path / "annotations.json")
    assert names == scene.target.landmarks
    for image, seen, pixels in zip(images, scene.seen(), scene.pixels(), strict=False):
        visible = np.array(image.visibility) == 2
        assert visible[seen].all()
        assert visible[~seen].sum() <= 1  # a pose off by its sigma sees a corner of grazing incidence
        assert np.abs(image.pixels - pixels).max() < 5.0
        x, y, width, height = image.box
        assert ((pixels >= (x - 2, y - 2)) & (pixels <= (x + width + 2, y + height + 2))).all()


def test_saving_keeps_what_else_the_target_says_and_the_old_file(scene: Scene, tmp_path: Path) -> None:
    distance = KnownDistance(between=("feed", "nozzle"), length_m=2.1, sigma_m=0.01)
    motion = MotionPrior(kind="target", jerk_density_m_s25=0.2)
    told = replace(scene.target, mesh=None, distances=(distance,), motion=motion)
    project = open_project(tmp_path, target=told)
    (tmp_path / "target.toml").write_text("# by hand\n")
    export_all(project, {}, None)
    assert (tmp_path / "target.toml").read_text() == "# by hand\n"  # nothing was changed: left alone
    project.document.set_sigma(0, (0.0, 0.0, 0.0))
    project.document.move_landmark(1, (1.0, 2.0, 3.0))
    export_all(project, {}, None)
    assert (tmp_path / "target.toml.old").read_text() == "# by hand\n"
    saved = load_target(tmp_path / "target.toml")
    assert (saved.distances, saved.motion) == ((distance,), motion)
    assert saved.positions[1].tolist() == [1.0, 2.0, 3.0]
    assert np.sqrt(np.diag(saved.covariance))[:6] == pytest.approx([0.0, 0.0, 0.0, 0.05, 0.05, 0.05])
    assert saved.touchdown is not None
    project.document.delete_landmark(16)
    export_all(project, {}, None)
    assert load_target(tmp_path / "target.toml").distances == ()


def test_labels_of_another_target_are_refused_and_kept(scene: Scene, tmp_path: Path, repository: Path) -> None:
    labelled(scene, tmp_path).journal.close()
    before = (tmp_path / JOURNAL).read_bytes()
    frigate = load_target(repository / "data" / "frigate" / "target.toml")
    with pytest.raises(InputError, match=r"labels are of another target \(satellite\).*expected labels of frigate"):
        open_project(tmp_path, target=frigate)
    assert (tmp_path / JOURNAL).read_bytes() == before


def test_a_wrong_mesh_is_refused_and_the_labels_kept(scene: Scene, tmp_path: Path, repository: Path) -> None:
    labelled(scene, tmp_path).journal.close()
    before = (tmp_path / JOURNAL).read_bytes()
    other = load_surface(repository / "data" / "frigate" / "frigate.ply")
    with pytest.raises(InputError, match=r"not of frigate\.ply: .* off it \(they were made on satellite\.ply\)"):
        open_project(tmp_path, surface=other)
    assert (tmp_path / JOURNAL).read_bytes() == before


def test_a_mesh_that_was_edited_is_taken_with_a_notice(scene: Scene, tmp_path: Path) -> None:
    labelled(scene, tmp_path).journal.close()
    edited = replace(scene.surface, sha256="0" * 64)
    project = open_project(tmp_path, surface=edited)
    assert any("satellite.ply has changed" in notice for notice in project.notices)
    project.journal.close()
    again = open_project(tmp_path, surface=edited)
    assert again.notices == ()
    again.journal.close()


def test_a_mesh_in_millimetres_is_noticed(tmp_path: Path) -> None:
    trimesh.creation.box(extents=(3000.0, 1000.0, 1000.0)).export(tmp_path / "part.stl")
    project = open_project(tmp_path, surface=load_surface(tmp_path / "part.stl"))
    assert "--mesh-scale 0.001" in project.notices[0]
    project.journal.close()
    (tmp_path / "metres").mkdir()
    project = open_project(tmp_path / "metres", surface=load_surface(tmp_path / "part.stl", 0.001))
    assert project.notices == ()
    project.journal.close()


def test_a_torn_journal_is_told_of(scene: Scene, tmp_path: Path) -> None:
    labelled(scene, tmp_path).journal.close()
    path = tmp_path / JOURNAL
    path.write_bytes(path.read_bytes()[:-20])
    project = open_project(tmp_path, target=scene.target)
    assert any("cut off" in notice for notice in project.notices)
    assert sorted(project.document.labels.frames) == [0, 10, 20]
    project.journal.close()


def test_images_of_another_size_and_huge_ones_are_one_line(scene: Scene, tmp_path: Path) -> None:
    project = labelled(scene, tmp_path)
    write_image(project.frames[0].path, np.zeros((20, 30, 3), np.uint8))
    with pytest.raises(InputError, match="expected 1024 x 1024 as the camera has, got an image of 30 x 20"):
        project.check_frame(project.frames[0])
    header = b"P5 60000 60000 255\n"
    project.frames[1].path.write_bytes(header)
    with pytest.raises(InputError):
        project.check_frame(project.frames[1])
    write_image(project.frames[2].path, np.zeros((1024, 1024, 3), np.uint8))
    project.check_frame(project.frames[2])
    with pytest.raises(KeyError):
        project.frame(5)


def test_frames_without_pose_are_not_truth(scene: Scene, tmp_path: Path) -> None:
    project = labelled(scene, tmp_path)
    labels = project.document.labels
    project.document.set_marks(10, dict(list(labels.marks(10).items())[:3]), "few")
    labels = project.document.labels
    solutions = {f.number: solve_frame(labels, view_of(labels, f.number, 0), scene.camera) for f in project.frames}
    exported = export_all(project, solutions, None)
    assert (exported.labelled, exported.posed) == (4, 3)
    assert [each.frame for each in read_truth(tmp_path / "truth.csv")] == [0, 20, 30]
    assert not (tmp_path / "target_refined.toml").exists()
    assert str(exported).endswith("4 frames labelled, 3 with pose")
