# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""target.toml <-> Target, docs/files.md."""

import json
import zipfile
import zlib
from pathlib import Path
from typing import cast, get_args

import numpy as np

from fairlead.io.documents import read_toml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields
from fairlead.io.paths import resolve_inside
from fairlead.types import KnownDistance, ModelCovariance, MotionKind, MotionPrior, Points3, Target

MAX_LANDMARKS = 2048
"""Landmarks of one target; their joint covariance then takes 300 MB."""

_TOP = ("name", "mesh", "prior", "landmark", "motion", "touchdown", "distance")


def load_target(path: Path | str) -> Target:
    """Read target.toml, and the covariance beside it where `[prior] covariance` names one.

    Raises InputError: file, key, what came, what was expected.
    """
    path = Path(path)
    top = Fields(read_toml(path), _TOP, path)
    landmarks = [
        Fields(item, ("name", "position_m", "sigma_m"), path, f"landmark[{index}]")
        for index, item in enumerate(top.items("landmark"))
    ]
    if not 0 < len(landmarks) <= MAX_LANDMARKS:
        raise InputError(path, f"landmark: expected 1 to {MAX_LANDMARKS} landmarks, got {len(landmarks)}")
    names = tuple(landmark.text("name") for landmark in landmarks)
    positions = np.array([landmark.numbers("position_m", 3) for landmark in landmarks], dtype=np.float64)
    try:
        return Target(
            name=top.text("name"),
            landmarks=names,
            positions=positions,
            covariance=_covariance(top, landmarks, names, positions, path),
            mesh=resolve_inside(path.parent, top.text("mesh"), path) if "mesh" in top else None,
            touchdown=_touchdown(top, path),
            distances=_distances(top, path),
            motion=_motion(top, path),
        )
    except InputError:
        raise
    except ValueError as error:
        raise InputError(path, str(error)) from error


def prior_covariance(positions: Points3, sigmas_m: Points3, scale_sigma: float) -> ModelCovariance:
    """P0 = diag(sigma^2) + scale_sigma^2 x0 x0^T, x0 about the centroid, docs/files.md eq. (1).

    Parameters
    ----------
    positions, sigmas_m
        (n, 3) [m]: X0 and the standard deviation of each coordinate.
    scale_sigma
        Standard deviation of the common scale error [-].
    """
    about_centroid = (positions - positions.mean(axis=0)).ravel()
    return np.diag(sigmas_m.ravel() ** 2) + scale_sigma**2 * np.outer(about_centroid, about_centroid)


def _covariance(
    top: Fields, landmarks: list[Fields], names: tuple[str, ...], positions: Points3, path: Path
) -> ModelCovariance:
    prior = Fields(top.get("prior") if "prior" in top else {}, ("sigma_m", "scale_sigma", "covariance"), path, "prior")
    common = prior.number("sigma_m", minimum=0.0) if "sigma_m" in prior else None
    scale_sigma = prior.number("scale_sigma", minimum=0.0) if "scale_sigma" in prior else 0.0
    if "covariance" in prior:
        return _read_covariance(resolve_inside(path.parent, prior.text("covariance"), path), names)
    sigmas = np.array([_sigma(landmark, common) for landmark in landmarks], dtype=np.float64)
    return prior_covariance(positions, sigmas, scale_sigma)


def _sigma(landmark: Fields, common: float | None) -> list[float]:
    if "sigma_m" not in landmark:
        if common is None:
            raise landmark.error("sigma_m", "missing, and [prior] has no sigma_m")
        return [common] * 3
    if not isinstance(landmark.get("sigma_m"), list):
        return [landmark.number("sigma_m", minimum=0.0)] * 3
    sigmas = landmark.numbers("sigma_m", 3)
    if min(sigmas) < 0.0:
        raise landmark.error("sigma_m", f"expected numbers >= 0, got {sigmas}")
    return sigmas


def _touchdown(top: Fields, path: Path) -> np.ndarray | None:
    if "touchdown" not in top:
        return None
    return np.array(Fields(top.get("touchdown"), ("position_m",), path, "touchdown").numbers("position_m", 3))


def _motion(top: Fields, path: Path) -> MotionPrior | None:
    if "motion" not in top:
        return None
    fields = Fields(top.get("motion"), ("kind", "jerk_density_m_s25"), path, "motion")
    kind = cast(MotionKind, fields.choice("kind", get_args(MotionKind)))
    density = 0.0 if kind == "none" and "jerk_density_m_s25" not in fields else fields.number("jerk_density_m_s25")
    return MotionPrior(kind=kind, jerk_density_m_s25=density)


def _distances(top: Fields, path: Path) -> tuple[KnownDistance, ...]:
    distances: list[KnownDistance] = []
    for index, item in enumerate(top.items("distance")):
        fields = Fields(item, ("between", "length_m", "sigma_m"), path, f"distance[{index}]")
        between = fields.items("between")
        if len(between) != 2 or not all(isinstance(name, str) for name in between):
            raise fields.error("between", "expected two landmark names")
        pair = cast(tuple[str, str], tuple(between))
        distance = KnownDistance(between=pair, length_m=fields.number("length_m"), sigma_m=fields.number("sigma_m"))
        distances.append(distance)
    return tuple(distances)


