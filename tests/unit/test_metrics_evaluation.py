# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One evaluation as a whole: what is there with truth, without truth, without poses, without frames."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fairlead import geometry
from fairlead.evaluate import METRICS, Evaluation, evaluate, evaluation_to_json, metric_values
from fairlead.evaluate.history import models_of_frames
from fairlead.evaluate.notes import notes
from fairlead.evaluate.tables import tables
from fairlead.evaluate.tiles import main_method, tiles
from fairlead.evaluate.units import MILLIMETRE, length_unit, number
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
NAMES = tuple("abcdefg")
X = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [3, 3, 0], [0, 3, 3], [3, 0, 3]])
SIGMA_M = 0.2


def target(positions: np.ndarray, sigma_m: float = SIGMA_M) -> Target:
    return Target(name="cube", landmarks=NAMES, positions=positions, covariance=sigma_m**2 * np.eye(21))


def estimate(frame: int, T: np.ndarray | None, reason: str = "") -> Estimate:
    return Estimate(
        frame=frame,
        stamp_ns=40_000_000 * frame,
        status="lost" if T is None else "tracking",
        reason=reason,
        T_camera_target=np.full((4, 4), np.nan) if T is None else T,
        covariance=np.full((6, 6), np.nan) if T is None else 1e-4 * np.eye(6),
        n_inliers=7,
        reprojection_rms_px=0.5,
        information_gained=0.0,
        reset_counter=0,
        inliers=(),
    )


def true_pose(frame: int) -> np.ndarray:
    return geometry.exp_se3(np.array([-1.0, -1.0, 20.0 - 0.1 * frame, 0.2, 0.02 * frame, 0.1]))


def flight(count: int = 12, *, lost: tuple[int, ...] = (), error: float = 0.01, name: str = "map") -> Evaluation:
    """Frames of an approach; poses are off by `error` in each component, landmarks by SIGMA_M before, less after."""
    rng = np.random.default_rng(1)
    truth = [TruthPose(frame=k, stamp_ns=40_000_000 * k, T_camera_target=true_pose(k)) for k in range(count)]
    poses = [geometry.perturb(true_pose(k), error * rng.normal(size=6)) for k in range(count)]
    estimates = [estimate(k, None if k in lost else poses[k], "gated" if k in lost else "") for k in range(count)]
    views = [
        View(
            frame=k,
            stamp_ns=40_000_000 * k,
            landmarks=NAMES,
            pixels=geometry.project(CAMERA, geometry.transform(true_pose(k), X)) + rng.normal(size=(7, 2)),
            covariances=np.broadcast_to(np.eye(2), (7, 2, 2)),
        )
        for k in range(count)
    ]
    before = target(X + SIGMA_M * rng.normal(size=X.shape))
    after = target(X + 0.1 * SIGMA_M * rng.normal(size=X.shape), 0.1 * SIGMA_M)
    history = [
        ModelSample(frame=k, stamp_ns=40_000_000 * k, positions=m.positions, sigmas_m=np.full((7, 3), 0.1))
        for k, m in ((0, before), (5, after))
    ]
    refined = name != "epnp"
    return evaluate(
        truth,
        estimates,
        target0=before,
        target_estimated=after if refined else None,
        target_true=target(X),
        mesh=X,
        views=views,
        camera=CAMERA,
        timings_ms=np.linspace(0.1, 0.3, count),
        models=history if refined else None,
    )


def test_a_perfect_run_has_no_error() -> None:
    truth = [TruthPose(frame=k, stamp_ns=k, T_camera_target=true_pose(k)) for k in range(4)]
    estimates = [replace(estimate(k, true_pose(k)), stamp_ns=k) for k in range(4)]
    found = evaluate(truth, estimates, target0=target(X), target_estimated=target(X), target_true=target(X), mesh=X)
    values = metric_values(found)
    for key in ("rotation_deg", "translation_m", "position_m", "landmarks_m", "add_m", "mssd_m", "ate_se3_m", "rpe_m"):
        assert values[key] == pytest.approx(0.0, abs=1e-9), key
    assert (values["coverage_percent"], values["failure_percent"]) == (100.0, 0.0)
    # Without observations, times and a camera there is nothing to say of them.
    assert not {"reprojection_px", "update_p50_ms", "mspd_px"} & set(values)


def test_every_metric_is_there_when_everything_is_given_and_keys_are_unique() -> None:
    keys = [metric.key for metric in METRICS]
    assert len(set(keys)) == len(keys)
    assert list(metric_values(flight())) == keys


def test_without_truth() -> None:
    found = evaluate(None, [estimate(0, true_pose(0))], target0=target(X), target_estimated=target(X + 0.1))
    assert found.truth is None
    assert set(metric_values(found)) == {"coverage_percent", "prior_factor", "landmark_shift_m"} - {"prior_factor"}
    assert evaluation_to_json(found)["pose"] is None


