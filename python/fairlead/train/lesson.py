# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What a trainer repeats: a batch in, a loss out. docs/networks.md section 3."""

import math
from typing import Any

import lightning
import torch
from torch import Tensor

from fairlead.train.crops import normalise
from fairlead.train.labels import Batch
from fairlead.train.losses import (
    covariance_loss,
    distance_loss,
    gaussian_loss,
    landmark_weight,
    mean_of,
    presence_loss,
    similarity_loss,
    there,
    visibility_loss,
    whitened,
)
from fairlead.train.networks.catalogue import Network, make_network
from fairlead.train.networks.prediction import Prediction
from fairlead.train.networks.rtmpose import RtmPose

DISTANCE_WEIGHT = 0.1
SIMILARITY_WEIGHT = 0.2
COVARIANCE_WEIGHT = 0.2
VISIBILITY_WEIGHT = 0.5
PRESENCE_WEIGHT = 0.5


def channels_last(network: Network) -> Network:
    """The same network with the memory laid out as the processor likes it."""
    for weights in (*network.parameters(), *network.buffers()):
        if weights.ndim == 4:
            weights.data = weights.data.contiguous(memory_format=torch.channels_last)
    return network


class Lesson(lightning.LightningModule):
    """One network, its loss, its optimiser: AdamW, warm-up, flat, half a cosine down over the second half."""

    def __init__(
        self,
        network: str,
        landmarks: tuple[str, ...],
        steps: int,
        *,
        rate: float,
        decay: float = 0.05,
        size: int = 256,
    ) -> None:
        super().__init__()
        self.save_hyperparameters()
        self.name, self.landmarks, self.size = network, tuple(landmarks), size
        self.steps, self.rate, self.decay = steps, rate, decay
        self.network = channels_last(make_network(network, len(landmarks), size))

    @property
    def any_size(self) -> bool:
        """Whether the network takes images of any multiple of 32 px."""
        return not isinstance(self.network, RtmPose)

    def forward(self, images: Tensor) -> Prediction:
        """8 bit (b, 3, h, w), blue green red."""
        return self.network(normalise(images).contiguous(memory_format=torch.channels_last))

    def training_step(self, batch: Batch, index: int) -> Tensor:
        """Sum of the six losses."""
        del index
        prediction = self(batch.images)
        weight = landmark_weight(batch)
        parts = {
            "map": mean_of(self.network.map_loss(prediction.maps, batch.pixels), weight),
            "distance": DISTANCE_WEIGHT * mean_of(distance_loss(prediction, batch), weight),
            "similarity": SIMILARITY_WEIGHT * similarity_loss(prediction, batch).mean(),
            "covariance": COVARIANCE_WEIGHT * mean_of(covariance_loss(prediction, batch), weight),
            "visibility": VISIBILITY_WEIGHT * visibility_loss(prediction, batch).mean(),
            "presence": PRESENCE_WEIGHT * presence_loss(prediction, batch).mean(),
        }
        loss = torch.stack(list(parts.values())).sum()
        self.log_dict({f"train/{name}": value.detach() for name, value in parts.items()}, on_step=False, on_epoch=True)
        self.log("train/loss", loss.detach(), on_step=False, on_epoch=True, prog_bar=True)
        return loss

    def validation_step(self, batch: Batch, index: int) -> None:
        """Errors of visible landmarks, in pixels of the crop."""
        del index
        prediction = self(batch.images)
        seen = batch.visibility == 2
        distance = (prediction.pixels - batch.pixels).norm(dim=-1)[seen]
        nees = 0.5 * whitened(prediction, batch).square().sum(-1)[seen]
        right = ((prediction.visible > 0.0) == seen).float().mean()
        self.log("valid/median_px", distance.median(), prog_bar=True)
        self.log("valid/mean_px", distance.mean())
        self.log("valid/within_5_px", (distance < 5.0).float().mean())
        self.log("valid/nees_median", nees.median())
        self.log("valid/visibility_right", right)
        self.log("valid/presence_right", ((prediction.present > 0.0) == there(batch)).float().mean())

    def configure_optimizers(self) -> Any:
        """AdamW without decay of biases and norms; the rate by the step."""
        decayed = [p for p in self.parameters() if p.ndim > 1]
        others = [p for p in self.parameters() if p.ndim <= 1]
        groups = [{"params": decayed, "weight_decay": self.decay}, {"params": others, "weight_decay": 0.0}]
        optimiser = torch.optim.AdamW(groups, lr=self.rate)
        schedule = torch.optim.lr_scheduler.LambdaLR(optimiser, lambda step: share_of_rate(step, self.steps))
        return {"optimizer": optimiser, "lr_scheduler": {"scheduler": schedule, "interval": "step"}}


def share_of_rate(step: int, steps: int) -> float:
    """Of the learning rate: warm-up, flat, half a cosine down to 0.02 over the second half."""
    warm = min(1.0, (step + 1) / min(500.0, 0.05 * steps + 1.0))
    done = min(1.0, step / steps)
    return warm * (0.02 + 0.98 * 0.5 * (1.0 + math.cos(math.pi * max(0.0, 2.0 * done - 1.0))))


class Settling(lightning.LightningModule):
    """After the course: the head for covariance and visibility alone, by a Gaussian; nothing else changes."""

    def __init__(self, lesson: Lesson, steps: int, rate: float = 1e-3) -> None:
        super().__init__()
        self.lesson, self.steps, self.rate = lesson.requires_grad_(requires_grad=False), steps, rate
        self.head = lesson.network.landmark.requires_grad_()

    def train(self, mode: bool = True) -> "Settling":  # noqa: FBT001, FBT002
        """The means of batch norm are not to move."""
        del mode
        return super().train(mode=False)

    def training_step(self, batch: Batch, index: int) -> Tensor:
        """Gaussian of the errors, and visibility."""
        del index
        prediction = self.lesson(batch.images)
        likelihood = mean_of(gaussian_loss(prediction, batch), landmark_weight(batch))
        return COVARIANCE_WEIGHT * likelihood + VISIBILITY_WEIGHT * visibility_loss(prediction, batch).mean()

    def configure_optimizers(self) -> Any:
        """Adam, half a cosine down."""
        optimiser = torch.optim.Adam(self.head.parameters(), lr=self.rate)
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, self.steps)
        return {"optimizer": optimiser, "lr_scheduler": {"scheduler": schedule, "interval": "step"}}
