# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An OpenGL context without a window."""

from pathlib import Path
from typing import TYPE_CHECKING

from fairlead.render.errors import RenderError

if TYPE_CHECKING:
    import moderngl

_SHADERS = Path(__file__).parent / "shaders"


def open_context() -> "moderngl.Context":
    """A context on EGL. Raises RenderError, one line, where there is no moderngl or no EGL."""
    try:
        import moderngl
    except ImportError as error:
        raise RenderError("moderngl is not installed: pip install 'fairlead[render]'") from error
    try:
        context = moderngl.create_context(standalone=True, backend="egl", require=330)  # pyright: ignore[reportArgumentType]
    except Exception as error:  # the loader raises whatever the driver made of it
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise RenderError(
            f"no OpenGL 3.3 on EGL here ({reason}); Debian: apt install libegl1 libgl1-mesa-dri"
        ) from error
    context.gc_mode = "context_gc"
    return context


def load_program(context: "moderngl.Context", vertex: str, fragment: str) -> "moderngl.Program":
    """A program of two shader files; those that speak of light get light.glsl."""
    texts = [(_SHADERS / name).read_text(encoding="utf-8") for name in (vertex, fragment)]
    light = (_SHADERS / "light.glsl").read_text(encoding="utf-8")
    version = "#version 330\n"
    if "noise_map" in texts[1]:
        texts[1] = version + light + texts[1].removeprefix(version)
    return context.program(vertex_shader=texts[0], fragment_shader=texts[1])
