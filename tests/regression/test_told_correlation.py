# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A network's errors stay from image to image; told as independent, the covariance was far too small."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.inputs import DetectedViews, told_correlation
from fairlead.io.network_card import Calibration, card_from_json, card_json
from fairlead.sources.source import ImageFrame
from fairlead.tracker import TrackerOptions
from fairlead.types import Correlation, Estimate, View
from tests.unit.detect.test_network_detector import CARD


class Images:
    """None at all."""

    def __iter__(self):
        return iter(())

    def count(self) -> int:
        return 0


class Stubborn:
    """A detector whose errors stay for 0.2 rad."""

    correlation = Correlation(angle_rad=0.2, log_range=1.0, design_effect=2.0)

    def detect(self, image: np.ndarray, frame: int, stamp_ns: int) -> View:
        raise AssertionError(ImageFrame)

    def follow(self, estimate: Estimate) -> None:
        raise AssertionError(estimate)


def test_the_estimator_is_told_what_the_detector_says() -> None:
    told = told_correlation(DetectedViews(Images(), Stubborn()), TrackerOptions())
    assert (told.correlation_time_s, told.correlation_angle_rad, told.correlation_log_range) == (0.0, 0.2, 1.0)
    assert told.design_effect == 2.0


def test_the_option_file_has_the_last_word() -> None:
    for said in ({"correlation_time_s": 0.5}, {"design_effect": 3.0}):
        options = replace(TrackerOptions(), **said)
        assert told_correlation(DetectedViews(Images(), Stubborn()), options) == options


@pytest.mark.parametrize("angle_deg", [0.0, 7.5])
def test_the_card_says_it(angle_deg: float) -> None:
    calibration = Calibration(correlation_angle_deg=angle_deg, correlation_log_range=0.0, design_effect=4.0)
    told = card_from_json(card_json(replace(CARD, calibration=calibration)), Path("x.onnx")).calibration.correlation
    assert told == Correlation(angle_rad=float(np.radians(angle_deg)), design_effect=4.0)


def test_a_card_that_says_nothing_tells_the_default() -> None:
    assert said({}) == Correlation(angle_rad=float(np.radians(12.0)), log_range=1.5, design_effect=2.5)


@pytest.mark.parametrize("seconds", [0.0, 8.0])
def test_a_card_that_says_a_time_means_that_alone(seconds: float) -> None:
    assert said({"correlation_time_s": seconds}) == Correlation(time_s=seconds, design_effect=2.5)


def said(calibration: dict[str, float]) -> Correlation:
    card = json.loads(card_json(CARD))
    keys = "correlation_time_s", "correlation_angle_deg", "correlation_log_range"
    kept = {key: value for key, value in card["calibration"].items() if key not in keys}
    card["calibration"] = kept | calibration
    return card_from_json(json.dumps(card), Path("x.onnx")).calibration.correlation
