# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The second job: landmarks in the frames."""

from html import escape
from typing import TYPE_CHECKING

import numpy as np
from nicegui import ui

from fairlead.annotate.labels import Landmark, Mark
from fairlead.annotate.overlay import draw_marks, draw_mesh
from fairlead.annotate.page.filmstrip import Filmstrip, State
from fairlead.annotate.page.picture import Picture
from fairlead.annotate.solve import FrameSolution

if TYPE_CHECKING:
    from fairlead.annotate.page.shell import Shell

GRAB = 10.0
"""A mark is taken hold of within this distance on the screen [px]."""
NUDGE_PX = 0.25
KEYS = (
    *(("click", "place, drag to move"), ("← →", "frame"), ("↑ ↓", "landmark"), ("N", "carry on to the next")),
    *(("H", "hidden"), ("Del", "clear"), ("Shift ←→↑↓", "nudge ¼ px"), ("wheel", "zoom"), ("right drag", "pan")),
    *(("F", "to the target"), ("0", "fit"), ("M", "mesh")),
)


class FramesPanel:
    """Image, marks, list of landmarks."""

    def __init__(self, shell: "Shell") -> None:
        self._shell = shell
        self.bench = shell.bench
        frames, camera = self.bench.project.frames, self.bench.project.camera
        self.frame = frames[0].number if frames else None
        self.chosen: int | None = None
        self._held: tuple[int, Mark | None] | None = None
        self._shown: int | None = None
        self._mesh = True
        self._picture: Picture | None = None
        if not frames or camera is None:
            lacks = "camera.yaml" if frames else "frames: put images into the folder images/"
            ui.label(f"This folder has no {lacks}, and start again.").classes("p-8 text-lg dim")
            return
        with ui.row().classes("w-full h-full no-wrap gap-0"):
            with ui.column().classes("grow h-full no-wrap gap-0 min-w-0"):
                self._picture = Picture(camera.width, camera.height, self._press, self._drag, self._release, self._draw)
                self._strip = Filmstrip(len(frames), self.go, lambda place: self.show_frame(frames[place].number))
            with ui.column().classes("side w-80 shrink-0 h-full no-wrap gap-2 p-3"):
                self._sidebar()

    def _sidebar(self) -> None:
        with ui.row().classes("w-full items-center no-wrap gap-1"):
            carry = ui.button("Carry on", icon="keyboard_double_arrow_right", on_click=self.propagate)
            carry.props("dense no-caps no-wrap unelevated").classes("grow").tooltip("Marks to the next frame (N)")
            for text, icon, does, key in (
                ("Hidden", "visibility_off", self.hide, "H"),
                ("Clear", "backspace", self.clear, "Del"),
            ):
                ui.button(text, icon=icon, on_click=does).props("dense flat no-caps no-wrap").tooltip(key)
        self._pose = ui.html(sanitize=False).classes("w-full text-sm").mark("pose")
        self._list = ui.column().classes("w-full grow min-h-0 overflow-auto no-wrap gap-0")
        self._warnings = ui.column().classes("w-full gap-0 text-sm warn")
        with ui.row().classes("w-full gap-x-2 gap-y-1 text-xs dim"):
            for key, does in KEYS:
                with ui.row().classes("gap-1 items-center"):
                    ui.label(key).classes("key")
                    ui.label(does)

    def refresh(self) -> None:
        """Draw the frame as it is now."""
        if self.frame is None or self._picture is None:
            return
        if self.chosen not in {each.number for each in self.bench.labels.landmarks}:
            self.chosen = self._next_unmarked()
        self._show_image(self._picture, self.frame)
        self._draw()
        self._fill_list(self.frame)
        frames = self.bench.project.frames
        here = [each.number for each in frames].index(self.frame)
        self._strip.draw([self.state(each.number) for each in frames], here, self.frame)

    def _show_image(self, picture: Picture, number: int) -> None:
        if self._shown == number:
            return
        self._shown = number
        project = self.bench.project
        usable = self._shell.attempt(lambda: project.check_frame(project.frame(number)))
        picture.show(f"/frame/{number if usable else 'none'}")

    def _draw(self) -> None:
        if self.frame is None or self._picture is None or self.bench.project.camera is None:
            return
        solution = self.bench.solution(self.frame)
        marks = dict(self.bench.labels.marks(self.frame))
        if self._held is not None and self._held[1] is not None:
            marks[self._held[0]] = self._held[1]
        mesh, surface = "", self.bench.project.surface
        if self._mesh and surface is not None and solution is not None and solution.estimate.ok:
            mesh = draw_mesh(surface, self.bench.project.camera, solution.estimate.T_camera_target)
        self._picture.draw(mesh + draw_marks(self.bench.labels, marks, solution, self.chosen, self._picture.scale))

    def _fill_list(self, frame: int) -> None:
        solution = self.bench.solution(frame)
        marks = self.bench.labels.marks(frame)
        self._pose.set_content(pose_text(solution))
        self._list.clear()
        with self._list:
            for landmark in self.bench.labels.landmarks:
                self._list_line(landmark, marks.get(landmark.number), solution)
        self._warnings.clear()
        with self._warnings:
            for warned in () if solution is None or not solution.estimate.ok else solution.warnings[:4]:
                ui.label(f"⚠ {warned.text}").mark("warning")

    def _list_line(self, landmark: Landmark, mark: Mark | None, solution: FrameSolution | None) -> None:
        number = landmark.number
        warned = solution is not None and number in {each.number for each in solution.warnings}
        residual = None if solution is None else solution.residuals.get(number)
        sign, style, text = "○", "dim", ""
        if mark is not None and mark.hidden:
            sign, text = "◌", "hidden"
        elif mark is not None:
            sign, style = "●", "warn" if warned else "carried" if mark.origin == "flow" else "good"
            text = "" if residual is None else f"{np.hypot(*residual):.2f} px"
        elif solution is not None and solution.projected and number not in solution.in_sight:
            text = "out of sight"
        row = ui.row().classes(f"line w-full items-center gap-2 {'chosen' if number == self.chosen else ''}")
        with row.on("click", lambda: self.choose(number)).mark(f"landmark-{landmark.name}"):
            ui.label(sign).classes(style)
            ui.label(landmark.name).classes("grow truncate")
            ui.label(text).classes(f"number text-sm whitespace-nowrap {style}")

    def state(self, frame: int) -> State:
        """How far a frame is."""
        if not self.bench.labels.marks(frame):
            return "none"
        solution = self.bench.solution(frame)
        if solution is None or solution.estimate.reason == "too_few":
            return "few"
        return "warn" if solution.warnings else "good"

    def _press(self, u: float, v: float) -> None:
        if self.frame is None or self._picture is None:
            return
        scale = self._picture.scale
        marks = {n: m for n, m in self.bench.labels.marks(self.frame).items() if not m.hidden}
        distances = {n: scale * float(np.hypot(m.u_px - u, m.v_px - v)) for n, m in marks.items()}
        nearest = min(distances, key=distances.__getitem__, default=None)
        if nearest is not None and distances[nearest] <= GRAB and self.chosen in (nearest, *marks, None):
            self._held = (nearest, None)
            self.choose(nearest)
        elif self.chosen is not None:
            self._held = (self.chosen, Mark(u_px=u, v_px=v))
            self._draw()
        else:
            none = "there are no landmarks yet: pick some on the mesh first"
            self._shell.complain("choose a landmark in the list first" if self.bench.labels.landmarks else none)

    def _drag(self, u: float, v: float) -> None:
        if self._held is not None:
            self._held = (self._held[0], Mark(u_px=u, v_px=v))
            self._draw()

    def _release(self, u: float, v: float) -> None:
        if self._held is None or self.frame is None:
            return
        (number, moved), frame = self._held, self.frame
        self._held = None
        if moved is None:
            return
        was_marked = number in self.bench.labels.marks(frame)
        if self._shell.attempt(lambda: self.bench.document.mark(frame, number, u, v)) and not was_marked:
            self.choose(self._next_unmarked(number))

    def _next_unmarked(self, after: int | None = None) -> int | None:
        """The next landmark of the list that has no mark here and is not known to be out of sight; None if none is."""
        numbers = [each.number for each in self.bench.labels.landmarks]
        if not numbers or self.frame is None:
            return None
        place = numbers.index(after) + 1 if after in numbers else 0
        marks, solution = self.bench.labels.marks(self.frame), self.bench.solution(self.frame)
        known = solution is not None and bool(solution.projected)
        seen = numbers if not known or solution is None else solution.in_sight
        return next((n for n in [*numbers[place:], *numbers[:place]] if n not in marks and n in seen), None)

    def choose(self, number: int | None) -> None:
        """Make a landmark the one that is placed next."""
        self.chosen = number
        self.refresh()

    def go(self, step: int) -> None:
        """To another frame."""
        if self.frame is not None:
            self.show_frame(self.bench.next_frame(self.frame, step))

    def show_frame(self, number: int) -> None:
        """To this frame."""
        self.frame = number
        self._held = None
        self.chosen = self._next_unmarked()
        self.refresh()

    def propagate(self) -> None:
        """Carry the marks to the next frame, and go there."""
        frame = self.frame
        if frame is None:
            return

        def carry() -> None:
            done = self.bench.propagate(frame)
            self.show_frame(done.frame)
            self._shell.say(str(done))

        self._shell.attempt(carry)

    def hide(self) -> None:
        """The chosen landmark cannot be seen here."""
        if self.frame is not None and self.chosen is not None:
            frame, number = self.frame, self.chosen
            if self._shell.attempt(lambda: self.bench.document.hide(frame, number)):
                self.choose(self._next_unmarked(number))

    def clear(self) -> None:
        """Take the chosen landmark's mark away."""
        if self.frame is not None and self.chosen is not None:
            frame, number = self.frame, self.chosen
            self._shell.attempt(lambda: self.bench.document.clear(frame, number))

    def _nudge(self, du: float, dv: float) -> None:
        if self.frame is None or self.chosen is None:
            return
        mark, frame, number = self.bench.labels.marks(self.frame).get(self.chosen), self.frame, self.chosen
        if mark is not None and not mark.hidden:
            u, v = mark.u_px + du, mark.v_px + dv
            self._shell.attempt(lambda: self.bench.document.mark(frame, number, u, v))

    def _step(self, step: int) -> None:
        numbers = [each.number for each in self.bench.labels.landmarks]
        if numbers:
            place = numbers.index(self.chosen) + step if self.chosen in numbers else 0
            self.choose(numbers[place % len(numbers)])

    def _toggle_mesh(self) -> None:
        self._mesh = not self._mesh
        self._draw()

    def _to_target(self) -> None:
        solution = None if self.frame is None else self.bench.solution(self.frame)
        if self._picture is not None and solution is not None and solution.projected:
            pixels = np.array(list(solution.projected.values()))
            self._picture.look_at(tuple(pixels.min(axis=0).tolist()), tuple(pixels.max(axis=0).tolist()))

    def key(self, key: str, *, shift: bool) -> None:
        """A key that was pressed while this panel was shown."""
        if self._picture is None:
            return
        arrows = {"ArrowLeft": (-1, 0), "ArrowRight": (1, 0), "ArrowUp": (0, -1), "ArrowDown": (0, 1)}
        if key in arrows and shift:
            self._nudge(NUDGE_PX * arrows[key][0], NUDGE_PX * arrows[key][1])
        elif key in arrows:
            along, across = arrows[key]
            self.go(along) if along else self._step(across)
        elif key in ("+", "=", "-"):
            self._picture.zoom(0.8 if key == "-" else 1.25)
        else:
            commands = {"n": self.propagate, "h": self.hide, "m": self._toggle_mesh, "f": self._to_target}
            commands |= {"delete": self.clear, "backspace": self.clear, "0": self._picture.fit}
            commands.get(key.lower(), lambda: None)()


def pose_text(solution: FrameSolution | None) -> str:
    """Distance, residual and uncertainty of the pose, or why there is none."""
    if solution is None or not solution.estimate.ok:
        text = "no marks yet" if solution is None or not solution.warnings else solution.warnings[0].text
        return f'<span class="dim">no pose: {escape(text)}</span>'
    estimate = solution.estimate
    t = estimate.T_camera_target[:3, 3]
    sigma_m = np.sqrt(np.trace(estimate.covariance[:3, :3]))
    sigma_deg = np.degrees(np.sqrt(np.trace(estimate.covariance[3:, 3:])))
    where = f"<b>{np.linalg.norm(t):.4g} m</b> away · residual <b>{estimate.reprojection_rms_px:.2f} px</b>"
    return f'<span class="number">{where}<br>1σ: {sigma_m:.2g} m, {sigma_deg:.2g}°</span>'
