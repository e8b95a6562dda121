# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""report.html: self-contained, well-formed, safe with any name, the same for the same run; judging run folders."""

import csv
import json
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate import (
    Evaluation,
    ReportHeader,
    evaluate,
    evaluate_run,
    evaluate_runs,
    render_report,
    write_report,
)
from fairlead.evaluate.figures import COLOURS
from fairlead.evaluate.figures.svg import VARIABLES
from fairlead.io.camera import save_camera
from fairlead.io.errors import InputError
from fairlead.io.model_history import ModelSample
from fairlead.io.observations import write_views
from fairlead.io.poses import write_poses, write_truth
from fairlead.io.run_record import RunRecord, write_run_record
from fairlead.io.target import save_target
from fairlead.types import Camera, Estimate, Target, TruthPose, View

CAMERA = Camera(
    name="c",
    width=640,
    height=480,
    model="pinhole",
    K=np.array([[500.0, 0, 320], [0, 500.0, 240], [0, 0, 1]]),
    distortion=np.zeros(0),
)
X = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [3, 3, 0], [0, 3, 3]])
NAMES = ("$a_1$", "<b>&", "_c", "船首", "e'\"", "f")
"""As people name things: mathematics, markup, other scripts."""
STEP_NS = 40_000_000
VOID = {"meta", "link", "br", "img", "input", "hr"}


def target(offset_m: float, sigma_m: float = 0.2) -> Target:
    X_off = X + offset_m * np.sin(np.arange(18.0)).reshape(6, 3)
    return Target(name="a <ship> & co", landmarks=NAMES, positions=X_off, covariance=sigma_m**2 * np.eye(18))


def true_pose(frame: int) -> np.ndarray:
    return geometry.exp_se3(np.array([-1.0, -1.0, 20.0 - 0.01 * frame, 0.2, 0.002 * frame, 0.1]))


def estimates(count: int, lost: int) -> list[Estimate]:
    rng = np.random.default_rng(0)
    made: list[Estimate] = []
    for k in range(count):
        T = geometry.perturb(true_pose(k), 0.01 * rng.normal(size=6))
        gone = lost <= k < lost + count // 10
        made.append(
            Estimate(
                frame=k,
                stamp_ns=STEP_NS * k,
                status="lost" if gone else "tracking",
                reason="gated" if gone else "",
                T_camera_target=np.full((4, 4), np.nan) if gone else T,
                covariance=np.full((6, 6), np.nan) if gone else 1e-4 * np.eye(6),
                n_inliers=0 if gone else 6,
                reprojection_rms_px=float("nan") if gone else 0.5,
                information_gained=0.0,
                reset_counter=0,
                inliers=(),
            )
        )
    return made


def truth(count: int) -> list[TruthPose]:
    return [TruthPose(frame=k, stamp_ns=STEP_NS * k, T_camera_target=true_pose(k)) for k in range(count)]


def views(count: int) -> list[View]:
    rng = np.random.default_rng(2)
    return [
        View(
            frame=k,
            stamp_ns=STEP_NS * k,
            landmarks=NAMES,
            pixels=geometry.project(CAMERA, geometry.transform(true_pose(k), X)) + rng.normal(size=(6, 2)),
            covariances=np.broadcast_to(np.eye(2), (6, 2, 2)),
        )
        for k in range(count)
    ]


def flight(count: int, *, lost: int = 5) -> Evaluation:
    after = target(0.02, 0.02)
    sample = ModelSample(frame=0, stamp_ns=0, positions=after.positions, sigmas_m=np.full((6, 3), 0.02))
    return evaluate(
        truth(count),
        estimates(count, lost),
        target0=target(0.2),
        target_estimated=after,
        target_true=target(0.0),
        mesh=X,
        views=views(count),
        camera=CAMERA,
        timings_ms=np.full(count, 0.2),
        models=[sample],
    )


HEADER = ReportHeader(
    title="a <ship> & co",
    subtitle="<script>alert(1)</script>",
    camera=CAMERA,
    versions=(("fairlead", "0.1.0"),),
    inputs=(("source", "obs & more.csv", "0123456789abcdef0000"),),
)


