# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Entries of a network's card, each with its limits."""

from collections.abc import Collection, Mapping
from typing import cast

from fairlead.io.fields import Fields


def texts(fields: Fields, key: str) -> tuple[str, ...]:
    """A list of names."""
    items = fields.items(key)
    if not all(isinstance(item, str) and item for item in items):
        raise fields.error(key, "expected a list of names")
    return tuple(cast(list[str], items))


def number(fields: Fields, key: str, default: float, low: float, high: float) -> float:
    """Between low and high, or the default where nothing is said."""
    if key not in fields:
        return default
    value = fields.number(key)
    if not low <= value <= high:
        raise fields.error(key, f"expected {low:g} to {high:g}, got {value:g}")
    return value


def whole(fields: Fields, key: str, low: int, high: int) -> int:
    """A whole number from low to high."""
    value = fields.integer(key)
    if not low <= value <= high:
        raise fields.error(key, f"expected a whole number from {low} to {high}, got {value}")
    return value


def three(fields: Fields, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """Three numbers, or the default where nothing is said."""
    return tuple(fields.numbers(key, 3)) if key in fields else default


def each(fields: Fields, key: str, landmarks: int, least: float) -> tuple[float, ...]:
    """One number, or one a landmark."""
    single = not isinstance(fields.get(key), Collection) or isinstance(fields.get(key), str | Mapping)
    values = [fields.number(key)] if single else fields.numbers(key)
    if len(values) not in (1, landmarks) or min(values, default=0.0) < least:
        raise fields.error(key, f"expected one number or {landmarks}, none below {least:g}, got {len(values)}")
    return tuple(values)
