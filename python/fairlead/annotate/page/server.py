# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The server: this machine only, everything it serves is installed or in the folder."""

import mimetypes
import socket
from importlib.resources import files

from fastapi import Response
from nicegui import app, ui
from starlette.middleware.trustedhost import TrustedHostMiddleware

from fairlead.annotate.page.shell import Shell
from fairlead.annotate.workbench import Workbench
from fairlead.io.errors import InputError
from fairlead.opencv import read_image
from fairlead.opencv.filters import encode_png

HOST = "127.0.0.1"
SHOWN_AS_THEY_ARE = (".png", ".jpg", ".jpeg", ".webp", ".bmp")
"""A browser decodes these itself; others are turned into PNG."""
NO_CACHE = {"Cache-Control": "no-store"}


def free_port(wanted: int) -> int:
    """The wanted port, or any with 0. Raises OSError where it is taken."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((HOST, wanted))
        return int(probe.getsockname()[1])


def serve(bench: Workbench, port: int, *, show: bool) -> None:
    """Serve the page until the process is told to stop."""
    shells: dict[str, Shell] = {}
    script = files("fairlead.annotate.page").joinpath("zoom.js").read_text(encoding="utf-8")

    def page() -> None:
        client = ui.context.client
        ui.add_head_html(f"<script>{script}</script>")
        shell = Shell(bench, lambda: len(shells))

        def come() -> None:
            shells[client.id] = shell
            for each in shells.values():
                each.count_tabs()

        def go() -> None:
            shells.pop(client.id, None)
            for each in shells.values():
                each.count_tabs()

        client.on_connect(come)
        client.on_delete(go)

    _add_files(bench)
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])
    ui.run(
        page,
        host=HOST,
        port=port,
        title=f"fairlead annotate: {bench.project.name}",
        favicon="⚓",
        reload=False,
        show=show,
        show_welcome_message=False,
        reconnect_timeout=10.0,
    )


def _add_files(bench: Workbench) -> None:
    """Routes for the mesh and the frames."""

    @app.get("/mesh.glb")
    def mesh() -> Response:
        surface = bench.project.surface
        if surface is None:
            return Response(status_code=404)
        return Response(surface.glb, media_type="model/gltf-binary", headers=NO_CACHE)

    @app.get("/frame/{number}")
    def frame(number: str) -> Response:
        try:
            found = bench.project.frame(int(number))
            bench.project.check_frame(found)
            if found.path.suffix.lower() in SHOWN_AS_THEY_ARE:
                kind = mimetypes.guess_type(found.path.name)[0] or "application/octet-stream"
                return Response(found.path.read_bytes(), media_type=kind, headers=NO_CACHE)
            return Response(encode_png(read_image(found.path)), media_type="image/png", headers=NO_CACHE)
        except (InputError, KeyError, ValueError, OSError):
            return Response(status_code=404)  # the page has said why
