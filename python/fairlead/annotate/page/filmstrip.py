# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""All frames in a strip, coloured by how far they are; a click goes there."""

from collections.abc import Callable, Sequence
from typing import Literal

from nicegui import events, ui

State = Literal["none", "few", "good", "warn"]
"""Of a frame: without marks, too few for a pose, with a pose, with something odd."""
COLOURS: dict[State, str] = {"none": "#334155", "few": "#fbbf24", "good": "#4ade80", "warn": "#f87171"}
_WHERE = "(e) => emit(e.offsetX / e.currentTarget.clientWidth)"


class Filmstrip:
    """`go` hears of steps by -1 and 1, `show` of the place of a frame that was clicked."""

    def __init__(self, count: int, go: Callable[[int], None], show: Callable[[int], None]) -> None:
        self._count, self._show = count, show
        with ui.row().classes("bar w-full shrink-0 items-center no-wrap gap-3 px-3 h-14"):
            ui.button(icon="chevron_left", on_click=lambda: go(-1)).props("flat round dense").tooltip("←")
            self._strip = ui.html(sanitize=False).classes("strip grow h-6").mark("strip")
            self._strip.on("click", self._click, js_handler=_WHERE)
            ui.button(icon="chevron_right", on_click=lambda: go(1)).props("flat round dense").tooltip("→")
            self._place = ui.label().classes("number text-right whitespace-nowrap").mark("place")

    def draw(self, states: Sequence[State], here: int, number: int) -> None:
        """States of all frames; the frame at place `here` is the one that is shown, and its number."""
        width = 1000.0 / self._count
        gap = min(2.0, 0.1 * width)
        boxes: list[str] = []
        for place, state in enumerate(states):
            outline = ' stroke="#fff" stroke-width="3" vector-effect="non-scaling-stroke"' if place == here else ""
            at = f'x="{place * width + 0.5 * gap:.2f}" y="2" width="{width - gap:.2f}" height="20"'
            boxes.append(f'<rect {at} fill="{COLOURS[state]}"{outline}/>')
        box = 'viewBox="0 0 1000 24" preserveAspectRatio="none" style="pointer-events:none;display:block"'
        self._strip.set_content(f'<svg width="100%" height="24" {box}>{"".join(boxes)}</svg>')
        self._place.set_text(f"frame {number} · {here + 1} of {self._count}")

    def _click(self, event: events.GenericEventArguments) -> None:
        self._show(min(max(int(float(event.args) * self._count), 0), self._count - 1))
