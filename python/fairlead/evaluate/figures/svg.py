# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A figure as SVG to be put into a page: no fixed size, the page's fonts, colours that follow light and dark."""

import io
import re

from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import COLOURS, GRID, INK, MUTED, OTHERS, styled

VARIABLES: dict[str, str] = {
    INK: "--ink",
    MUTED: "--muted",
    GRID: "--grid",
    **{colour: f"--{name}" for name, colour in COLOURS.items() if name != "truth"},
    **{colour: f"--other-{index}" for index, colour in enumerate(OTHERS)},
}
"""Which CSS variable of the page stands for which colour."""

_NAMED = re.compile(r'(\bid="|xlink:href="#|\bhref="#|url\(#)')
_COLOUR = re.compile(r"#[0-9a-f]{6}")
_GEOMETRY = re.compile(r'\b(?:d|x|y|points|transform)="[^"]*"')
_LONG = re.compile(r"-?\d+\.\d{3,}")
_MARKERS = re.compile(r'<g([^>]*)>\s*((?:<use [^>]*?style="([^"]*)"/>\s*)(?:<use [^>]*?style="\3"/>\s*)+)</g>')
_FONT = re.compile(r"'DejaVu Sans'(?:, *[\w' -]+)*")


@styled
def figure_svg(figure: Figure, prefix: str) -> str:
    """The <svg> element alone. `prefix` keeps its ids apart from those of other figures on the page."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*|<style[^>]*>.*?</style>\s*", "", svg, flags=re.DOTALL)
    head, body = svg.split(">", 1)
    head = re.sub(r' (?:width|height)="[^"]*"', "", head)
    body = _NAMED.sub(lambda found: f"{found.group(1)}{prefix}-", body)
    body = _COLOUR.sub(lambda found: _variable(found.group(0)), body)
    body = _FONT.sub("var(--sans)", body)
    body = _GEOMETRY.sub(lambda found: _LONG.sub(_hundredths, found.group(0)), body)
    body = _MARKERS.sub(_style_once, body)
    return f'{head} style="stroke-linejoin: round">{body}'.strip()


def _variable(colour: str) -> str:
    return f"var({VARIABLES[colour]})" if colour in VARIABLES else colour


def _hundredths(found: re.Match[str]) -> str:
    """Points are 1/72 inch: a hundredth is finer than any screen."""
    return f"{float(found.group(0)):.2f}".rstrip("0").rstrip(".")


def _style_once(found: re.Match[str]) -> str:
    """Many markers of one style: let them inherit it from their group."""
    attributes, markers, style = found.groups()
    bare = re.sub(r"\s+", " ", markers.replace(f' style="{style}"', ""))
    return f'<g{attributes} style="{style}">{bare}</g>'
