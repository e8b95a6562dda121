# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One picture of the overlay: silhouette, landmarks with their ellipses, detections, inset, text."""

from collections.abc import Mapping

import numpy as np

from fairlead import geometry, opencv
from fairlead.cameras import project
from fairlead.io.mesh import Mesh
from fairlead.opencv import Colour, Image, Line
from fairlead.sinks.overlay.canvas import Canvas
from fairlead.sinks.overlay.caption import draw_caption, draw_legend
from fairlead.sinks.overlay.inset import Follower, Window
from fairlead.sinks.overlay.projection import landmark_ellipses, silhouette
from fairlead.sinks.sink import Outcome
from fairlead.types import Camera, Estimate, Matrix4, Pixels, PoseEstimator, Target

MODEL: Colour = (255, 190, 70)
TRUE: Colour = (60, 220, 255)
SEEN: Colour = (120, 255, 120)
OUTLIER: Colour = (90, 90, 255)
WHITE: Colour = (255, 255, 255)
DARK: Colour = (28, 24, 20)


class OverlayPainter:
    """Draws what the estimator believes over what the camera saw, docs/pipeline.md section 3.

    Parameters
    ----------
    target : its mesh, if given, must be that of the target frame
    estimator : whose current landmarks are drawn
    truth : true poses by frame, whose silhouette is drawn in yellow
    """

    def __init__(
        self,
        target: Target,
        camera: Camera,
        estimator: PoseEstimator,
        *,
        mesh: Mesh | None = None,
        truth: Mapping[int, Matrix4] | None = None,
    ) -> None:
        self._target, self._camera, self._estimator = target, camera, estimator
        self._mesh = mesh
        self._truth = truth or {}
        self._follower = Follower(camera.width, camera.height)

    def paint(self, outcome: Outcome) -> Image:
        """A new image; black behind where the source has no images."""
        if outcome.image is None:
            image = np.full((self._camera.height, self._camera.width, 3), DARK, np.uint8)
        else:
            image = outcome.image.copy()
        clean = image.copy()
        canvas = Canvas(image)
        extent = self._extent(outcome)
        window = None if extent is None else self._follower.follow(*extent)
        edges = self._edges(outcome.estimate, 1.0 if window is None else window.side / window.shown_px)
        self._draw(canvas, outcome, edges, close=window is None)
        if window is not None:
            zoomed = Canvas.magnified(clean, window.side, window.centre, window.shown_px)
            zoomed.line = canvas.line
            self._draw(zoomed, outcome, edges, close=True)
            draw_legend(zoomed.image, self._legend())
            _paste(canvas, zoomed, window)
        draw_caption(image, outcome.estimate, self._target)
        return image

    def _legend(self) -> list[tuple[str, Colour]]:
        named = [("pose", MODEL), ("detected", SEEN), ("not believed", OUTLIER), ("3σ", WHITE)]
        return [("truth", TRUE), *named] if self._truth else named

    def _edges(self, estimate: Estimate, scale: float) -> tuple[list[Line], list[Line]]:
        """Silhouettes of the estimated and of the true pose."""
        mesh, true = self._mesh, self._truth.get(estimate.frame)
        if mesh is None:
            return [], []
        ours = silhouette(self._camera, mesh, estimate.T_camera_target, scale) if estimate.ok else []
        return ours, [] if true is None else silhouette(self._camera, mesh, true, scale)

    def _extent(self, outcome: Outcome) -> tuple[np.ndarray, np.ndarray] | None:
        """From where to where the target reaches in the image: by its pose, else by what was detected."""
        seen = outcome.view.pixels
        if outcome.estimate.ok:
            X = self._mesh.vertices if self._mesh is not None else self._estimator.model.positions
            seen = project(self._camera, geometry.transform(outcome.estimate.T_camera_target, X))
        seen = seen[np.isfinite(seen).all(axis=1)]
        size = np.array([self._camera.width, self._camera.height], dtype=np.float64)
        seen = seen[((seen > -0.5) & (seen < size - 0.5)).all(axis=1)]
        return (seen.min(axis=0), seen.max(axis=0)) if len(seen) else None

    def _draw(self, canvas: Canvas, outcome: Outcome, edges: tuple[list[Line], list[Line]], *, close: bool) -> None:
        """Silhouettes, and from close by what was detected and how sure it is."""
        ours, true = edges
        canvas.tint(ours, MODEL, 0.2)
        canvas.outline(ours, MODEL, width=canvas.line * (2 if close else 1))
        if close:
            canvas.outline(true, TRUE, width=canvas.line)
            self._draw_landmarks(canvas, outcome)

    def _draw_landmarks(self, canvas: Canvas, outcome: Outcome) -> None:
        estimate, view = outcome.estimate, outcome.view
        arm = 4.0 * canvas.line
        for name, pixel in zip(view.landmarks, view.pixels, strict=True):
            good = name in estimate.inliers
            at: Pixels = pixel[None]
            colour = SEEN if good else OUTLIER
            canvas.cross(at, arm, DARK, width=3 * canvas.line, turned=not good)
            canvas.cross(at, arm, colour, width=canvas.line, turned=not good)
        if not estimate.ok:
            return
        pixels, covariances = landmark_ellipses(self._camera, estimate, self._estimator.model.positions)
        for pixel, covariance in zip(pixels, covariances, strict=True):
            canvas.ellipse(pixel[None], covariance, 3.0, WHITE, width=canvas.line)
            canvas.ellipse(pixel[None], covariance, 1.0, MODEL, width=canvas.line)
            canvas.dot(pixel[None], 1.6 * canvas.line, WHITE)
        if self._target.touchdown is not None:
            pixels, covariances = landmark_ellipses(self._camera, estimate, self._target.touchdown[None])
            canvas.ellipse(pixels, covariances[0], 3.0, TRUE, width=2 * canvas.line)
            canvas.cross(pixels, 2.0 * arm, TRUE, width=canvas.line)


def _paste(canvas: Canvas, zoomed: Canvas, window: Window) -> None:
    """The inset into its corner, with frames about it and about what it shows."""
    opencv.draw_lines(canvas.image, [window.square()], WHITE, width=canvas.line, closed=True)
    canvas.image[window.top : window.top + window.side, window.left : window.left + window.side] = zoomed.image
    frame = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * (window.side - 1) + [window.left, window.top]
    opencv.draw_lines(canvas.image, [frame], WHITE, width=2 * canvas.line, closed=True)
