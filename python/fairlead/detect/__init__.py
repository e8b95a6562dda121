# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Image to observations: a detector turns an image into a view and owes each pixel a covariance that was measured."""

from fairlead.detect.detector import Detector, detector_from_spec

__all__ = ["Detector", "detector_from_spec"]
