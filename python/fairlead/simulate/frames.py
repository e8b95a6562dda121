# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""When images are taken, which are lost, and what their stamps say. docs/simulate.md eq. (2)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Int64

from fairlead.simulate.limits import expect, expect_at_least_zero, expect_positive, expect_share
from fairlead.simulate.outages import draw_outages
from fairlead.simulate.paths import Path
from fairlead.simulate.recorded import Recorded
from fairlead.simulate.rotations import Times
from fairlead.simulate.streams import Streams

DEFAULT_RATE_HZ = 25.0
"""Of a flight that is not recorded and says neither rate nor count [1/s]."""
LARGEST_JITTER = 0.24
"""Jitter and errors of stamps are cut off at this share of the interval, so that no frame overtakes another [-]."""
MAX_FRAMES = 200_000


@dataclass(frozen=True, kw_only=True)
class Frames:
    """The images of a flight; with neither rate nor count 25 a second, or the stamps of a recorded flight."""

    rate_hz: float | None = None
    """Images per second, the first at the start [1/s]."""
    count: int | None = None
    """Instead of the rate: so many images, the first at the start and the last at the end."""
    jitter_s: float = 0.0
    """1 sigma of the time of exposure about its turn; the stamps are true [s]."""
    stamp_sigma_s: float = 0.0
    """1 sigma of the error of the stamps [s]."""
    drop_share: float = 0.0
    """Share of the images that are lost [-]."""
    drop_s: float = 0.0
    """How long a gap is on average; 0: each image by itself [s]."""

    def __post_init__(self) -> None:
        if self.rate_hz is not None:
            expect_positive("rate_hz", self.rate_hz)
            expect("rate_hz", self.rate_hz, "rate_hz or count, not both", when=self.count is None)
        if self.count is not None:
            expect("count", self.count, f"1 to {MAX_FRAMES}", when=1 <= self.count <= MAX_FRAMES)
        for field in ("jitter_s", "stamp_sigma_s", "drop_s"):
            expect_at_least_zero(field, getattr(self, field))
        expect_share("drop_share", self.drop_share)

    def turns(self, path: Path) -> Times:
        """When each image is due, lost ones too [s]. Raises ValueError for more than MAX_FRAMES."""
        if self.count is not None:
            return np.linspace(0.0, path.length_s, self.count)
        if self.rate_hz is None and isinstance(path, Recorded):
            return path.stamps_s
        return instants(DEFAULT_RATE_HZ if self.rate_hz is None else self.rate_hz, path.length_s)

    def draw(self, turns: Times, streams: Streams) -> "Exposures":
        """Times, stamps and losses, eq. (2)."""
        exposed = turns + _cut_normal(turns, self.jitter_s, streams, "jitter")
        stamps = exposed + _cut_normal(turns, self.stamp_sigma_s, streams, "stamps")
        kept = np.ones(len(turns), dtype=np.bool_)
        if self.drop_share > 0.0:
            kept = ~draw_outages(turns, 1, self.drop_share, self.drop_s, streams.of("drops"))[:, 0]
        return Exposures(t_s=exposed, stamps_ns=nanoseconds(stamps), kept=kept)


@dataclass(frozen=True, kw_only=True, eq=False)
class Exposures:
    """Every image that is due."""

    t_s: Times
    """When it was taken [s]."""
    stamps_ns: Int64[np.ndarray, "k"]
    """What its stamp says."""
    kept: Bool[np.ndarray, "k"]
    """Whether it arrived."""


def instants(rate_hz: float, length_s: float) -> Times:
    """0, 1/rate, 2/rate, ... up to the length [s]."""
    count = int(np.floor(length_s * rate_hz * (1.0 + 1e-12) + 1e-9)) + 1
    expect("rate_hz", rate_hz, f"at most {MAX_FRAMES} instants in {length_s:g} s", when=count <= MAX_FRAMES)
    return np.arange(count) / rate_hz


def nanoseconds(t_s: Times) -> Int64[np.ndarray, "k"]:
    """Stamps."""
    return np.rint(1e9 * t_s).astype(np.int64)


def _cut_normal(turns: Times, sigma_s: float, streams: Streams, effect: Literal["jitter", "stamps"]) -> Times:
    if sigma_s == 0.0 or len(turns) < 2:
        return np.zeros(len(turns))
    limit = LARGEST_JITTER * float(np.diff(turns).min())
    return np.clip(sigma_s * streams.of(effect).standard_normal(len(turns)), -limit, limit)
