# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A series of errors in five numbers, docs/metrics.md eq. (1)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Series = Float64[np.ndarray, " k"]
"""One number per frame, landmark or observation; NaN where there is none."""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """What stands in the tables. NaN throughout where `count` is 0. Units are those of the series."""

    count: int
    """Number of values: those that are not NaN."""
    mean: float
    rms: float
    median: float
    p95: float
    maximum: float


def summarise(values: Series) -> Summary:
    """Mean, root mean square, median, 95 % quantile and maximum, docs/metrics.md eq. (1).

    NaN means "no value" and is left out, so `count` belongs beside every figure. Quantiles interpolate linearly
    (Hyndman and Fan 1996, type 7).
    """
    present = values[~np.isnan(values)]
    if not present.size:
        return Summary(count=0, mean=np.nan, rms=np.nan, median=np.nan, p95=np.nan, maximum=np.nan)
    return Summary(
        count=int(present.size),
        mean=float(present.mean()),
        rms=root_mean_square(present),
        median=float(np.median(present)),
        p95=quantile(present, 0.95),
        maximum=float(present.max()),
    )


def quantile(values: Series, share: float) -> float:
    """Linear between order statistics (Hyndman and Fan 1996, type 7); inf where one of the two is inf."""
    lower = float(np.quantile(values, share, method="lower"))
    upper = float(np.quantile(values, share, method="higher"))
    return float(np.quantile(values, share)) if np.isfinite([lower, upper]).all() else upper


def root_mean_square(values: Series) -> float:
    """sqrt(mean v^2); NaN of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else float("nan")


@dataclass(frozen=True, kw_only=True)
class UpdateTime:
    """Wall time of one update [ms], docs/metrics.md eq. (24)."""

    count: int
    p50_ms: float
    p99_ms: float
    mean_ms: float
    maximum_ms: float


def update_time(times_ms: Series) -> UpdateTime | None:
    """Quantiles of the update time; NaN entries are frames that were not timed. None where nothing was timed."""
    present = times_ms[np.isfinite(times_ms)]
    if not present.size:
        return None
    p50, p99 = np.quantile(present, [0.5, 0.99])
    return UpdateTime(
        count=int(present.size),
        p50_ms=float(p50),
        p99_ms=float(p99),
        mean_ms=float(present.mean()),
        maximum_ms=float(present.max()),
    )
