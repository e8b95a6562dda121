# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A simulated approach with awkward names, and a parser of the page: shared by the tests of the report."""

from collections import Counter
from html.parser import HTMLParser

import numpy as np

from fairlead import geometry
from fairlead.evaluate import Evaluation, evaluate
from fairlead.io.model_history import ModelSample
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


def without_truth(count: int) -> Evaluation:
    return evaluate(
        None,
        estimates(count, 0),
        target0=target(0.2),
        target_estimated=target(0.1),
        views=views(count),
        camera=CAMERA,
    )


VOID = {"meta", "link", "br", "img", "input", "hr"}


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
