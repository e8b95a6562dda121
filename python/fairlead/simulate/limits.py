# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a scenario may say; each function raises ValueError that begins with the field's name."""

import math


def expect(field: str, value: object, expected: str, *, when: bool) -> None:
    """Raise unless `when` holds."""
    if not when:
        raise ValueError(f"{field}: expected {expected}, got {value!r}")


def expect_positive(field: str, value: float) -> None:
    """Finite and above 0."""
    expect(field, value, "a number > 0", when=math.isfinite(value) and value > 0.0)


def expect_at_least_zero(field: str, value: float) -> None:
    """Finite and not below 0."""
    expect(field, value, "a number >= 0", when=math.isfinite(value) and value >= 0.0)


def expect_share(field: str, value: float) -> None:
    """In 0..1."""
    expect(field, value, "a share between 0 and 1", when=0.0 <= value <= 1.0)


def expect_interval(field: str, value: tuple[float, float]) -> None:
    """0 < low <= high."""
    expect(field, value, "two numbers, 0 < low <= high", when=0.0 < value[0] <= value[1] < math.inf)
