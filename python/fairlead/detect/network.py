# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A landmark network as a detector: acquire in the whole image, then follow. docs/detect.md section 7."""

from pathlib import Path

import numpy as np

from fairlead.detect.acquire import Sighting, acquire, believed, look
from fairlead.detect.agreement import agrees_with_prediction, rough_model
from fairlead.detect.onnx import Network
from fairlead.detect.roi import Follower
from fairlead.detect.window import window_about
from fairlead.io.errors import InputError
from fairlead.opencv import GreyImage, Image, coloured
from fairlead.types import Camera, Correlation, Estimate, Target, View

FOLLOW_LANDMARKS = 4
FOLLOW_SCORE = 0.25
"""Share of the expected landmarks that following is content with; acquisition wants more, from its card."""


class NetworkDetector:
    """Looks where the target should be by the last poses; where it is not, in the whole image, at once and every time.

    Raises InputError for a network that cannot be used, or whose landmarks are not the target's.
    """

    def __init__(self, path: Path, target: Target, camera: Camera) -> None:
        self.network = Network(path)
        card = self.network.card
        try:
            self._model = rough_model(target, card.landmarks, camera)
        except ValueError as error:
            raise InputError(path, str(error)) from error
        self._follower = Follower(self._model.X_target[self._model.known], camera, card.input.pad)
        self._threshold = card.calibration.visible_threshold
        self._in_vain = 0
        self.acquisitions = 0
        """How often the whole image was searched."""

    @property
    def correlation(self) -> Correlation:
        """As its card says: neighbouring images show the same pixels of the same target."""
        return self.network.card.calibration.correlation

    def detect(self, image: Image | GreyImage, frame: int, stamp_ns: int) -> View:
        """The landmarks that are seen; an empty view where the target is not found.

        Raises ValueError for an image that is neither blue, green, red nor grey, of 8 bits each.
        """
        image = coloured(image)
        sighting = self._followed(image, stamp_ns)
        if sighting is None:
            self.acquisitions += 1
            sighting = acquire(self.network, self._model, image, self._in_vain)
            self._follower.forget()
        self._in_vain = self._in_vain + 1 if sighting is None else 0
        if sighting is None:
            return View(
                frame=frame, stamp_ns=stamp_ns, landmarks=(), pixels=np.empty((0, 2)),
                covariances=np.empty((0, 2, 2)), scores=np.empty(0),
            )  # fmt: skip
        if sighting.agreement is not None:
            self._follower.note(stamp_ns, sighting.agreement.T_camera_target, sighting.agreement.covariance)
        return self._view(sighting, frame, stamp_ns)

    def follow(self, estimate: Estimate) -> None:
        """What the estimator made of the last view: its pose is better than that of one image alone."""
        if estimate.status == "tracking":
            self._follower.note(estimate.stamp_ns, estimate.T_camera_target, estimate.covariance)

    def _followed(self, image: Image, stamp_ns: int) -> Sighting | None:
        """Where it should be; None where it is not."""
        prediction = self._follower.predict(stamp_ns)
        region = None if prediction is None else self._follower.region(prediction)
        if prediction is None or region is None:
            return None
        window = window_about(np.array(region.middle), region.side, self.network.size)
        sighting = look(self.network, self._model, image, window, self._threshold)
        if believed(sighting, FOLLOW_LANDMARKS, FOLLOW_SCORE):
            return sighting
        seen = sighting.keypoints.above(self._threshold)
        near = agrees_with_prediction(
            self._model, sighting.keypoints, seen, prediction.T_camera_target, region.margin_px
        )
        return Sighting(window=window, keypoints=sighting.keypoints, agreement=None) if near else None

    def _view(self, sighting: Sighting, frame: int, stamp_ns: int) -> View:
        keypoints = sighting.keypoints
        rows = np.flatnonzero(keypoints.above(self._threshold) & self._model.known)
        return View(
            frame=frame,
            stamp_ns=stamp_ns,
            landmarks=tuple(self._model.names[j] for j in rows),
            pixels=keypoints.pixels[rows],
            covariances=keypoints.covariances[rows],
            scores=keypoints.scores[rows],
        )
