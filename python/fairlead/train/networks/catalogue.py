# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Networks by name."""

from fairlead.train.networks.heat import Heat
from fairlead.train.networks.rtmpose import RtmPose
from fairlead.train.networks.tinypose import TinyPose

Network = Heat | RtmPose | TinyPose
NAMES = ("heat-t", "heat-s", "heat-m", "rtmpose-t", "rtmpose-s", "rtmpose-m", "tinypose")


def make_network(name: str, landmarks: int, size: int = 256) -> Network:
    """A network with random weights for crops of size x size px. Raises ValueError for a name that is none of NAMES."""
    if name not in NAMES:
        raise ValueError(f"network: expected one of {', '.join(NAMES)}, got {name!r}")
    kind, _, width = name.partition("-")
    if kind == "heat":
        return Heat(landmarks, width)
    if kind == "rtmpose":
        return RtmPose(landmarks, width, (size, size))
    return TinyPose(landmarks)
