# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Table 2: how wrong the networks' landmarks are, and how true their covariances."""

import dataclasses

from fairlead.reproduce import published
from fairlead.reproduce.content import Column, Row, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.experiments.shared import NO_SEQUENCES, network_facts, undetected

_COLUMNS = (
    Column(key="sequence", title="sequence"),
    Column(key="network", title="network"),
    Column(key="mean_px", title="mean error, visible [px]"),
    Column(key="median_px", title="median [px]"),
    Column(key="p95_px", title="95 % [px]"),
    Column(key="found", title="visible found [%]", percent=True),
    Column(key="hidden_px", title="mean error, hidden [px]"),
    Column(key="bias_px", title="constant part per landmark [px rms]", digits=2),
)
_COVARIANCE = (
    Column(key="sequence", title="sequence"),
    Column(key="network", title="network"),
    Column(key="inside_50", title="inside 50 % ellipse [%]", percent=True),
    Column(key="inside_90", title="90 % [%]", percent=True),
    Column(key="inside_99", title="99 % [%]", percent=True),
    Column(key="nees", title="NEES / 2", digits=2),
    Column(key="factor", title="variance factor [-]"),
    Column(key="outliers", title="outliers [%]", percent=True, digits=2),
    Column(key="inefficiency", title="frames that say as much as one"),
    Column(key="stays_s", title="errors stay [s]", digits=2),
    Column(key="design_effect", title="landmarks alike: pose errs x"),
)


def landmarks(context: Context) -> Section:
    """Every network on every sequence."""
    rows: list[Row] = []
    for sequence, network in context.pairs():
        measured = context.measured(sequence, network)
        if measured is not None:
            rows.append(
                {"sequence": sequence.name, "network": network.label, "frames": len(sequence.truth)}
                | dataclasses.asdict(measured)
                | {"design_effect": context.design_effect(sequence, network)}
            )
    note = "Error: distance from the exact projection. Hidden landmarks are behind something, inside the image."
    trust = (
        "Shares inside the ellipses of the covariance that the network tells; right would be 50, 90, 99 %, and a NEES "
        "of 1. The variance factor is the same with outliers (beyond the 99.9 % ellipse) left out. Frames that say as "
        "much as one: 1 for errors that are new in every frame, the number of frames for errors that stay; then "
        "the time constant that would make it so. Landmarks alike: by how much more the pose of a frame errs, squared, "
        "than its landmarks say one by one (design effect)."
    )
    return Section(
        name="landmarks",
        title="Table 2: landmark error of the networks",
        published=published.SEQUENCES,
        tables=[
            Table(name="table2", title="Table 2: landmark error", columns=_COLUMNS, rows=rows, note=note),
            Table(
                name="table2_covariance", title="Is its covariance true?", columns=_COVARIANCE, rows=rows, note=trust
            ),
        ],
        missing=undetected(context) if context.sequences else [NO_SEQUENCES],
        facts=network_facts(context),
    )
