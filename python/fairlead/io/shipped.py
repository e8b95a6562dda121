# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Data that comes with the program."""

from pathlib import Path

import fairlead


def shipped_data(name: str) -> Path:
    """Folder `data/<name>`: inside an installed package, else at the root of the source tree.

    Raises FileNotFoundError, which means that the installation is broken.
    """
    package = Path(fairlead.__file__).resolve().parent
    for folder in (package / "data" / name, package.parents[1] / "data" / name):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(2, f"data/{name} did not come with this installation", str(package / "data" / name))
