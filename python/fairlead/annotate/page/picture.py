# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One image with what is drawn over it; zoom and pan happen in the browser (zoom.js), clicks come in image pixels."""

from collections.abc import Callable

from nicegui import events, ui

from fairlead.annotate.overlay import HALF_PX

NEAR = 3.0
"""Screen pixels per image pixel from which on the image's own pixels are shown as squares."""
_ONLY_DRAGS = "(e) => { if (e.mouse_event_type !== 'mousemove' || (e.buttons & 1)) emit(e) }"

Point = Callable[[float, float], None]


class Picture:
    """`press`, `move` and `release` hear of the left button, in image pixels; `rescaled` of a new zoom."""

    def __init__(
        self, width: int, height: int, press: Point, move: Point, release: Point, rescaled: Callable[[], None]
    ) -> None:
        self._press, self._move, self._release, self._rescaled = press, move, release, rescaled
        self.scale = 1.0
        """Screen pixels per image pixel."""
        self._attached = False
        with ui.element("div").classes("box grow w-full min-h-0") as self._box, ui.element("div"):
            self._image = ui.interactive_image(size=(width, height), sanitize=False).classes("w-full")
            self._image.props["events"] = ["mousedown", "mousemove", "mouseup"]
            self._image.on("mouse", self._mouse, js_handler=_ONLY_DRAGS)
        self._attach = f"fairlead.attach(getHtmlElement({self._box.id}), {width}, {height})"
        ui.on("scale", self._scale)

    def show(self, source: str) -> None:
        """Another image."""
        if not self._attached:
            self._attached = True
            ui.run_javascript(self._attach)
        self._image.set_source(source)

    def draw(self, svg: str) -> None:
        """What lies over it."""
        self._image.set_content(svg)

    def fit(self) -> None:
        """The whole image."""
        ui.run_javascript("fairlead.fit()")

    def zoom(self, factor: float) -> None:
        """Larger or smaller about the middle."""
        ui.run_javascript(f"fairlead.by({factor})")

    def look_at(self, low: tuple[float, float], high: tuple[float, float]) -> None:
        """A rectangle of the image [px], with some room about it."""
        ui.run_javascript(f"fairlead.region({low[0]:.1f}, {low[1]:.1f}, {high[0]:.1f}, {high[1]:.1f})")

    def _scale(self, event: events.GenericEventArguments) -> None:
        self.scale = float(event.args)
        self._box.classes(**({"add": "near"} if self.scale >= NEAR else {"remove": "near"}))
        self._rescaled()

    def _mouse(self, event: events.GenericEventArguments) -> None:
        """The browser's (0, 0) is half a pixel off ours; a pixel of the screen is hit in its middle."""
        kind = event.args["mouse_event_type"]
        shift = 0.5 / self.scale - HALF_PX
        u, v = float(event.args["image_x"]) + shift, float(event.args["image_y"]) + shift
        if kind == "mousemove":
            self._move(u, v)
        elif event.args["button"] == 0:
            (self._press if kind == "mousedown" else self._release)(u, v)
