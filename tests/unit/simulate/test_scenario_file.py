# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""scenario.toml: every key of a record, one clear line for what is wrong, and what is written reads back the same."""

import dataclasses
import re
from pathlib import Path

import pytest

from fairlead.io.errors import InputError
from fairlead.simulate import Legs, Scenario, load_scenario, shipped_scenarios
from fairlead.simulate.scenario_file import TRAJECTORIES, scenario_document
from fairlead.simulate.tables import toml_value

HEAD = 'target = "frigate"\ncamera = "frigate"\n'


def load(folder: Path, text: str) -> Scenario:
    path = folder / "s.toml"
    path.write_text(HEAD + text)
    return load_scenario(path).scenario


def values(scenario: Scenario) -> dict[str, object]:
    """All but what is loaded from other files."""
    names = [field.name for field in dataclasses.fields(scenario) if field.name not in ("target", "camera")]
    return {name: getattr(scenario, name) for name in names}


@pytest.mark.parametrize("name", shipped_scenarios())
def test_what_is_written_reads_back_the_same(name, tmp_path):
    source = load_scenario(name)
    text = scenario_document(source.scenario, target="frigate", camera="frigate")
    (tmp_path / "again.toml").write_text(text)
    again = load_scenario(tmp_path / "again.toml")
    assert values(again.scenario) == values(source.scenario)
    assert scenario_document(again.scenario, target="frigate", camera="frigate") == text


def test_names_of_what_comes_along():
    expected = {"arc", "flight-30s", "rolling-ship-3", "rolling-ship-5", "turn-3g", "stop", "landing", "orbit-2.0"}
    expected |= {"rendezvous-10", "rendezvous-20", "rendezvous-30", "rough", "correlated-noise", "range-finder"}
    assert expected == set(shipped_scenarios())
    for name in shipped_scenarios():
        assert load_scenario(name).scenario.name == name


def test_defaults_and_a_little_of_everything(tmp_path):
    assert values(load(tmp_path, ""))["model"] is None
    scenario = load(
        tmp_path,
        """
seed = 5
[trajectory]
kind = "legs"
start_m = [-1, 2, 3]
[[trajectory.leg]]
duration_s = 3
turn_g = 1
[model]
sigma_m = [1, 2, 3]
told_independent = true
[target_motion.roll]
amplitude_deg = 4
period_s = 9
[dropout]
blackout_s = [[1, 2], [4, 5]]
[[range]]
[[range]]
landmark = "bow"
[normals]
bow = [1, 0, 0]
""",
    )
    path = scenario.trajectory
    assert isinstance(path, Legs)
    assert (path.start_m, path.leg[0].turn_g, scenario.seed) == ((-1.0, 2.0, 3.0), 1.0, 5)
    assert scenario.model is not None
    assert scenario.model.sigma_m == (1.0, 2.0, 3.0)
    assert scenario.target_motion.roll is not None
    assert scenario.target_motion.roll.period_s == 9.0
    assert scenario.dropout.blackout_s == ((1.0, 2.0), (4.0, 5.0))
    assert [finder.landmark for finder in scenario.range] == [None, "bow"]
    assert scenario.normals == {"bow": (1.0, 0.0, 0.0)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nois = 1\n", "s.toml: nois: unknown key; did you mean 'noise'?"),
        ("[noise]\nsigma = 1\n", "noise.sigma: unknown key; did you mean 'sigma_px'?"),
        ("[noise]\nsigma_px = 'one'\n", "noise.sigma_px: expected a number, got 'one'"),
        ("[noise]\nsigma_px = true\n", "noise.sigma_px: expected a number, got True"),
        ("[noise]\nsigma_px = -1\n", "noise.sigma_px: expected a number > 0, got -1.0"),
        ("[noise]\nsigma_px = 1e300\n", "noise.sigma_px: expected numbers up to 1e+09, got 1e+300"),
        ("[normals]\nbow = [1e300, 0, 0]\n", "normals: expected numbers up to 1e+09"),
        ("[noise]\nsigma_px = nan\n", "noise.sigma_px: expected a number, got nan"),
        ("[noise]\ntold = 'all'\n", "noise.told: expected one of actual, constant, got 'all'"),
        ("noise = 3\n", "noise: expected a table, got 3"),
        ("[trajectory]\nangle_deg = 3\n", "trajectory.kind: missing"),
        ("[trajectory]\nkind = 'ark'\n", "trajectory.kind: expected one of arc, orbit, rendezvous"),
        ("[trajectory]\nkind = 'arc'\nturns = 3\n", "trajectory.turns: unknown key"),
        ("[trajectory]\nkind = 'approach'\ndistance_m = 10\n", "trajectory.distance_m: expected at least the 312.5 m"),
        ("[trajectory]\nkind = 'legs'\n[[trajectory.leg]]\nturn_g = 1\n", "trajectory.leg[0].duration_s: missing"),
        ("[trajectory]\nkind = 'legs'\nleg = 3\n", "trajectory.leg: expected a list, got 3"),
        ("[trajectory]\nkind = 'recorded'\n", "trajectory.file: missing"),
        ("[trajectory]\nkind = 'recorded'\nfile = '../x.tum'\n", "s.toml: names a file that is not there: '../x.tum'"),
        ("[frames]\ncount = 2.5\n", "frames.count: expected a whole number, got 2.5"),
        ("[frames]\ncount = 0\n", "frames.count: expected 1 to 200000, got 0"),
        ("[model]\nsigma_m = [1, 2]\n", "model.sigma_m: expected 3 numbers, got [1, 2]"),
        ("[model]\ntold_independent = 1\n", "model.told_independent: expected true or false, got 1"),
        ("[swaps]\npairs = [['bow']]\n", "swaps.pairs: expected pairs of names, got ['bow']"),
        ("[swaps]\npairs = [['bow', 'keel']]\n", "swaps.pairs: expected landmarks of frigate, got 'keel'"),
        ("[dropout]\nblackout_s = [[3, 1]]\n", "dropout.blackout_s: expected pairs of two times, begin <= end"),
        ("[dropout]\nblackout_s = [3]\n", "dropout.blackout_s: expected pairs of numbers, got 3"),
        ("[normals]\nkeel = [1, 0, 0]\n", "normals.keel: expected landmarks of frigate"),
        ("[normals]\nbow = [0, 0, 0]\n", "normals.bow: expected a direction"),
        ("normals = 3\n", "normals: expected a table, got 3"),
        ("[pointing]\nat = 'keel'\n", "pointing.at: expected a landmark of frigate, got 'keel'"),
        ("[target_motion]\nabout = 'keel'\n", "target_motion.about: expected a landmark of frigate, got 'keel'"),
        ("[target_motion.roll]\nperiod_s = 0\n", "target_motion.roll.period_s: expected two numbers"),
        ("[[range]]\nlandmark = 'keel'\n", "range[0].landmark: expected a landmark of frigate, got 'keel'"),
        ("[motion]\nkind = 'target'\n", "motion.jerk_density_m_s25: missing"),
        ("[motion]\nkind = 'up'\njerk_density_m_s25 = 1\n", "motion.kind: expected one of range, target, world, none"),
        ("seed = -1\n", "seed: expected a whole number >= 0, got -1"),
        ("target_is = 'true'\n", "target_is: expected one of truth, told, got 'true'"),
        ("[noise\n", "malformed TOML"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, text, message):
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "s.toml"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ('camera = "frigate"\n', "target: missing"),
        (
            'target = "frigatte"\ncamera = "frigate"\n',
            "target: expected a file or the name of data that come along, got 'frigatte'; did you mean 'frigate'?",
        ),
        ('target = "../t.toml"\ncamera = "frigate"\n', "names a file that is not there"),
        (
            'target = "frigate"\ncamera = "scenarios"\n',
            "camera: expected a file or the name of data that come along, got 'scenarios'",
        ),
    ],
)
def test_files_that_are_not_there(tmp_path, head, message):
    (tmp_path / "s.toml").write_text(head)
    with pytest.raises(InputError) as caught:
        load_scenario(tmp_path / "s.toml")
    assert message in str(caught.value)


