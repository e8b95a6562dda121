# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The folder that `fairlead simulate` writes: what an estimator is told, and apart from it the truth."""

import dataclasses
import shutil
from dataclasses import dataclass
from pathlib import Path

from fairlead.io.attitudes import write_attitudes
from fairlead.io.camera import save_camera
from fairlead.io.errors import InputError
from fairlead.io.observations import write_views
from fairlead.io.poses import write_truth
from fairlead.io.ranges import write_ranges
from fairlead.io.run_record import InputFile, RunRecord, input_file, write_run_record
from fairlead.io.target import save_target
from fairlead.simulate.flight import simulate
from fairlead.simulate.recorded import Recorded
from fairlead.simulate.scenario_file import ScenarioFile, scenario_document
from fairlead.simulate.truth import Simulation

TOLD = ("target.toml", "target.npz", "camera.yaml", "observations.csv", "range.csv", "attitude.csv")
TRUE = ("truth.csv", "target_true.toml", "target_true.npz", "observations_true.csv")
RECIPE = ("scenario.toml", "scenario_target.toml", "scenario_target.npz", "scenario_recorded.tum", "run.json")


@dataclass(frozen=True, kw_only=True)
class SimulateSummary:
    """What was written."""

    output: Path
    images: int
    observations: int
    ranges: int
    attitudes: int


def write_simulation(source: ScenarioFile, output: Path, *, seed: int | None = None) -> SimulateSummary:
    """Draw the scenario's flight and write it; files of an earlier one are replaced.

    Parameters
    ----------
    seed : instead of the scenario's

    Raises InputError, before anything is written, for a scenario that cannot be flown or would be written over.
    """
    if seed is not None:
        source = dataclasses.replace(source, scenario=dataclasses.replace(source.scenario, seed=seed))
    inputs = _inputs(source)
    for item in inputs:
        if Path(item.path).parent == output.resolve():
            raise InputError(item.path, f"lies in {output}, where the results go; choose another folder")
    try:
        flight = simulate(source.scenario, source.scenario.seed)
    except InputError:
        raise
    except ValueError as error:
        raise InputError(source.path, str(error)) from error
    output.mkdir(parents=True, exist_ok=True)
    for name in (*TOLD, *TRUE, *RECIPE):
        (output / name).unlink(missing_ok=True)
    _write_told(output, flight)
    _write_truth(output, flight)
    _write_recipe(output, source, flight, inputs)
    return SimulateSummary(
        output=output,
        images=len(flight.views),
        observations=sum(len(view.landmarks) for view in flight.views),
        ranges=len(flight.ranges),
        attitudes=len(flight.attitudes),
    )


def _inputs(source: ScenarioFile) -> tuple[InputFile, ...]:
    """Every file that the flight depends on, with its hash."""
    paths = {"scenario": source.path, "target": source.target, "camera": source.camera}
    scenario = source.scenario
    if scenario.occlusion.kind == "mesh" and scenario.target.mesh is not None:
        paths["mesh"] = scenario.target.mesh
    if isinstance(scenario.trajectory, Recorded):
        paths["recorded"] = scenario.trajectory.file
    return tuple(input_file(role, path) for role, path in paths.items())


def _write_told(output: Path, flight: Simulation) -> None:
    save_target(output / "target.toml", flight.target_told)
    save_camera(output / "camera.yaml", flight.camera)
    write_views(output / "observations.csv", flight.views)
    if flight.ranges:
        write_ranges(output / "range.csv", flight.ranges)
    if flight.attitudes:
        write_attitudes(output / "attitude.csv", flight.attitudes)


def _write_truth(output: Path, flight: Simulation) -> None:
    write_truth(output / "truth.csv", flight.truth)
    save_target(output / "target_true.toml", flight.target_true)
    write_views(output / "observations_true.csv", flight.views_true)


def _write_recipe(output: Path, source: ScenarioFile, flight: Simulation, inputs: tuple[InputFile, ...]) -> None:
    """scenario.toml as resolved, with copies of what it names, so that it gives the same flight again; run.json."""
    scenario = source.scenario
    target = source.shipped_target
    if target is None:
        target = "scenario_target.toml"
        given = scenario.target
        if scenario.occlusion.kind == "mesh" and given.mesh is not None:
            mesh = output / f"scenario_mesh{given.mesh.suffix}"
            shutil.copyfile(given.mesh, mesh)
            given = dataclasses.replace(given, mesh=mesh)
        save_target(output / target, given)
    recorded = None
    if isinstance(scenario.trajectory, Recorded):
        recorded = "scenario_recorded.tum"
        shutil.copyfile(scenario.trajectory.file, output / recorded)
    document = scenario_document(scenario, target=target, camera="camera.yaml", recorded=recorded)
    (output / "scenario.toml").write_text(document, encoding="utf-8", newline="\n")
    count = len(flight.views)
    options = {"scenario": scenario.name, "output": str(output)}
    record = RunRecord(
        command="simulate", state="done", options=options, inputs=inputs, seed=scenario.seed,
        frames=count, frames_with_pose=count,
    )  # fmt: skip
    write_run_record(output / "run.json", record)
