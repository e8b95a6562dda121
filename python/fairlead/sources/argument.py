# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A source as it stands on the command line."""

from pathlib import Path
from typing import Annotated

from tyro.constructors import PrimitiveConstructorSpec


def parse_source(text: str) -> Path | str:
    """A path, or the name of something live as it is."""
    return text if "://" in text or text.startswith("camera:") else Path(text)


Source = Annotated[
    Path | str,
    PrimitiveConstructorSpec(
        nargs=1,
        metavar="SOURCE",
        instance_from_str=lambda words: parse_source(words[0]),
        is_instance=lambda value: isinstance(value, Path | str),
        str_from_instance=lambda value: [str(value)],
    ),
]
"""A path, or text for what is live: `camera:0`, `rtsp://...`."""
