# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Landmark networks by ONNX Runtime: a checked file with its card, outputs to keypoints. docs/detect.md."""

from fairlead.detect.onnx.session import Network

__all__ = ["Network"]
