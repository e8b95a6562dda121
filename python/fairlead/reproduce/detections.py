# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Stage 1: what each network finds in each sequence, once; kept by the hash of network and images.

It is `fairlead track` that runs, with the told model of seed 0, so that the box that the network looks into follows the
prediction as it does for a user. docs/reproduce.md section 3.
"""

import hashlib
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fairlead import run
from fairlead.config import TrackConfig
from fairlead.inputs import let_go, open_views, told_correlation
from fairlead.io.errors import InputError
from fairlead.io.observations import read_views
from fairlead.io.run_record import read_run_record
from fairlead.io.target import save_target
from fairlead.io.timing import read_timing
from fairlead.progress import ProgressFactory
from fairlead.reproduce.sequences import Sequence
from fairlead.study.recorded import core_digest
from fairlead.tracker import TrackerOptions
from fairlead.types import View

TABLES = "detections"
"""Folder in a sequence with tables of another detector, `<name>.csv`."""
LABELS = {"heat-t": "heatmap", "rtmpose-t": "RTMPose", "tinypose": "PP-TinyPose"}
"""The networks that come along."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """A detector: an ONNX file, or a table that a sequence brings along."""

    name: str
    path: Path | None

    @property
    def label(self) -> str:
        """In tables and figures."""
        stem = self.name.removesuffix("-early")
        return LABELS.get(stem, stem) + (" (early)" if stem != self.name else "")


@dataclass(frozen=True, kw_only=True, eq=False)
class Detections:
    """All views of a sequence by one network."""

    network: Network
    views: tuple[View, ...]
    detect_ms: np.ndarray
    """Per frame, the first left out; empty for tables."""
    options: TrackerOptions
    """What `track` and `refine` tell the estimator of this detector's errors."""


def networks_of(paths: Iterable[Path], sequences: Iterable[Sequence]) -> list[Network]:
    """The files, and the names of the tables that sequences bring along."""
    networks = {path.stem: Network(name=path.stem, path=path) for path in paths}
    for sequence in sequences:
        for table in sorted((sequence.folder / TABLES).glob("*.csv")):
            networks.setdefault(table.stem, Network(name=table.stem, path=None))
    order = list(LABELS)
    return sorted(networks.values(), key=lambda each: order.index(each.name) if each.name in order else len(order))


def detect(
    sequence: Sequence, network: Network, cache: Path, progress: ProgressFactory, images: Path | None = None
) -> Detections | None:
    """Read the table, or make it; None where there is neither a table nor an image. `images`: instead of its own."""
    images = sequence.images if images is None else images
    table = sequence.folder / TABLES / f"{network.name}.csv"
    if network.path is None or (table.is_file() and images is None):
        return _read(network, table, None, TrackerOptions()) if table.is_file() else None
    if images is None:
        return None
    folder = cache / f"{sequence.name}-{network.name}-{_key(sequence, network.path, images)}"
    told = folder.with_name(f"{folder.name}-told") / "target.toml"
    config = TrackConfig(
        source=images, target=told, camera=sequence.camera_path, output=folder, detector=str(network.path)
    )
    if not _is_done(folder):
        shutil.rmtree(folder, ignore_errors=True)  # half a folder is made anew
        told.parent.mkdir(parents=True, exist_ok=True)
        save_target(told, sequence.told(0))
        run.track(config, progress)
    return _read(network, folder / "observations.csv", folder / "timing.csv", _told(config, sequence))


def _told(config: TrackConfig, sequence: Sequence) -> TrackerOptions:
    """By the same door as a user's run."""
    source = open_views(config, sequence.told(0), sequence.camera)
    try:
        return told_correlation(source, TrackerOptions())
    finally:
        let_go(source)


def _is_done(folder: Path) -> bool:
    try:
        return read_run_record(folder / "run.json").state == "done"
    except InputError:
        return False


def _read(network: Network, table: Path, timing: Path | None, options: TrackerOptions) -> Detections:
    times = [] if timing is None else [each.detect_ms for each in read_timing(timing)][1:]
    return Detections(
        network=network,
        views=tuple(read_views(table)),
        detect_ms=np.array(times, dtype=np.float64),
        options=options,
    )


def _key(sequence: Sequence, network: Path, images: Path) -> str:
    """Hash of everything that the table depends on, the estimator that leads the detector included."""
    digest = hashlib.sha256(core_digest().encode("ascii"))
    files = [images] if images.is_file() else sorted(images.rglob("rgb/*"))
    for path in (network, sequence.camera_path, *files):
        digest.update(path.name.encode("utf-8") + b"\0")
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    digest.update(np.ascontiguousarray(sequence.told(0).positions).tobytes())
    return digest.hexdigest()[:12]