def _read_covariance(path: Path, names: tuple[str, ...]) -> ModelCovariance:
    """Covariance of the named landmarks from an npz with `landmarks` (n,) and `covariance` (3n, 3n) [m^2]."""
    limit = 8 * (3 * len(names)) ** 2 + 4096
    try:
        with zipfile.ZipFile(path) as archive:
            stored = {info.filename: info.file_size for info in archive.infolist()}
        for member in ("landmarks.npy", "covariance.npy"):
            if member not in stored:
                raise InputError(path, f"expected arrays landmarks and covariance, got {', '.join(stored) or 'none'}")
        if stored["covariance.npy"] > limit or stored["landmarks.npy"] > 2**26:
            raise InputError(path, f"covariance: larger than {len(names)} landmarks need")
        with np.load(path, allow_pickle=False) as arrays:
            order = [str(name) for name in arrays["landmarks"].tolist()]
            covariance = np.asarray(arrays["covariance"], dtype=np.float64)
    except InputError:
        raise
    except (
        *(OSError, EOFError, ValueError, TypeError, KeyError, MemoryError, OverflowError),
        *(zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, AttributeError),
    ) as error:
        raise InputError(path, f"no usable npz: {error}") from error
    size = 3 * len(names)
    if covariance.shape != (size, size):
        raise InputError(path, f"covariance: expected shape {(size, size)}, got {covariance.shape}")
    if sorted(order) != sorted(names):
        raise InputError(path, "landmarks: expected the landmarks of the target, got others")
    rows = (3 * np.array([order.index(name) for name in names])[:, None] + np.arange(3)).ravel()
    return covariance[np.ix_(rows, rows)]


def check_target_name(path: Path | str) -> Path:
    """The path, if a target can be written there. Raises InputError unless it ends in .toml and no folder is there."""
    path = Path(path)
    for place in (path, path.with_suffix(".npz")):
        if place.is_dir():
            raise InputError(place, "is a folder; expected the name of a target file that ends in .toml")
    if path.suffix.lower() != ".toml":
        raise InputError(path, "is no name of a target; expected one that ends in .toml")
    return path


def save_target(path: Path | str, target: Target) -> None:
    """Write target.toml, and beside it `<stem>.npz` with the full covariance; each replaces the old file at once.

    The sigmas in the text are the roots of the diagonal, for people; read back, the npz replaces them.
    A mesh that does not lie under the new file's folder is named in a comment only.
    Raises InputError for a name that `check_target_name` refuses, before anything is written.
    """
    path = check_target_name(path)
    side = path.with_suffix(".npz")
    sigmas = np.sqrt(np.clip(np.diag(target.covariance), 0.0, None)).reshape(-1, 3)
    temporary = side.with_name(f".{side.stem}.part.npz")
    np.savez(temporary, landmarks=np.array(target.landmarks, dtype=np.str_), covariance=target.covariance)
    temporary.replace(side)
    _write_text(path, _document(target, path.parent, f"covariance = {_quoted(side.name)}", sigmas))


def save_prior(path: Path | str, target: Target, sigmas_m: Points3, scale_sigma: float = 0.0) -> None:
    """Write target.toml for a person to edit: P0 as sigmas (n, 3) [m] and a scale, `prior_covariance`, no npz."""
    path = Path(path)
    _write_text(path, _document(target, path.parent, f"scale_sigma = {float(scale_sigma)!r}", sigmas_m))


def _write_text(path: Path, text: str) -> None:
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    temporary.replace(path)


def _document(target: Target, folder: Path, prior: str, sigmas: Points3) -> str:
    lines = [f"name = {_quoted(target.name)}"]
    if target.mesh is not None:
        lines.append(_mesh_line(target.mesh, folder))
    lines += ["", "[prior]", prior]
    if target.motion is not None:
        lines += ["", "[motion]", f"kind = {_quoted(target.motion.kind)}"]
        lines.append(f"jerk_density_m_s25 = {float(target.motion.jerk_density_m_s25)!r}")
    if target.touchdown is not None:
        lines += ["", "[touchdown]", f"position_m = {target.touchdown.tolist()}"]
    for name, position, sigma in zip(target.landmarks, target.positions.tolist(), sigmas.tolist(), strict=True):
        lines += ["", "[[landmark]]", f"name = {_quoted(name)}", f"position_m = {position}", f"sigma_m = {sigma}"]
    for distance in target.distances:
        between = ", ".join(_quoted(name) for name in distance.between)
        lines += ["", "[[distance]]", f"between = [{between}]"]
        lines += [f"length_m = {float(distance.length_m)!r}", f"sigma_m = {float(distance.sigma_m)!r}"]
    return "\n".join(lines) + "\n"


def _mesh_line(mesh: Path, folder: Path) -> str:
    resolved = mesh.resolve()
    if resolved.is_relative_to(folder.resolve()):
        return f"mesh = {_quoted(resolved.relative_to(folder.resolve()).as_posix())}"
    return f"# mesh {_quoted(str(resolved))} lies outside this folder"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
