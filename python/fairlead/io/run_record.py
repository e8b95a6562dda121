# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""run.json: what a run was told, with what it ran and on what input."""

import dataclasses
import hashlib
import importlib.metadata
import json
import platform
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields

VERSION = 1
RunState = Literal["running", "done", "interrupted", "failed"]

_PACKAGES = ("fairlead", "numpy", "opencv-python-headless", "pyarrow", "PyYAML", "scipy")
_KEYS = (
    *("version", "command", "state", "options", "estimator", "seed", "inputs"),
    *("versions", "git", "frames", "frames_with_pose", "frames_dropped"),
)


@dataclass(frozen=True, kw_only=True)
class InputFile:
    """A file (or folder) that a run read."""

    role: str
    """source, target, camera, ..."""
    path: str
    sha256: str
    """Of the bytes; of a folder: of the names and sizes of its files."""


@dataclass(frozen=True, kw_only=True)
class RunRecord:
    """The content of run.json."""

    command: str
    state: RunState
    options: object
    """The resolved options: a frozen dataclass when written, plain JSON values when read back."""
    inputs: tuple[InputFile, ...]
    estimator: object = None
    """The resolved options of the estimator, alike; None where it has none."""
    seed: int | None = None
    frames: int = 0
    frames_with_pose: int = 0
    frames_dropped: int = 0
    """Of a live source: images that nobody had time for."""

    def input_path(self, role: str) -> Path | None:
        """Where the input of this role was; None if there was none."""
        return next((Path(item.path) for item in self.inputs if item.role == role), None)


def input_file(role: str, path: Path | str) -> InputFile:
    """Hash a file or the listing of a folder."""
    path = Path(path).resolve()
    digest = hashlib.sha256()
    if path.is_dir():
        for item in sorted(item for item in path.rglob("*") if item.is_file()):
            digest.update(f"{item.relative_to(path).as_posix()}\0{item.stat().st_size}\n".encode(errors="replace"))
    else:
        with path.open("rb") as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
    return InputFile(role=role, path=str(path), sha256=digest.hexdigest())


def write_run_record(path: Path, record: RunRecord) -> None:
    """Write run.json; it replaces the old one at once."""
    document = {
        "version": VERSION,
        "command": record.command,
        "state": record.state,
        "options": _plain(record.options),
        "estimator": _plain(record.estimator),
        "seed": record.seed,
        "inputs": [dataclasses.asdict(item) for item in record.inputs],
        "versions": {"python": platform.python_version(), **_versions()},
        "git": git_commit(),
        "frames": record.frames,
        "frames_with_pose": record.frames_with_pose,
        "frames_dropped": record.frames_dropped,
    }
    write_json(path, document)


def write_json(path: Path, document: object) -> None:
    """Write a JSON document that replaces the old one at once. Raises ValueError for NaN and infinity."""
    temporary = path.with_name(f".{path.name}.part")
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    temporary.write_text(text + "\n", encoding="utf-8", newline="\n")
    temporary.replace(path)


def read_run_record(path: Path | str) -> RunRecord:
    """Read run.json. Raises InputError."""
    path = Path(path)
    try:
        document = cast(object, json.loads(read_text(path)))
    except (json.JSONDecodeError, RecursionError) as error:
        raise InputError(path, f"malformed JSON: {error}") from error
    fields = Fields(document, _KEYS, path)
    if fields.integer("version") != VERSION:
        raise fields.error("version", f"expected {VERSION}, got {fields.integer('version')}")
    items = [
        Fields(item, ("role", "path", "sha256"), path, f"inputs[{index}]")
        for index, item in enumerate(fields.items("inputs"))
    ]
    inputs = [InputFile(role=item.text("role"), path=item.text("path"), sha256=item.text("sha256")) for item in items]
    return RunRecord(
        command=fields.text("command"),
        state=cast(RunState, fields.text("state")),
        options=fields.get("options"),
        estimator=fields.get("estimator"),
        seed=None if fields.get("seed") is None else fields.integer("seed"),
        inputs=tuple(inputs),
        frames=fields.integer("frames"),
        frames_with_pose=fields.integer("frames_with_pose"),
        frames_dropped=fields.integer("frames_dropped") if "frames_dropped" in fields else 0,
    )


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, tuple | list):
        return [_plain(item) for item in cast(list[Any], value)]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return str(value)
    return value


def _versions() -> dict[str, str]:
    versions: dict[str, str] = {}
    for package in _PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return versions


def git_commit() -> str | None:
    """Commit of the source tree that this package is imported from; None where there is none."""
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        return None
    try:
        command = ["git", "-C", str(root), "rev-parse", "HEAD"]
        answer = subprocess.run(command, capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip() or None
