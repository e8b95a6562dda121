# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A network's errors stay from image to image; told as independent, the covariance was far too small."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fairlead.inputs import DetectedViews, told_correlation
from fairlead.io.network_card import Calibration, card_from_json, card_json
from fairlead.sources.source import ImageFrame
from fairlead.tracker import TrackerOptions
from fairlead.types import Estimate, View
from tests.unit.detect.test_network_detector import CARD


class Images:
    """None at all."""

    def __iter__(self):
        return iter(())

    def count(self) -> int:
        return 0


class Stubborn:
    """A detector whose errors stay for 3 s."""

    correlation_time_s = 3.0

    def detect(self, image: np.ndarray, frame: int, stamp_ns: int) -> View:
        raise AssertionError(ImageFrame)

    def follow(self, estimate: Estimate) -> None:
        raise AssertionError(estimate)


def test_the_estimator_is_told_what_the_detector_says() -> None:
    assert told_correlation(DetectedViews(Images(), Stubborn()), TrackerOptions()).correlation_time_s == 3.0


def test_the_option_file_has_the_last_word() -> None:
    options = replace(TrackerOptions(), correlation_time_s=0.5)
    assert told_correlation(DetectedViews(Images(), Stubborn()), options) == options


@pytest.mark.parametrize("seconds", [0.0, 2.5])
def test_the_card_says_it(seconds: float) -> None:
    card = replace(CARD, calibration=Calibration(correlation_time_s=seconds))
    assert card_from_json(card_json(card), Path("x.onnx")).calibration.correlation_time_s == seconds
    assert card_from_json(card_json(CARD), Path("x.onnx")).calibration.correlation_time_s == 8.0
