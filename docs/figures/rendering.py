# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The contact sheets of docs/rendering.md: python docs/figures/rendering.py [crops] [weather] [sequences].

Needs fairlead[render]; the last two also Blender (Python 3.11), half an hour on two cores.
"""

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fairlead.io.camera import load_camera
from fairlead.io.coco import read_coco
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.opencv import read_image
from fairlead.opencv.filters import resized, write_image
from fairlead.render.command import render
from fairlead.render.flights import FRIGATE_M, fly
from fairlead.render.job import Job, Setting
from fairlead.render.sequence import render_sequence
from fairlead.render.weather import KINDS, Weather

HERE = Path(__file__).parent
GREEN, RED = (60, 220, 60), (60, 60, 240)


def sheet(tiles: Sequence[np.ndarray], columns: int, name: str, quality: int = 85) -> None:
    """Tiles of one size, row by row."""
    rows = [np.hstack(tiles[k : k + columns]) for k in range(0, len(tiles), columns)]
    write_image(HERE / name, np.ascontiguousarray(np.vstack(rows)), quality=quality)


def small(image: np.ndarray, size: int) -> np.ndarray:
    """A square picture at another size."""
    return np.clip(np.round(resized(image.astype(np.float32), size, size)), 0, 255).astype(np.uint8)


def crops(name: str, *, surroundings: str, count: int, columns: int) -> None:
    """Crops with their labels: green visible, red hidden."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        # Every 40th, so that many skies and seas are shown.
        render(
            "crops",
            out,
            target=shipped_data(name) / "target.toml",
            surroundings=surroundings,
            count=40 * count,
            size=160,
        )  # type: ignore[arg-type]
        _, labels = read_coco(out / "annotations.json")
        tiles = []
        for label in labels[::40]:
            tile = read_image(out / label.file_name).copy()
            for (u, v), visibility in zip(np.round(label.pixels).astype(int), label.visibility, strict=True):
                if visibility > 0:
                    tile[max(v - 1, 0) : v + 2, max(u - 1, 0) : u + 2] = GREEN if visibility == 2 else RED
            tiles.append(tile)
    sheet(tiles, columns, f"crops_{name}.jpg")


def frames(flight: str, shares: Sequence[float], folder: Path, name: str = "frigate") -> Job:
    """A job of some frames of a flight at full quality."""
    data = shipped_data(name)
    target = load_target(data / "target.toml")
    size = float(np.linalg.norm(np.ptp(target.positions, axis=0)))
    at_sea = name == "frigate"
    placed = fly(flight, target, stride=5, scale=1.0 if at_sea else size / FRIGATE_M)
    chosen = tuple(placed[int(share * (len(placed) - 1))] for share in shares)
    return Job(
        target=target,
        camera=load_camera(data / "camera.yaml"),
        placed=chosen,
        folder=folder,
        samples=16,
        setting=Setting(surroundings="sea" if at_sea else "space"),
    )


def pictures(job: Job) -> list[np.ndarray]:
    """Rendered and read back."""
    render_sequence(job)
    return [read_image(job.folder / "rgb" / f"{placed.frame:06d}.png") for placed in job.placed]


def sequences() -> None:
    """First, middle and last frame of each flight, and of one of the satellite."""
    tiles: list[np.ndarray] = []
    with tempfile.TemporaryDirectory() as folder:
        for flight in ("orbit-2.0", "rendezvous-10", "rendezvous-20", "rendezvous-30", "landing"):
            tiles += pictures(frames(flight, (0.0, 0.5, 1.0), Path(folder) / flight))
        tiles += pictures(frames("rendezvous-20", (0.0, 0.5, 1.0), Path(folder) / "satellite", "satellite"))
    sheet([small(tile, 320) for tile in tiles], 3, "sequences.jpg", quality=80)


def weather() -> None:
    """One frame in every weather at strength 0.6, from one linear render."""
    with tempfile.TemporaryDirectory() as folder:
        clear = frames("landing", (0.6,), Path(folder) / "clear")
        tiles = pictures(clear)
        for kind in KINDS:
            other = replace(
                clear, folder=Path(folder) / kind, reuse=clear.folder, weather=Weather(kind=kind, strength=0.6)
            )
            tiles += pictures(other)
    tiles = [tile[150:918, 128:896] for tile in tiles]
    sheet([small(tile, 300) for tile in tiles], 4, "weather.jpg", quality=80)


if __name__ == "__main__":
    wanted = sys.argv[1:] or ["crops", "weather", "sequences"]
    if "crops" in wanted:
        crops("frigate", surroundings="sea", count=40, columns=8)
        crops("satellite", surroundings="space", count=16, columns=8)
    if "weather" in wanted:
        weather()
    if "sequences" in wanted:
        sequences()
