# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""scenario.toml <-> Scenario, docs/simulate.md section 1."""

import dataclasses
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from fairlead.io.camera import load_camera
from fairlead.io.documents import read_toml
from fairlead.io.errors import InputError
from fairlead.io.fields import Fields, nearest
from fairlead.io.paths import resolve_inside
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.simulate.legs import Legs
from fairlead.simulate.paths import Approach, Arc, Helix, Orbit, Rendezvous
from fairlead.simulate.paths import Path as FlightPath
from fairlead.simulate.recorded import Recorded
from fairlead.simulate.scenario import Scenario
from fairlead.simulate.tables import read_record, toml_lines, toml_value

TRAJECTORIES: dict[str, type[FlightPath]] = {
    "arc": Arc,
    "orbit": Orbit,
    "rendezvous": Rendezvous,
    "approach": Approach,
    "helix": Helix,
    "legs": Legs,
    "recorded": Recorded,
}
_NAME = re.compile(r"[A-Za-z0-9_-]+(?:\.\d+)?")


@dataclass(frozen=True, kw_only=True, eq=False)
class ScenarioFile:
    """A scenario and the files that it came from."""

    scenario: Scenario
    path: Path
    target: Path
    camera: Path
    shipped_target: str | None
    """Name of the target where it came along with the program."""


def shipped_scenarios() -> list[str]:
    """Names of the scenarios that come along."""
    return sorted(path.stem for path in shipped_data("scenarios").glob("*.toml"))


def find_scenario(name: str) -> Path:
    """A file, or the scenario of this name that comes along. Raises InputError that names the nearest."""
    path = Path(name)
    if path.suffix == ".toml" or path.is_file():
        return path
    known = shipped_scenarios()
    if name not in known:
        raise InputError(path, f"neither a file nor a scenario that comes along; {nearest(name, known)}")
    return shipped_data("scenarios") / f"{name}.toml"


def load_scenario(name: Path | str, *, target: Path | None = None, camera: Path | None = None) -> ScenarioFile:
    """Read a scenario by file or by name; `target` and `camera` replace those that it names.

    Raises InputError: file, key, what came, what was expected.
    """
    path = find_scenario(str(name))
    table = read_toml(path)
    top = Fields(table, [field.name for field in dataclasses.fields(Scenario)], path)
    target_path = target or _named_file(top, "target", "target.toml", path)
    camera_path = camera or _named_file(top, "camera", "camera.yaml", path)
    given: dict[str, object] = {"target": load_target(target_path), "camera": load_camera(camera_path)}
    given["name"] = top.text("name") if "name" in top else path.stem
    if "trajectory" in top:
        given["trajectory"] = _trajectory(top.get("trajectory"), path)
    scenario = read_record(Scenario, table, path, "", given)
    named = top.text("target") if target is None else ""
    shipped = named if _NAME.fullmatch(named) else None
    return ScenarioFile(scenario=scenario, path=path, target=target_path, camera=camera_path, shipped_target=shipped)


def _named_file(top: Fields, key: str, file: str, path: Path) -> Path:
    """What comes along under a bare name; else a file in the folder of the scenario."""
    name = top.text(key)
    if not _NAME.fullmatch(name):
        return resolve_inside(path.parent, name, path)
    known = {each.parent.name: each for each in shipped_data("scenarios").parent.glob(f"*/{file}")}
    if name not in known:
        raise top.error(
            key, f"expected a file or the name of data that come along, got {name!r}; {nearest(name, known)}"
        )
    return known[name]


def _trajectory(table: object, path: Path) -> FlightPath:
    """The path of `kind`, with its own keys."""
    kinds = {"kind": ""} | (dict(cast(Mapping[str, Any], table)) if isinstance(table, Mapping) else {})
    fields = Fields(table, kinds, path, "trajectory")
    kind = TRAJECTORIES[fields.choice("kind", TRAJECTORIES)]
    del kinds["kind"]
    return read_record(kind, kinds, path, "trajectory")


def scenario_document(scenario: Scenario, *, target: str, camera: str, recorded: str | None = None) -> str:
    """scenario.toml with every key that has a value; the names are those of the files beside it."""
    lines = [
        f"name = {toml_value(scenario.name)}",
        f"seed = {scenario.seed}",
        f"target = {toml_value(target)}",
        f"camera = {toml_value(camera)}",
        f"target_is = {toml_value(scenario.target_is)}",
    ]
    path = scenario.trajectory
    if recorded is not None:
        path = dataclasses.replace(cast(Recorded, path), file=Path(recorded))
    kind = next(name for name, kind in TRAJECTORIES.items() if isinstance(path, kind))
    lines += ["", "[trajectory]", f"kind = {toml_value(kind)}", *toml_lines(path, "trajectory")]
    written = ("name", "seed", "target", "camera", "target_is", "trajectory")
    for field in dataclasses.fields(scenario):
        value: object = getattr(scenario, field.name)
        if field.name in written or value is None:
            continue
        lines += _table(field.name, value)
    return "\n".join(lines) + "\n"


def _table(name: str, value: object) -> list[str]:
    if isinstance(value, Mapping):
        normals = cast(Mapping[str, object], value)
        rows = [f"{toml_value(key)} = {toml_value(each)}" for key, each in normals.items()]
        return ["", f"[{name}]", *rows] if rows else []
    if isinstance(value, tuple):
        records = cast(tuple[object, ...], value)
        return [line for each in records for line in ("", f"[[{name}]]", *toml_lines(each, name))]
    return ["", f"[{name}]", *toml_lines(value, name)]
