# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A new user's way through the page in a real browser: mesh and frames to target, labels, truth, and a tracked run.

FAIRLEAD_SCREENSHOTS names a folder that pictures of the page are then left in.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fairlead.annotate.journal import read_journal
from fairlead.annotate.surface import load_surface
from fairlead.cameras import project
from fairlead.cli import main
from fairlead.geometry import difference, inverse, transform
from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.poses import read_poses, read_truth
from fairlead.io.target import load_target
from fairlead.opencv.filters import write_image

BROWSER = shutil.which("chromium")
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no chromium here: apt-get install chromium")
FRAMES = 20
# The page is put together without a graphics card, the mesh by SwiftShader: fastest on a machine without one.
ARGUMENTS = (
    *("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-gpu-rasterization", "--disable-gpu-compositing"),
)
WAIT_MS = 45_000


@dataclass
class Server:
    """fairlead annotate in a process of its own."""

    process: subprocess.Popen[str]
    address: str


def serve(folder: Path) -> Server:
    command = [sys.executable, "-m", "fairlead", "annotate", str(folder), "--no-show", "--port", "0"]
    # NiceGUI behaves otherwise where it sees that it is tested; a user's does not.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST")}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    line = process.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:\d+", line)
    if found is None:
        process.kill()
        pytest.fail(f"no address: {line} {process.communicate()[1]}")
    if not wait_for(int(found[0].rpartition(":")[2]), process):
        process.kill()
        pytest.fail(f"nobody listens at {found[0]}: {process.communicate()[1]}")
    return Server(process=process, address=found[0])


def wait_for(port: int, process: subprocess.Popen[str]) -> bool:
    """Until somebody listens there."""
    for _ in range(900):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return True
        if process.poll() is not None:
            return False
        time.sleep(0.1)
    return False


def stop(server: Server, number: int = signal.SIGINT) -> str:
    server.process.send_signal(number)
    return server.process.communicate(timeout=60)[1]


