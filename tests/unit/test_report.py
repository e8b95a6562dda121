# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""report.html: self-contained, well-formed, safe with any name, the same for the same run."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fairlead.evaluate import ReportHeader, evaluate, render_report, write_report
from fairlead.evaluate.figures import COLOURS
from fairlead.evaluate.figures.svg import VARIABLES
from tests.unit.report_flight import CAMERA, estimates, flight, parsed, target, truth, without_truth

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
