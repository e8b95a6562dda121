# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""All that a flight is made from: who flies where, and every way in which what is told differs from what is true."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from fairlead.simulate.camera_motion import Pointing, Shake
from fairlead.simulate.errors import ModelError
from fairlead.simulate.frames import Frames
from fairlead.simulate.limits import expect
from fairlead.simulate.mistakes import Outliers, Swaps
from fairlead.simulate.noise import Noise
from fairlead.simulate.paths import Arc, Path
from fairlead.simulate.sensors import AttitudeSensor, RangeFinder
from fairlead.simulate.target_motion import TargetMotion
from fairlead.simulate.visibility import Dropout, Occlusion, named_normals
from fairlead.types import Camera, MotionPrior, Target


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenario:
    """A flight before it is drawn; docs/simulate.md has every key. Raises ValueError that begins with the key."""

    name: str
    target: Target
    camera: Camera
    seed: int = 0
    """What the command line draws with unless it is told another one; `simulate` is always told."""
    target_is: Literal["truth", "told"] = "truth"
    """Which of the two the target's positions are; the other scatters about it (docs/bound.md)."""
    trajectory: Path = field(default_factory=Arc)
    pointing: Pointing = field(default_factory=Pointing)
    shake: Shake = field(default_factory=Shake)
    frames: Frames = field(default_factory=Frames)
    model: ModelError | None = None
    """None: the error is drawn from the target's own prior, which is what is told."""
    noise: Noise = field(default_factory=Noise)
    outliers: Outliers = field(default_factory=Outliers)
    swaps: Swaps = field(default_factory=Swaps)
    occlusion: Occlusion = field(default_factory=Occlusion)
    normals: Mapping[str, tuple[float, float, float]] = field(default_factory=dict[str, tuple[float, float, float]])
    """Outward direction at each landmark, target axes; used by occlusion and by the aspect of the noise."""
    dropout: Dropout = field(default_factory=Dropout)
    target_motion: TargetMotion = field(default_factory=TargetMotion)
    range: tuple[RangeFinder, ...] = ()
    attitude: AttitudeSensor | None = None
    motion: MotionPrior | None = None
    """What the estimator is told of the motion; None: what the target's file says."""

    def __post_init__(self) -> None:
        target = self.target
        expect("seed", self.seed, "a whole number >= 0", when=self.seed >= 0)
        checks: list[tuple[str, Callable[[], object]]] = [
            ("pointing", lambda: self.pointing.point(target)),
            ("target_motion", lambda: self.target_motion.point(target)),
            ("swaps", lambda: self.swaps.columns(target)),
            ("normals", lambda: named_normals(target, self.normals)),
            ("occlusion", lambda: self.occlusion.check(target)),
        ]
        for where, check in checks:
            try:
                check()
            except ValueError as error:
                raise ValueError(f"{where}.{error}") from error
        for index, finder in enumerate(self.range):
            known = finder.landmark is None or finder.landmark in target.landmarks
            expect(f"range[{index}].landmark", finder.landmark, f"a landmark of {target.name}", when=known)
