# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What is minimised. docs/networks.md section 3."""

import torch
import torch.nn.functional as F
from torch import Tensor

from fairlead.train.labels import Batch
from fairlead.train.networks.prediction import Prediction

FOUND_PX = 10.0
"""A landmark that is farther off is lost: its error says nothing of what a crop's errors share."""
HIDDEN_WEIGHT = 0.3
"""Of a hidden landmark: where it must be is told by the rest of the ship, but less well."""


def landmark_weight(batch: Batch) -> Tensor:
    """(b, n): 0 outside, HIDDEN_WEIGHT hidden, 1 visible."""
    return torch.where(batch.visibility == 2, 1.0, torch.where(batch.visibility == 1, HIDDEN_WEIGHT, 0.0))


def mean_of(values: Tensor, weight: Tensor) -> Tensor:
    """Weighted mean; 0 where there is no weight."""
    return (values * weight).sum() / weight.sum().clamp_min(1.0)


def whitened(prediction: Prediction, batch: Batch, *, detach_mean: bool = True) -> Tensor:
    """(b, n, 2): L^-1 (z - pixels)."""
    mean = prediction.pixels.detach() if detach_mean else prediction.pixels
    e = batch.pixels - mean
    l11, l22 = prediction.cholesky[..., 0].exp(), prediction.cholesky[..., 1].exp()
    first = e[..., 0] / l11
    return torch.stack([first, (e[..., 1] - prediction.cholesky[..., 2] * first) / l22], dim=-1)


def covariance_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b, n): negative log of Student's t with 4 degrees of freedom at the error of a fixed mean [nat].

    log det L + 3 log(1 + s / 4), s the squared whitened error: a Gaussian would pay any price for one gross error.
    """
    s = whitened(prediction, batch).square().sum(-1)
    return prediction.cholesky[..., 0] + prediction.cholesky[..., 1] + 3.0 * torch.log1p(0.25 * s)


def gaussian_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b, n): negative log of a Gaussian at the error of a fixed mean [nat]: log det L + s / 2.

    Least where the covariance is the mean square of the errors, gross ones included.
    """
    s = whitened(prediction, batch).square().sum(-1)
    return prediction.cholesky[..., 0] + prediction.cholesky[..., 1] + 0.5 * s


def visibility_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b, n): cross entropy of being seen [nat]."""
    seen = (batch.visibility == 2).to(prediction.visible.dtype)
    return F.binary_cross_entropy_with_logits(prediction.visible, seen, reduction="none")


def there(batch: Batch) -> Tensor:
    """(b,): whether the target is in the crop: some landmark of it, seen or hidden."""
    return (batch.visibility > 0).any(dim=1)


def presence_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b,): cross entropy of the target being in the crop [nat]."""
    wanted = there(batch).to(prediction.present.dtype)
    return F.binary_cross_entropy_with_logits(prediction.present, wanted, reduction="none")


def distance_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b, n): Huber's loss of the error, 1 px at the corner [px]."""
    return F.smooth_l1_loss(prediction.pixels, batch.pixels, reduction="none", beta=1.0).sum(-1)


def similarity_loss(prediction: Prediction, batch: Batch) -> Tensor:
    """(b,): Huber's loss of what the errors of a crop share, 1 px at the corner [px]; 0 where most landmarks are lost.

    The similarity t + s q + r q' that fits the errors best, q the landmarks about their mean and of unit rms, q' the
    same turned by 90 degrees: a pose errs by t, s and r, and hardly by the rest. docs/networks.md section 3.
    """
    weight = landmark_weight(batch)
    share = (weight / weight.sum(1, keepdim=True).clamp_min(1.0))[..., None]
    e = prediction.pixels - batch.pixels
    found = (share[..., 0] * (e.norm(dim=-1) < FOUND_PX)).sum(1) > 0.5
    e = share * e
    about = batch.pixels - (share * batch.pixels).sum(1, keepdim=True)
    q = about / (share * about.square()).sum((1, 2), keepdim=True).sqrt().clamp_min(1.0)
    along, across = (e * q).sum((1, 2)), (e[..., 1] * q[..., 0] - e[..., 0] * q[..., 1]).sum(1)
    shared = torch.stack([*e.sum(1).unbind(-1), along, across], dim=-1)
    return found * F.smooth_l1_loss(shared, torch.zeros_like(shared), reduction="none", beta=1.0).sum(-1)
