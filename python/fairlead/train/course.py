# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""From labelled crops to a trained network: small crops first, then whole ones. docs/networks.md section 4."""

import logging
import warnings
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import lightning
import torch
from lightning.pytorch.callbacks import Callback, EMAWeightAveraging, ModelCheckpoint
from lightning.pytorch.loggers import CSVLogger
from torch.utils.data import DataLoader, Sampler

from fairlead.progress import Progress, ProgressFactory, silent
from fairlead.train.checkpoint import load_lesson
from fairlead.train.crops import Crops, collate
from fairlead.train.curves import draw_curves
from fairlead.train.lesson import Lesson, Settling
from fairlead.train.start import warm_start

EPOCH = 4096
"""Crops between two checkpoints, drawn anew from all that there are."""
VALIDATED = 256
"""Held-out crops that are looked at after an epoch; all of them by `fairlead calibrate`."""
MEASURED = 64
"""Crops that the batch norms of an exported network are measured on."""
STAGES = ((0.45, 2), (0.7, 3))
"""Until which share of the course crops are shown at so many quarters of their side: cheaper by the square."""
AVERAGED = 0.05
"""Share of the course's steps that the average of the weights reaches back, which is what is validated and kept."""
LAST, SETTLED = "last.ckpt", "settled.ckpt"
PRECISIONS: dict[str, Any] = {"auto": None, "32": "32-true", "bf16": "bf16-mixed", "16": "16-mixed"}


