# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a renderer hands over: light, and what is true of every pixel."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

FAR_M = 60_000.0
"""Distance of what has none [m]."""

Radiance = Float32[np.ndarray, "h w 3"]
Distance = Float32[np.ndarray, "h w"]
Mask = Bool[np.ndarray, "h w"]


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearImage:
    """Light before it meets a sensor, red green blue; a white wall in full sun has radiance 1."""

    radiance: Radiance
    distance: Distance
    """From the camera [m]; FAR_M for the sky."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TruthImage:
    """What lies on the ray through the centre of each pixel."""

    mask: Mask
    """The target, with nothing in front of it."""
    depth: Distance
    """z of the surface in camera axes [m]; infinity for sea and sky."""
