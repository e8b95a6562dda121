# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figure 12: error of each single landmark before and after."""

import numpy as np

from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context, Seeds
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.figures.dumbbells import draw_dumbbells
from fairlead.reproduce.methods import BATCH, EPNP, ONLINE, WINDOW

_METHODS = (EPNP, WINDOW, ONLINE, BATCH)


def single_landmarks(context: Context) -> Section:
    """Default network; root mean square over told models."""
    panels: dict[str, dict[str, np.ndarray]] = {}
    names: tuple[str, ...] = ()
    rows: list[dict[str, Cell]] = []
    for sequence in context.sequences:
        network = context.best_network(sequence)
        if network is None or (names and sequence.true.landmarks != names):
            continue
        names = sequence.true.landmarks
        errors = {method: _errors(context.runs(sequence, network), method) for method in _METHODS}
        panels[sequence.name] = errors
        for j, name in enumerate(names):
            numbers = {method: float(values[j]) for method, values in errors.items()}
            rows.append({"sequence": sequence.name, "landmark": name, **numbers})
    columns = [Column(key="sequence", title="sequence"), Column(key="landmark", title="landmark")]
    columns += [Column(key=key, title=title) for key, title in zip(_METHODS, _TITLES, strict=True)]
    caption = (
        "Error of each landmark of the model, root mean square over told models: told (hollow) and at the end of the "
        "flight. What is more than 2.5 times the largest told error is drawn at the edge."
    )
    return Section(
        name="single_landmarks",
        title="Figure 12: single landmarks before and after",
        published="On real images single landmarks get worse.",
        tables=[Table(name="figure12", title="Error of single landmarks [m rms]", columns=columns, rows=rows)],
        pictures=[Picture(name="figure12", caption=caption, figure=draw_dumbbells(names, _drawn(panels)))]
        if panels
        else [],
        missing=[] if panels else [NO_SEQUENCES],
        facts=run_facts(context) | {"source": published.SOURCE},
    )


_TITLES = (
    "told model [m]",
    "published window [m]",
    "fairlead, online [m]",
    "fairlead, batch [m]",
)


def _errors(seeds: Seeds, method: str) -> np.ndarray:
    """EPnP's model is the told one."""
    squares = [
        ((tracks[method].X - flight.X_true) ** 2).sum(axis=1)
        for tracks, flight in zip(seeds.tracks, seeds.flights, strict=True)
    ]
    return np.sqrt(np.mean(squares, axis=0))


def _drawn(panels: dict[str, dict[str, np.ndarray]]) -> dict[str, dict[str, np.ndarray]]:
    """Beyond 2.5 times the largest told error at the edge."""
    cut: dict[str, dict[str, np.ndarray]] = {}
    for name, errors in panels.items():
        limit = 2.5 * float(errors[EPNP].max())
        cut[name] = {method: np.minimum(errors[method], limit) for method in _METHODS}
    return cut
