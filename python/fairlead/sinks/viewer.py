# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the estimator believes in three dimensions, by rerun: live, or as a file to look at later."""

import logging
from pathlib import Path
from typing import Any

import numpy as np

from fairlead import geometry
from fairlead.cameras import project
from fairlead.io.errors import InputError
from fairlead.io.mesh import Mesh
from fairlead.sinks.overlay.caption import STATUS_COLOUR
from fairlead.sinks.sink import Outcome
from fairlead.types import Camera, Matrix4, PoseEstimator, Target

_log = logging.getLogger(__name__)

JPEG_QUALITY = 85
_GOODBYE_S = 3.0
_SHOWN_SIGMAS = 3.0
_BLUE, _YELLOW, _GREEN, _RED, _WHITE = (70, 190, 255), (255, 220, 60), (120, 255, 120), (255, 90, 90), (255, 255, 255)
_TARGET, _CAMERA = "target", "target/camera"


class ViewerSink:
    """The target stands still, the camera moves: surface, landmarks with 3-sigma ellipsoids, path, image, curves.

    Raises InputError without the extra `viewer`; OSError where the file cannot be written.
    """

    def __init__(
        self,
        target: Target,
        camera: Camera,
        estimator: PoseEstimator,
        *,
        mesh: Mesh | None = None,
        rrd: Path | None = None,
        live: bool = False,
    ) -> None:
        try:
            import rerun
        except ImportError as error:
            raise InputError("--viewer", "needs the extra: pip install 'fairlead[viewer]'") from error
        self._rr: Any = rerun
        self._camera, self._estimator, self._mesh = camera, estimator, mesh
        self._stream: Any = rerun.RecordingStream("fairlead", send_properties=True)
        if rrd is not None:
            rrd.open("wb").close()  # where that fails, rerun would only say so in its log
        sinks = ([] if rrd is None else [rerun.FileSink(str(rrd))]) + ([rerun.GrpcSink()] if live else [])
        if live:
            try:
                self._stream.spawn(connect=False)
            except RuntimeError as error:
                raise InputError("--viewer", f"cannot be started: {error}") from error
        self._stream.set_sinks(*sinks, default_blueprint=self._blueprint())
        self._last: np.ndarray | None = None
        self._size = float(np.ptp(target.positions, axis=0).max())
        self._draw_target(target, mesh)

    def _blueprint(self) -> Any:
        import rerun.blueprint as layout

        plots = [
            layout.TimeSeriesView(origin=f"plots/{name}", name=name)
            for name in ("range_m", "sigma_m", "reprojection_px")
        ]
        right = layout.Vertical(layout.Spatial2DView(origin=_CAMERA, name="camera"), layout.Tabs(*plots))
        always = _up_to_now(layout, self._rr)
        scene = layout.Spatial3DView(origin=_TARGET, name="target", overrides={f"{_TARGET}/path": always})
        return layout.Blueprint(layout.Horizontal(scene, right, column_shares=[3, 2]), collapse_panels=True)

    def _draw_target(self, target: Target, mesh: Mesh | None) -> None:
        rr = self._rr
        if mesh is not None:
            surface = rr.Mesh3D(
                vertex_positions=mesh.vertices[mesh.faces].reshape(-1, 3), vertex_normals=_normals(mesh)
            )
            self._stream.log(f"{_TARGET}/surface", surface, static=True)
        if target.touchdown is not None:
            point = rr.Points3D([target.touchdown], colors=[_YELLOW], radii=0.012 * self._size, labels=["touchdown"])
            self._stream.log(f"{_TARGET}/touchdown", point, static=True)
        pinhole = rr.Pinhole(
            image_from_camera=self._camera.K,
            resolution=[self._camera.width, self._camera.height],
            camera_xyz=rr.ViewCoordinates.RDF,
            image_plane_distance=0.3 * self._size,
        )
        self._stream.log(_CAMERA, pinhole, static=True)

    def write(self, outcome: Outcome) -> None:
        """Log one frame."""
        estimate = outcome.estimate
        self._stream.set_time("frame", sequence=estimate.frame)
        self._stream.set_time("stamp", duration=np.timedelta64(estimate.stamp_ns, "ns"))
        if outcome.image is not None:
            picture = self._rr.Image(outcome.image, color_model="BGR").compress(jpeg_quality=JPEG_QUALITY)
            self._stream.log(f"{_CAMERA}/image", picture)
        self._log_detections(outcome)
        blue, green, red = STATUS_COLOUR[estimate.status]
        text = f"{estimate.status} {estimate.reason}".strip()
        self._stream.log("status", self._rr.TextLog(text, color=(red, green, blue)))
        if estimate.ok:
            self._log_pose(estimate.T_camera_target, outcome)
            self._log_model()

    def _log_detections(self, outcome: Outcome) -> None:
        view, estimate = outcome.view, outcome.estimate
        colours = [_GREEN if name in estimate.inliers else _RED for name in view.landmarks]
        seen = self._rr.Points2D(view.pixels, colors=colours or None, radii=self._rr.Radius.ui_points(3.0))
        self._stream.log(f"{_CAMERA}/image/detected", seen)

    def _log_pose(self, T_camera_target: Matrix4, outcome: Outcome) -> None:
        rr, estimate = self._rr, outcome.estimate
        T_target_camera = geometry.inverse(T_camera_target)
        here = T_target_camera[:3, 3]
        if self._last is not None:
            step = rr.LineStrips3D([np.array([self._last, here])], colors=[_BLUE], radii=rr.Radius.ui_points(1.5))
            self._stream.log(f"{_TARGET}/path", step)
        self._last = here
        self._stream.log(_CAMERA, rr.Transform3D(translation=here, mat3x3=T_target_camera[:3, :3]))
        shown = project(self._camera, geometry.transform(T_camera_target, self._estimator.model.positions))
        usable = shown[np.isfinite(shown).all(axis=1)]
        points = rr.Points2D(usable, colors=[_WHITE], radii=rr.Radius.ui_points(1.5))
        self._stream.log(f"{_CAMERA}/image/projected", points)
        sigma = float(np.sqrt(np.trace(estimate.covariance[:3, :3])))
        values = {"range_m": float(np.linalg.norm(T_camera_target[:3, 3])), "sigma_m": sigma}
        for name, value in (values | {"reprojection_px": estimate.reprojection_rms_px}).items():
            self._stream.log(f"plots/{name}", rr.Scalars(value))

    def _log_model(self) -> None:
        """Landmarks where they are thought to be now; half axes are three standard deviations."""
        rr, model = self._rr, self._estimator.model
        blocks = np.array([model.covariance[3 * j : 3 * j + 3, 3 * j : 3 * j + 3] for j in range(len(model.landmarks))])
        values, axes = np.linalg.eigh(blocks)
        axes[np.linalg.det(axes) < 0.0, :, 0] *= -1.0
        quaternions = [geometry.quat_xyzw_from_matrix(R) for R in axes]
        shapes = rr.Ellipsoids3D(
            centers=model.positions,
            half_sizes=_SHOWN_SIGMAS * np.sqrt(values.clip(0.0)),
            quaternions=quaternions,
            colors=[_BLUE],
        )
        self._stream.log(f"{_TARGET}/landmarks/ellipsoids", shapes)
        names = rr.Points3D(model.positions, colors=[_WHITE], labels=model.landmarks, show_labels=False)
        self._stream.log(f"{_TARGET}/landmarks/points", names)

    def close(self) -> None:
        """Write what is left; safe to call twice."""
        if self._stream is not None:
            stream, self._stream = self._stream, None
            try:
                stream.flush(timeout_sec=_GOODBYE_S)
            except RuntimeError as error:  # somebody closed the viewer
                _log.warning("viewer: %s", (str(error).splitlines() or ["is gone"])[0])
            stream.disconnect()


def _up_to_now(layout: Any, rr: Any) -> Any:
    """Everything up to the moment that is looked at: the path is logged step by step."""
    begin, now = rr.TimeRangeBoundary.infinite(), rr.TimeRangeBoundary.cursor_relative()
    return layout.VisibleTimeRanges([rr.VisibleTimeRange("frame", start=begin, end=now)])


def _normals(mesh: Mesh) -> np.ndarray:
    """One per corner, that of its triangle: edges stay sharp."""
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.repeat(normals / np.where(lengths > 0.0, lengths, 1.0), 3, axis=0)
