# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the records check of their fields; each function raises ValueError that names the field."""

import operator
from math import isfinite
from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

RIGID_TOLERANCE = 1e-6
"""Largest deviation of R^T R from I that still counts as a rotation [-]."""


def frozen_array(values: ArrayLike, shape: tuple[int, ...], name: str) -> np.ndarray:
    """Copy to a read-only float64 array of this shape; an empty list has any shape without elements.

    Raises ValueError, naming the field, for another shape, and for what would lose its mask or imaginary part.
    """
    came = type(values).__name__
    try:
        given = np.asarray(values)
        if given.dtype.kind == "c":
            came = "complex numbers"
        if given.dtype.kind == "c" or np.ma.isMaskedArray(values):
            raise TypeError
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: expected numbers of shape {shape}, got {came}") from error
    if array.shape == (0,) and shape[0] == 0:
        array = array.reshape(shape)
    if array.shape != shape:
        raise ValueError(f"{name}: expected shape {shape}, got {array.shape}")
    array.setflags(write=False)
    return array


def integer(value: SupportsIndex, name: str) -> int:
    """A whole number of 64 bits."""
    try:
        whole = operator.index(value)
    except TypeError as error:
        raise ValueError(f"{name}: expected an integer, got {value!r}") from error
    if not -(2**63) <= whole < 2**63:
        raise ValueError(f"{name}: expected a 64-bit integer, got {whole}")
    return whole


def number(value: float, name: str) -> float:
    """A number, which need not be finite."""
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: expected a number, got {value!r}") from error


def instance(value: object, kind: type, name: str) -> None:
    """An object of this class."""
    if not isinstance(value, kind):
        raise ValueError(f"{name}: expected {kind.__name__}, got {type(value).__name__}")


def names(values: tuple[str, ...], name: str) -> tuple[str, ...]:
    """Texts, none of them empty."""
    texts = tuple(values)
    for value in texts:
        if not isinstance(value, str) or not value:  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ValueError(f"{name}: expected non-empty text, got {value!r}")
    return texts


def finite(array: np.ndarray, name: str) -> None:
    """Neither NaN nor infinite."""
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite numbers, got {array.tolist()}")


def positive(value: float, name: str) -> None:
    """Finite and above 0."""
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"{name}: expected a positive number, got {value}")


def assign(record: object, **values: object) -> None:
    """Set fields of a frozen record while it is being made."""
    for name, value in values.items():
        object.__setattr__(record, name, value)


def choice(value: str, allowed: tuple[str, ...], name: str) -> None:
    """One of the allowed words."""
    if value not in allowed:
        raise ValueError(f"{name}: expected one of {', '.join(allowed)}, got {value!r}")


def is_covariance(matrix: np.ndarray, tolerance: float = 1e-9) -> bool:
    """Finite, symmetric and positive semidefinite, judged on the correlations, so that units may be mixed.

    Variances below 1e-14 of the largest count as zero; the smallest eigenvalue may be -tolerance x size.
    """
    if _is_plainly_positive_definite(matrix):
        return True
    variances = np.diag(matrix)
    if not np.isfinite(matrix).all() or variances.min(initial=0.0) < 0.0:
        return False
    largest = float(variances.max(initial=0.0))
    if largest == 0.0:
        return not matrix.any()
    scale = np.sqrt(variances + 1e-14 * largest)
    correlations = matrix / np.outer(scale, scale)
    if np.abs(correlations - correlations.T).max() > tolerance:
        return False
    try:
        np.linalg.cholesky(correlations + tolerance * matrix.shape[0] * np.eye(matrix.shape[0]))
    except np.linalg.LinAlgError:
        return False
    return True


def _is_plainly_positive_definite(matrix: np.ndarray) -> bool:
    """Symmetric to the last bit and with a Cholesky factor: the usual case, found out ten times faster."""
    try:
        factor = np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return bool(np.isfinite(factor).all() and np.array_equal(matrix, matrix.T))


def is_rigid(T: np.ndarray, tolerance: float = RIGID_TOLERANCE) -> bool:
    """R R^T = I and det R = +1 to `tolerance`, last row 0 0 0 1, finite. Written out: this runs for every frame."""
    (a, b, c, x), (d, e, f, y), (g, h, i, z), last = T.tolist()
    if last != [0.0, 0.0, 0.0, 1.0] or not isfinite(x + y + z):
        return False
    lengths = (a * a + b * b + c * c, d * d + e * e + f * f, g * g + h * h + i * i)
    angles = (a * d + b * e + c * f, a * g + b * h + c * i, d * g + e * h + f * i)
    orthonormal = all(abs(v - 1.0) <= tolerance for v in lengths) and all(abs(v) <= tolerance for v in angles)
    return orthonormal and a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) > 0.0
