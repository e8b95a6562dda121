# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What comes and goes: on and off by chance, each time for a while. docs/simulate.md eq. (16)."""

import numpy as np
from jaxtyping import Bool, Int

from fairlead.simulate.rotations import Times

States = Bool[np.ndarray, "k n"]


def draw_outages(t_s: Times, n: int, share: float, mean_s: float, rng: np.random.Generator) -> States:
    """n independent chains, true where it is out: a share of the time, for mean_s on average; eq. (16).

    With mean_s = 0 every instant is drawn by itself. The draws do not depend on share and mean_s, so a greater share
    with mean_s = 0 contains the smaller one.
    """
    u = rng.random((len(t_s), n))
    if mean_s <= 0.0 or share <= 0.0 or share >= 1.0:
        return u < share
    keep = np.exp(-np.diff(t_s) / (mean_s * (1.0 - share)))
    out = np.empty(u.shape, dtype=np.bool_)
    out[0] = u[0] < share
    for k in range(1, len(t_s)):
        out[k] = u[k] < share * (1.0 - keep[k - 1]) + keep[k - 1] * out[k - 1]
    return out


def first_of_run(states: States, *, held: bool) -> Int[np.ndarray, "k n"]:
    """Row in which each state began; its own row where nothing is held."""
    rows = np.broadcast_to(np.arange(len(states))[:, None], states.shape)
    if not held:
        return np.array(rows)
    began = np.array(rows)
    began[1:][states[1:] & states[:-1]] = 0
    return np.maximum.accumulate(began, axis=0)
