# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a reader must know before believing the numbers: one sentence each."""

from collections.abc import Mapping

from fairlead.evaluate.evaluation import Evaluation


def notes(evaluations: Mapping[str, Evaluation]) -> tuple[str, ...]:
    """Warnings about the comparison as a whole, then about single runs. Empty if there is nothing to say."""
    found: list[str] = []
    judged = {len(each.truth.rows) for each in evaluations.values() if each.truth is not None}
    frames = {
        tuple(each.run.stamps_ns[each.truth.rows].tolist()) for each in evaluations.values() if each.truth is not None
    }
    if len(frames) > 1:
        counts = ", ".join(str(count) for count in sorted(judged))
        found.append(f"The methods were judged on different frames ({counts} of them): their means do not compare.")
    single = len(evaluations) == 1
    for name, evaluation in evaluations.items():
        found += [sentence if single else f"{name}: {sentence}" for sentence in _of_run(evaluation)]
    return tuple(found)


def _of_run(evaluation: Evaluation) -> list[str]:
    sentences: list[str] = []
    truth, image, covered = evaluation.truth, evaluation.reprojection, evaluation.coverage
    if not covered.n_ok:
        sentences.append("no frame has a pose.")
    elif covered.first_ok:
        sentences.append(f"the first pose came at frame {evaluation.run.frames[covered.first_ok]}.")
    if covered.reasons:
        sentences.append("no pose because of " + ", ".join(f"{why} ({count})" for why, count in covered.reasons) + ".")
    if covered.doubts:
        doubts = ", ".join(f"{why} ({count})" for why, count in covered.doubts)
        sentences.append(f"the data contradict what was told of the model or of the detections: {doubts}.")
    if covered.n_resets:
        sentences.append(f"the estimator announced {covered.n_resets} jumps of the pose.")
    if truth is not None:
        sentences += _of_matching(evaluation)
        nees = truth.consistency.nees
        if nees is not None and nees.n_outside:
            sentences.append(f"{nees.n_outside} poses have an error that their covariance calls impossible.")
    if image is not None and image.n_dropped:
        sentences.append(
            f"{image.n_dropped} observations could not be used (not finite, unknown, or without covariance)."
        )
    return sentences


def _of_matching(evaluation: Evaluation) -> list[str]:
    assert evaluation.truth is not None
    matching = evaluation.truth.matching
    if not matching.n_matched:
        return [f"none of the {matching.n_truth} true poses has a frame in this run; check the stamps."]
    sentences: list[str] = []
    if matching.n_matched < matching.n_estimates:
        sentences.append(
            f"truth is known for {matching.n_matched} of {matching.n_estimates} frames; the rest is not judged."
        )
    if matching.n_truth_left_over:
        sentences.append(f"{matching.n_truth_left_over} of {matching.n_truth} true poses have no frame in this run.")
    if matching.n_by_nearest:
        offset_ms = 1e-6 * matching.largest_offset_ns
        sentences.append(
            f"{matching.n_by_nearest} frames were matched by the nearest stamp, up to {offset_ms:.3g} ms off."
        )
    return sentences
