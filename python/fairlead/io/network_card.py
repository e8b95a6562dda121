# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The card of a landmark network: what it wants to see and what its outputs mean, docs/files.md section 14.

It travels as JSON in the metadata of the .onnx file, or as TOML beside a file that has none.
"""

import dataclasses
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np

from fairlead.io.card_fields import each, number, texts, three, whole
from fairlead.io.documents import read_toml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields
from fairlead.types import Correlation

FORMAT = 1
METADATA_KEY = "fairlead_card"
MAX_SIDE_PX = 4096
MAX_LANDMARKS = 2048

Color = Literal["RGB", "BGR"]
Kind = Literal["pixels", "simcc", "heatmap"]

OUTPUTS: dict[Kind, tuple[str, ...]] = {
    "pixels": ("pixels", "cholesky", "visible"),
    "simcc": ("simcc_x", "simcc_y"),
    "heatmap": (),
}
"""Names that are looked for where the card gives none; a heatmap is the one output with four dimensions."""

_NOTES = ("notes", "training", "accuracy")
"""Tables of a card that people read, and nothing here does."""


@dataclass(frozen=True, kw_only=True)
class NetworkInput:
    """The picture that the network wants."""

    name: str
    width: int
    """Of the crops it was made for [px]."""
    height: int
    color: Color = "RGB"
    mean: tuple[float, ...] = (0.0, 0.0, 0.0)
    """Grey levels 0 to 255, in the order of `color`: x = (v - mean) / std."""
    std: tuple[float, ...] = (1.0, 1.0, 1.0)
    pad: float = 1.25
    """Side of the crop over that of the landmarks' box [-]."""
    any_size: bool = False
    """Fully convolutional: any multiple of 32 px will do."""


@dataclass(frozen=True, kw_only=True)
class Decoding:
    """How outputs become pixels of the crop, docs/detect.md section 3."""

    kind: Kind = "pixels"
    outputs: tuple[str, ...] = ()
    """Names, in the order of OUTPUTS; those if not given."""
    bins_per_px: float = 2.0
    """simcc."""
    stride: float = 4.0
    """heatmap: px of a cell."""
    origin_px: float = 0.0
    """Where the centre of the first bin or cell is, (0, 0) being the centre of the crop's top-left pixel [px]."""
    beta: float = 10.0
    """simcc: the weights are exp(beta x output); 0: the outputs are weights themselves."""
    window: float = 8.0
    """simcc: bins to either side of the highest that the expectation is taken over."""
    blur: float = 2.0
    """heatmap: sigma of the smoothing before the peak is read [cells]."""


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What the outputs are worth, docs/detect.md section 4."""

    visible_threshold: float = 0.0
    """Logit (pixels) or height of the peak (simcc, heatmap) above which a landmark counts as seen."""
    scale: tuple[float, ...] = (1.0,)
    """pixels: factor on the network's covariance, one or one a landmark [-]."""
    floor_px: float = 0.0
    """pixels: root of a variance that is added [px of the crop]."""
    tail_dof: float | None = None
    """Degrees of freedom of the Student t that describes the tail [-]; for people and estimators."""
    sigma_px: tuple[float, ...] = ()
    """simcc, heatmap: standard deviation of each coordinate, one or one a landmark [px of the crop]."""
    spread_factor: float = 0.0
    """simcc, heatmap: what is added of the peak's own covariance [-]."""
    correlation_time_s: float = 0.0
    """Errors of two images this far apart in time are e times less alike, docs/motion.md eq. (12) [s]; 0: no matter."""
    correlation_angle_deg: float = 12.0
    """The same by the turn of the line of sight in the target frame [deg]."""
    correlation_log_range: float = 1.5
    """The same by the logarithm of the range [-]."""
    design_effect: float = 2.5
    """The pose of an image errs so many times more, squared, since its landmarks err alike, docs/motion.md eq. (16)."""

    @property
    def correlation(self) -> Correlation:
        """How alike errors are, as estimators take it."""
        return Correlation(
            time_s=self.correlation_time_s,
            angle_rad=math.radians(self.correlation_angle_deg),
            log_range=self.correlation_log_range,
            design_effect=self.design_effect,
        )


