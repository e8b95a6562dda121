# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Bad weather: errors of networks and tracker against its strength, and what their covariances say of it."""

from collections.abc import Mapping
from collections.abc import Sequence as Rows
from dataclasses import replace

from fairlead.render.errors import RenderError
from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Detections, Network
from fairlead.reproduce.experiments.shared import network_facts
from fairlead.reproduce.figures.weather import draw_weather
from fairlead.reproduce.measured import Measured, measure, views_of
from fairlead.reproduce.methods import EPNP, ONLINE, Flight
from fairlead.reproduce.scores import score, summarise
from fairlead.reproduce.sequences import Sequence, find_sequences
from fairlead.reproduce.skies import render_skies
from fairlead.reproduce.work import Job, flight_of, run_job

SEEDS = 5
CALIBRATED = "calibrated"
_COLUMNS = (
    Column(key="kind", title="weather"),
    Column(key="strength", title="strength", plain=True),
    Column(key="network", title="network"),
    Column(key="mean_px", title="landmark error [px]"),
    Column(key="median_px", title="median [px]"),
    Column(key="found", title="visible found [%]", percent=True),
    Column(key="inside_90", title="inside its 90 % ellipse [%]", percent=True),
    Column(key="nees", title="its NEES / 2", digits=2),
    Column(key="factor", title="its variance factor [-]", digits=2),
    Column(key="epnp_m", title="EPnP: translation [m]"),
    Column(key="map_m", title="online: translation [m]"),
    Column(key="map_failed", title="online: failed [%]", percent=True, digits=2),
    Column(key="map_nees_median", title="online: NEES / 6, median", digits=2),
    Column(key="calibrated_m", title="calibrated: translation [m]"),
    Column(key="calibrated_nees_median", title="calibrated: NEES / 6, median", digits=2),
)


def weather(context: Context) -> Section:
    """Every KIND-STRENGTH folder of --weather; `clear-0` is the sequence without."""
    missing = ["networks trained without weather beside those trained with it: one training each is what there is"]
    folder = context.config.weather
    if folder is None:
        return _section(context, [], ["no weather was rendered: expected --weather", *missing])
    try:
        render_skies(folder, context.progress)
    except RenderError as error:
        return _section(context, [], [f"no weather was rendered: {error}", *missing])
    scenes = find_sequences((folder,), context.target_path, context.cache / "tables")
    rows = [row for scene in scenes for network in context.networks if (row := _row(context, scene, network))]
    return _section(context, sorted(rows, key=_order), missing)


def _order(row: Mapping[str, Cell]) -> tuple[str, str, float]:
    return str(row["kind"]), str(row["network"]), float(row["strength"] or 0.0)


def _row(context: Context, scene: Sequence, network: Network) -> dict[str, Cell] | None:
    kind, _, strength = scene.name.rpartition("-")
    found = context.detections(scene, network)
    if found is None:
        return None
    row: dict[str, Cell] = {"kind": kind, "strength": float(strength), "network": network.label}
    measured = measure(context.observed(scene, network))
    if measured is not None:
        row |= {key: getattr(measured, key) for key in ("mean_px", "median_px", "p95_px", "found")}
        row |= {key: getattr(measured, key) for key in ("inside_90", "nees", "factor", "outliers")}
    for name, each in _scores(context, scene, found, measured).items():
        numbers = summarise(each)
        row |= {f"{name}_m": numbers["translation_all_m"], f"{name}_deg": numbers["rotation_all_deg"]}
        row |= {f"{name}_failed": numbers["failed"], f"{name}_nees": numbers["pose_nees"]}
        row |= {f"{name}_nees_median": numbers["pose_nees_median"]}
        row |= {f"{name}_sigma_m": numbers["sigma_translation_m"]}
    return row


def _scores(
    context: Context, scene: Sequence, found: Detections, measured: Measured | None
) -> dict[str, list[dict[str, float]]]:
    """EPnP and online as they come, and online with the covariances calibrated in this weather."""
    observed = context.observed(scene, found.network)
    scores: dict[str, list[dict[str, float]]] = {EPNP: [], ONLINE: [], CALIBRATED: []}
    for seed in range(min(SEEDS, context.seeds)):
        flight = flight_of(scene, found.views, observed, seed)
        name = f"{scene.name}/{found.network.name}/weather-{seed:03d}"
        job = Job(flight=flight, name=name, methods=(EPNP, ONLINE), options=found.options)
        for method, track in run_job(job, context.cache / "runs").items():
            scores[method].append(score(track, flight))
        told = flight if measured is None else calibrated(flight, measured.factor)
        job = replace(job, flight=told, name=f"{name}-calibrated", methods=(ONLINE,))
        scores[CALIBRATED].append(score(run_job(job, context.cache / "runs")[ONLINE], told))
    return scores


def calibrated(flight: Flight, factor: float) -> Flight:
    """The same observations with their variances times `factor`."""
    observed = replace(flight.observed, covariances=factor * flight.observed.covariances)
    return replace(flight, observed=observed, views=views_of(flight.told.landmarks, observed))


def _section(context: Context, rows: Rows[Mapping[str, Cell]], missing: Rows[str]) -> Section:
    note = (
        "Translation counts failed frames with their limits. NEES: 1 is a true covariance, outliers are inside; that "
        "of the landmarks is the network's alone. The variance factor is the calibration that the network's "
        "covariance would need in this condition, outliers left out; 'calibrated' is online told that. It changes "
        "little, because ours finds a common factor by itself. Pictures are 2.4 s apart: where the network loses the "
        "ship, it has to be found again, and one picture in which something else is taken for it costs a whole mean."
    )
    caption = (
        "Median error of visible landmarks; translation error of fairlead online, failed frames with their limits; "
        "their share; and its NEES per degree of freedom, median (1 is a true covariance). 0 is clear."
    )
    table = Table(name="weather", title="Against the strength of the weather", columns=_COLUMNS, rows=rows, note=note)
    pictures = [Picture(name="weather", caption=caption, figure=draw_weather(rows))] if rows else []
    return Section(
        name="weather",
        title="Weather",
        published=published.WEATHER,
        words=[_WORDS],
        tables=[table] if rows else [],
        pictures=pictures,
        missing=missing,
        facts={"told models": str(min(SEEDS, context.seeds))} | network_facts(context),
    )


_WORDS = (
    "The same flight under every weather, 17 pictures of the fast renderer (docs/reproduce.md section 10): light, "
    "flight and sea are the same, nothing but the weather differs. The fast renderer is what most training pictures "
    "came from; on full renders a network errs a little more (data/frigate/heat-t.md)."
)
