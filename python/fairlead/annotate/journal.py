# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""labels.jsonl: every action is one line that is on the disk before it is shown; the last word on a frame holds.

Nothing is rewritten while a person works, so a kill at any moment loses at most the line that was being written.
docs/files.md section 17.
"""

import errno
import fcntl
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, cast

from fairlead.annotate.document import Action, LandmarksChange
from fairlead.annotate.labels import Labels, Landmark, Mark, triple
from fairlead.io.documents import describe_os_error
from fairlead.io.errors import InputError

VERSION = 1
MAX_BYTES = 1024 * 1024 * 1024
_SPARE_LINES = 2000
"""Lines beyond one a frame that are kept before the file is written anew when it is opened."""


@dataclass(frozen=True, kw_only=True)
class Header:
    """What the labels belong to."""

    target: str
    mesh: str = ""
    """Name of the file; empty without a mesh."""
    mesh_sha256: str = ""


@dataclass(frozen=True, kw_only=True)
class Written:
    """What a journal held when it was opened."""

    header: Header
    labels: Labels
    torn: bool
    """Whether a last line that was being written when the program was killed has been cut off."""
    lines: int


class Journal:
    """An open labels.jsonl, locked against other processes. Raises InputError where it is no such file, or in use."""

    def __init__(self, path: Path, header: Header) -> None:
        self.path = path
        try:
            self._stream: BinaryIO = path.open("a+b", buffering=0)
        except OSError as error:
            raise InputError(path, f"cannot be written: {describe_os_error(error)}") from error
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._stream.close()
            raise InputError(path, "is being edited by another fairlead annotate: close that one first") from error
        try:
            self.written = self._load(header)
        except BaseException:
            self.close()
            raise

    def _load(self, header: Header) -> Written:
        if self.path.stat().st_size == 0:
            self._append(_header_line(header))
        written = read_journal(self.path)
        if written.torn:
            self._cut_torn_line()
        return written

    def _cut_torn_line(self) -> None:
        data = self.path.read_bytes()
        os.ftruncate(self._stream.fileno(), data.rfind(b"\n") + 1)

    def record(self, action: Action) -> None:
        """Write an action down. Raises OSError; the file is then as before."""
        self._append(b"".join(_line(_change_json(change)) for change in action.changes))

    def start_over(self, header: Header, labels: Labels) -> None:
        """Put a new file with these labels in the place of this one, at once."""
        lines = [_header_line(header), _line(_landmarks_json(labels.landmarks))]
        lines += [_line(_marks_json(frame, marks)) for frame, marks in sorted(labels.frames.items())]
        part = self.path.with_name(f".{self.path.name}.part")
        stream = part.open("a+b", buffering=0)
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.ftruncate(stream.fileno(), 0)
            _write_all(stream, b"".join(lines))
            os.fsync(stream.fileno())
            part.replace(self.path)
        except BaseException:
            stream.close()
            raise
        self._stream.close()
        self._stream = stream

    @property
    def is_long(self) -> bool:
        """Whether most of its lines have been overruled."""
        return self.written.lines > 2 * len(self.written.labels.frames) + _SPARE_LINES

    def _append(self, data: bytes) -> None:
        end = os.fstat(self._stream.fileno()).st_size
        try:
            _write_all(self._stream, data)
            os.fsync(self._stream.fileno())
        except OSError as error:
            os.ftruncate(self._stream.fileno(), end)
            raise OSError(error.errno or errno.EIO, error.strerror, str(self.path)) from error

    def close(self) -> None:
        """Close it and let others have it; safe to call twice."""
        self._stream.close()


def read_journal(path: Path) -> Written:
    """What a labels.jsonl holds. Raises InputError (file, line)."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(path, f"larger than {MAX_BYTES} bytes: no labels")
        data = path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read: {describe_os_error(error)}") from error
    lines = data.split(b"\n")
    torn = lines.pop() != b""
    if not lines:
        raise InputError(path, "expected labels of fairlead annotate, got an unfinished line", line=1)
    header = _header(_parsed(lines[0], path, 1), path)
    landmarks: tuple[Landmark, ...] = ()
    frames: dict[int, Mapping[int, Mark]] = {}
    for number, line in enumerate(lines[1:], 2):
        entry = _parsed(line, path, number)
        try:
            if "landmarks" in entry:
                landmarks = Labels(landmarks=tuple(_landmark(each) for each in entry["landmarks"])).landmarks
            else:
                frames[int(entry["frame"])] = {int(k): _mark(each) for k, each in entry["marks"].items()}
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            what = f"{type(error).__name__}: {error}"
            raise InputError(path, f"expected landmarks, or a frame and its marks, got {what}", line=number) from error
    labels = Labels(landmarks=landmarks, frames={frame: marks for frame, marks in frames.items() if marks})
    return Written(header=header, labels=labels, torn=torn, lines=len(lines))


def _write_all(stream: BinaryIO, data: bytes) -> None:
    while data:
        data = data[stream.write(data) :]


def _parsed(line: bytes, path: Path, number: int) -> dict[str, Any]:
    try:
        entry = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise InputError(path, f"malformed line: {error}", line=number) from error
    if not isinstance(entry, dict):
        raise InputError(path, f"expected an object, got {type(entry).__name__}", line=number)
    return cast(dict[str, Any], entry)


def _header(entry: dict[str, Any], path: Path) -> Header:
    version = entry.get("fairlead_labels")
    if version != VERSION:
        raise InputError(path, f"expected labels of version {VERSION}, got {version!r}", line=1)
    texts = [entry.get(key, "") for key in ("target", "mesh", "mesh_sha256")]
    if not all(isinstance(text, str) for text in texts):
        raise InputError(path, "target, mesh, mesh_sha256: expected texts", line=1)
    return Header(target=texts[0], mesh=texts[1], mesh_sha256=texts[2])


def _line(entry: object) -> bytes:
    return json.dumps(entry, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode() + b"\n"


def _header_line(header: Header) -> bytes:
    return _line({"fairlead_labels": VERSION, **vars(header)})


def _change_json(change: object) -> dict[str, Any]:
    if isinstance(change, LandmarksChange):
        return _landmarks_json(change.after)
    return _marks_json(change.frame, change.after)  # pyright: ignore[reportAttributeAccessIssue]


def _landmarks_json(landmarks: tuple[Landmark, ...]) -> dict[str, Any]:
    rows = [
        {"number": each.number, "name": each.name, "position_m": each.position_m, "sigma_m": each.sigma_m}
        for each in landmarks
    ]
    return {"landmarks": rows}


def _landmark(entry: Mapping[str, Any]) -> Landmark:
    return Landmark(
        number=int(entry["number"]),
        name=str(entry["name"]),
        position_m=triple(entry["position_m"]),
        sigma_m=triple(entry["sigma_m"]),
    )


def _marks_json(frame: int, marks: Mapping[int, Mark]) -> dict[str, Any]:
    return {"frame": frame, "marks": {str(number): _mark_json(mark) for number, mark in marks.items()}}


def _mark_json(mark: Mark) -> object:
    return "hidden" if mark.hidden else [mark.u_px, mark.v_px, mark.sigma_px, mark.origin]


def _mark(entry: Any) -> Mark:
    if entry == "hidden":
        return Mark(hidden=True)
    u_px, v_px, sigma_px, origin = entry
    return Mark(u_px=float(u_px), v_px=float(v_px), sigma_px=float(sigma_px), origin=origin)
