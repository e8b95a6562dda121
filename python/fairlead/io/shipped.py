# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Data that comes with the program."""

import re
from pathlib import Path

import fairlead

DEFAULT_NETWORK = "heat-t"
_NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")


def shipped_data(name: str) -> Path:
    """Folder `data/<name>`: inside an installed package, else at the root of the source tree.

    Raises FileNotFoundError, which means that the installation is broken.
    """
    package = Path(fairlead.__file__).resolve().parent
    for folder in (package / "data" / name, package.parents[1] / "data" / name):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(2, f"data/{name} did not come with this installation", str(package / "data" / name))


def shipped_network(name: str) -> Path | None:
    """`frigate` or `frigate/rtmpose-t`: a network that came with a target, DEFAULT_NETWORK if none is named.

    None where there is no such file.
    """
    target, _, network = name.partition("/")
    if not (_NAME.fullmatch(target) and _NAME.fullmatch(network or DEFAULT_NETWORK)):
        return None
    try:
        path = shipped_data(target) / f"{network or DEFAULT_NETWORK}.onnx"
    except FileNotFoundError:
        return None
    return path if path.is_file() else None
