# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What several experiments say alike."""

import hashlib

from fairlead.reproduce.context import Context

NO_SEQUENCES = "no sequence with truth was found: expected --sequences, or clips that come along"
NO_REAL_SHIP = "a real sequence of a ship: none with truth can be had, the publication's is not public"


def undetected(context: Context) -> list[str]:
    """Which network has nothing to say of which sequence."""
    lines = [
        f"{network.label} on {sequence.name}: no images and no table of its detections"
        for network in context.networks
        for sequence in context.sequences
        if context.detections(sequence, network) is None
    ]
    return lines if context.networks else ["no network was found: expected --networks, or those that come along"]


def network_facts(context: Context) -> dict[str, str]:
    """Which files they are."""
    facts: dict[str, str] = {}
    for network in context.networks:
        if network.path is None:
            facts[network.label] = "table of detections"
        else:
            facts[network.label] = f"{network.path.name} {hashlib.sha256(network.path.read_bytes()).hexdigest()[:10]}"
    return facts


def run_facts(context: Context) -> dict[str, str]:
    """How much was run."""
    return {"told models per sequence": str(context.seeds)} | network_facts(context)
