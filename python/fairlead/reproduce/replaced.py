# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight with the errors of its network replaced by others, one property after the other.

With f S the measured covariance and L L^T = f S, errors are e = L w: docs/reproduce.md section 7, eq. (5).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fairlead.reproduce.measured import Measured, Observed, outlying, views_of
from fairlead.reproduce.methods import Flight

Whitened = Callable[[np.ndarray, Observed, Measured, np.random.Generator], np.ndarray]
"""w of the network, (k, n, 2), NaN where nothing is observed, to other w; what becomes NaN is not observed."""


@dataclass(frozen=True, kw_only=True)
class Errors:
    """One kind of them."""

    name: str
    label: str
    make: Whitened
    told: bool
    """Whether ours is told that they stay, as with this network; it is not where they do not."""


def replaced(flight: Flight, errors: Errors, measured: Measured, seed: int) -> Flight:
    """The same views of the same landmarks with other errors."""
    seen = flight.observed
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(20_251_125,)))
    known = np.isfinite(seen.errors).all(axis=2)
    L = np.full_like(seen.covariances, np.nan)
    L[known] = np.linalg.cholesky(measured.factor * seen.covariances[known])
    w = np.full_like(seen.errors, np.nan)
    w[known] = np.linalg.solve(L[known], seen.errors[known][..., None])[..., 0]
    other = np.einsum("knab,knb->kna", L, errors.make(w, seen, measured, rng))
    observed = replace(seen, pixels=seen.pixels - seen.errors + other, errors=other)
    return replace(flight, views=views_of(flight.told.landmarks, observed), observed=observed)


def _white(w: np.ndarray, _: Observed, __: Measured, rng: np.random.Generator) -> np.ndarray:
    return rng.standard_normal(w.shape)


def _dealt(w: np.ndarray, _: Observed, __: Measured, rng: np.random.Generator) -> np.ndarray:
    """Those of the network, each at a frame and a landmark of another: as heavy in the tails, and nothing stays."""
    known = np.isfinite(w).all(axis=2)
    other = np.full_like(w, np.nan)
    other[known] = rng.permutation(w[known])
    return other


def _staying(w: np.ndarray, seen: Observed, measured: Measured, rng: np.random.Generator) -> np.ndarray:
    """w_k = a w_k-1 + sqrt(1 - a^2) v_k, a = exp(-interval / tau), tau of docs/reproduce.md eq. (3)."""
    tau_s = measured.stays_s
    intervals_s = 1e-9 * np.diff(seen.stamps_ns)
    v = rng.standard_normal(w.shape)
    for k, interval_s in enumerate(intervals_s, 1):
        a = float(np.exp(-interval_s / tau_s)) if tau_s > 0.0 else 0.0
        v[k] = a * v[k - 1] + np.sqrt(1.0 - a * a) * v[k]
    return v


def _signed(w: np.ndarray, _: Observed, __: Measured, rng: np.random.Generator) -> np.ndarray:
    """One sign a coordinate of a landmark, for all frames: only what the landmarks have in common is gone."""
    return w * rng.choice([-1.0, 1.0], size=w.shape[1:])


def _centred(w: np.ndarray, _: Observed, __: Measured, ___: np.random.Generator) -> np.ndarray:
    """Without what is constant over the flight, landmark by landmark."""
    count = np.isfinite(w).sum(axis=0)
    return w - np.nansum(w, axis=0) / np.maximum(count, 1)


def _inlying(w: np.ndarray, seen: Observed, _: Measured, __: np.random.Generator) -> np.ndarray:
    return np.where(outlying(seen)[..., None], np.nan, w)


def _real(w: np.ndarray, _: Observed, __: Measured, ___: np.random.Generator) -> np.ndarray:
    return w


WHITE, STAYING, SIGNED, CENTRED, INLYING, REAL = "white", "staying", "signed", "centred", "inlying", "real"
KINDS = (
    Errors(name=WHITE, label="drawn, independent", make=_white, told=False),
    Errors(name="white-told", label="drawn, independent, told to stay", make=_white, told=True),
    Errors(name="dealt", label="network's, dealt anew", make=_dealt, told=False),
    Errors(name=STAYING, label="drawn, staying", make=_staying, told=True),
    Errors(name=SIGNED, label="network's, a random sign a landmark", make=_signed, told=True),
    Errors(name=CENTRED, label="network's, less their mean", make=_centred, told=True),
    Errors(name=INLYING, label="network's, without outliers", make=_inlying, told=True),
    Errors(name=REAL, label="network's", make=_real, told=True),
)
"""From what the bound takes for granted to what there is."""
