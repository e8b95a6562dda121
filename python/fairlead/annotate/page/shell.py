# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One browser tab: bar with undo, redo and save, three panels, keys. All tabs show the one document of the server."""

import time
from collections.abc import Callable
from typing import Any

from nicegui import ui
from nicegui.events import KeyEventArguments

from fairlead.annotate.document import Action
from fairlead.annotate.page.frames import FramesPanel
from fairlead.annotate.page.landmarks import LandmarksPanel
from fairlead.annotate.page.look import STYLE
from fairlead.annotate.page.truth import TruthPanel
from fairlead.annotate.workbench import Workbench
from fairlead.io.errors import one_line


class Shell:
    """The page of one tab."""

    def __init__(self, bench: Workbench, tabs_open: Callable[[], int]) -> None:
        self.bench = bench
        self._tabs_open = tabs_open
        ui.dark_mode(value=True)
        ui.colors(primary="#0ea5e9", secondary="#334155", accent="#22d3ee")
        ui.add_css(STYLE)
        with ui.column().classes("w-full h-screen no-wrap gap-0"):
            self._bar()
            with (
                ui.tab_panels(self._tabs, value=self._first)
                .classes("w-full grow min-h-0 bg-transparent")
                .props("animated=false")
            ):
                with ui.tab_panel("Landmarks").classes("p-0 h-full"):
                    self.landmarks = LandmarksPanel(self)
                with ui.tab_panel("Frames").classes("p-0 h-full"):
                    self.frames = FramesPanel(self)
                with ui.tab_panel("Truth").classes("p-0 h-full"):
                    self.truth = TruthPanel(self)
        ui.keyboard(on_key=self._key)
        client = ui.context.client
        client.on_delete(bench.document.listen(self._changed))
        for notice in bench.project.notices:
            ui.notify(notice, type="warning", timeout=0, close_button="OK", multi_line=True)
        self.refresh()

    @property
    def _first(self) -> str:
        return "Frames" if self.bench.labels.landmarks and self.bench.project.frames else "Landmarks"

    def _bar(self) -> None:
        with ui.row().classes("bar w-full items-center no-wrap gap-2 px-4 h-14 shrink-0"):
            ui.label("fairlead").classes("text-lg font-bold")
            ui.label(self.bench.project.name).classes("text-lg dim whitespace-nowrap")
            first: Any = self._first  # a name will do, whatever the annotation says
            with ui.tabs(value=first, on_change=lambda: self.refresh()).classes("ml-6") as self._tabs:
                ui.tab("Landmarks", icon="place")
                ui.tab("Frames", icon="burst_mode")
                ui.tab("Truth", icon="task_alt")
            self._tabs.props("inline-label no-caps dense")
            ui.space()
            self._others = ui.label().classes("few text-sm whitespace-nowrap").mark("tabs")
            self._status = ui.label("every action is saved at once").classes("dim text-sm truncate").mark("status")
            self._undo = ui.button(icon="undo", on_click=self.undo).props("flat round dense").tooltip("Undo (Ctrl+Z)")
            self._redo = ui.button(icon="redo", on_click=self.redo).props("flat round dense")
            self._redo.tooltip("Redo (Ctrl+Shift+Z)")
            save = ui.button("Save files", icon="save", on_click=self.save).props(
                "dense no-caps unelevated padding='4px 12px'"
            )
            save.tooltip("Write target.toml, observations.csv, truth.csv, annotations.json (Ctrl+S)")

    @property
    def tab(self) -> str:
        """The panel that is shown."""
        return str(self._tabs.value)

    def show(self, tab: str) -> None:
        """Show a panel."""
        self._tabs.set_value(tab)

    def attempt(self, action: Callable[[], object]) -> bool:
        """Do what a person asked for; what cannot be done is said in one line, and nothing has changed."""
        try:
            action()
        except OSError as error:
            self.complain(f"not saved, and not done: {error.filename or ''} {error.strerror or error}")
            return False
        except ValueError as error:
            self.complain(str(error))
            return False
        return True

    def say(self, text: str) -> None:
        """What was done, where it is always said."""
        self._status.set_text(f"{text} · saved {time.strftime('%H:%M:%S')}")

    def complain(self, text: str) -> None:
        """Say what went wrong."""
        ui.notify(one_line(text), type="negative", timeout=8000, close_button="OK", multi_line=True, position="top")

    def _changed(self, action: Action) -> None:
        self.say(action.what)
        self.refresh()

    def refresh(self) -> None:
        """Show what is now; only the panel that is seen."""
        document = self.bench.document
        self._undo.set_enabled(document.can_undo)
        self._redo.set_enabled(document.can_redo)
        panel = {"Landmarks": self.landmarks, "Frames": self.frames, "Truth": self.truth}[self.tab]
        panel.refresh()
        self.landmarks.be_seen(seen=panel is self.landmarks)

    def count_tabs(self) -> None:
        """Say where the page is open more than once."""
        tabs = self._tabs_open()
        self._others.set_text(f"open in {tabs} tabs: all show and edit the same labels" if tabs > 1 else "")

    def undo(self) -> None:
        """Take back the last action."""
        self.attempt(self.bench.document.undo)

    def redo(self) -> None:
        """Do it again."""
        self.attempt(self.bench.document.redo)

    def save(self) -> None:
        """Write the files."""
        self.attempt(lambda: ui.notify(f"Saved {self.bench.save()}", type="positive", timeout=6000, position="top"))

    def _key(self, event: KeyEventArguments) -> None:
        if not event.action.keydown:
            return
        key, held = str(event.key), event.modifiers
        if held.ctrl or held.meta:
            commands = {"z": self.redo if held.shift else self.undo, "y": self.redo, "s": self.save}
            command = commands.get(key.lower())
            if command is not None and not event.action.repeat:
                command()
        elif self.tab == "Frames":
            self.frames.key(key, shift=held.shift)
        elif self.tab == "Landmarks":
            self.landmarks.key(key)