def test_true_landmarks_alone_give_landmark_errors() -> None:
    found = evaluate(None, [estimate(0, true_pose(0))], target0=target(X + 0.3), target_true=target(X))
    values = metric_values(found)
    assert values["landmarks_before_m"] == pytest.approx(0.3 * math.sqrt(3.0))
    assert values["landmarks_se3_m"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_run_without_any_pose_is_all_failure_and_no_number(count: int) -> None:
    found = flight(count, lost=tuple(range(count)))
    values = metric_values(found)
    if count:
        assert values["failure_percent"] == 100.0
        assert values["rotation_deg_penalised"] == 30.0
        assert math.isnan(values["rotation_deg"])
        assert values["coverage_percent"] == 0.0
    else:
        assert math.isnan(values["coverage_percent"])
        assert "failure_percent" not in values
    document = json.loads(json.dumps(evaluation_to_json(found), allow_nan=False))
    assert document["pose"]["raw"]["rotation_deg"]["summary"]["mean"] is None


def test_json_has_no_nan_and_keeps_infinity() -> None:
    behind = [estimate(0, geometry.exp_se3(np.array([0.0, 0, -20.0, 0, 0, 0])))]
    truth = [TruthPose(frame=0, stamp_ns=0, T_camera_target=true_pose(0))]
    found = evaluate(truth, behind, target0=target(X), target_true=target(X), mesh=X, camera=CAMERA)
    document = evaluation_to_json(found)
    text = json.dumps(document, allow_nan=False)
    assert json.loads(text)["pose"]["surface"]["mspd_summary"]["maximum"] == "inf"
    assert json.loads(text)["pose"]["failures"]["n_wrong"] == 1
    assert document["update_time"] is None


def test_json_names_every_landmark() -> None:
    document = evaluation_to_json(flight())
    after = document["model_after"]
    assert isinstance(after, dict)
    raw = after["raw"]
    assert isinstance(raw, dict)
    per_landmark = raw["per_landmark_m"]
    assert isinstance(per_landmark, dict)
    assert tuple(per_landmark) == NAMES
    assert raw["scale"] == 1.0


def test_a_frame_belongs_to_the_latest_model_before_it() -> None:
    samples = [
        ModelSample(frame=k, stamp_ns=stamp, positions=X + k, sigmas_m=np.ones((7, 3)))
        for k, stamp in ((1, 40_000_000), (2, 120_000_000))
    ]
    estimates = [estimate(k, true_pose(k)) for k in range(5)]
    found = models_of_frames(estimates, target(X), target(X + 9.0), samples)
    assert [float(each[0, 0]) for each in found] == [0.0, 1.0, 1.0, 2.0, 2.0]
    assert [float(each[0, 0]) for each in models_of_frames(estimates, target(X), target(X + 9.0), None)] == [9.0] * 5


def test_samples_of_another_target_are_refused() -> None:
    wrong = [ModelSample(frame=0, stamp_ns=0, positions=X[:3], sigmas_m=np.ones((3, 3)))]
    with pytest.raises(ValueError, match="models: expected samples of 7 landmarks, got one of 3"):
        evaluate(None, [estimate(0, true_pose(0))], target0=target(X), target_true=target(X), models=wrong)


def test_table_marks_bands_and_the_best_method() -> None:
    evaluations = {"epnp": flight(lost=(3,), error=0.05, name="epnp"), "map": flight()}
    rows = {row.key: row for table in tables(evaluations) for row in table.rows}
    coverage = rows["coverage_percent"].cells
    assert coverage[0] is not None
    assert coverage[1] is not None
    assert (coverage[0].text, coverage[0].mark, coverage[0].best) == ("91.7", "fair", False)
    assert (coverage[1].text, coverage[1].mark, coverage[1].best) == ("100", "good", True)
    refined = rows["landmarks_m"].cells
    assert refined[0] is not None
    assert refined[1] is not None
    assert (refined[0].mark, refined[1].mark) == (None, "good")
    assert rows["landmark_shift_m"].cells[0] is None
    nees = rows["pose_nees"].cells[1]
    assert nees is not None
    assert nees.mark == "good"
    assert nees.details[0].startswith("99.9 % band 0.")
    assert rows["pose_inside_95_percent"].cells[0] is not None


def test_tiles_are_about_our_method_and_name_the_others() -> None:
    evaluations = {"epnp": flight(name="epnp"), "map": flight()}
    assert main_method(evaluations) == "map"
    assert main_method({"fairlead": flight(), "epnp": flight(name="epnp")}) == "fairlead"
    first = tiles(evaluations)[0]
    assert (first.label, first.unit) == ("rotation", "deg")
    assert first.others[0][0] == "epnp"
    assert [tile.before != "" for tile in tiles(evaluations)] == [False, False, True, False, False, False]
    with pytest.raises(ValueError, match="expected at least one run"):
        main_method({})


def test_notes_say_what_spoils_a_comparison() -> None:
    whole, part = flight(), flight(8)
    assert any("judged on different frames (8, 12 of them)" in note for note in notes({"map": whole, "epnp": part}))
    assert notes({"map": whole}) == ()
    assert any("no pose because of gated (1)" in note for note in notes({"map": flight(lost=(2,))}))
    unmatched = evaluate(
        [TruthPose(frame=7, stamp_ns=10**15, T_camera_target=np.eye(4))], [estimate(0, true_pose(0))], target0=target(X)
    )
    assert any("none of the 1 true poses has a frame in this run" in note for note in notes({"map": unmatched}))


def test_small_targets_are_reported_in_millimetres() -> None:
    small = evaluate(None, [estimate(0, true_pose(0))], target0=target(0.1 * X), target_true=target(0.1 * X + 0.01))
    assert length_unit([small]) is MILLIMETRE
    row = next(row for table in tables({"map": small}) for row in table.rows if row.key == "landmarks_m")
    assert row.unit == "mm"
    assert row.cells[0] is not None
    assert row.cells[0].text == "17.3"
    assert metric_values(small)["landmarks_m"] == pytest.approx(0.0173, abs=1e-4)
    assert length_unit([small, flight()]) is not MILLIMETRE


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.5, "1234"),
        (12.345, "12.3"),
        (0.012345, "0.0123"),
        (-1.5, "−1.50"),
        (1.5e7, "1.50e+07"),
        (math.nan, "–"),
        (math.inf, "∞"),
    ],
)
def test_three_digits(value: float, text: str) -> None:
    assert number(value) == text
