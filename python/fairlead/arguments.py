# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Words of the command line -> a frozen config; what is wrong with them in one line."""

import contextlib
import io
import re
import sys
from collections.abc import Sequence
from typing import Any

import tyro

from fairlead.config import UsageError

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
"""What makes letters red or bold on a terminal."""


def parse_arguments(forms: Any, words: Sequence[str] | None, *, prog: str, description: str) -> Any:
    """The config, one of `forms`, that the words spell; help goes to stdout, and then SystemExit.

    Raises UsageError with the one line that says what is wrong.
    """
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            config = tyro.cli(forms, prog=prog, description=description, args=words)
    except SystemExit as ended:
        if not ended.code:
            raise
        raise _own(ended) or UsageError(_unframed(said.getvalue())) from None
    sys.stderr.write(said.getvalue())
    return config


def _own(ended: BaseException) -> UsageError | None:
    """The error of a config that made the parser end, if that is why."""
    cause = ended.__context__
    while cause is not None and not isinstance(cause, UsageError):
        cause = cause.__context__
    return cause


def _unframed(panel: str) -> str:
    """The text of the parser's panel without its frame, its title and its last part, which names the help."""
    parts = [""]
    for line in _COLOUR.sub("", panel).splitlines()[1:-1]:  # title and bottom
        text = line.strip("│| ")
        if text and not text.strip("─-"):
            parts.append("")
        else:
            parts[-1] += f" {text}"
    told = [part.strip().rstrip(".") for part in parts if part.strip() and "full helptext" not in part]
    return "; ".join(told) or "arguments that cannot be used"
