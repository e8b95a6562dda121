# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Bad weather: errors of networks and tracker against its strength."""

from collections.abc import Mapping
from collections.abc import Sequence as Rows

from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import network_facts
from fairlead.reproduce.figures.weather import draw_weather
from fairlead.reproduce.measured import measure
from fairlead.reproduce.methods import EPNP, ONLINE
from fairlead.reproduce.scores import score, summarise
from fairlead.reproduce.sequences import Sequence, find_sequences
from fairlead.reproduce.work import job_of, run_job

SEEDS = 3
_COLUMNS = (
    Column(key="kind", title="weather"),
    Column(key="strength", title="strength", plain=True),
    Column(key="network", title="network"),
    Column(key="mean_px", title="landmark error [px]"),
    Column(key="p95_px", title="95 % [px]"),
    Column(key="found", title="visible found [%]", percent=True),
    Column(key="inside_90", title="inside its 90 % ellipse [%]", percent=True),
    Column(key="factor", title="variance factor [-]"),
    Column(key="epnp_m", title="EPnP: translation [m]"),
    Column(key="map_m", title="online: translation [m]"),
    Column(key="map_failed", title="online: failed [%]", percent=True, digits=2),
    Column(key="map_nees", title="online: NEES / 6", digits=2),
)


def weather(context: Context) -> Section:
    """Every KIND-STRENGTH folder that --weather holds; `clear-0` is the sequence without."""
    missing = ["networks trained without weather beside those trained with it: one training each is what there is"]
    if context.config.weather is None:
        return _section(context, [], ["no weather was rendered: expected --weather", *missing])
    scenes = find_sequences((context.config.weather,), context.target_path, context.cache / "tables")
    rows = [row for scene in scenes for network in context.networks if (row := _row(context, scene, network))]
    return _section(context, sorted(rows, key=_order), missing)


def _order(row: Mapping[str, Cell]) -> tuple[str, str, float]:
    return str(row["kind"]), str(row["network"]), float(row["strength"] or 0.0)


def _row(context: Context, scene: Sequence, network: Network) -> dict[str, Cell] | None:
    kind, _, strength = scene.name.rpartition("-")
    found = context.detections(scene, network)
    if found is None:
        return None
    observed = context.observed(scene, network)
    measured = measure(observed)
    scores: dict[str, list[dict[str, float]]] = {EPNP: [], ONLINE: []}
    for seed in range(min(SEEDS, context.seeds)):
        job = job_of(scene, found, observed, seed)
        tracks = run_job(job, context.cache / "runs")
        for method, each in scores.items():
            each.append(score(tracks[method], job.flight))
    ours, theirs = summarise(scores[ONLINE]), summarise(scores[EPNP])
    row: dict[str, Cell] = {"kind": kind, "strength": float(strength), "network": network.label}
    if measured is not None:
        row |= {"mean_px": measured.mean_px, "p95_px": measured.p95_px, "found": measured.found}
        row |= {"inside_90": measured.inside_90, "factor": measured.factor}
    row |= {"epnp_m": theirs["translation_all_m"], "map_m": ours["translation_all_m"]}
    return row | {
        "map_failed": ours["failed"],
        "map_nees": ours["pose_nees"],
        "map_sigma_m": ours["sigma_translation_m"],
    }


def _section(context: Context, rows: Rows[Mapping[str, Cell]], missing: Rows[str]) -> Section:
    note = (
        "Weather is laid over the light of the same rendered images (docs/rendering.md section 6), so that nothing "
        "but the weather differs. Translation counts failed frames with their limits. The variance factor is the "
        "calibration that the network's covariance would need in this condition."
    )
    caption = "Mean error of visible landmarks, and translation error of fairlead online, against strength; 0 is clear."
    table = Table(name="weather", title="Against the strength of the weather", columns=_COLUMNS, rows=rows, note=note)
    pictures = [Picture(name="weather", caption=caption, figure=draw_weather(rows))] if rows else []
    return Section(
        name="weather",
        title="Weather",
        published=published.WEATHER,
        tables=[table] if rows else [],
        pictures=pictures,
        missing=missing,
        facts={"told models": str(min(SEEDS, context.seeds))} | network_facts(context),
    )
