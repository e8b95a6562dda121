# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Each part off, or on, once."""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fairlead.reproduce.content import Cell, Column, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.methods import ONLINE, Flight
from fairlead.reproduce.scores import paired, score, summarise
from fairlead.reproduce.sequences import Sequence
from fairlead.reproduce.work import Job, flight_of, run_job
from fairlead.tracker import TrackerOptions


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One change."""

    name: str
    label: str
    options: Callable[[TrackerOptions], TrackerOptions] = lambda told: told
    """Of what a user's estimator would be told."""
    change: Callable[[Flight], Flight] | None = None


def _prior_too_wide(flight: Flight) -> Flight:
    return dataclasses.replace(flight, told=dataclasses.replace(flight.told, covariance=100.0 * flight.told.covariance))


def _one_covariance(flight: Flight) -> Flight:
    """All observations get the median variance of the sequence, round."""
    S = flight.observed.covariances
    with np.errstate(invalid="ignore"):
        variance = float(np.nanmedian(0.5 * np.trace(S, axis1=2, axis2=3)))
    views = tuple(
        dataclasses.replace(view, covariances=np.tile(variance * np.eye(2), (len(view.landmarks), 1, 1)))
        for view in flight.views
    )
    known = np.asarray(np.isfinite(S).all(axis=(2, 3)))
    observed = dataclasses.replace(
        flight.observed, covariances=np.where(known[..., None, None], variance * np.eye(2), np.nan)
    )
    return dataclasses.replace(flight, views=views, observed=observed)


def _changed(name: str, label: str, **options: Any) -> Variant:
    return Variant(name=name, label=label, options=lambda told: dataclasses.replace(told, **options))


VARIANTS = (
    Variant(name="default", label="as it comes"),
    Variant(name="untold", label="not told that errors stay", options=lambda _: TrackerOptions()),
    Variant(name="prior", label="model prior told ten times too wide", change=_prior_too_wide),
    _changed("loss", "robust loss turns at 10 sigma", loss_threshold=100.0),
    Variant(name="covariance", label="one covariance for all detections", change=_one_covariance),
    _changed("window-8", "a window of 8 views", max_views=8),
    _changed("window-64", "a window of 64 views", max_views=64),
    _changed("motion-range", "motion: smooth range", motion="range", jerk_density_m_s25=0.5),
    _changed("motion-target", "motion: smooth path", motion="target", jerk_density_m_s25=0.5),
)
_COLUMNS = (
    Column(key="sequence", title="sequence"),
    Column(key="label", title="fairlead, online"),
    Column(key="rotation_all_deg", title="rotation [deg]"),
    Column(key="translation_all_m", title="translation [m]", interval=True),
    Column(key="ratio", title="translation / as it comes", interval=True),
    Column(key="model_m", title="model [m]"),
    Column(key="failed", title="failed [%]", percent=True, digits=2),
    Column(key="pose_nees", title="NEES / 6", digits=2),
    Column(key="model_nees", title="model NEES / 3n", digits=2),
    Column(key="update_mean_ms", title="update [ms]"),
)
_WORDS = (
    "As it comes: told by the network's card that its errors stay, as `track` tells it; motion is off, because nothing "
    "is told of how the target moves, and here it is on once."
)
_CANNOT = (
    "marginalisation: what leaves the window is always compressed; the sizes of the window show what relinearising "
    "is worth",
    "the robust loss as a whole: with a threshold that is never reached the tracker finds no pose",
    "noise estimation: the common factor of the variances is always estimated",
    "the model prior as a whole: without it the estimator is the published window of table 3",
)


def ablation(context: Context) -> Section:
    """Default network on every sequence."""
    rows: list[dict[str, Cell]] = []
    for sequence in context.sequences:
        network = context.best_network(sequence)
        if network is not None:
            rows += _rows(context, sequence, network)
    note = "Failed frames count with their limits. All rows of a sequence have the same told models; ratios are paired."
    return Section(
        name="ablation",
        title="Ablation: each part off once",
        words=[_WORDS],
        tables=[Table(name="ablation", title="Each part off, or on, once", columns=_COLUMNS, rows=rows, note=note)],
        missing=[*_CANNOT, *([] if rows else [NO_SEQUENCES])],
        facts=run_facts(context),
    )


def _rows(context: Context, sequence: Sequence, network: Network) -> list[dict[str, Cell]]:
    found = context.detections(sequence, network)
    assert found is not None
    rows: list[dict[str, Cell]] = []
    plain: list[float] = []
    with context.progress(f"ablation, {sequence.name}", lambda: len(VARIANTS) * context.seeds) as advance:
        for variant in VARIANTS:
            scores: list[dict[str, float]] = []
            for seed in range(context.seeds):
                flight = flight_of(sequence, found.views, context.observed(sequence, network), seed)
                told = flight if variant.change is None else variant.change(flight)
                name = f"{sequence.name}/{network.name}/{variant.name}-{seed:03d}"
                job = Job(flight=told, name=name, methods=(ONLINE,), options=variant.options(found.options))
                scores.append(score(run_job(job, context.cache / "runs")[ONLINE], told))
                advance(1)
            errors = [each["translation_all_m"] for each in scores]
            plain = plain or errors
            pair = paired(errors, plain)
            head: dict[str, Cell] = {"sequence": sequence.name, "network": network.label, "variant": variant.name}
            ratio = {"ratio": pair.ratio, "ratio_low95": pair.low, "ratio_high95": pair.high}
            rows.append(head | {"label": variant.label} | summarise(scores) | ratio)
    return rows
