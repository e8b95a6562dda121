# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Sums of sines: what rolls, heaves and vibrates, smooth and known at every instant."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from fairlead.simulate.rotations import Times

Waves = Float64[np.ndarray, "m"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Sines:
    """y(t) = sum_i a_i sin(2 pi f_i t + phase_i), docs/simulate.md eq. (5)."""

    amplitudes: Waves
    frequencies_hz: Waves
    phases_rad: Waves

    def __call__(self, t_s: Times) -> Times:
        """The sum at these instants, in the unit of the amplitudes."""
        if not len(self.amplitudes):
            return np.zeros(len(t_s))
        return np.sin(2.0 * np.pi * t_s[:, None] * self.frequencies_hz + self.phases_rad) @ self.amplitudes


NOTHING = Sines(amplitudes=np.zeros(0), frequencies_hz=np.zeros(0), phases_rad=np.zeros(0))


def draw_sines(
    rms: float, band_hz: tuple[float, float], waves: int, rng: np.random.Generator, phase_rad: float | None = None
) -> Sines:
    """Equal amplitudes rms sqrt(2 / waves), frequencies and phases uniform, docs/simulate.md eq. (6).

    Parameters
    ----------
    rms : root of the mean square over a long time
    band_hz : lowest and highest frequency
    phase_rad : the phase of all waves, where it is given
    """
    frequencies = rng.uniform(band_hz[0], band_hz[1], waves)
    phases = rng.uniform(0.0, 2.0 * np.pi, waves)
    return Sines(
        amplitudes=np.full(waves, rms * np.sqrt(2.0 / waves)),
        frequencies_hz=frequencies,
        phases_rad=phases if phase_rad is None else np.full(waves, phase_rad),
    )
