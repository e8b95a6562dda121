# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figure 11: pose errors per frame of one sample per sequence, and the error of the model over the flight."""

import numpy as np

from fairlead.reproduce import published
from fairlead.reproduce.content import Picture, Section
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import Network
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, run_facts
from fairlead.reproduce.figures.curves import Curves, draw_curves
from fairlead.reproduce.methods import BATCH, BOUND, EPNP, ONLINE, TRUE, WINDOW
from fairlead.reproduce.scores import errors_of
from fairlead.reproduce.sequences import Sequence

_METHODS = (EPNP, WINDOW, TRUE, ONLINE, BATCH)
_WITH_MODEL = (WINDOW, ONLINE, BATCH)


def curves(context: Context) -> Section:
    """Default network."""
    rows = [
        _curves(context, sequence, network)
        for sequence in context.sequences
        if (network := context.best_network(sequence)) is not None
    ]
    caption = (
        "Left and middle: errors with told model 0, thin every frame (EPnP and online), thick the root mean square "
        "over 11 frames; the bound is that of what was seen so far. Right: mean error of the model over all told "
        "models; the told one is EPnP's."
    )
    pictures = [Picture(name="figure11", caption=caption, figure=draw_curves(rows))] if rows else []
    return Section(
        name="curves",
        title="Figure 11: errors over the flight",
        published=published.SEQUENCES,
        pictures=pictures,
        missing=[] if rows else [NO_SEQUENCES],
        facts=run_facts(context),
    )


def _curves(context: Context, sequence: Sequence, network: Network) -> Curves:
    seeds, bounds = context.runs(sequence, network), context.bounds(sequence, network)
    errors = {method: errors_of(seeds.tracks[0][method], sequence.T_true) for method in _METHODS}
    rotation = {method: each.rotation_deg for method, each in errors.items()}
    translation = {method: each.translation_m for method, each in errors.items()}
    if bounds is not None:
        rotation[BOUND], translation[BOUND] = bounds.causal.rotation_rms_deg, bounds.causal.translation_rms_m
    model = {method: np.mean([tracks[method].model_m for tracks in seeds.tracks], axis=0) for method in _WITH_MODEL}
    stamps = np.array([pose.stamp_ns for pose in sequence.truth])
    told = [np.linalg.norm(flight.told.positions - flight.X_true, axis=1).mean() for flight in seeds.flights]
    return Curves(
        title=sequence.name,
        seconds=1e-9 * (stamps - stamps[0]),
        rotation_deg=rotation,
        translation_m=translation,
        model_m=model,
        told_m=float(np.mean(told)),
    )