@dataclass(frozen=True, kw_only=True)
class Course:
    """How long and how; `fairlead train --help` says what each is."""

    network: str
    output: Path
    crops: int
    batch: int = 32
    rate: float = 1e-3
    size: int = 256
    threads: int | None = None
    workers: int = 1
    seed: int = 0
    start: Path | None = None
    precision: str = "auto"
    settle: int = 8192

    @property
    def epoch(self) -> int:
        """Crops of an epoch; whole batches."""
        return max(1, min(EPOCH, self.crops) // self.batch) * self.batch

    @property
    def epochs(self) -> int:
        """How many."""
        return max(1, round(self.crops / self.epoch))

    @property
    def steps(self) -> int:
        """Of the optimiser."""
        return self.epochs * self.epoch // self.batch

    def size_at(self, epoch: int) -> int:
        """Side of the crops [px]. RTMPose takes one size; who starts from a trained network sees whole crops alone."""
        if self.network.startswith("rtmpose") or self.start is not None:
            return self.size
        quarters = (quarters for share, quarters in STAGES if epoch < share * self.epochs)
        return self.size // 4 * next(quarters, 4)


class Draw(Sampler[int]):
    """So many crops at random, others in each epoch, the same when resumed."""

    def __init__(self, crops: Crops, count: int) -> None:
        self._crops, self._count = crops, count

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[int]:
        generator = torch.Generator().manual_seed(self._crops.seed + 7919 * self._crops.epoch)
        return iter(torch.randint(len(self._crops), (self._count,), generator=generator).tolist())


class Data(lightning.LightningDataModule):
    """Crops to train with and held-out ones; the side grows with the epochs."""

    def __init__(self, course: Course, learned: Crops, held_out: Crops) -> None:
        super().__init__()
        self._course, self._learned, self._held_out = course, learned, held_out

    def train_dataloader(self) -> Any:
        """Of the current epoch."""
        crops, course = self._learned, self._course
        crops.epoch = self.trainer.current_epoch if self.trainer is not None else 0
        crops.size = course.size_at(crops.epoch)
        return DataLoader(
            crops, course.batch, sampler=Draw(crops, course.epoch), collate_fn=collate, num_workers=course.workers
        )

    def val_dataloader(self) -> Any:
        """Held-out crops, whole and untouched."""
        return DataLoader(self._held_out, self._course.batch, collate_fn=collate, num_workers=self._course.workers)


class Told(Callback):
    """Tells a progress bar, and draws the curves after each epoch."""

    def __init__(self, course: Course, advance: Progress) -> None:
        self._course, self._advance = course, advance

    def on_train_start(self, trainer: Any, pl_module: Any) -> None:
        """What an earlier call did counts."""
        del pl_module
        self._advance(trainer.current_epoch * self._course.epoch)

    def on_train_batch_end(self, *_: Any, **__: Any) -> None:
        """One batch more."""
        self._advance(self._course.batch)

    def on_train_epoch_end(self, trainer: Any, pl_module: Any) -> None:
        """The logger has written the epoch before."""
        del pl_module
        if trainer.is_global_zero:
            draw_curves(self._course.output)


def follow(course: Course, learned: Crops, held_out: Crops, *, progress: ProgressFactory = silent) -> list[str]:
    """Train; goes on where an earlier call in the same folder stopped. Returns lines for people. Raises InputError."""
    if course.threads is not None:
        torch.set_num_threads(course.threads)
    course.output.mkdir(parents=True, exist_ok=True)
    last = course.output / LAST
    torch.manual_seed(course.seed)  # of the weights that the lesson begins with
    lesson = Lesson(course.network, learned.landmarks, course.steps, rate=course.rate, size=course.size)
    lines: list[str] = []
    if course.start is not None and not last.exists():
        first = collate([learned[k % len(learned)] for k in range(MEASURED)])
        taken, of = warm_start(lesson, course.start, first.images)
        lines.append(f"{course.start}: {taken} of {of} arrays taken over")
    with progress("crops", lambda: course.epochs * course.epoch) as advance, _quiet(course.seed):
        trainer = _trainer(course, Told(course, advance), len(held_out))
        try:
            trainer.fit(
                lesson, datamodule=Data(course, learned, held_out), ckpt_path=last if last.exists() else None,
                weights_only=True,
            )  # fmt: skip
        except SystemExit as end:  # the trainer's answer to Ctrl-C, after it has put things away
            raise (end.__context__ or KeyboardInterrupt()) from None
    settled = settle(course, learned, progress=progress) if course.settle else last
    curves = draw_curves(course.output)
    found = {name: float(value) for name, value in trainer.callback_metrics.items() if name.startswith("valid/")}
    lines += [f"{name[6:]}: {value:.3f}" for name, value in sorted(found.items())]
    return [*lines, str(settled), *([] if curves is None else [str(curves)])]


def settle(course: Course, learned: Crops, *, progress: ProgressFactory = silent) -> Path:
    """Covariance and visibility learned on, on whole crops, with everything else held; writes settled.ckpt."""
    path, last = course.output / SETTLED, course.output / LAST
    if path.exists() and path.stat().st_mtime >= last.stat().st_mtime:
        return path
    steps = max(1, course.settle // course.batch)
    settling = Settling(load_lesson(last), steps)
    learned.epoch, learned.size = course.epochs, course.size
    draw = Draw(learned, steps * course.batch)
    loader = DataLoader(learned, course.batch, sampler=draw, collate_fn=collate, num_workers=course.workers)
    with progress("covariances", lambda: len(draw)) as advance, _quiet(course.seed):
        trainer = lightning.Trainer(
            max_epochs=1, gradient_clip_val=1.0, callbacks=[Told(course, advance)], logger=False,
            enable_checkpointing=False, enable_model_summary=False, enable_progress_bar=False,
        )  # fmt: skip
        try:
            trainer.fit(settling, loader)
        except SystemExit as end:
            raise (end.__context__ or KeyboardInterrupt()) from None
    part = path.with_name(f".{path.name}.part")
    parts = {"state_dict": settling.lesson.state_dict(), "hyper_parameters": dict(settling.lesson.hparams)}
    torch.save(parts, part)
    part.replace(path)
    return path


def _trainer(course: Course, told: Told, held_out: int) -> lightning.Trainer:
    part = len(list(course.output.glob("curves_*")))  # each part of a course that was stopped has curves of its own
    return lightning.Trainer(
        max_epochs=course.epochs,
        reload_dataloaders_every_n_epochs=1,
        precision=PRECISIONS[course.precision] or ("16-mixed" if torch.cuda.is_available() else "32-true"),
        gradient_clip_val=5.0,
        callbacks=[
            EMAWeightAveraging(decay=1.0 - 1.0 / (AVERAGED * course.steps + 10.0), update_starting_at_step=0),
            ModelCheckpoint(course.output, filename="best", monitor="valid/median_px", enable_version_counter=False),
            ModelCheckpoint(course.output, filename=LAST.removesuffix(".ckpt"), enable_version_counter=False),
            told,
        ],
        logger=CSVLogger(course.output, name="", version=f"curves_{part}"),
        log_every_n_steps=course.epoch // course.batch,
        enable_model_summary=False,
        enable_progress_bar=False,
        num_sanity_val_steps=0,
        limit_val_batches=-(-min(VALIDATED, held_out) // course.batch),
    )


@contextmanager
def _quiet(seed: int) -> Generator[None]:
    """The trainer greets, advises and warns; a library prints nothing."""
    names = ("lightning.pytorch", "lightning.fabric")
    levels = [logging.getLogger(name).level for name in names]
    try:
        for name in names:
            logging.getLogger(name).setLevel(logging.ERROR)
        lightning.seed_everything(seed, verbose=False)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for name, level in zip(names, levels, strict=True):
            logging.getLogger(name).setLevel(level)