def test_a_surface_that_is_not_there(tmp_path, repository):
    lines = (repository / "data" / "frigate" / "target.toml").read_text().splitlines()
    (tmp_path / "bare.toml").write_text("\n".join(line for line in lines if not line.startswith("mesh")))
    (tmp_path / "s.toml").write_text('target = "bare.toml"\ncamera = "frigate"\n[occlusion]\nkind = "mesh"\n')
    with pytest.raises(InputError, match=r"s.toml: occlusion.kind: expected a mesh in the target \S+, got none"):
        load_scenario(tmp_path / "s.toml")


def test_a_name_that_does_not_come_along_names_the_nearest():
    with pytest.raises(InputError, match="neither a file nor a scenario that comes along; did you mean 'landing'"):
        load_scenario("landin")
    with pytest.raises(InputError, match="cannot be read"):
        load_scenario("nothing.toml")


def test_a_folder_of_that_name_is_no_scenario(tmp_path, monkeypatch):
    """As after `fairlead simulate arc -o arc`."""
    (tmp_path / "arc").mkdir()
    monkeypatch.chdir(tmp_path)
    assert load_scenario("arc").scenario.name == "arc"


def test_text_survives_toml(tmp_path):
    """Quotes, controls and other scripts in a name."""
    name = 'a "b" \\ \t \x7f \x01 Schiff \u8239'
    text = f"name = {toml_value(name)}\n"
    assert load(tmp_path, text).name == name


def defaults() -> list[tuple[str, str, object]]:
    """(table, key, default) of everything that a scenario may hold."""
    from fairlead.simulate import AttitudeSensor, Leg, ModelError, RangeFinder, Shifting, Turning

    tables = {"trajectory.leg": Leg, "target_motion.roll": Turning, "target_motion.heave": Shifting}
    tables |= {"model": ModelError, "range": RangeFinder, "attitude": AttitudeSensor}
    tables |= {f"trajectory {kind}": path for kind, path in TRAJECTORIES.items()}
    for field in dataclasses.fields(Scenario):
        if field.default_factory is not dataclasses.MISSING and field.name not in ("trajectory", "normals"):
            tables[field.name] = type(field.default_factory())
    return [
        (table, field.name, field.default) for table, record in tables.items() for field in dataclasses.fields(record)
    ]


def test_the_python_of_the_page_runs(repository):
    page = (repository / "docs" / "simulate.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    names: dict[str, object] = {}
    exec(program.replace("range(1000)", "range(2)"), names)
    assert names["run"] == 1
    assert len(names["told"]) == 4


def test_the_page_names_every_key_with_its_default(repository):
    """docs/simulate.md: a row | `key` | default | in the part of each table."""
    page = (repository / "docs" / "simulate.md").read_text(encoding="utf-8")
    rows = set(re.findall(r"^\| `([a-z_0-9]+)` \| ([^|]*?) \|", page, re.MULTILINE))
    missing = []
    for table, key, default in defaults():
        text = "" if default is None or default is dataclasses.MISSING else toml_value(default).strip('"')
        if isinstance(default, tuple) and default and dataclasses.is_dataclass(default[0]):
            continue
        if (key, text) not in rows:
            missing.append(f"{table}.{key} = {text}")
    assert missing == []
