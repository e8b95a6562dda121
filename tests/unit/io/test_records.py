# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""run.json, option files, and lines that survive whatever happens to the writer."""

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from fairlead.io.csv_lines import CsvWriter
from fairlead.io.errors import InputError, one_line
from fairlead.io.options import load_options
from fairlead.io.run_record import RunRecord, input_file, read_run_record, write_json, write_run_record


@dataclass(frozen=True, kw_only=True)
class Options:
    size: int = 3
    gate: float = 2.5
    fast: bool = False
    name: str = "x"
    path: Path | None = None

    def __post_init__(self) -> None:
        if self.size < 1:
            raise ValueError(f"size: expected at least 1, got {self.size}")


def test_run_record_says_what_ran_on_what(tmp_path: Path) -> None:
    source = tmp_path / "a.csv"
    source.write_text("abc")
    record = RunRecord(
        command="track",
        state="running",
        options=Options(path=tmp_path, gate=float("inf")),
        inputs=(input_file("source", source),),
        seed=7,
        frames=3,
        frames_with_pose=2,
    )
    write_run_record(tmp_path / "run.json", record)
    document = json.loads((tmp_path / "run.json").read_text())
    assert document["inputs"][0]["sha256"] == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert document["options"] == {"size": 3, "gate": "inf", "fast": False, "name": "x", "path": str(tmp_path)}
    assert document["versions"]["numpy"]
    again = read_run_record(tmp_path / "run.json")
    assert (again.command, again.state, again.seed) == ("track", "running", 7)
    assert (again.frames, again.frames_with_pose) == (3, 2)
    assert again.input_path("source") == source
    assert again.input_path("truth") is None


def test_hash_of_a_folder_sees_names_and_sizes(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("1")
    first = input_file("source", tmp_path)
    (tmp_path / "a.png").write_text("22")
    second = input_file("source", tmp_path)
    (tmp_path / "a.png").rename(tmp_path / "b.png")
    assert len({first.sha256, second.sha256, input_file("source", tmp_path).sha256}) == 3


@pytest.mark.parametrize("text", ["", "[]", "{", '{"version": 1}', '{"version": 2}', "[" * 100_000])
def test_wrong_run_records(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(InputError, match=r"run\.json"):
        read_run_record(tmp_path / "run.json")


def test_a_run_record_of_another_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    write_run_record(path, RunRecord(command="track", state="done", options=None, inputs=()))
    path.write_text(path.read_text().replace('"version": 1', '"version": 2'))
    with pytest.raises(InputError, match="version: expected 1, got 2"):
        read_run_record(path)


def test_json_never_holds_nan(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "m.json", {"a": float("nan")})
    assert not (tmp_path / "m.json").exists()


def test_option_files_change_only_what_they_name(tmp_path: Path) -> None:
    path = tmp_path / "options.toml"
    path.write_text('size = 5\nfast = true\ngate = 1\nname = "y"\n')
    assert load_options(path, Options()) == Options(size=5, fast=True, gate=1.0, name="y")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sise = 5", "sise: unknown key; did you mean 'size'?"),
        ("size = 5.5", "size: expected a whole number, got 5.5"),
        ("size = true", "size: expected a whole number"),
        ("fast = 1", "fast: expected true or false, got 1"),
        ('gate = "wide"', "gate: expected a number, got 'wide'"),
        ("size = 0", "size: expected at least 1, got 0"),
        ("name = 3", "name: expected text"),
    ],
)
def test_wrong_option_files(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "options.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_options(path, Options())
    assert message in str(caught.value)


def test_rows_are_on_disk_when_write_returns(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    writer = CsvWriter(path, ("a", "b"))
    writer.write_rows([(1, 'x "y", z'), (2.5, "")])
    assert path.read_text() == 'a,b\n1,"x ""y"", z"\n2.5,\n'
    with pytest.raises(ValueError, match="expected 2 cells, got 1"):
        writer.write_rows([(1,)])
    writer.close()


def test_a_row_that_does_not_fit_is_cut_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    writer = CsvWriter(path, ("a",))
    writer.write_rows([("first",)])
    stream = writer._stream

    class AlmostFull:
        """Takes two bytes, then says that the disk is full."""

        taken = 0

        def write(self, data: bytes) -> int:
            if self.taken:
                raise OSError(28, "No space left on device")
            self.taken = stream.write(data[:2])
            return self.taken

        def __getattr__(self, name: str) -> object:
            return getattr(stream, name)

    monkeypatch.setattr(writer, "_stream", AlmostFull())
    with pytest.raises(OSError, match="No space left"):
        writer.write_rows([("second",)])
    writer.close()
    assert path.read_text() == "a\nfirst\n"


def test_messages_are_one_printable_line() -> None:
    assert one_line("a\n  b\x1b[31m\tc") == "a b?[31m c"
    assert len(one_line("x" * 1000)) == 400
    assert str(InputError("f.csv", "bad\nthing", line=3)) == "f.csv:3: bad thing"
