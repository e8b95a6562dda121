# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The words on an overlay: status, range, how sure."""

import numpy as np

from fairlead import geometry
from fairlead.opencv import Colour, Image
from fairlead.sinks.overlay.lettering import text_mask, write_text
from fairlead.types import Estimate, Status, Target

STATUS_COLOUR: dict[Status, Colour] = {
    "tracking": (110, 200, 90),
    "coasting": (60, 180, 250),
    "acquiring": (210, 170, 100),
    "lost": (80, 80, 235),
}
_WHITE: Colour = (245, 245, 245)
_SOFT: Colour = (200, 200, 200)


def describe(estimate: Estimate, target: Target) -> list[str]:
    """Lines about one estimate; range and lateral sigma are those of the touchdown point, else of the middle."""
    about = f"frame {estimate.frame}   {1e-9 * estimate.stamp_ns:.2f} s"
    if not estimate.ok:
        return [about, estimate.reason.replace("_", " ")] if estimate.reason else [about]
    X = target.positions.mean(axis=0) if target.touchdown is None else np.asarray(target.touchdown)
    T = estimate.T_camera_target
    p = T[:3, :3] @ X + T[:3, 3]
    C = geometry.point_covariance(T, estimate.covariance, X)
    distance = float(np.linalg.norm(p))
    along = p / distance
    side = np.linalg.svd(along[None])[2][1:]
    range_sigma = float(np.sqrt(max(along @ C @ along, 0.0)))
    lateral = float(np.sqrt(max(np.linalg.eigvalsh(side @ C @ side.T)[-1], 0.0)))
    angle = float(np.degrees(np.sqrt(max(np.linalg.eigvalsh(estimate.covariance[3:, 3:])[-1], 0.0))))
    digits = 1 if distance >= 100.0 else 3
    return [
        about,
        f"range {distance:.{digits}f} ± {range_sigma:.{digits}f} m",
        f"lateral ± {lateral:.{digits + 1}f} m",
        f"attitude ± {angle:.2f}°",
        f"{estimate.n_inliers} landmarks, {estimate.reprojection_rms_px:.2f} px rms",
    ]


def draw_caption(image: Image, estimate: Estimate, target: Target) -> None:
    """In the top-left corner, on a darkened plate."""
    size = max(9, round(min(image.shape[:2]) / 58))
    gap = round(0.7 * size)
    lines = describe(estimate, target)
    height = text_mask("", size).shape[0]
    head = text_mask(estimate.status, size, bold=True).shape[1] + round(1.2 * gap)
    name = text_mask(target.name, size, bold=True).shape[1]
    width = max([head + gap + name, *(text_mask(line, size).shape[1] for line in lines)])
    step = height + round(0.25 * size)
    plate = image[gap : 3 * gap + step * (len(lines) + 1), gap : 3 * gap + width]
    plate[:] = (0.42 * plate).astype(np.uint8)
    chip = image[2 * gap - 2 : 2 * gap + height + 2, 2 * gap : 2 * gap + head]
    chip[:] = STATUS_COLOUR[estimate.status]
    write_text(image, estimate.status, (2 * gap + round(0.6 * gap), 2 * gap), size, (20, 20, 20), bold=True)
    write_text(image, target.name, (3 * gap + head, 2 * gap), size, _WHITE, bold=True)
    for number, line in enumerate(lines, 1):
        colour = _SOFT if number == 1 else _WHITE
        write_text(image, line, (2 * gap, 2 * gap + round(0.2 * size) + number * step), size, colour)


def draw_legend(image: Image, entries: list[tuple[str, Colour]]) -> None:
    """Words in their colours along the lower edge of an inset; those that do not fit are left out."""
    size = max(8, round(image.shape[0] / 30))
    gap = round(0.6 * size)
    height = text_mask("", size).shape[0]
    plate = image[-height - gap :]
    plate[:] = (0.42 * plate).astype(np.uint8)
    x = gap
    for text, colour in entries:
        width = text_mask(text, size).shape[1]
        if x + width > image.shape[1]:
            return
        write_text(image, text, (x, image.shape[0] - height - gap // 2), size, colour)
        x += width + 2 * gap
