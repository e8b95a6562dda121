# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The third job: poses of all labelled frames, and all of them solved jointly."""

from typing import TYPE_CHECKING, Any

import numpy as np
from nicegui import events, run, ui

from fairlead.annotate.solve import FrameSolution, JointSolution

if TYPE_CHECKING:
    from fairlead.annotate.page.shell import Shell

_COLUMNS = [
    {"name": "frame", "label": "frame", "field": "frame", "sortable": True, "align": "right"},
    {"name": "marks", "label": "marks", "field": "marks", "sortable": True, "align": "right"},
    {"name": "rms", "label": "residual [px]", "field": "rms", "sortable": True, "align": "right"},
    {"name": "distance", "label": "distance [m]", "field": "distance", "sortable": True, "align": "right"},
    {"name": "sigma_m", "label": "1σ position [m]", "field": "sigma_m", "sortable": True, "align": "right"},
    {"name": "sigma_deg", "label": "1σ rotation [°]", "field": "sigma_deg", "sortable": True, "align": "right"},
    {"name": "by", "label": "solved", "field": "by", "sortable": True, "align": "left"},
    {"name": "warnings", "label": "warnings", "field": "warnings", "align": "left"},
]


class TruthPanel:
    """Table of poses, joint solution, files."""

    def __init__(self, shell: "Shell") -> None:
        self._shell = shell
        self.bench = shell.bench
        with ui.column().classes("w-full h-full p-6 gap-4 no-wrap"):
            with ui.row().classes("w-full items-center gap-4"):
                self._numbers = ui.html(sanitize=False).classes("text-base grow").mark("numbers")
                self._joint = ui.button("Solve all jointly", icon="hub", on_click=self.solve)
                self._joint.props("no-caps unelevated")
            self._result = ui.html(sanitize=False).classes("w-full dim").mark("joint")
            self._table = ui.table(columns=_COLUMNS, rows=[], row_key="frame", pagination=50)
            self._table.classes("w-full min-h-0").props("flat dense bordered")
            self._table.on("rowClick", self._row)

    def refresh(self) -> None:
        """Show the poses as they are now."""
        frames = self.bench.labelled()
        solutions = {frame.number: self.bench.truth(frame.number) for frame in frames}
        posed = [each for each in solutions.values() if each is not None and each.estimate.ok]
        warned = sum(bool(each.warnings) for each in posed)
        style = "warn" if warned else ""
        self._numbers.set_content(
            f"<b>{len(frames)}</b> of {len(self.bench.project.frames)} frames labelled · "
            f'<b class="good">{len(posed)}</b> with a pose · <b class="{style}">{warned}</b> with warnings'
        )
        self._table.rows = [self._line(number, each) for number, each in solutions.items()]
        self._joint.set_enabled(bool(posed))
        self._result.set_content(self._joint_text())

    def _line(self, number: int, solution: FrameSolution | None) -> dict[str, Any]:
        marks = sum(not mark.hidden for mark in self.bench.labels.marks(number).values())
        line: dict[str, Any] = {"frame": number, "marks": marks}
        if solution is not None:
            line["warnings"] = "; ".join(each.text for each in solution.warnings)
        if solution is not None and solution.estimate.ok:
            estimate, joint = solution.estimate, self.bench.joint
            by = joint is not None and self.bench.joint_is_current and number in joint.solutions
            covariance = estimate.covariance
            line |= {
                "rms": round(estimate.reprojection_rms_px, 2),
                "distance": round(float(np.linalg.norm(estimate.T_camera_target[:3, 3])), 3),
                "sigma_m": float(f"{np.sqrt(np.trace(covariance[:3, :3])):.2g}"),
                "sigma_deg": float(f"{np.degrees(np.sqrt(np.trace(covariance[3:, 3:]))):.2g}"),
                "by": "jointly" if by else "alone",
            }
        return line

    def _joint_text(self) -> str:
        joint = self.bench.joint
        if joint is None:
            return (
                "Each frame is solved as it is clicked. Jointly, the frames also agree on where the landmarks are: "
                "that is better where the landmarks are only roughly known, and changes little where they are exact."
            )
        if not self.bench.joint_is_current:
            return '<span class="few">The labels have changed since all frames were solved jointly: solve again.</span>'
        return joint_text(joint, self.bench.labels.positions)

    async def solve(self) -> None:
        """All frames in one, beside the page."""
        self._joint.props("loading")
        try:
            joint = await run.io_bound(self.bench.solve_all)
            if joint is not None:  # None while the server is shutting down
                self.bench.take_joint(joint)
        except ValueError as error:
            self._shell.complain(str(error))
        finally:
            self._joint.props(remove="loading")
        self._shell.refresh()

    def _row(self, event: events.GenericEventArguments) -> None:
        self._shell.frames.show_frame(int(event.args[1]["frame"]))
        self._shell.show("Frames")


def joint_text(joint: JointSolution, told: np.ndarray) -> str:
    """Residual, and how far the landmarks moved."""
    moved = np.linalg.norm(joint.refinement.model.positions - told, axis=1)
    farthest = joint.refinement.model.landmarks[int(np.argmax(moved))]
    fits = "" if joint.refinement.converged else ' <span class="warn">It did not converge.</span>'
    return (
        f'<span class="good">Solved jointly</span>: {len(joint.solutions)} frames, residual '
        f"{joint.refinement.reprojection_rms_px:.2f} px; landmarks moved by {np.sqrt(np.mean(moved**2)):.2g} m rms, "
        f"most {farthest} by {moved.max():.2g} m. Save writes these poses, "
        f"and the landmarks as target_refined.toml.{fits}"
    )
