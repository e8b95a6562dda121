# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""target.toml: what it may say, and what is said about it when it is wrong."""

from pathlib import Path

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.io.target import load_target, save_target

GOOD = """
name = "frigate"
[prior]
sigma_m = 1.0
scale_sigma = 0.01
[motion]
kind = "target"
jerk_density_m_s25 = 0.2
[touchdown]
position_m = [1.0, 2.0, 3.0]
[[landmark]]
name = "bow"
position_m = [140.0, 0.0, 10.0]
sigma_m = 0.5
[[landmark]]
name = "mast"
position_m = [70, 0, 30]
sigma_m = [0.1, 0.2, 0.3]
[[landmark]]
name = "stern"
position_m = [0.0, 0.0, 5.0]
[[distance]]
between = ["bow", "stern"]
length_m = 140.1
sigma_m = 0.05
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "target.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_field_is_read(tmp_path: Path) -> None:
    target = load_target(write(tmp_path, GOOD))
    assert target.name == "frigate"
    assert target.landmarks == ("bow", "mast", "stern")
    assert target.positions[1].tolist() == [70.0, 0.0, 30.0]
    assert target.motion is not None
    assert target.motion.kind == "target"
    assert target.touchdown is not None
    assert target.touchdown.tolist() == [1.0, 2.0, 3.0]
    assert target.distances[0].between == ("bow", "stern")
    assert target.mesh is None


def test_prior_is_independent_errors_plus_shared_scale(tmp_path: Path) -> None:
    target = load_target(write(tmp_path, GOOD))
    sigmas = np.array([0.5, 0.5, 0.5, 0.1, 0.2, 0.3, 1.0, 1.0, 1.0])
    x0 = np.array([70.0, 0.0, -5.0, 0.0, 0.0, 15.0, -70.0, 0.0, -10.0])  # about the centroid (70, 0, 15)
    assert np.allclose(target.covariance, np.diag(sigmas**2) + 1e-4 * np.outer(x0, x0), rtol=1e-14)


def test_sigma_0_fixes_a_landmark_and_scale_defaults_to_none(tmp_path: Path) -> None:
    text = 'name = "t"\n[[landmark]]\nname = "a"\nposition_m = [1, 2, 3]\nsigma_m = 0\n'
    assert not load_target(write(tmp_path, text)).covariance.any()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "frigate"', "", "name: missing"),
        ('name = "frigate"', "name = 3", "name: expected text, got 3"),
        ("scale_sigma", "scale_sgima", "prior.scale_sgima: unknown key; did you mean 'scale_sigma'?"),
        ("[touchdown]", "[touchdwon]", "touchdwon: unknown key; did you mean 'touchdown'?"),
        ("sigma_m = 1.0", "sigma_m = -1.0", "prior.sigma_m: expected a number >= 0, got -1.0"),
        ("sigma_m = 1.0", "sigma_m = nan", "prior.sigma_m: expected a number >= 0, got nan"),
        ("sigma_m = 1.0", 'sigma_m = "1.0"', "prior.sigma_m: expected a number >= 0, got '1.0'"),
        ("sigma_m = 1.0", "", r"landmark[2].sigma_m: missing, and [prior] has no sigma_m"),
        ("sigma_m = [0.1, 0.2, 0.3]", "sigma_m = [0.1, 0.2]", "landmark[1].sigma_m: expected 3 numbers"),
        ("sigma_m = [0.1, 0.2, 0.3]", "sigma_m = [0.1, -0.2, 0.3]", "landmark[1].sigma_m: expected numbers >= 0"),
        ("position_m = [70, 0, 30]", "position_m = [70, 0]", "landmark[1].position_m: expected 3 numbers, got [70, 0]"),
        ("position_m = [70, 0, 30]", "position_m = [70, 0, inf]", "landmark[1].position_m: expected finite numbers"),
        ("position_m = [70, 0, 30]", "position_m = [70, true, 1]", "landmark[1].position_m: expected finite numbers"),
        ("position_m = [70, 0, 30]", "positon_m = [70, 0, 30]", "did you mean 'position_m'?"),
        ('name = "mast"', 'name = "bow"', "'bow' more than once"),
        ('between = ["bow", "stern"]', 'between = ["bow", "keel"]', "no landmark is named 'keel'"),
        ('between = ["bow", "stern"]', 'between = ["bow"]', "distance[0].between: expected two landmark names"),
        ("length_m = 140.1", "length_m = 0", "length_m: expected a positive number"),
        ('kind = "target"', 'kind = "warp"', "motion.kind: expected one of range, target, world, none, got 'warp'"),
        ("jerk_density_m_s25 = 0.2", "", "motion.jerk_density_m_s25: missing"),
        ("[[landmark]]", "[[landmrak]]", "landmrak: unknown key; did you mean 'landmark'?"),
        ("[motion]", "motion]", "malformed TOML"),
        ("[motion]", "motion = 3\n[other]", "unknown key"),
        ('name = "frigate"', 'name = "frigate"\nmesh = "../frigate.ply"', "not there"),
        ("sigma_m = 1.0", 'covariance = "none.npz"', "names a file that is not there: 'none.npz'"),
    ],
)
def test_one_line_says_what_is_wrong(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    path = write(tmp_path, GOOD.replace(old, new))
    with pytest.raises(InputError) as caught:
        load_target(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_nothing_but_text_is_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        load_target(tmp_path / "none.toml")
    with pytest.raises(InputError, match="directory"):
        load_target(tmp_path)
    path = tmp_path / "target.toml"
    path.write_bytes(b'name = "\xff"')
    with pytest.raises(InputError, match=r"target.toml:1: byte 0xff is not UTF-8"):
        load_target(path)
    path.write_bytes(b"#" * (17 * 1024 * 1024))
    with pytest.raises(InputError, match="larger than"):
        load_target(path)
    path.write_text("name = " + "[" * 100_000)
    with pytest.raises(InputError, match="malformed TOML"):
        load_target(path)
    path.write_text('name = "none"')
    with pytest.raises(InputError, match="expected 1 to 2048 landmarks, got 0"):
        load_target(path)


def test_names_in_the_file_stay_under_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    folder.mkdir()
    (tmp_path / "secret.ply").write_text("ply")
    (folder / "link.ply").symlink_to(tmp_path / "secret.ply")
    (folder / "inside.ply").write_text("ply")
    head, tail = GOOD.split("[prior]", 1)
    for name in ("../secret.ply", "link.ply", str(tmp_path / "secret.ply")):
        path = write(folder, f'{head}mesh = "{name}"\n[prior]{tail}')
        with pytest.raises(InputError, match="outside its folder"):
            load_target(path)
    path = write(folder, f'{head}mesh = "inside.ply"\n[prior]{tail}')
    assert load_target(path).mesh == (folder / "inside.ply").resolve()


def test_mesh_survives_where_it_lies_beside(tmp_path: Path) -> None:
    (tmp_path / "frigate.ply").write_text("ply")
    head, tail = GOOD.split("[prior]", 1)
    target = load_target(write(tmp_path, f'{head}mesh = "frigate.ply"\n[prior]{tail}'))
    save_target(tmp_path / "again.toml", target)
    assert load_target(tmp_path / "again.toml").mesh == (tmp_path / "frigate.ply").resolve()
    elsewhere = tmp_path / "run"
    elsewhere.mkdir()
    save_target(elsewhere / "target.toml", target)
    assert load_target(elsewhere / "target.toml").mesh is None
    assert "# mesh" in (elsewhere / "target.toml").read_text()


def test_covariance_beside_replaces_the_sigmas_in_any_order(tmp_path: Path) -> None:
    target = load_target(write(tmp_path, GOOD))
    save_target(tmp_path / "refined.toml", target)
    assert np.array_equal(load_target(tmp_path / "refined.toml").covariance, target.covariance)
    order = [2, 0, 1]
    rows = (3 * np.array(order)[:, None] + np.arange(3)).ravel()
    names = np.array(target.landmarks)[order]
    np.savez(tmp_path / "refined.npz", landmarks=names, covariance=target.covariance[np.ix_(rows, rows)])
    assert np.array_equal(load_target(tmp_path / "refined.toml").covariance, target.covariance)


def test_a_name_that_no_target_can_have_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    target = load_target(write(tmp_path, GOOD))
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "beside.npz").mkdir()
    before = sorted(tmp_path.rglob("*"))
    for name, message in (
        ("pen.npz", r"pen\.npz: is no name of a target; expected one that ends in \.toml"),
        ("pen", r"pen: is no name of a target"),
        ("folder", r"folder: is a folder"),
        ("folder.toml", r"folder\.toml: is a folder"),
        ("beside.toml", r"beside\.npz: is a folder"),
    ):
        with pytest.raises(InputError, match=message):
            save_target(tmp_path / name, target)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.fixture
def refined(tmp_path: Path) -> Path:
    save_target(tmp_path / "refined.toml", load_target(write(tmp_path, GOOD)))
    return tmp_path / "refined.toml"


NAMES = np.array(["bow", "mast", "stern"])


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"landmarks": NAMES.astype(object), "covariance": np.eye(9)}, "no usable npz: Object arrays"),
        ({"landmarks": NAMES, "covariance": np.eye(9).astype(object)}, "no usable npz: Object arrays"),
        ({"landmarks": NAMES}, "expected arrays landmarks and covariance, got landmarks.npy"),
        ({"landmarks": NAMES, "covariance": np.eye(6)}, "expected shape (9, 9), got (6, 6)"),
        ({"landmarks": NAMES[:2], "covariance": np.eye(9)}, "expected the landmarks of the target"),
        ({"landmarks": NAMES, "covariance": -np.eye(9)}, "positive semidefinite"),
        ({"landmarks": NAMES, "covariance": np.full((9, 9), np.nan)}, "positive semidefinite"),
        ({"landmarks": NAMES, "covariance": np.eye(900)}, "larger than 3 landmarks need"),
        ({"landmarks": NAMES, "covariance": np.array(["x"] * 81).reshape(9, 9)}, "no usable npz"),
    ],
)
def test_a_covariance_file_that_cannot_be_used(refined: Path, arrays: dict[str, np.ndarray], message: str) -> None:
    np.savez(refined.with_suffix(".npz"), **arrays)
    with pytest.raises(InputError) as caught:
        load_target(refined)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_npz_is_never_unpickled(refined: Path) -> None:
    """A pickle that would create a file when it is loaded."""
    witness = refined.parent / "executed"

    class Trap:
        def __reduce__(self) -> tuple[object, ...]:
            return (Path.touch, (witness,))

    np.savez(refined.with_suffix(".npz"), landmarks=NAMES, covariance=np.array([Trap()], dtype=object))
    with pytest.raises(InputError):
        load_target(refined)
    refined.with_suffix(".npz").write_bytes(refined.with_suffix(".npz").read_bytes()[:50])
    with pytest.raises(InputError, match="no usable npz"):
        load_target(refined)
    assert not witness.exists()
