# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Whatever a person does to a scenario, it ends in a flight of finite numbers or in one line."""

from dataclasses import replace

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from fairlead.io.errors import InputError
from fairlead.simulate import load_scenario, shipped_scenarios, simulate

VALUES = (
    *("0", "-1", "1e308", "1e9", "-1e9", "nan", "inf", "1e-300", "90", "0.5", "100000000000", "true", "'x'", "''"),
    *("[]", "[1]", "[1, 2, 3]", "[nan, 1, 2]", "[1e300, 1, 1]", "[[1, 2]]", "[['bow', 'bow']]", "{}", "2026-01-01"),
)
EDITS = st.lists(st.tuples(st.integers(0, 200), st.sampled_from([*VALUES, None])), min_size=1, max_size=3)


def edited(text: str, edits: list[tuple[int, str | None]]) -> str:
    """Some values replaced, some lines left out."""
    lines = text.splitlines()
    for number, value in edits:
        keys = [index for index, line in enumerate(lines) if "=" in line and not line.startswith("#")]
        index = keys[number % len(keys)]
        lines[index] = "" if value is None else f"{lines[index].split('=')[0]}= {value}"
    return "\n".join(lines)


@example(name="rough", edits=[(4, "0")])
@example(name="landing", edits=[(3, "1e9")])
@given(name=st.sampled_from(shipped_scenarios()), edits=EDITS)
def test_it_flies_or_says_why(tmp_path_factory, repository, name, edits):
    path = tmp_path_factory.mktemp("edits") / "s.toml"
    path.write_text(edited((repository / "data" / "scenarios" / f"{name}.toml").read_text(), edits))
    try:
        scenario = load_scenario(path).scenario
        flight = simulate(replace(scenario, frames=replace(scenario.frames, rate_hz=None, count=4)), 1)
    except ValueError as error:
        assert_is_one_line(error, path)
        return
    assert np.isfinite(flight.T_true).all()
    for view in flight.views:
        assert np.isfinite(view.pixels).all()
        assert np.isfinite(view.covariances).all()


def assert_is_one_line(error, path):
    """Of the file where it is read; of the flight where it cannot be flown."""
    assert "expected" in str(error) or "malformed" in str(error) or "names a file" in str(error)
    assert "\n" not in str(error)
    assert str(error).startswith(str(path)) == isinstance(error, InputError)
