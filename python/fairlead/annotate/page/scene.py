# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The mesh in NiceGUI's three.js scene, with a ball and a name for every landmark."""

from collections.abc import Callable

import numpy as np
from nicegui import events, ui

from fairlead.annotate.labels import Landmark, Triple
from fairlead.annotate.surface import Surface

BALL = 0.008
"""Radius of a landmark's ball, as a share of the target's size [-]."""
BACKGROUND = "#0b1220"
FOV_DEG = 40.0
FPS_SEEN, FPS_UNSEEN = 20, 0.2
"""Pictures of the scene per second; it goes on being drawn behind another panel."""
NAME_STYLE = "font:600 12px sans-serif;text-shadow:0 0 3px #000,0 0 3px #000;margin-top:-24px"


class SurfaceScene:
    """Picks on the mesh, clicks on landmarks, landmarks that were dragged."""

    def __init__(
        self,
        surface: Surface,
        pick: Callable[[Triple], None],
        choose: Callable[[int | None], None],
        drop: Callable[[int, Triple, Triple], None],
    ) -> None:
        self._surface = surface
        self._pick, self._choose, self._drop = pick, choose, drop
        self._radius = BALL * surface.size_m
        self._shown: tuple[tuple[Landmark, ...], int | None] = ((), None)
        camera = ui.scene.perspective_camera(fov=FOV_DEG, near=0.01 * surface.size_m, far=50.0 * surface.size_m)
        self.scene = ui.scene(
            grid=False,
            camera=camera,
            background_color=BACKGROUND,
            on_click=self._clicked,
            click_events=["click", "dblclick"],
            on_drag_end=self._dragged,
            fps=FPS_SEEN,
        ).classes("w-full h-full")
        with self.scene as scene:
            scene.gltf("/mesh.glb").with_name("mesh")
        x, y, z = (surface.middle + surface.size_m * np.array([0.74, -0.74, 0.54])).tolist()
        a, b, c = surface.middle.tolist()
        self.scene.move_camera(x=x, y=y, z=z, look_at_x=a, look_at_y=b, look_at_z=c, duration=0)

    def show(self, landmarks: tuple[Landmark, ...], chosen: int | None) -> None:
        """Draw the landmarks anew where they have changed."""
        if self._shown == (landmarks, chosen):
            return
        self._shown = (landmarks, chosen)
        self.scene.delete_objects(lambda each: each.name != "mesh")
        with self.scene as scene:
            for landmark in landmarks:
                is_chosen = landmark.number == chosen
                colour = "#fde047" if is_chosen else "#38bdf8"
                ball = scene.sphere(self._radius * (1.35 if is_chosen else 1.0)).move(*landmark.position_m)
                ball.material(colour).with_name(f"landmark {landmark.number}").draggable()
                style = f"color:{colour};{NAME_STYLE}"
                scene.text(landmark.name, style=style).move(*landmark.position_m).with_name("name")

    def be_seen(self, *, seen: bool) -> None:
        """Draw it often only while it is seen."""
        self.scene.props["fps"] = FPS_SEEN if seen else FPS_UNSEEN

    def _clicked(self, event: events.SceneClickEventArguments) -> None:
        """On a ball: choose it. A double click on the mesh: a new landmark."""
        hit = next(
            (each for each in event.hits if each.object_name == "mesh" or _number(each.object_name) is not None), None
        )
        if hit is None:
            return
        number = _number(hit.object_name)
        if number is not None:
            self._choose(number)
        elif event.click_type == "dblclick":
            self._pick((hit.x, hit.y, hit.z))

    async def _dragged(self, event: events.SceneDragEventArguments) -> None:
        number = _number(event.object_name)
        if number is None:
            return
        try:
            eye = (await self.scene.get_camera())["position"]
        except TimeoutError:
            return
        self._shown = ((), None)  # the ball lies where it was dropped, not where the landmark will be
        self._drop(number, (eye["x"], eye["y"], eye["z"]), (event.x, event.y, event.z))


def _number(name: str) -> int | None:
    word, _, digits = name.partition(" ")
    return int(digits) if word == "landmark" and digits.isdecimal() else None
