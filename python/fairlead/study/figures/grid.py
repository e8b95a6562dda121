# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Heat maps: error in units of EPnP's over noise and angle, for each model error and share of outliers."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure

from fairlead.evaluate.figures.style import COLOURS, INK, styled
from fairlead.study.figures.look import LABELS
from fairlead.study.settings import Setting
from fairlead.study.summary import Line

METHODS = ("window", "map")
_BETTER = LinearSegmentedColormap.from_list("gain", [COLOURS["map"], "#ffffff", COLOURS["epnp"]])
_NORM = TwoSlopeNorm(vmin=-2.0, vcenter=0.0, vmax=2.0)
"""Of log2 of the ratio: a quarter to four times."""


@styled
def draw_gain(lines: Sequence[Line], settings: Sequence[Setting], error: str, title: str) -> Figure:
    """Left the published window, right the batch with the prior; one row of panels per share of outliers."""
    outliers = sorted({setting.outlier_fraction for setting in settings})
    models = sorted({setting.model_sigma_m for setting in settings})
    found = {(line.method, line.setting.name): line for line in lines}
    figure = Figure(figsize=(12.0, 1.2 + 1.75 * len(outliers)), layout="constrained")
    panels = figure.subplots(len(outliers), len(METHODS) * len(models), sharex=True, sharey=True, squeeze=False)
    columns = [(method, model) for method in METHODS for model in models]
    for i, (row, share) in enumerate(zip(panels, outliers, strict=True)):
        for axes, (method, model) in zip(row, columns, strict=True):
            cells = [s for s in settings if s.outlier_fraction == share and s.model_sigma_m == model]
            _panel(axes, cells, {s.name: found[method, s.name] for s in cells if (method, s.name) in found}, error)
            if i == 0:
                axes.set_title(f"{LABELS[method].partition(' (')[0]}\nmodel error {model:g} m", fontsize=8.5)
            if i == len(outliers) - 1:
                axes.set_xlabel("noise [px]")
        row[0].set_ylabel(f"{100 * share:g} % outliers\nangle [deg]")
    bar = figure.colorbar(ScalarMappable(_NORM, _BETTER), ax=panels, aspect=40, pad=0.01, ticks=[-2, -1, 0, 1, 2])
    bar.ax.set_yticklabels(["1/4", "1/2", "1", "2", "4"])
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, fontweight="bold")
    return figure


def _panel(axes: Axes, cells: Sequence[Setting], lines: Mapping[str, Line], error: str) -> None:
    angles = sorted({cell.angle_deg for cell in cells})
    sigmas = sorted({cell.sigma_px for cell in cells})
    ratios = np.full((len(angles), len(sigmas)), np.nan)
    for cell in cells:
        if cell.name in lines:
            at = angles.index(cell.angle_deg), sigmas.index(cell.sigma_px)
            ratios[at] = lines[cell.name].against["epnp", error].ratio
    axes.imshow(np.log2(ratios), cmap=_BETTER, norm=_NORM, aspect="auto", origin="lower")
    for (i, j), ratio in np.ndenumerate(ratios):
        if np.isfinite(ratio):
            dark = abs(np.log2(ratio)) > 1.5
            text = f"{ratio:.2f}" if ratio < 9.95 else f"{ratio:.0f}"
            axes.text(j, i, text, ha="center", va="center", fontsize=6.5, color="white" if dark else INK)
    axes.set_xticks(range(len(sigmas)), [f"{value:g}" for value in sigmas])
    axes.set_yticks(range(len(angles)), [f"{value:g}" for value in angles])
    axes.grid(visible=False)
    axes.tick_params(length=0)
