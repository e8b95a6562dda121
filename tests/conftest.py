# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What every test has: checked array shapes, deterministic hypothesis, the repository's folders."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import hypothesis
import pytest
from jaxtyping import install_import_hook

if TYPE_CHECKING:
    from tests.clip import Clip

# Every annotated shape of the package is verified while tests run; in production the annotations are free.
install_import_hook("fairlead", "beartype.beartype")

hypothesis.settings.register_profile("fixed", derandomize=True, deadline=None, database=None, max_examples=50)
hypothesis.settings.register_profile("long", deadline=None, max_examples=2000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "fixed"))

ROOT = Path(__file__).resolve().parent.parent


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="accept new numbers, printing old -> new")


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the repository."""
    return ROOT


@pytest.fixture(scope="session")
def update_golden(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--update-golden"))


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the recordings that are no part of the repository: FAIRLEAD_SHARED_DATA, else ../shared/data."""
    folder = Path(os.environ.get("FAIRLEAD_SHARED_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"recordings are not here: {folder} (set FAIRLEAD_SHARED_DATA)")
    return folder


@pytest.fixture(scope="session")
def marker_pen(shared_data: Path) -> Path:
    """Photographs of a pen with eight tags whose nominal model is wrong."""
    return shared_data / "marker_pen"


@pytest.fixture(scope="session")
def temple_ring(shared_data: Path) -> Path:
    """Photographs of a plaster temple with camera poses from a gantry."""
    return shared_data / "temple_ring"


@pytest.fixture(scope="session")
def clip(tmp_path_factory: pytest.TempPathFactory) -> "Clip":
    """Forty drawn images of a book of tags; the images are read-only."""
    from tests.clip import make_clip

    made = make_clip(tmp_path_factory.mktemp("clip"))
    for image in made.images:
        image.setflags(write=False)
    return made
