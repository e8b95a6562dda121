# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""How each metric is read off an evaluation, with its small print and its mark (docs/metrics.md section 10)."""

from collections.abc import Callable

from fairlead.evaluate.alignment import Alignment
from fairlead.evaluate.consistency import Nees
from fairlead.evaluate.evaluation import AgainstTruth, Evaluation
from fairlead.evaluate.metric import Mark, Read, Reading, graded
from fairlead.evaluate.pose_errors import ErrorSeries, PoseErrors
from fairlead.evaluate.summary import Summary
from fairlead.evaluate.surface import SurfaceErrors
from fairlead.evaluate.trajectory import TrajectoryErrors
from fairlead.evaluate.units import number


def coverage(evaluation: Evaluation) -> Reading:
    """Frames with a pose [%]."""
    found = evaluation.coverage
    return graded(100.0 * found.rate, (95.0, 100.0), (50.0, 100.0), f"{found.n_ok} of {found.n_frames} frames")


def of_truth(read: Callable[[AgainstTruth], Reading | None]) -> Read:
    """Nothing without truth, or where no frame was judged."""

    def guarded(evaluation: Evaluation) -> Reading | None:
        truth = evaluation.truth
        return None if truth is None or not truth.matching.n_matched else read(truth)

    return guarded


def failures(truth: AgainstTruth) -> Reading:
    """Frames without a pose, or with one beyond a limit [%]."""
    found = truth.raw.failures
    note = f"{found.n_without_pose} without pose, {found.n_wrong} wrong, of {found.n_frames}"
    return graded(100.0 * found.rate, (0.0, 0.0), (0.0, 5.0), note)


def pose(alignment: Alignment, pick: Callable[[PoseErrors], ErrorSeries], *, penalised: bool = False) -> Read:
    """Mean of one kind of pose error under one alignment; over the frames with a pose, or over all and penalised."""

    def read(truth: AgainstTruth) -> Reading | None:
        errors = {"raw": truth.raw, "se3": truth.se3, "sim3": truth.sim3}[alignment]
        if errors is None:
            return None
        series = pick(errors)
        if penalised:
            return Reading(value=series.penalised, note="all judged frames")
        summary = series.summary
        spread = (("rms", summary.rms), ("median", summary.median), ("p95", summary.p95))
        return Reading(value=summary.mean, spread=spread)

    return of_truth(read)


def model(alignment: Alignment, *, after: bool) -> Read:
    """Rms of the landmark errors [m]; the refined model is marked by comparison with the given one."""

    def read(evaluation: Evaluation) -> Reading | None:
        before = None if evaluation.model_before is None else evaluation.model_before.aligned(alignment)
        refined = None if evaluation.model_after is None else evaluation.model_after.aligned(alignment)
        errors = refined if after else before
        if errors is None or before is None:
            return None
        spread = (("mean", errors.summary.mean), ("worst", errors.summary.maximum))
        mark = _compared(errors.summary.rms, before.summary.rms) if after else None
        return Reading(value=errors.summary.rms, spread=spread, mark=mark)

    return read


def _compared(now: float, before: float) -> Mark | None:
    """None for a method that leaves the model alone."""
    return None if now == before else "good" if now < before else "bad"


def nees(pick: Callable[[Evaluation], Nees | None]) -> Read:
    """NEES / dof against its band, docs/metrics.md eq. (20)."""

    def read(evaluation: Evaluation) -> Reading | None:
        found = pick(evaluation)
        if found is None:
            return None
        band, one = found.band999, found.band999_one
        note = f"99.9 % band {band.lower:.2f}–{band.upper:.2f}"
        if found.n_samples > 1:
            note += f"; of one pose {one.lower:.2f}–{one.upper:.2f}"
        if found.n_outside:
            note += f"; {found.n_outside} with an error called impossible"
        mark: Mark = "good" if band.holds(found.per_dof) else "fair" if one.holds(found.per_dof) else "bad"
        return Reading(value=found.per_dof, note=note, mark="bad" if found.n_outside else mark)

    return read


def pose_nees(evaluation: Evaluation) -> Nees | None:
    """Of all judged poses."""
    return None if evaluation.truth is None else evaluation.truth.consistency.nees


def model_nees(evaluation: Evaluation) -> Nees | None:
    """Of the model that came out."""
    return None if evaluation.model_after is None else evaluation.model_after.nees


def share_inside(truth: AgainstTruth) -> Reading | None:
    """Poses inside their own 95 % band [%]."""
    found = truth.consistency.nees
    return None if found is None else Reading(value=100.0 * found.share_inside_95, note="expected 95")


def prior_factor(evaluation: Evaluation) -> Reading | None:
    """How much worse the given model was than told [-], docs/metrics.md eq. (21)."""
    change = evaluation.model_change
    if change is None or change.prior_factor is None:
        return None
    return graded(change.prior_factor, (0.5, 1.5), (0.0, 3.0))


def landmark_shift(evaluation: Evaluation) -> Reading | None:
    """Rms distance between given and refined landmarks [m]."""
    change = evaluation.model_change
    return None if change is None else Reading(value=change.summary.rms, spread=(("most", change.summary.maximum),))


def reprojection(evaluation: Evaluation) -> Reading | None:
    """Rms over all observations [px]."""
    found = evaluation.reprojection
    if found is None:
        return None
    spread = (("median", found.summary.median), ("without outliers", found.rms_in_gate_px))
    return Reading(value=found.summary.rms, spread=spread, note=f"{found.summary.count} observations")


def noise_factor(evaluation: Evaluation) -> Reading | None:
    """How many times too small the told sigma looks [-], docs/metrics.md eq. (13)."""
    found = evaluation.reprojection
    if found is None:
        return None
    return graded(found.robust_noise_factor, (0.8, 1.25), (0.0, 2.0), f"with outliers {number(found.noise_factor)}")


def outliers(evaluation: Evaluation) -> Reading | None:
    """Observations beyond the 99.9 % gate [%]."""
    found = evaluation.reprojection
    return None if found is None else graded(100.0 * found.outlier_share, (0.0, 1.0), (0.0, 10.0), "expected 0.1")


def surface(pick: Callable[[SurfaceErrors], tuple[Summary | None, float | None]]) -> Read:
    """Mean of one surface error, with its recall."""

    def read(truth: AgainstTruth) -> Reading | None:
        if truth.surface is None:
            return None
        summary, recall = pick(truth.surface)
        if summary is None or recall is None:
            return None
        return Reading(value=summary.mean, note=f"recall {100.0 * recall:.1f} %")

    return of_truth(read)


def path(pick: Callable[[TrajectoryErrors], Summary | None]) -> Read:
    """Rms of one trajectory error."""

    def read(truth: AgainstTruth) -> Reading | None:
        found = None if truth.trajectory is None else pick(truth.trajectory)
        return None if found is None else Reading(value=found.rms, spread=(("max", found.maximum),))

    return of_truth(read)


def update_time_p50(evaluation: Evaluation) -> Reading | None:
    """Median of the update time [ms]."""
    found = evaluation.update_time
    return None if found is None else Reading(value=found.p50_ms, spread=(("mean", found.mean_ms),))


def update_time_p99(evaluation: Evaluation) -> Reading | None:
    """99 % quantile of the update time [ms]."""
    found = evaluation.update_time
    return None if found is None else Reading(value=found.p99_ms, spread=(("max", found.maximum_ms),))