@dataclass(frozen=True, kw_only=True)
class Acquisition:
    """How the target is found in a whole image, and when it is believed, docs/detect.md section 6."""

    levels: int = 3
    """Passes: the whole image in one crop's size, then with squares of half, a quarter, ... of that side."""
    visible_threshold: float = -2.0
    """As in the calibration, but for candidates, which may be badly framed."""
    min_landmarks: int = 6
    """Landmarks that must agree with one pose of the rough model."""
    min_score: float = 0.5
    """Of the landmarks that this pose puts into the crop, the share that is seen where it should be [-]."""


@dataclass(frozen=True, kw_only=True)
class NetworkCard:
    """Everything about a network that its weights do not say."""

    name: str
    landmarks: tuple[str, ...]
    """In the order of the outputs."""
    input: NetworkInput
    network: str = ""
    """What kind of network it is, e.g. heat-t."""
    target: str = ""
    """The target that it was trained for."""
    decoding: Decoding = field(default_factory=Decoding)
    calibration: Calibration = field(default_factory=Calibration)
    acquisition: Acquisition = field(default_factory=Acquisition)
    sha256: str | None = None
    """Of the .onnx file; only in a card beside it."""

    def per_landmark(self, values: tuple[float, ...]) -> np.ndarray:
        """(n,) from one value or n."""
        return np.broadcast_to(np.array(values, dtype=np.float64), (len(self.landmarks),))


def card_json(card: NetworkCard) -> str:
    """The text for the metadata entry METADATA_KEY."""
    return json.dumps({"format": FORMAT} | _said(dataclasses.asdict(card)))


def _said(table: dict[str, Any]) -> dict[str, Any]:
    """Without what is empty or not known."""
    plain = {key: _said(value) if isinstance(value, dict) else value for key, value in table.items()}
    return {key: value for key, value in plain.items() if value not in (None, "", (), [])}


def card_from_json(text: str, path: Path) -> NetworkCard:
    """The card in a metadata entry of `path`. Raises InputError."""
    try:
        document: object = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(path, f"metadata {METADATA_KEY}: malformed JSON: {error}") from error
    return _card(document, path, f"metadata {METADATA_KEY}")


def load_card(path: Path) -> NetworkCard:
    """The card in a TOML file. Raises InputError: file, key, what came, what was expected."""
    return _card(read_toml(path), path, "")


def _card(document: object, path: Path, where: str) -> NetworkCard:
    known = ("format", *(each.name for each in dataclasses.fields(NetworkCard)), *_NOTES)
    top = Fields(document, known, path, where)
    if top.integer("format") != FORMAT:
        raise top.error("format", f"expected {FORMAT}, got {top.integer('format')}")
    landmarks = texts(top, "landmarks")
    if not 0 < len(landmarks) <= MAX_LANDMARKS or len(set(landmarks)) != len(landmarks):
        raise top.error("landmarks", f"expected 1 to {MAX_LANDMARKS} different names, got {len(landmarks)}")
    decoding = _decoding(_table(top, "decoding", Decoding, path, where))
    return NetworkCard(
        name=top.text("name"),
        network=top.text("network") if "network" in top else "",
        target=top.text("target") if "target" in top else "",
        landmarks=landmarks,
        input=_input(_table(top, "input", NetworkInput, path, where)),
        decoding=decoding,
        calibration=_calibration(_table(top, "calibration", Calibration, path, where), len(landmarks), decoding.kind),
        acquisition=_acquisition(_table(top, "acquisition", Acquisition, path, where)),
        sha256=top.text("sha256").lower() if "sha256" in top else None,
    )


def _table(top: Fields, key: str, record: type[Any], path: Path, where: str) -> Fields:
    known = tuple(each.name for each in dataclasses.fields(record))
    return Fields(top.get(key) if key in top else {}, known, path, f"{where}.{key}" if where else key)