@pytest.fixture(scope="module")
def page() -> str:
    return render_report({"epnp": flight(40, lost=20), "map": flight(40), "a <method> $x$": without_truth(40)}, HEADER)


class Tags(HTMLParser):
    """Collects what the page refers to, and complains about tags that do not close in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.references: list[str] = []
        self.ids: Counter[str] = Counter()
        self.kinds: Counter[str] = Counter()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.kinds[tag] += 1
        for name, value in attrs:
            if name in ("href", "src", "xlink:href", "action", "srcset", "data"):
                self.references.append(value or "")
            if name == "id":
                self.ids[value or ""] += 1
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> without a start"
        assert self.open.pop() == tag


def parsed(page: str) -> Tags:
    tags = Tags()
    tags.feed(page)
    tags.close()
    assert tags.open == []
    return tags


def test_nothing_is_fetched_and_nothing_runs(page: str) -> None:
    tags = parsed(page)
    assert all(reference.startswith("#") for reference in tags.references)
    assert set(re.findall(r"https?://[^\"' <)]*", page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }
    assert "@import" not in page
    assert all(found.startswith("#") for found in re.findall(r"url\(([^)]*)\)", page))
    assert re.findall(r"<script[^>]*>", page) == ['<script type="application/json" id="metrics">']
    assert not {"link", "iframe", "object", "img"} & set(tags.kinds)


def test_ids_are_unique_and_references_point_somewhere(page: str) -> None:
    tags = parsed(page)
    assert [name for name, count in tags.ids.items() if count > 1] == []
    wanted = {found[1:] for found in tags.references} | set(re.findall(r"url\(#([^)]*)\)", page))
    assert wanted <= set(tags.ids)


def test_every_figure_is_well_formed_svg_without_a_size_or_style_of_its_own(page: str) -> None:
    figures = re.findall(r"<svg.*?</svg>", page, re.DOTALL)
    # errors, 2 x consistency, landmarks raw and aligned, model, trajectory, residuals, reprojection
    assert len(figures) == 9
    for svg in figures:
        root = ElementTree.fromstring(svg)
        assert root.get("viewBox")
        assert root.get("width") is None
        assert "<style" not in svg
        assert "DejaVu" not in svg


def test_names_are_text_never_markup_or_mathematics(page: str) -> None:
    assert "<title>a &lt;ship&gt; &amp; co: evaluation</title>" in page
    assert "<script>alert" not in page
    assert "a &lt;method&gt; $x$" in page
    for name in ("$a_1$", "&lt;b&gt;&amp;", "_c", "船首"):
        assert f">{name}</text>" in page, name


def test_all_methods_and_numbers_are_on_the_page(page: str) -> None:
    for key in ("rotation_deg", "pose_nees", "landmarks_sim3_m", "add_m", "update_p99_ms"):
        assert f'<tr id="{key}">' in page
    document = json.loads(re.findall(r'id="metrics">(.*?)</script>', page, re.DOTALL)[0])
    assert list(document) == ["epnp", "map", "a <method> $x$"]
    assert document["map"]["coverage"]["n_frames"] == 40
    assert "no pose because of gated (4)" in page


def test_the_same_run_gives_the_same_page() -> None:
    pages = {render_report({"refine": without_truth(8)}, HEADER) for _ in range(2)}
    assert len(pages) == 1


def test_every_colour_has_a_light_and_a_dark_form(page: str) -> None:
    style = page[page.index("<style>") : page.index("</style>")]
    light, dark = style.split("prefers-color-scheme: dark", 1)
    for variable in VARIABLES.values():
        assert f"{variable}:" in light, variable
        assert f"{variable}:" in dark, variable
    assert set(COLOURS) == {"epnp", "window", "map", "refine", "truth", "bound"}


def without_truth(count: int) -> Evaluation:
    return evaluate(
        None,
        estimates(count, 0),
        target0=target(0.2),
        target_estimated=target(0.1),
        views=views(count),
        camera=CAMERA,
    )


@pytest.mark.parametrize("count", [0, 1])
def test_hardly_any_frames(count: int) -> None:
    parsed(render_report({"map": flight(count)}, HEADER))


def test_no_pose_at_all() -> None:
    evaluation = evaluate(truth(10), [each for each in estimates(100, 0) if not each.ok], target0=target(0.2))
    page = render_report({"map": evaluation}, HEADER)
    parsed(page)
    assert "No frame has a pose." in page


def test_without_truth_the_page_speaks_of_what_is_known() -> None:
    page = render_report({"refine": without_truth(20)}, HEADER)
    parsed(page)
    assert "no truth" in page
    assert 'id="reprojection_px"' in page
    assert 'id="rotation_deg"' not in page
    assert "How far each landmark moved" in page


def test_a_long_run_stays_small(tmp_path: Path) -> None:
    write_report(tmp_path / "report.html", {"map": flight(400)}, HEADER)
    assert (tmp_path / "report.html").stat().st_size < 500_000
    assert [item.name for item in tmp_path.iterdir()] == ["report.html"]


def write_run(folder: Path, count: int = 12, method: str = "map") -> Path:
    """A folder as `track` leaves it, written through the same functions."""
    folder.mkdir()
    save_target(folder / "target.toml", target(0.2))
    save_target(folder / "target_refined.toml", target(0.02, 0.02))
    save_camera(folder / "camera.yaml", CAMERA)
    write_poses(folder / "poses.csv", estimates(count, 3))
    write_views(folder / "observations.csv", views(count))
    (folder / "timing.csv").write_text(
        "frame,stamp_ns,detect_ms,update_ms\n"
        + "".join(f"{k},{STEP_NS * k},0.1,{0.2 + 0.01 * k}\n" for k in range(count))
    )
    record = RunRecord(command="track", state="done", options={"method": method}, inputs=(), frames=count)
    write_run_record(folder / "run.json", record)
    return folder


def test_run_folder(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    write_truth(tmp_path / "truth.csv", truth(12))
    save_target(tmp_path / "target_true.toml", target(0.0))
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 2 3\nf 1 2 4\n")
    report = evaluate_run(
        run, tmp_path / "truth.csv", target_true=tmp_path / "target_true.toml", mesh=tmp_path / "mesh.obj"
    )
    assert report == run / "report.html"
    parsed(report.read_text(encoding="utf-8"))
    document = json.loads((run / "metrics.json").read_text())
    metrics = document["runs"]["map"]["metrics"]
    # The estimates are the true poses times Exp(0.01 m, 0.01 rad): 0.01 sqrt(2 x 4 / pi) = 0.016 in the mean.
    assert metrics["translation_m"] == pytest.approx(0.016, rel=0.5)
    assert metrics["coverage_percent"] == pytest.approx(100.0 * 11 / 12)
    assert metrics["add_m"] > 0.0
    assert metrics["update_p50_ms"] == pytest.approx(0.255)
    with (run / "errors.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 12
    assert (rows[3]["failed"], rows[3]["rotation_deg"]) == ("1", "")
    assert float(rows[0]["translation_m"]) > 0.0


def test_several_runs_side_by_side_without_truth(tmp_path: Path) -> None:
    runs = {name: write_run(tmp_path / name, method=name) for name in ("epnp", "map")}
    report = evaluate_runs(runs, output=tmp_path / "both")
    assert sorted(item.name for item in report.parent.iterdir()) == [
        *("errors_epnp.csv", "errors_map.csv", "metrics.json", "report.html")
    ]
    assert list(json.loads((report.parent / "metrics.json").read_text())["runs"]) == ["epnp", "map"]


def test_what_cannot_be_used_is_one_line(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    (tmp_path / "mesh.ply").write_bytes(b"ply\nformat ascii 1.0\n")
    with pytest.raises(InputError, match=r"mesh\.ply: no readable mesh"):
        evaluate_run(run, mesh=tmp_path / "mesh.ply")
    with pytest.raises(InputError, match=r"truth\.csv"):
        evaluate_run(run, tmp_path / "truth.csv")
    (run / "run.json").unlink()
    with pytest.raises(InputError, match=r"run\.json"):
        evaluate_run(run)
    assert not (run / "report.html").exists()
