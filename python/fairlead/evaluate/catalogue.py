# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The list of all metrics, in the order of the tables: docs/metrics.md."""

from collections.abc import Callable, Mapping

from fairlead.evaluate import readers
from fairlead.evaluate.alignment import Alignment
from fairlead.evaluate.evaluation import Evaluation
from fairlead.evaluate.metric import Better, Group, Metric, Read
from fairlead.evaluate.pose_errors import ErrorSeries, PoseErrors
from fairlead.evaluate.readers import of_truth


def _rotation(errors: PoseErrors) -> ErrorSeries:
    return errors.rotation_deg


def _translation(errors: PoseErrors) -> ErrorSeries:
    return errors.translation_m


def _translation_percent(errors: PoseErrors) -> ErrorSeries:
    return errors.translation_percent


def _position(errors: PoseErrors) -> ErrorSeries:
    return errors.position_m


def _position_percent(errors: PoseErrors) -> ErrorSeries:
    return errors.position_percent


def _metric(key: str, group: Group, label: str, unit: str, read: Read, better: Better = "lower") -> Metric:
    return Metric(key=key, group=group, label=label, unit=unit, better=better, read=read)


_POSE: tuple[tuple[str, str, str, Callable[[PoseErrors], ErrorSeries]], ...] = (
    ("rotation_deg", "rotation", "deg", _rotation),
    ("translation_m", "translation", "m", _translation),
    ("translation_percent", "translation", "% of range", _translation_percent),
    ("position_m", "camera position", "m", _position),
    ("position_percent", "camera position", "% of range", _position_percent),
)


def _pose_metrics() -> tuple[Metric, ...]:
    plain = [
        _metric(key, "pose", f"{label}, mean", unit, readers.pose("raw", pick)) for key, label, unit, pick in _POSE
    ]
    strict = [
        _metric(
            f"{key}_penalised", "pose", f"{label}, failures penalised", unit, readers.pose("raw", pick, penalised=True)
        )
        for key, label, unit, pick in _POSE
        if unit != "m"
    ]
    return (*plain, *strict)


def _aligned_metrics(alignment: Alignment, moved: str) -> tuple[Metric, ...]:
    return tuple(
        _metric(f"{key}_{alignment}", "aligned", f"{label}, {moved}", unit, readers.pose(alignment, pick))
        for key, label, unit, pick in _POSE
        if unit != "% of range" or key == "position_percent"
    )


METRICS: tuple[Metric, ...] = (
    _metric("coverage_percent", "frames", "frames with a pose", "%", readers.coverage, "higher"),
    _metric("failure_percent", "frames", "failures", "%", of_truth(readers.failures)),
    *_pose_metrics(),
    *_aligned_metrics("se3", "rigid"),
    *_aligned_metrics("sim3", "similarity"),
    _metric("landmarks_before_m", "landmarks", "given model, raw", "m", readers.model("raw", after=False)),
    _metric("landmarks_m", "landmarks", "refined model, raw", "m", readers.model("raw", after=True)),
    _metric("landmarks_before_se3_m", "landmarks", "given model, rigid", "m", readers.model("se3", after=False)),
    _metric("landmarks_se3_m", "landmarks", "refined model, rigid", "m", readers.model("se3", after=True)),
    _metric("landmarks_before_sim3_m", "landmarks", "given model, similarity", "m", readers.model("sim3", after=False)),
    _metric("landmarks_sim3_m", "landmarks", "refined model, similarity", "m", readers.model("sim3", after=True)),
    _metric("landmark_shift_m", "landmarks", "landmarks moved by", "m", readers.landmark_shift, "neither"),
    _metric("pose_nees", "consistency", "NEES of the pose / dof", "-", readers.nees(readers.pose_nees), "one"),
    _metric(
        "pose_inside_95_percent", "consistency", "poses inside 95 %", "%", of_truth(readers.share_inside), "neither"
    ),
    _metric("model_nees", "consistency", "NEES of the model / dof", "-", readers.nees(readers.model_nees), "one"),
    _metric("prior_factor", "consistency", "prior factor", "-", readers.prior_factor, "one"),
    _metric("reprojection_px", "image", "reprojection, rms", "px", readers.reprojection),
    _metric("noise_factor", "image", "noise factor, robust", "-", readers.noise_factor, "one"),
    _metric("outlier_percent", "image", "outliers", "%", readers.outliers),
    _metric("add_m", "surface", "ADD, mean", "m", readers.surface(lambda s: (s.add_summary, s.add_recall))),
    _metric("mssd_m", "surface", "MSSD, mean", "m", readers.surface(lambda s: (s.mssd_summary, s.mssd_recall))),
    _metric("mspd_px", "surface", "MSPD, mean", "px", readers.surface(lambda s: (s.mspd_summary, s.mspd_recall))),
    _metric("ate_se3_m", "path", "ATE, path aligned rigidly", "m", readers.path(lambda t: t.ate_se3_m)),
    _metric("rpe_m", "path", "RPE, translation", "m", readers.path(lambda t: t.rpe_m)),
    _metric("rpe_deg", "path", "RPE, rotation", "deg", readers.path(lambda t: t.rpe_deg)),
    _metric("update_p50_ms", "time", "update, median", "ms", readers.update_time_p50),
    _metric("update_p99_ms", "time", "update, 99 %", "ms", readers.update_time_p99),
)
"""Each key once; an evaluation has those whose input it was given."""


def metric_values(evaluation: Evaluation) -> Mapping[str, float]:
    """Key -> value of every metric that this run has, in the order of METRICS."""
    readings = ((metric.key, metric.read(evaluation)) for metric in METRICS)
    return {key: reading.value for key, reading in readings if reading is not None}
