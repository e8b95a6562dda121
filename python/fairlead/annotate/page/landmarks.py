# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The first job: landmarks on the mesh, in 3D."""

from typing import TYPE_CHECKING

import numpy as np
from nicegui import ui

from fairlead.annotate.labels import Landmark, triple
from fairlead.annotate.page.scene import SurfaceScene

if TYPE_CHECKING:
    from fairlead.annotate.page.shell import Shell

_HELP = (
    ("double click", "on the mesh: new landmark"),
    ("click", "a landmark: choose"),
    ("drag", "a landmark: move it over the surface"),
    ("drag, wheel", "elsewhere: turn, zoom"),
    ("Del", "delete the chosen"),
)


class LandmarksPanel:
    """Mesh, points on it, and what is known of the chosen one."""

    def __init__(self, shell: "Shell") -> None:
        self._shell = shell
        self.bench = shell.bench
        self.chosen: int | None = None
        surface = self.bench.project.surface
        with ui.row().classes("w-full h-full no-wrap gap-0"):
            with ui.element("div").classes("grow h-full min-w-0 relative"):
                self._scene = None if surface is None else SurfaceScene(surface, self.pick, self.choose, self.drop)
                if surface is None:
                    ui.label("This folder has no mesh: type survey coordinates on the right.").classes(
                        "p-8 text-lg dim"
                    )
            with ui.column().classes("side w-96 shrink-0 h-full no-wrap gap-3 p-3"):
                self._suggestions()
                self._list = ui.column().classes("w-full grow min-h-0 overflow-auto no-wrap gap-0")
                self._editor = ui.column().classes("w-full gap-1")
                self._survey()
                with ui.column().classes("gap-1 text-xs dim"):
                    for key, does in _HELP:
                        with ui.row().classes("gap-1 items-center"):
                            ui.label(key).classes("key")
                            ui.label(does)

    def _suggestions(self) -> None:
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            self._count = ui.number(value=12, min=1, max=200, precision=0).props("dense outlined").classes("w-20")
            self._count.mark("suggest-count")
            suggest = ui.button("Suggest", icon="auto_awesome", on_click=self.suggest)
            suggest.props("dense no-caps unelevated padding='6px 12px'").tooltip("Sharp corners, in sight, well spread")
            suggest.set_enabled(self.bench.project.surface is not None)
            self._snap = ui.switch("snap to corners", value=True).props("dense").classes("text-sm")
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            self._sigma = ui.number("1σ of all [m]", value=self.bench.default_sigma_m, min=0.0, format="%.4g")
            self._sigma.props("dense outlined").classes("w-32").mark("sigma-all")
            ui.button("Set for all", on_click=self.set_all_sigmas).props("dense flat no-caps")

    def _survey(self) -> None:
        with ui.expansion("Type survey coordinates", icon="edit_location_alt").classes("w-full text-sm").props("dense"):
            self._new_name = ui.input("name").props("dense outlined").classes("w-full")
            with ui.row().classes("w-full no-wrap gap-1"):
                self._new = [ui.number(f"{axis} [m]", format="%.6g").props("dense outlined") for axis in "xyz"]
            ui.button("Add", icon="add", on_click=self.add_survey).props("dense flat no-caps")

    def refresh(self) -> None:
        """Show the landmarks as they are now."""
        labels = self.bench.labels
        if self.chosen not in {each.number for each in labels.landmarks}:
            self.chosen = None
        if self._scene is not None:
            self._scene.show(labels.landmarks, self.chosen)
        self._list.clear()
        with self._list:
            if not labels.landmarks:
                ui.label("No landmarks yet: double-click on the mesh, or let some be suggested.").classes("dim p-2")
            for landmark in labels.landmarks:
                self._line(landmark)
        self._editor.clear()
        if self.chosen is not None:
            with self._editor:
                self._edit(labels.landmark(self.chosen))

    def be_seen(self, *, seen: bool) -> None:
        """Whether this panel is the one that is shown."""
        if self._scene is not None:
            self._scene.be_seen(seen=seen)

    def _line(self, landmark: Landmark) -> None:
        row = ui.row().classes(f"line w-full items-center gap-2 {'chosen' if landmark.number == self.chosen else ''}")
        with row.on("click", lambda: self.choose(landmark.number)).mark(f"point-{landmark.name}"):
            ui.icon("place").classes("few" if landmark.number == self.chosen else "carried")
            ui.label(landmark.name).classes("grow truncate")
            ui.label(", ".join(f"{value:.3f}" for value in landmark.position_m)).classes("number text-xs dim")
            ui.label(f"±{max(landmark.sigma_m):.3g}").classes("number text-xs dim")

    def _edit(self, landmark: Landmark) -> None:
        number = landmark.number
        with ui.row().classes("w-full items-center no-wrap gap-1"):
            name = ui.input("name", value=landmark.name).props("dense outlined").classes("grow").mark("name")
            name.on(
                "change",
                lambda: self._try(lambda: self.bench.document.rename_landmark(number, str(name.value).strip())),
            )
            ui.button(icon="delete", on_click=self.delete).props("flat round dense").classes("warn").tooltip(
                "Delete (Del)"
            )
        with ui.row().classes("w-full no-wrap gap-1"):
            at = [
                ui.number(f"{a} [m]", value=x, format="%.6g") for a, x in zip("xyz", landmark.position_m, strict=True)
            ]
            sigma = ui.number("1σ [m]", value=max(landmark.sigma_m), min=0.0, format="%.4g").mark("sigma")
        for each in (*at, sigma):
            each.props("dense outlined")
        for each in at:
            each.on("change", lambda: self._try(lambda: self.bench.document.move_landmark(number, _numbers(at))))
        sigma.on("change", lambda: self._try(lambda: self.bench.document.set_sigma(number, _numbers([sigma] * 3))))

    def _try(self, action: object) -> None:
        if not self._shell.attempt(action):  # pyright: ignore[reportArgumentType]
            self.refresh()

    def choose(self, number: int | None) -> None:
        """Make a landmark the chosen one."""
        self.chosen = number
        self.refresh()

    def pick(self, position: tuple[float, float, float]) -> None:
        """A new landmark where the mesh was picked."""
        sigma_m = float(self._sigma.value or 0.0)
        document = self.bench.document
        at = self.bench.pick(position, snap=bool(self._snap.value))
        self.chosen = document.next_number()
        self._shell.attempt(lambda: document.add_landmark(document.free_name(), at, (sigma_m, sigma_m, sigma_m)))

    def drop(self, number: int, seen_from: tuple[float, float, float], position: tuple[float, float, float]) -> None:
        """A landmark was dragged: it goes to where the line of sight meets the surface, else to the nearest point."""
        surface = self.bench.project.surface
        if surface is None:
            return
        hit = surface.first_hit(np.array(seen_from), np.array(position))
        at = self.bench.pick(position if hit is None else hit.tolist(), snap=bool(self._snap.value))
        self.chosen = number
        self._try(lambda: self.bench.document.move_landmark(number, at))
        self.refresh()

    def suggest(self) -> None:
        """Add corners of the mesh."""
        count = int(self._count.value or 0)

        def add() -> None:
            found = self.bench.suggest(count)
            short = "" if found >= count else ": the mesh has no more distinct corners that can be seen"
            ui.notify(
                f"{found} landmarks suggested{short}", type="info" if found else "warning", position="bottom-left"
            )

        self._shell.attempt(add)

    def set_all_sigmas(self) -> None:
        """The same sigma for all landmarks."""
        self._shell.attempt(lambda: self.bench.document.set_all_sigmas(float(self._sigma.value or 0.0)))

    def add_survey(self) -> None:
        """A landmark from typed coordinates."""
        sigma_m = float(self._sigma.value or 0.0)
        name = str(self._new_name.value).strip() or self.bench.document.free_name()
        self.chosen = self.bench.document.next_number()
        self._try(lambda: self.bench.document.add_landmark(name, _numbers(self._new), (sigma_m, sigma_m, sigma_m)))

    def delete(self) -> None:
        """Delete the chosen landmark."""
        if self.chosen is not None:
            number = self.chosen
            self._shell.attempt(lambda: self.bench.document.delete_landmark(number))

    def key(self, key: str) -> None:
        """A key that was pressed while this panel was shown."""
        if key in ("Delete", "Backspace"):
            self.delete()


def _numbers(inputs: list[ui.number]) -> tuple[float, float, float]:
    """Raises ValueError for an empty one."""
    values = [each.value for each in inputs if each.value is not None]
    if len(values) != len(inputs):
        raise ValueError("expected three numbers")
    return triple([float(value) for value in values])
