# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What lies about in a room and is not the target: boxes, balls, rods, hands, and tags of no family. Sizes about 1."""

import numpy as np

from fairlead.geometry import exp_so3
from fairlead.render.modelling import Modeller
from fairlead.render.surface import Material, Surface
from fairlead.render.tagged import MATERIALS, add_tag


def thing(rng: np.random.Generator) -> Surface:
    """A box, a ball or a rod, of one or two colours."""
    first, second = (
        Material(name=name, colour=_colour(rng), roughness=float(rng.uniform(0.2, 1.0))) for name in ("a", "b")
    )
    m = Modeller([first, second])
    kind = rng.integers(3)
    if kind == 0:
        half = 0.5 * np.exp(0.6 * rng.standard_normal(3))
        x, y, z = ((-float(h), float(h)) for h in half)
        m.block("a", x, y, z, roof="b", chamfer=float(rng.choice([0.0, 0.4 * half.min()])))
    elif kind == 1:
        m.ball("a", (0.0, 0.0, 0.0), float(rng.uniform(0.2, 0.8)), sides=20)
    else:
        m.rod("a", (0.0, 0.0, -1.5), (0.0, 0.0, 0.3), float(rng.uniform(0.05, 0.3)), sides=14)
        m.rod("b", (0.0, 0.0, 0.3), (0.0, 0.0, 0.6), float(rng.uniform(0.05, 0.3)), sides=14)
    return m.surface()


def hand(rng: np.random.Generator) -> Surface:
    """Something like fingers about the z axis, which end at z = 0, and the wrist above."""
    dark = float(np.exp(rng.uniform(np.log(0.25), np.log(1.3))))
    r, g, b = np.clip(dark * np.array([0.50, 0.27, 0.20]) * np.exp(0.1 * rng.standard_normal(3)), 0.0, 0.9).tolist()
    m = Modeller([Material(name="skin", colour=(r, g, b), roughness=0.6)])
    radius = float(rng.uniform(0.12, 0.2))
    for k in range(4):
        angle = 0.8 * k + rng.uniform(0.0, 0.6)
        knuckle = np.array([0.9 * np.cos(angle), 0.9 * np.sin(angle), rng.uniform(0.5, 1.2)])
        tip = np.array([0.35 * np.cos(angle + 0.6), 0.35 * np.sin(angle + 0.6), rng.uniform(0.0, 0.5)])
        m.ball("skin", tip, radius)
        m.rod("skin", tip, knuckle, radius, sides=12)
        m.ball("skin", knuckle, radius)
    m.rod("skin", (0.7, 0.5, 0.9), (2.5, 2.0, 2.5), 0.55, sides=14)
    return m.surface()


def false_tag(rng: np.random.Generator) -> Surface:
    """A cube with patterns that no family has, so that cells alone are not the target."""
    m = Modeller(MATERIALS)
    x = (-0.65, 0.65)
    m.block("body", x, x, x)
    quad = np.array([[-0.5, 0.5, 0.66], [0.5, 0.5, 0.66], [0.5, -0.5, 0.66], [-0.5, -0.5, 0.66]])
    n = int(rng.integers(5, 9))
    for turn in ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (-0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, -0.5, 0.0)):
        white = np.zeros((n, n), bool)
        white[1:-1, 1:-1] = rng.random((n - 2, n - 2)) < 0.5
        add_tag(m, quad @ exp_so3(np.pi * np.array(turn)).T, white, 0.9)
    return m.surface()


def _colour(rng: np.random.Generator) -> tuple[float, float, float]:
    value = float(rng.beta(1.0, 1.5))
    r, g, b = np.clip(value * np.exp(rng.choice([0.1, 0.8]) * rng.standard_normal(3)), 0.01, 0.9).tolist()
    return r, g, b