def _input(fields: Fields) -> NetworkInput:
    default = NetworkInput(name="input", width=1, height=1)
    width, height = (whole(fields, key, 8, MAX_SIDE_PX) for key in ("width", "height"))
    any_size = fields.get("any_size") if "any_size" in fields else False
    if not isinstance(any_size, bool):
        raise fields.error("any_size", f"expected true or false, got {any_size!r}")
    std = three(fields, "std", default.std)
    if min(std) <= 0.0:
        raise fields.error("std", f"expected numbers above 0, got {list(std)}")
    return NetworkInput(
        name=fields.text("name"),
        width=width,
        height=height,
        color=cast(Color, fields.choice("color", get_args(Color))) if "color" in fields else default.color,
        mean=three(fields, "mean", default.mean),
        std=std,
        pad=number(fields, "pad", default.pad, 1.0, 4.0),
        any_size=any_size,
    )


def _decoding(fields: Fields) -> Decoding:
    default = Decoding()
    kind = cast(Kind, fields.choice("kind", get_args(Kind))) if "kind" in fields else default.kind
    outputs = texts(fields, "outputs") if "outputs" in fields else ()
    count = max(1, len(OUTPUTS[kind]))
    if outputs and len(outputs) != count:
        raise fields.error("outputs", f"expected {count} names for kind {kind}, got {len(outputs)}")
    return Decoding(
        kind=kind,
        outputs=outputs,
        bins_per_px=number(fields, "bins_per_px", default.bins_per_px, 0.1, 32.0),
        stride=number(fields, "stride", default.stride, 0.5, 64.0),
        origin_px=number(fields, "origin_px", default.origin_px, -64.0, 64.0),
        beta=number(fields, "beta", default.beta, 0.0, 1000.0),
        window=number(fields, "window", default.window, 1.0, 256.0),
        blur=number(fields, "blur", default.blur, 0.0, 16.0),
    )


def _calibration(fields: Fields, landmarks: int, kind: Kind) -> Calibration:
    default = Calibration()
    sigma = each(fields, "sigma_px", landmarks, 1e-3) if "sigma_px" in fields else ()
    if kind != "pixels" and not sigma:
        raise fields.error("sigma_px", f"missing: a network of kind {kind} gives no covariance, so the card must")
    scale = each(fields, "scale", landmarks, 1e-6) if "scale" in fields else default.scale
    return Calibration(
        visible_threshold=number(fields, "visible_threshold", default.visible_threshold, -1e6, 1e6),
        scale=scale,
        floor_px=number(fields, "floor_px", default.floor_px, 0.0, 1e3),
        tail_dof=number(fields, "tail_dof", 0.0, 0.1, 1e6) if "tail_dof" in fields else None,
        sigma_px=sigma,
        spread_factor=number(fields, "spread_factor", default.spread_factor, 0.0, 1e3),
        design_effect=number(fields, "design_effect", default.design_effect, 1.0, 1e3),
        **_correlation(fields),
    )


def _correlation(fields: Fields) -> dict[str, float]:
    """What is said of how long errors stay; a card that says anything of it says all."""
    default = Calibration()
    limits = {"correlation_time_s": 1e4, "correlation_angle_deg": 180.0, "correlation_log_range": 1e2}
    silent = not any(key in fields for key in limits)
    return {
        key: number(fields, key, getattr(default, key) if silent else 0.0, 0.0, most) for key, most in limits.items()
    }


def _acquisition(fields: Fields) -> Acquisition:
    default = Acquisition()
    return Acquisition(
        levels=whole(fields, "levels", 1, 6) if "levels" in fields else default.levels,
        visible_threshold=number(fields, "visible_threshold", default.visible_threshold, -1e6, 1e6),
        min_landmarks=whole(fields, "min_landmarks", 4, MAX_LANDMARKS)
        if "min_landmarks" in fields
        else default.min_landmarks,
        min_score=number(fields, "min_score", default.min_score, 0.0, 1.0),
    )
