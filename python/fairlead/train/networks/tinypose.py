# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""PP-TinyPose (PaddleDetection): Lite-HRNet, one heatmap a landmark at stride 4, DARK decoding (Zhang et al. 2020).

What is published, and beside it covariance and visibility from the features under the peak, and presence.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from fairlead.train.networks.heat import STRIDE, expectation, gaussian_rows
from fairlead.train.networks.layers import even_contrast
from fairlead.train.networks.lite_hrnet import WIDTHS, LiteHrNet
from fairlead.train.networks.pooling import LandmarkHead, Presence, seen_if_present
from fairlead.train.networks.prediction import Prediction

SIGMA = 2.0
"""Of the label's heat, and of the blur before a peak is fitted [cells]."""
REACH = 5
"""Of that blur [cells]."""
MAP_WEIGHT = 1000.0
"""The mean over a map that is nearly empty is small beside the other losses."""


class TinyPose(nn.Module):
    """Any crop whose sides are multiples of 32 px."""

    def __init__(self, landmarks: int) -> None:
        super().__init__()
        self.backbone = LiteHrNet()
        self.heat = nn.Conv2d(WIDTHS[0], landmarks, 1)
        self.blur = Blur(landmarks)
        self.landmark = LandmarkHead(landmarks, WIDTHS[0] + 3)
        self.presence = Presence(WIDTHS[-1])

    def forward(self, images: Tensor) -> Prediction:
        """(b, 3, h, w), normalised."""
        features, coarse = self.backbone(even_contrast(images))
        features = features.float()
        heat = self.heat(features).float()
        _, known = expectation(heat, features)
        cholesky, seen = self.landmark(known)
        present = self.presence(coarse)
        visible, pixels = seen_if_present(seen, present), dark(heat.detach(), self.blur)
        return Prediction(pixels=pixels, cholesky=cholesky, visible=visible, present=present, maps=(heat,))

    def map_loss(self, maps: tuple[Tensor, ...], pixels: Tensor) -> Tensor:
        """(b, n): mean square difference from a Gaussian of SIGMA cells."""
        (heat,) = maps
        across, down = gaussian_rows(pixels, heat.shape[3], heat.shape[2], SIGMA)
        return MAP_WEIGHT * (heat - down[..., :, None] * across[..., None, :]).square().mean((2, 3))


class Blur(nn.Module):
    """Gaussian of SIGMA cells over each map, not learned."""

    def __init__(self, maps: int) -> None:
        super().__init__()
        weight = torch.exp(-0.5 * (torch.arange(-REACH, REACH + 1) / SIGMA) ** 2)
        self.across = nn.Buffer((weight / weight.sum()).reshape(1, 1, 1, -1).repeat(maps, 1, 1, 1))

    def forward(self, heat: Tensor) -> Tensor:
        """(b, n, h, w) -> (b, n, h, w)."""
        n = self.across.shape[0]
        blurred = F.conv2d(heat, self.across, padding=(0, REACH), groups=n)
        return F.conv2d(blurred, self.across.transpose(2, 3), padding=(REACH, 0), groups=n)


def dark(heat: Tensor, blur: Blur) -> Tensor:
    """Pixels (b, n, 2): one Newton step on the log of the blurred heat from its highest cell."""
    h, w = heat.shape[2:]
    blurred = blur(heat)
    log = blurred.clamp_min(1e-10).log()
    at = heat.flatten(2).argmax(2)
    u, v = (at % w).clamp(1, w - 2), torch.div(at, w, rounding_mode="floor").clamp(1, h - 2)
    flat = log.flatten(2)

    def around(du: int, dv: int) -> Tensor:
        return flat.gather(2, ((v + dv) * w + u + du)[..., None])[..., 0]

    middle = around(0, 0)
    gu, gv = 0.5 * (around(1, 0) - around(-1, 0)), 0.5 * (around(0, 1) - around(0, -1))
    huu = around(1, 0) - 2.0 * middle + around(-1, 0)
    hvv = around(0, 1) - 2.0 * middle + around(0, -1)
    huv = 0.25 * (around(1, 1) - around(1, -1) - around(-1, 1) + around(-1, -1))
    determinant = (huu * hvv - huv * huv).clamp_min(1e-6)
    su = -(hvv * gu - huv * gv) / determinant
    sv = -(huu * gv - huv * gu) / determinant
    peak = torch.stack([u + su.clamp(-1.0, 1.0), v + sv.clamp(-1.0, 1.0)], dim=-1)
    return STRIDE * peak + 0.5 * (STRIDE - 1)