@pytest.fixture(scope="module")
def sequence(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty frames of the satellite: from its approach where they were rendered, at a quarter of the size."""
    folder = tmp_path_factory.mktemp("sequence")
    truth = [
        *("render", "landing", "--target", str(repository / "data" / "satellite" / "target.toml")),
        *("--surroundings", "space", "--quality", "draft", "--frames", str(FRAMES), "--stride", "2"),
        *("--camera", str(small_camera(repository, folder)), "-o", str(folder / "rendered")),
    ]
    if main(truth) != 0:
        pytest.skip("no OpenGL here: apt-get install libegl1 libgl1-mesa-dri")
    return folder


def small_camera(repository: Path, folder: Path) -> Path:
    text = (repository / "data" / "satellite" / "camera.yaml").read_text()
    for old, new in (("1024", "384"), ("1910.0", "2400.0"), ("511.5", "191.5")):
        text = text.replace(old, new)
    (folder / "camera.yaml").write_text(text)
    return folder / "camera.yaml"


@pytest.fixture
def folder(sequence: Path, repository: Path, tmp_path: Path) -> Path:
    """What a new user has: a mesh, a calibration, images."""
    folder = tmp_path / "satellite"
    shutil.copytree(sequence / "rendered" / "rgb", folder / "images")
    shutil.copy(repository / "data" / "satellite" / "satellite.ply", folder)
    shutil.copy(sequence / "camera.yaml", folder)
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=BROWSER, args=list(ARGUMENTS))
        yield chromium
        chromium.close()


def open_page(browser: Any, address: str, strangers: list[str]) -> Any:
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.set_default_timeout(WAIT_MS)
    page.on(
        "request", lambda r: None if r.url.startswith((address, "data:", "blob:", "ws:")) else strangers.append(r.url)
    )
    page.goto(address)
    page.get_by_text("fairlead", exact=True).wait_for()
    return page


def until(holds: Callable[[], bool]) -> None:
    """Wait for what the page does to the file."""
    for _ in range(300):
        if holds():
            return
        time.sleep(0.1)
    pytest.fail("waited in vain")


def picture(page: Any, name: str) -> None:
    wanted = os.environ.get("FAIRLEAD_SCREENSHOTS")
    if wanted:
        page.wait_for_timeout(1500)
        page.screenshot(path=str(Path(wanted) / f"annotate-{name}.png"))


def status(page: Any, text: str) -> None:
    page.get_by_text(text).first.wait_for()


def edit_in_3d(page: Any, folder: Path) -> None:
    """Pick a point on the mesh, name it, drag it over the surface, delete it."""
    canvas = page.locator("canvas").bounding_box()
    x, y = canvas["x"] + 0.5 * canvas["width"], canvas["y"] + 0.5 * canvas["height"]
    page.mouse.dblclick(x, y)
    status(page, "add p13")
    page.get_by_label("name").first.fill("bow")
    page.keyboard.press("Enter")
    status(page, "rename p13 to bow")
    before = read_journal(folder / "labels.jsonl").labels.landmarks[-1]
    page.mouse.move(x, y)
    page.wait_for_timeout(500)
    page.mouse.down()
    page.mouse.move(x + 30, y + 25, steps=4)
    page.mouse.up()
    status(page, "move bow")
    after = read_journal(folder / "labels.jsonl").labels.landmarks[-1]
    assert (before.name, after.name) == ("bow", "bow")
    assert after.position_m != before.position_m
    surface = load_surface(folder / "satellite.ply")
    assert surface.distance_m(np.array([before.position_m, after.position_m])).max() < 1e-3
    page.keyboard.press("Delete")
    status(page, "delete bow")


def click_landmarks(page: Any, folder: Path, T_camera_target: np.ndarray) -> int:
    """Click on every landmark that can be seen where it is; the page says which is next."""
    labels = read_journal(folder / "labels.jsonl").labels
    camera = load_camera(folder / "camera.yaml")
    eye = inverse(T_camera_target)[:3, 3]
    seen = load_surface(folder / "satellite.ply").seen_from(eye, labels.positions)
    pixels = project(camera, transform(T_camera_target, labels.positions))
    box = page.locator(".box img").bounding_box()
    scale = box["width"] / camera.width
    clicked = 0
    for landmark, ok, (u, v) in zip(labels.landmarks, seen, pixels, strict=True):
        if not (ok and 2.0 < u < camera.width - 3.0 and 2.0 < v < camera.height - 3.0):
            continue
        page.locator(".line").get_by_text(landmark.name, exact=True).last.click()
        page.mouse.click(box["x"] + (u + 0.5) * scale, box["y"] + (v + 0.5) * scale)
        status(page, f"mark {landmark.name} in frame 0")
        clicked += 1
    return clicked


@pytest.mark.slow
def test_from_mesh_and_frames_to_a_tracked_run(browser: Any, folder: Path, sequence: Path) -> None:
    server, strangers = serve(folder), list[str]()
    truth = read_truth(sequence / "rendered" / "truth.csv")
    try:
        page = open_page(browser, server.address, strangers)
        page.get_by_role("button", name="Suggest").click()
        status(page, "add 12 landmarks")
        edit_in_3d(page, folder)
        page.mouse.move(5, 5)
        picture(page, "landmarks")
        page.get_by_role("tab", name="Frames").click()
        page.locator(".box img").wait_for()
        page.wait_for_timeout(1000)
        assert click_landmarks(page, folder, truth[0].T_camera_target) >= 5
        page.keyboard.press("f")
        picture(page, "frames")
        for number in range(1, FRAMES):
            page.keyboard.press("n")
            status(page, f"frame {number}: ")
        page.get_by_role("tab", name="Truth").click()
        page.get_by_role("button", name="Solve all jointly").click()
        status(page, "Solved jointly")
        picture(page, "truth")
        page.get_by_role("button", name="Save files").click()
        status(page, f"{FRAMES} frames labelled")
    finally:
        stop(server)
    assert strangers == []
    check_files(folder, truth)


def check_files(folder: Path, truth: list[Any]) -> None:
    assert len(load_target(folder / "target.toml").landmarks) == 12
    views = list(read_views(folder / "observations.csv"))
    assert len(views) == FRAMES
    told = read_poses(folder / "truth.csv")
    assert len(told) >= FRAMES - 2
    for each in told:
        xi = difference(each.T_camera_target, truth[each.frame].T_camera_target)
        assert xi @ np.linalg.solve(each.covariance, xi) < 40.0  # chi-square of 6: one in a million beyond 38
    run = ["track", str(folder / "observations.csv"), "--target", str(folder / "target.toml")]
    run += ["--camera", str(folder / "camera.yaml"), "--truth", str(folder / "truth.csv"), "-o", str(folder / "run")]
    assert main(run) == 0
    assert sum(each.ok for each in read_poses(folder / "run" / "poses.csv")) >= FRAMES - 2


@pytest.mark.slow
def test_two_tabs_a_bad_image_and_a_killed_server_lose_nothing(browser: Any, folder: Path) -> None:
    write_image(
        folder / "images" / sorted(p.name for p in (folder / "images").glob("*.png"))[1], np.zeros((9, 9, 3), np.uint8)
    )
    server, strangers = serve(folder), list[str]()
    try:
        first = open_page(browser, server.address, strangers)
        second = open_page(browser, server.address, strangers)
        status(first, "open in 2 tabs")
        first.get_by_role("button", name="Suggest").click()
        status(second, "add 12 landmarks")
        second.get_by_text("p12", exact=True).first.wait_for()
        second.close()
        first.get_by_role("tab", name="Frames").click()
        first.locator(".box img").wait_for()
        first.wait_for_timeout(500)
        first.keyboard.press("h")
        status(first, "p1 is hidden in frame 0")
        first.keyboard.press("ArrowRight")
        status(first, "expected 384 x 384 as the camera has, got an image of 9 x 9")
        first.keyboard.press("Control+z")
        until(lambda: 0 not in read_journal(folder / "labels.jsonl").labels.frames)
        first.keyboard.press("Control+Shift+z")
        until(lambda: 0 in read_journal(folder / "labels.jsonl").labels.frames)
    finally:
        stop(server, signal.SIGKILL)
    labels = read_journal(folder / "labels.jsonl").labels
    assert labels.frames[0][labels.landmarks[0].number].hidden
    again = serve(folder)
    try:
        other = subprocess.run(
            [sys.executable, "-m", "fairlead", "annotate", str(folder), "--no-show", "--port", "0"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert other.returncode == 2
        assert "is being edited by another fairlead annotate" in other.stderr
        assert len(other.stderr.splitlines()) == 1
        page = open_page(browser, again.address, strangers)
        page.locator(".line").get_by_text("hidden", exact=True).wait_for()
    finally:
        said = stop(again)
    assert "Traceback" not in said
    assert read_journal(folder / "labels.jsonl").labels == labels
